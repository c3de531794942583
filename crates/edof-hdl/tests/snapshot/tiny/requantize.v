// From a sum to a rounded word: saturate((sum + (base << base_shift) + half) >> result_shift), ten cycles
// later. half is 2^(result_shift - 1), or 0 for a shift of 0. Numbers are in two's complement. Shifts are made
// in two cycles each, by less than eight and by eights; additions in two, half by half; what does not fit is
// known a cycle before it is replaced.
// From crates/edof-hdl/src/blocks/requantize.rs (Requantize).
`default_nettype none
module requantize #(
  parameter [47:0] BASE_BITS = 48'd0
) (
  input wire clock_i,
  input wire [47:0] sum_i,         // Sum out of the multipliers.
  input wire [15:0] base_i,        // Base word of the same element.
  input wire [5:0] base_shift_i,   // Left shift of the base word.
  input wire [5:0] result_shift_i, // Right shift of all.
  output wire [15:0] result_o,     // Result.
  output wire saturated_o          // The result did not fit and is clamped.
);

  localparam [47:0] ONE = 48'd1, ONES = 48'hffffffffffff, SIGN_BITS = 48'hffffffff0000,
      BEYOND = 48'hffffffff8000;
  localparam [15:0] MAX = 16'h7fff, MIN = 16'h8000;

  reg [47:0] fine_1_q, half_1_q, aligned_2_q, half_2_q, fine_7_q, shifted_8_q;
  reg [5:0] coarse_7_q;
  reg [15:0] result_9_q, result_q;
  reg too_large_q, too_small_q, saturated_q;

  // Cycles 1 and 2: the base to its place; the rounding term.
  wire [47:0] extended = base_i[15] ? ({32'd0, base_i} | SIGN_BITS) : {32'd0, base_i};

  wire [47:0] sum_to_4_delayed;
  edof_delay #(.WIDTH(48), .CYCLES(4)) sum_to_4 (.clock_i(clock_i), .data_i(sum_i), .data_o(sum_to_4_delayed));
  wire [5:0] shift_to_6_delayed;
  edof_delay #(.WIDTH(6), .CYCLES(6))
    shift_to_6 (.clock_i(clock_i), .data_i(result_shift_i), .data_o(shift_to_6_delayed));

  wire [5:0] coarse_to_1_data = base_shift_i & 6'h38;
  wire [5:0] coarse_to_1_delayed;
  edof_delay #(.WIDTH(6), .CYCLES(1))
    coarse_to_1 (.clock_i(clock_i), .data_i(coarse_to_1_data), .data_o(coarse_to_1_delayed));
  wire [47:0] with_half_sum;
  edof_add with_half (.clock_i(clock_i), .a_i(aligned_2_q), .b_i(half_2_q), .sum_o(with_half_sum));
  wire [47:0] total_sum;
  edof_add total (.clock_i(clock_i), .a_i(sum_to_4_delayed), .b_i(with_half_sum), .sum_o(total_sum));

  wire [47:0] fine_fill = total_sum[47] ? (~(ONES >> (shift_to_6_delayed & 6'd7))) : 48'd0;
  wire [47:0] coarse_fill = fine_7_q[47] ? (~(ONES >> coarse_7_q)) : 48'd0;

  // Cycles 9 and 10: saturation. In a value that fits, all bits from the sign bit on are equal.
  wire [47:0] outside = shifted_8_q[47] ? (~shifted_8_q & BEYOND) : (shifted_8_q & BEYOND);
  assign result_o = result_q, saturated_o = saturated_q;

  always @(posedge clock_i) begin
    fine_1_q <= extended << (base_shift_i & 6'd7);
    half_1_q <= (ONE << result_shift_i) >> 1;
    aligned_2_q <= (fine_1_q << coarse_to_1_delayed) & BASE_BITS;
    half_2_q <= half_1_q;
    fine_7_q <= (total_sum >> (shift_to_6_delayed & 6'd7)) | fine_fill;
    coarse_7_q <= shift_to_6_delayed & 6'h38;
    shifted_8_q <= (fine_7_q >> coarse_7_q) | coarse_fill;
    result_9_q <= shifted_8_q[15:0];
    too_large_q <= (|outside) && !shifted_8_q[47];
    too_small_q <= (|outside) && shifted_8_q[47];
    result_q <= result_9_q;
    if (too_large_q) result_q <= MAX;
    else if (too_small_q) result_q <= MIN;
    saturated_q <= too_large_q || too_small_q;
  end
endmodule
`default_nettype wire
