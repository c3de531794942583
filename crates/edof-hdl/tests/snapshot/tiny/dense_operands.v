// From what a step read to a row of weights and up to four values, four cycles after the step. Values without
// work are 0.
// From crates/edof-hdl/src/blocks/dense_operands.rs (DenseOperands).
`default_nettype none
module dense_operands #(
  parameter DENSE = 1 // 1 in the stage that is dense (I); in others the delays are absent.
) (
  input wire clock_i,
  input wire valid_i,           // There is a step.
  input wire first_i,           // The step is the first of its pass.
  input wire odd_i,             // The odd one of two elements is meant.
  input wire [11:0] base_i,     // Row of weights of the pass's first step.
  input wire [11:0] offset_i,   // What the step's row of weights is after it.
  input wire [31:0] pair_a_i,   // Two elements of the first part of the vector, two cycles after the step.
  input wire [31:0] pair_b_i,   // Of the second.
  input wire [31:0] pair_c_i,   // Of the third.
  input wire [31:0] pair_d_i,   // Of the fourth.
  output wire step_first_o,     // The step is the first of its pass.
  output wire [11:0] address_o, // Row of weights.
  output wire [24:0] value_a_o, // Value.
  output wire [24:0] value_b_o, // Of the second part.
  output wire [24:0] value_c_o, // Of the third.
  output wire [24:0] value_d_o  // Of the fourth.
);

  reg [11:0] row_q;
  reg [15:0] value_a_3_q, value_b_3_q, value_c_3_q, value_d_3_q;
  reg [24:0] value_a_4_q, value_b_4_q, value_c_4_q, value_d_4_q;

  // With the step, until what it read is there: bit 0 first, 1 valid, 2 odd.
  wire [2:0] flags = {odd_i, valid_i, first_i};

  // Cycle 4: as wide as a multiplier's input.
  wire [24:0] wide_a = {{9{value_a_3_q[15]}}, value_a_3_q};
  wire [24:0] wide_b = {{9{value_b_3_q[15]}}, value_b_3_q};
  wire [24:0] wide_c = {{9{value_c_3_q[15]}}, value_c_3_q};
  wire [24:0] wide_d = {{9{value_d_3_q[15]}}, value_d_3_q};
  assign value_a_o = value_a_4_q, value_b_o = value_b_4_q, value_c_o = value_c_4_q, value_d_o = value_d_4_q;

  wire [2:0] flags_to_2_delayed;
  edof_delay #(.WIDTH(3), .CYCLES(DENSE ? 2 : 0))
    flags_to_2 (.clock_i(clock_i), .data_i(flags), .data_o(flags_to_2_delayed));
  edof_delay #(.WIDTH(12), .CYCLES(DENSE ? 3 : 0))
    row_to_4 (.clock_i(clock_i), .data_i(row_q), .data_o(address_o));
  edof_delay #(.WIDTH(1), .CYCLES(DENSE ? 2 : 0))
    first_to_4 (.clock_i(clock_i), .data_i(flags_to_2_delayed[0]), .data_o(step_first_o));

  always @(posedge clock_i) begin
    row_q <= base_i + offset_i;
    // Cycle 3: the element of two.
    value_a_3_q <= pair_a_i[15:0];
    value_b_3_q <= pair_b_i[15:0];
    value_c_3_q <= pair_c_i[15:0];
    value_d_3_q <= pair_d_i[15:0];
    if (flags_to_2_delayed[2]) begin
      value_a_3_q <= pair_a_i[31:16];
      value_b_3_q <= pair_b_i[31:16];
      value_c_3_q <= pair_c_i[31:16];
      value_d_3_q <= pair_d_i[31:16];
    end
    if (!flags_to_2_delayed[1]) {value_a_3_q, value_b_3_q, value_c_3_q, value_d_3_q} <= 0;
    value_a_4_q <= wide_a;
    value_b_4_q <= wide_b;
    value_c_4_q <= wide_c;
    value_d_4_q <= wide_d;
  end
endmodule
`default_nettype wire
