// The calculator with AXI4-Stream ports: windows in, patches out, two words a beat. See docs/own-design.md.
`default_nettype none

module chain_axis (
  input  wire        aclk,
  input  wire        aresetn,
  // Two pixels of a window; TLAST: its last beat; TUSER: its set of weights.
  input  wire        s_axis_tvalid,
  output wire        s_axis_tready,
  input  wire [31:0] s_axis_tdata,
  input  wire        s_axis_tlast,
  input  wire        s_axis_tuser,
  // Two words of a patch; TLAST: its last beat; TUSER: the set of its window.
  output wire        m_axis_tvalid,
  input  wire        m_axis_tready,
  output wire [31:0] m_axis_tdata,
  output wire        m_axis_tlast,
  output wire        m_axis_tuser,
  // High for 48 cycles or more: drops the windows in progress, and keeps what was written.
  input  wire        flush,
  // Weights at run time, and what is read back; tie to 0 what is not used.
  input  wire        write_valid,
  input  wire [24:0] write_address,
  input  wire [31:0] write_data,
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

  wire window_ready, patch_valid;
  assign s_axis_tready = window_ready && !reset_q;
  assign m_axis_tvalid = patch_valid && !reset_q;

  // Beats between the stages are for observation; their number is the design's.
  /* verilator lint_off PINMISSING */
  /* verilator lint_off PINCONNECTEMPTY */
  chain calculator (
    .clock_i(aclk), .reset_i(reset_q), .flush_i(flush),
    .window_valid_i(s_axis_tvalid && !reset_q), .window_ready_o(window_ready), .window_data_i(s_axis_tdata),
    .window_last_i(s_axis_tlast), .window_set_i(s_axis_tuser),
    .patch_valid_o(patch_valid), .patch_ready_i(m_axis_tready), .patch_data_o(m_axis_tdata),
    .patch_last_o(m_axis_tlast), .patch_set_o(m_axis_tuser),
    .write_valid_i(write_valid), .write_address_i(write_address), .write_data_i(write_data),
    .status_address_i(status_address), .status_o(status), .window_fault_o(window_fault)
  );
  /* verilator lint_on PINCONNECTEMPTY */
  /* verilator lint_on PINMISSING */
endmodule

`default_nettype wire
