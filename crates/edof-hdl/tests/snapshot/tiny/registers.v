// What the host sets in a stage: shifts of both sets (result 6 bits, base 6, code 4, linear path 4), and
// control.
// From crates/edof-hdl/src/blocks/registers.rs (Registers).
`default_nettype none
module registers #(
  parameter INIT = "stage0_shifts.mem"
) (
  // Back to the values of the generated design; held for two cycles or more.
  input wire clock_i, input wire reset_i,
  input wire write_enable_i,              // Writes a register.
  input wire [11:0] write_row_i,          // Which: 0 and 1 are the shifts of each set, 2 is control.
  input wire [31:0] write_data_i,         // New value of the register.
  output wire [19:0] shifts_0_o,          // Shifts of set 0 (`edof_device::design::memory::Shifts::word`).
  output wire [19:0] shifts_1_o,          // Shifts of set 1.
  output wire skip_zeros_o                // Whether zeros are left out.
);

  localparam START_SKIP = 1'b1;

  reg [19:0] shifts_0_q, shifts_1_q;
  reg skip_q;

  assign shifts_0_o = shifts_0_q, shifts_1_o = shifts_1_q, skip_zeros_o = skip_q;

  wire [19:0] start_first, second;
  edof_start #(.WIDTH(20), .INIT(INIT)) start (.clock_i(clock_i), .first_o(start_first), .second_o(second));

  always @(posedge clock_i) begin
    if (write_enable_i) begin
      if (write_row_i == 12'd0) shifts_0_q <= write_data_i[19:0];
      else if (write_row_i == 12'd1) shifts_1_q <= write_data_i[19:0];
      else if (write_row_i == 12'd2) skip_q <= write_data_i[0];
    end
    if (reset_i) begin
      shifts_0_q <= start_first;
      shifts_1_q <= second;
      skip_q <= START_SKIP;
    end
  end

  wire unused = ^write_data_i; // Not every bit is read.
endmodule
`default_nettype wire
