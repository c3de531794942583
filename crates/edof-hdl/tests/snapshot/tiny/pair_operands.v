// From what a step read to rows of weights and values, four cycles after the step: pairs, or pixels of the
// window (F), shifted left where F aligns its two sums. A value without work is 0.
// From crates/edof-hdl/src/blocks/pair_operands.rs (PairOperands).
`default_nettype none
module pair_operands #(
  parameter ALIGNS = 1'b0, parameter TWO_ROWS = 1'b0,
  parameter DENSE = 1 // 1 in the stage that is dense (I), where the delays are absent.
) (
  input wire clock_i,
  input wire valid_a_i,           // There is a step, with a first value.
  input wire valid_b_i,           // With a second one.
  input wire first_i,             // The step is the first of its pass.
  input wire linear_i,            // The step belongs to the window (linear path).
  input wire odd_i,               // The odd one of two elements is meant.
  input wire set_i,               // The vector's set.
  input wire [11:0] base_i,       // Row of weights of input 0.
  input wire [11:0] offset_i,     // What the row of weights of a pixel is after it.
  input wire [24:0] even_pair_i,  // The even pair, two cycles after the step.
  input wire [24:0] odd_pair_i,   // The odd one.
  input wire [31:0] pixels_i,     // Two pixels, in the same way.
  input wire [7:0] shifts_0_i,    // Left shifts of set 0: of codes, of pixels.
  input wire [7:0] shifts_1_i,    // Of set 1.
  output wire step_first_o,       // The step is the first of its pass.
  output wire [11:0] address_a_o, // Row of weights.
  output wire [11:0] address_b_o, // Of the second value.
  output wire [24:0] value_a_o,   // Value.
  output wire [24:0] value_b_o    // The second one.
);

  reg [15:0] value_a_3_q, value_b_3_q;
  reg [11:0] base_3_q, offset_a_3_q, offset_b_3_q, address_a_4_q, address_b_4_q;
  reg [3:0] shift_3_q;
  reg [24:0] value_a_4_q, value_b_4_q;

  // With the step, until what it read is there: bit 0 first, 1 valid, 2 a second valid, 3 window, 4 odd, 5 set.
  wire [5:0] flags = {set_i, odd_i, linear_i, valid_b_i, valid_a_i, first_i};
  wire [5:0] flags_to_2_delayed;
  edof_delay #(.WIDTH(6), .CYCLES(DENSE ? 0 : 2))
    flags_to_2 (.clock_i(clock_i), .data_i(flags), .data_o(flags_to_2_delayed));

  // Cycle 3: the pair or pixel.
  wire [24:0] pair_a = flags_to_2_delayed[4] ? odd_pair_i : even_pair_i;
  wire [15:0] pixel_a = flags_to_2_delayed[4] ? pixels_i[31:16] : pixels_i[15:0];
  wire [7:0] shifts = flags_to_2_delayed[5] ? shifts_1_i : shifts_0_i;

  // Cycle 4: aligned, and its row.
  wire [24:0] wide_a = {{9{value_a_3_q[15]}}, value_a_3_q};
  wire [24:0] wide_b = {{9{value_b_3_q[15]}}, value_b_3_q};
  assign address_a_o = address_a_4_q, address_b_o = address_b_4_q, value_a_o = value_a_4_q;
  assign value_b_o = value_b_4_q;

  wire [23:0] rows_to_2_delayed;
  edof_delay #(.WIDTH(24), .CYCLES(DENSE ? 0 : 2))
    rows_to_2 (.clock_i(clock_i), .data_i({base_i, offset_i}), .data_o(rows_to_2_delayed));
  edof_delay #(.WIDTH(1), .CYCLES(DENSE ? 0 : 2))
    first_to_4 (.clock_i(clock_i), .data_i(flags_to_2_delayed[0]), .data_o(step_first_o));

  always @(posedge clock_i) begin
    value_a_3_q <= pair_a[15:0];
    value_b_3_q <= odd_pair_i[15:0];
    offset_a_3_q <= {3'd0, pair_a[24:16]};
    offset_b_3_q <= {3'd0, odd_pair_i[24:16]};
    shift_3_q <= shifts[3:0];
    if (flags_to_2_delayed[3]) begin
      value_a_3_q <= pixel_a;
      value_b_3_q <= pixels_i[31:16];
      offset_a_3_q <= rows_to_2_delayed[11:0];
      offset_b_3_q <= rows_to_2_delayed[11:0] | 12'd1;
      shift_3_q <= shifts[7:4];
    end
    // Without work the row is one that there is, not what an unwritten pair says.
    if (!flags_to_2_delayed[1]) {value_a_3_q, offset_a_3_q} <= 0;
    if (!(TWO_ROWS && flags_to_2_delayed[2])) {value_b_3_q, offset_b_3_q} <= 0;
    base_3_q <= rows_to_2_delayed[23:12];
    value_a_4_q <= wide_a;
    value_b_4_q <= wide_b;
    if (ALIGNS) begin
      value_a_4_q <= wide_a << shift_3_q;
      value_b_4_q <= wide_b << shift_3_q;
    end
    address_a_4_q <= base_3_q + offset_a_3_q;
    address_b_4_q <= base_3_q + offset_b_3_q;
  end
endmodule
`default_nettype wire
