// From dense vectors to (index, value) pairs: four slots, one fills while others wait and one is read, as often
// as there are passes. Ready while fewer than four are full. With skip_zeros only non-zero elements are kept.
// Pair 2r of slot s lies at row 128 s + r of the even memory, pair 2r + 1 at the same row of the odd one; both
// are read two cycles after read_row. A vector's descriptor comes three cycles after its last beat.
// From crates/edof-hdl/src/blocks/pair_store.rs (PairStore).
`default_nettype none
module pair_store #(
  parameter DENSE = 1, // 1 in the stage that is dense (I), where the memories are absent.
  parameter TWO_ROWS = 1'b0
) (
  input wire clock_i, input wire reset_i, // Empties all slots.
  input wire skip_zeros_i,                // Whether zeros are left out.
  input wire valid_i,                     // The input beat is valid.
  output wire ready_o,                    // The block accepts a valid input in this cycle.
  input wire [15:0] even_i,               // Element of even index.
  input wire [15:0] odd_i,                // Element of odd index.
  input wire last_i,                      // Whether the beat is its vector's last.
  input wire set_i,                       // The vector's set.
  output wire arrived_o,                  // A vector is whole.
  output wire [11:0] descriptor_o,        // What the sequencer must know of it.
  input wire [8:0] read_row_i,            // Which two pairs to read.
  output wire [24:0] even_pair_o,         // The even one of the two, two cycles later.
  output wire [24:0] odd_pair_o,          // The odd one.
  input wire finished_i                   // Frees the slot that is read.
);

  localparam [2:0] ALL_SLOTS = 3'd4;

  reg [2:0] full_q;
  reg ready_q, valid_1_q, last_1_q, set_1_q, valid_2_q, store_even_2_q, store_odd_2_q, last_2_q, set_2_q;
  reg even_write_3_q, odd_write_3_q, arrived_3_q, set_3_q;
  reg [15:0] even_1_q, odd_1_q, even_2_q, odd_2_q;
  reg [7:0] beat_q;
  reg [8:0] stored_q, count_3_q;
  reg [1:0] write_slot_q;
  reg [11:0] even_row_3_q, odd_row_3_q;
  reg [24:0] even_data_3_q, odd_data_3_q;

  // Room for a vector.
  assign ready_o = ready_q;
  wire accept = valid_i && ready_q;

  reg [2:0] full_next;
  always @* begin
    full_next = full_q;
    if (accept && last_i && !finished_i) full_next = full_q + 3'd1;
    else if (finished_i && (!(accept && last_i))) full_next = full_q - 3'd1;
  end

  // Where they go.
  wire store_one = store_even_2_q || store_odd_2_q;
  wire store_both = store_even_2_q && store_odd_2_q;
  wire [24:0] arrived_even = {beat_q, 1'b0, even_2_q};
  wire [24:0] arrived_odd = {beat_q, 1'b0, odd_2_q} | 25'h10000;
  wire [24:0] arrived_first = store_even_2_q ? arrived_even : arrived_odd;
  wire [11:0] row = {3'd0, write_slot_q, 7'd0} | {4'd0, stored_q[8:1]};
  wire [8:0] stored_next = store_both ? (stored_q + 9'd2) : (store_one ? (stored_q + 9'd1) : stored_q);
  wire [8:0] before_last = count_3_q - 9'd1;

  reg [7:0] steps;
  reg [3:0] flags;
  always @* begin
    steps = before_last[7:0];
    flags = {3'd0, set_3_q};
    if (count_3_q[0]) flags = flags | 4'd2;
    if (count_3_q == 9'd1) flags = flags | 4'd8;
    if (TWO_ROWS) begin
      steps = before_last[8:1];
      if (count_3_q == 9'd2) flags = flags | 4'd8;
    end
    if (count_3_q == 9'd0) begin
      steps = 8'd0;
      flags = flags | 4'he;
    end
  end

  assign arrived_o = arrived_3_q;
  assign descriptor_o = {steps, flags};

  edof_ram #(.WIDTH(25), .DEPTH(DENSE ? 0 : 512), .BLOCK(2), .INIT("")) even_pairs (
    .clock_i(clock_i), .read_address_i({3'd0, read_row_i}), .read_data_o(even_pair_o),
    .write_enable_i(even_write_3_q), .write_address_i(even_row_3_q), .write_data_i(even_data_3_q)
  );
  edof_ram #(.WIDTH(25), .DEPTH(DENSE ? 0 : 512), .BLOCK(2), .INIT("")) odd_pairs (
    .clock_i(clock_i), .read_address_i({3'd0, read_row_i}), .read_data_o(odd_pair_o),
    .write_enable_i(odd_write_3_q), .write_address_i(odd_row_3_q), .write_data_i(odd_data_3_q)
  );

  always @(posedge clock_i) begin
    full_q <= full_next;
    ready_q <= full_next != ALL_SLOTS;
    // Which elements are kept.
    valid_1_q <= accept;
    even_1_q <= even_i;
    odd_1_q <= odd_i;
    last_1_q <= last_i;
    set_1_q <= set_i;
    valid_2_q <= valid_1_q;
    store_even_2_q <= valid_1_q && (!skip_zeros_i || (|even_1_q));
    store_odd_2_q <= valid_1_q && (!skip_zeros_i || (|odd_1_q));
    even_2_q <= even_1_q;
    odd_2_q <= odd_1_q;
    last_2_q <= last_1_q;
    set_2_q <= set_1_q;
    even_write_3_q <= store_one;
    even_row_3_q <= row;
    even_data_3_q <= arrived_first;
    odd_write_3_q <= store_both;
    odd_row_3_q <= row;
    odd_data_3_q <= arrived_odd;
    if (stored_q[0]) begin
      even_write_3_q <= store_both;
      even_row_3_q <= row + 12'd1;
      even_data_3_q <= arrived_odd;
      odd_write_3_q <= store_one;
      odd_data_3_q <= arrived_first;
    end
    if (valid_2_q) begin
      beat_q <= beat_q + 8'd1;
      stored_q <= stored_next;
      if (last_2_q) begin
        {beat_q, stored_q} <= 0;
        write_slot_q <= write_slot_q + 2'd1;
      end
    end
    arrived_3_q <= valid_2_q && last_2_q;
    count_3_q <= stored_next;
    set_3_q <= set_2_q;
    if (reset_i) begin
      {full_q, ready_q, valid_1_q, valid_2_q, store_even_2_q, store_odd_2_q, beat_q, stored_q, write_slot_q,
          even_write_3_q, odd_write_3_q, arrived_3_q} <= 0;
    end
  end
endmodule
`default_nettype wire
