// Sensor values of 12 bits as the 16-bit raw words of `stream_core`: less darkness, and encoded as the folder's network takes light. See docs/own-design.md.
`default_nettype none

`ifndef EDOF_DIR
`define EDOF_DIR "./"
`endif

module sensor_words #(
  // Sensor value of darkness. Full light is 4095 whatever it is.
  parameter [11:0] BLACK = 12'd0
) (
  input  wire        aclk,
  input  wire        aresetn,
  // A sensor value, at the bottom.
  input  wire        s_axis_tvalid,
  output wire        s_axis_tready,
  input  wire [11:0] s_axis_tdata,
  // Its word.
  output wire        m_axis_tvalid,
  input  wire        m_axis_tready,
  output wire [15:0] m_axis_tdata
);
  reg [15:0] words [0:4095];
`ifdef EDOF_IMAGES_BY_NAME
  initial $readmemh("sensor_words.mem", words);
`else
  initial $readmemh({`EDOF_DIR, "mem/sensor_words.mem"}, words);
`endif

  wire [11:0] light = (s_axis_tdata > BLACK) ? s_axis_tdata - BLACK : 12'd0;
  reg [15:0] word_q;
  reg        valid_q;
  assign s_axis_tready = !valid_q || m_axis_tready;
  assign m_axis_tvalid = valid_q;
  assign m_axis_tdata = word_q;
  always @(posedge aclk) begin
    if (s_axis_tvalid && s_axis_tready) word_q <= words[light];
    if (!aresetn) valid_q <= 1'b0;
    else if (s_axis_tready) valid_q <= s_axis_tvalid;
  end
endmodule

`default_nettype wire
