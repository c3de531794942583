// The CRC (`edof_device::crc`) of every frame of beats that passes a boundary, and how many frames there were.
// It only looks: nothing waits for it. A snapshot copies the last whole frame's CRC and number to where they
// are shown, so that those of several boundaries belong together.
// From crates/edof-hdl/src/blocks/frame_check.rs (FrameCheck).
`default_nettype none
module frame_check #(
  parameter [27:0] LAST_BEAT = 28'd383
) (
  input wire clock_i, input wire reset_i, // The next beat is a frame's first, and the first frame's.
  input wire valid_i,                     // A beat passes in this cycle.
  input wire [31:0] data_i,               // The beat, in the low bits.
  input wire snapshot_i,                  // Copies CRC and number.
  // CRC of the last frame that was whole when the snapshot was taken; 0 before.
  output wire [31:0] crc_o,
  output wire [7:0] frames_o              // Frames that were whole by then, modulo 256.
);

  localparam WIDTH = 32; // Bits of a beat.

  reg valid_q, is_first_q, at_end_q, ends_q;
  reg [27:0] remaining_q;
  reg [31:0] whole_q, latched_q;
  reg [7:0] frames_q, latched_frames_q;

  assign crc_o = latched_q, frames_o = latched_frames_q;
  wire [1:0] resets_data = reset_i ? 2'd3 : 2'd0;

  wire [1:0] delayed;
  edof_delay #(.WIDTH(2), .CYCLES(1)) resets (.clock_i(clock_i), .data_i(resets_data), .data_o(delayed));

  wire [31:0] frame_crc_crc;
  edof_crc #(.WIDTH(WIDTH)) frame_crc (
    .clock_i(clock_i), .valid_i(valid_q), .first_i(is_first_q), .data_i(data_i), .crc_o(frame_crc_crc)
  );

  always @(posedge clock_i) begin
    valid_q <= valid_i;
    // Which beat it is; the CRC is made a cycle after its last one.
    ends_q <= valid_q && at_end_q;
    if (valid_q) begin
      is_first_q <= at_end_q;
      remaining_q <= remaining_q - 28'd1;
      at_end_q <= remaining_q == 28'd1;
      if (at_end_q) remaining_q <= LAST_BEAT;
    end
    if (ends_q) begin
      whole_q <= frame_crc_crc;
      frames_q <= frames_q + 8'd1;
    end
    if (snapshot_i) begin
      latched_q <= whole_q;
      latched_frames_q <= frames_q;
    end
    if (delayed[0]) {whole_q, frames_q} <= 0;
    if (delayed[1]) {latched_q, latched_frames_q} <= 0;
    if (reset_i) begin
      {valid_q, at_end_q, ends_q} <= 0;
      is_first_q <= 1'b1;
      remaining_q <= LAST_BEAT;
    end
  end
endmodule
`default_nettype wire
