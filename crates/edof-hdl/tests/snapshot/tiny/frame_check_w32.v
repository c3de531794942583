// The CRC (`edof_device::crc`) of every frame of beats that passes a boundary, and how many frames there were.
// It only looks: nothing waits for it.
// A snapshot copies the last whole frame's CRC and number to where they are shown, so that those of several
// boundaries belong together.
//
// No output follows an input within the cycle.
//
// From crates/edof-hdl/src/blocks/frame_check.rs (FrameCheck).
`default_nettype none

module frame_check_w32 #(
  parameter [27:0] LAST_BEAT = 28'd383
) (
  input wire clock_i,        // Clock.
  input wire reset_i,        // The next beat is a frame's first, and the first frame's.

  input wire valid_i,        // A beat passes in this cycle.
  input wire [31:0] data_i,  // It.
  input wire snapshot_i,     // Copies CRC and number.
  output wire [31:0] crc_o,  // CRC of the last frame that was whole when the snapshot was taken; 0 before.
  output wire [7:0] frames_o // Frames that were whole by then, modulo 256.
);

  wire [1:0] resets_later;
  wire [31:0] made_crc;
  reg valid_q, fresh_q, at_end_q, ends_q;
  reg [27:0] left_q;
  reg [31:0] whole_q, shown_q;
  reg [7:0] frames_q, shown_frames_q;

  // frame_check.rs:56
  wire [1:0] resets_now = reset_i ? 2'd3 : 2'd0;

  // frame_check.rs:83: Which beat it is; the CRC is made a cycle after its last one.
  assign crc_o = shown_q;
  assign frames_o = shown_frames_q;

  edof_delay #(.WIDTH(2), .CYCLES(1)) resets (.clock_i(clock_i), .now_i(resets_now), .later_o(resets_later));

  edof_crc #(.WIDTH(32)) made (
    .clock_i(clock_i), .valid_i(valid_q), .first_i(fresh_q), .data_i(data_i), .crc_o(made_crc)
  );

  always @(posedge clock_i) begin
    // frame_check.rs:60
    valid_q <= valid_i;
    // frame_check.rs:66: Which beat it is; the CRC is made a cycle after its last one.
    ends_q <= valid_q && at_end_q;
    if (valid_q) begin
      fresh_q <= at_end_q;
      left_q <= left_q - 28'd1;
      at_end_q <= left_q == 28'd1;
      if (at_end_q) left_q <= LAST_BEAT;
    end
    if (ends_q) begin
      whole_q <= made_crc;
      frames_q <= frames_q + 8'd1;
    end
    if (snapshot_i) begin
      shown_q <= whole_q;
      shown_frames_q <= frames_q;
    end
    if (reset_i) begin
      valid_q <= 1'b0;
      fresh_q <= 1'b1;
      left_q <= LAST_BEAT;
      at_end_q <= 1'b0;
      ends_q <= 1'b0;
    end
    if (resets_later[0]) begin
      whole_q <= 32'd0;
      frames_q <= 8'd0;
    end
    if (resets_later[1]) begin
      shown_q <= 32'd0;
      shown_frames_q <= 8'd0;
    end
  end
endmodule

`default_nettype wire
