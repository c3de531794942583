// The soft threshold of one element, three cycles later: sign(b) max(|b| - theta, 0) where two_sided, else
// max(b - theta, 0).
// From crates/edof-hdl/src/blocks/shrink.rs (Shrink).
`default_nettype none
module shrink (
  input wire clock_i,
  input wire [15:0] code_i,      // b.
  input wire [15:0] threshold_i, // θ.
  output wire [15:0] result_o,   // z.
  output wire saturated_o        // The result did not fit and is clamped (a negative θ).
);

  localparam TWO_SIDED = 1'b0;
  localparam [16:0] MAX = 17'd32767;

  reg [16:0] above_1_q, below_1_q;
  reg [15:0] above_2_q, below_2_q, result_q;
  reg is_above_q, is_below_q, too_large_q, saturated_q;

  // Cycle 1: how far it is from both ends of the dead zone.
  wire [16:0] wide_code = {code_i[15], code_i};
  wire [16:0] wide_threshold = {threshold_i[15], threshold_i};
  assign result_o = result_q, saturated_o = saturated_q;

  wire [16:0] result_q_value = MAX;
  always @(posedge clock_i) begin
    above_1_q <= wide_code - wide_threshold;
    below_1_q <= wide_code + wide_threshold;
    // Cycle 2: on which side it lies, and whether too far.
    above_2_q <= above_1_q[15:0];
    below_2_q <= below_1_q[15:0];
    is_above_q <= (|above_1_q) && !above_1_q[16];
    is_below_q <= TWO_SIDED && below_1_q[16];
    too_large_q <= above_1_q > MAX;
    // Cycle 3: the result.
    {result_q, saturated_q} <= 0;
    if (is_above_q) begin
      result_q <= above_2_q;
      if (too_large_q) begin
        result_q <= result_q_value[15:0];
        saturated_q <= 1'b1;
      end
    end else if (is_below_q) begin
      result_q <= below_2_q;
    end
  end

  wire unused = ^result_q_value; // Not every bit is read.
endmodule
`default_nettype wire
