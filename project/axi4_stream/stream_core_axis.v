// From raw pixels to codes with AXI4-Stream ports, as AXI4-Stream video: TUSER begins a frame, TLAST ends a line. See docs/own-design.md.
`default_nettype none

module stream_core_axis (
  input  wire        aclk,
  input  wire        aresetn,
  // Raw pixels, red first; lines and frames are counted from the reset on.
  input  wire        s_axis_tvalid,
  output wire        s_axis_tready,
  input  wire [15:0] s_axis_tdata,
  // Codes: luma low, Cb or Cr high.
  output wire        m_axis_tvalid,
  input  wire        m_axis_tready,
  output wire [15:0] m_axis_tdata,
  output wire        m_axis_tlast,
  output wire        m_axis_tuser,
  // High for 48 cycles or more: drops the frame in progress, and keeps what was written; the next pixel is a frame's first.
  input  wire        flush,
  // Set of weights of a frame; 1 for colour, 0 for luma only.
  input  wire        weight_set,
  input  wire        colour,
  // Weights and display tables at run time, and what is read back; tie to 0 what is not used.
  input  wire        write_valid,
  input  wire [24:0] write_address,
  input  wire [31:0] write_data,
  input  wire        table_write,
  input  wire [1:0]  table_select,
  input  wire [14:0] table_address,
  input  wire [11:0] table_data,
  input  wire [6:0]  status_address,
  output wire [31:0] status,
  output wire        window_fault
);
  // High for 64 cycles after aresetn, and from the first clock edge on: memories keep what they hold.
  reg [5:0] count_q = 6'd0;
  reg       reset_q = 1'b1;
  always @(posedge aclk)
    if (!aresetn) begin
      count_q <= 6'd0;
      reset_q <= 1'b1;
    end else if (&count_q) reset_q <= 1'b0;
    else count_q <= count_q + 6'd1;

  wire pixels_ready, picture_valid;
  assign s_axis_tready = pixels_ready && !reset_q;
  assign m_axis_tvalid = picture_valid && !reset_q;

  /* verilator lint_off PINCONNECTEMPTY */
  stream_core core (
    .clock_i(aclk), .reset_i(reset_q), .preserve_i(1'b0), .flush_i(flush),
    .pixels_valid_i(s_axis_tvalid && !reset_q), .pixels_ready_o(pixels_ready), .pixels_data_i(s_axis_tdata),
    .set_i(weight_set), .colour_i(colour),
    .picture_valid_o(picture_valid), .picture_ready_i(m_axis_tready), .picture_data_o(m_axis_tdata),
    .picture_user_o(m_axis_tuser), .picture_last_o(m_axis_tlast),
    .write_valid_i(write_valid), .write_address_i(write_address), .write_data_i(write_data),
    .status_address_i(status_address), .status_o(status), .window_fault_o(window_fault),
    .table_write_i(table_write), .table_select_i(table_select), .table_address_i(table_address), .table_data_i(table_data),
    .clear_i(1'b0), .saturated_sums_o(), .clamped_chroma_o(), .out_of_gamut_o(),
    .patches_o(), .busy_cycles_o(), .window_crc_o(), .window_frames_o(), .set_used_o()
  );
  /* verilator lint_on PINCONNECTEMPTY */
endmodule

`default_nettype wire
