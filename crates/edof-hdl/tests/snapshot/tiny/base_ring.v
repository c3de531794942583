// Base words that wait for their sums: a ring of eight vectors in block RAM, written as they arrive, read as
// their sums are taken. The ring never overflows: a stage holds at most four vectors in its store and three in
// its multipliers and drain. Vector v lies from row 128 v on.
// From crates/edof-hdl/src/blocks/base_ring.rs (BaseRing).
`default_nettype none
module base_ring #(
  parameter HAS_BASE = 0, // 1 where a base is added (M).
  parameter INPUTS = 64
) (
  input wire clock_i, input wire reset_i, // Empties the memory.
  input wire write_i,                     // A beat arrives.
  input wire [31:0] words_i,              // Two base words of the beat.
  input wire read_i,                      // Moves on to the next two.
  output wire [31:0] front_o              // The two that stood first two cycles ago.
);

  localparam [31:0] LAST_BEAT = INPUTS / 2 - 1;

  reg write_q;
  reg [31:0] words_q;
  reg [6:0] write_beat_q, read_beat_q;
  reg [2:0] write_vector_q, read_vector_q;

  edof_ram #(.WIDTH(32), .DEPTH(HAS_BASE * 1024), .BLOCK(2), .INIT("")) ram (
    .clock_i(clock_i), .read_address_i({2'd0, read_vector_q, read_beat_q}), .read_data_o(front_o),
    .write_enable_i(write_q), .write_address_i({2'd0, write_vector_q, write_beat_q}),
    .write_data_i(words_q)
  );

  always @(posedge clock_i) begin
    write_q <= write_i;
    words_q <= words_i;
    if (write_q) begin
      write_beat_q <= write_beat_q + 7'd1;
      if (write_beat_q == LAST_BEAT[6:0]) begin
        write_beat_q <= 7'd0;
        write_vector_q <= write_vector_q + 3'd1;
      end
    end
    if (read_i) begin
      read_beat_q <= read_beat_q + 7'd1;
      if (read_beat_q == LAST_BEAT[6:0]) begin
        read_beat_q <= 7'd0;
        read_vector_q <= read_vector_q + 3'd1;
      end
    end
    if (reset_i) {write_q, write_beat_q, write_vector_q, read_beat_q, read_vector_q} <= 0;
  end
endmodule
`default_nettype wire
