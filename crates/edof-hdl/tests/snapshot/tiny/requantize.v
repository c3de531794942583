// From a sum to a rounded word: saturate((sum + (base << base_shift) + half) >> result_shift), ten cycles later.
// half is 2^(result_shift - 1), or 0 for a shift of 0. Numbers are in two's complement. Shifts are made in two cycles each, by less
// than eight and by eights; additions in two, half by half; what does not fit is known a cycle before it is replaced.
//
// From crates/edof-hdl/src/blocks/requantize.rs (Requantize).
`default_nettype none

module requantize #(
    parameter [47:0] BASE_BITS = 48'd0
) (
    input  wire        clock_i,        // Clock.
    input  wire [47:0] sum_i,          // Sum out of the multipliers.
    input  wire [15:0] base_i,         // Base word of the same element.
    input  wire [5:0]  base_shift_i,   // Its left shift.
    input  wire [5:0]  result_shift_i, // Right shift of all.
    output wire [15:0] result_o,       // Result.
    output wire        saturated_o     // Whether it did not fit.
);

    localparam [47:0] ONE = 48'd1;
    localparam [47:0] ONES = 48'hffffffffffff;
    localparam [47:0] SIGN_BITS = 48'hffffffff0000;
    localparam [47:0] BEYOND = 48'hffffffff8000;
    localparam [15:0] MOST = 16'h7fff;
    localparam [15:0] LEAST = 16'h8000;

    wire [47:0] extended, fine_fill, coarse_fill, outside, sum_to_4_later;
    wire [5:0] shift_to_6_later;
    reg  [47:0] fine_1_q;
    wire [5:0] coarse_to_1_now, coarse_to_1_later;
    reg  [47:0] half_1_q, aligned_2_q, half_2_q;
    wire [47:0] with_half_sum, total_sum;
    reg  [47:0] fine_7_q;
    reg  [5:0] coarse_7_q;
    reg  [47:0] shifted_8_q;
    reg  [15:0] result_9_q;
    reg  too_large_q, too_small_q;
    reg  [15:0] result_q;
    reg  saturated_q;

    edof_delay #(.WIDTH(48), .CYCLES(4)) sum_to_4 (
        .clock_i(clock_i), .now_i(sum_i), .later_o(sum_to_4_later)
    );
    edof_delay #(.WIDTH(6), .CYCLES(6)) shift_to_6 (
        .clock_i(clock_i), .now_i(result_shift_i), .later_o(shift_to_6_later)
    );
    edof_delay #(.WIDTH(6), .CYCLES(1)) coarse_to_1 (
        .clock_i(clock_i), .now_i(coarse_to_1_now), .later_o(coarse_to_1_later)
    );
    edof_add with_half (
        .clock_i(clock_i), .a_i(aligned_2_q), .b_i(half_2_q), .sum_o(with_half_sum)
    );
    edof_add total (
        .clock_i(clock_i), .a_i(sum_to_4_later), .b_i(with_half_sum), .sum_o(total_sum)
    );

    assign extended = base_i[15] ? ({32'd0, base_i} | SIGN_BITS) : {32'd0, base_i};
    assign coarse_to_1_now = base_shift_i & 6'h38;
    assign fine_fill = total_sum[47] ? (~(ONES >> (shift_to_6_later & 6'd7))) : 48'd0;
    assign coarse_fill = fine_7_q[47] ? (~(ONES >> coarse_7_q)) : 48'd0;
    assign outside = shifted_8_q[47] ? (~shifted_8_q & BEYOND) : (shifted_8_q & BEYOND);
    assign result_o = result_q;
    assign saturated_o = saturated_q;

    always @(posedge clock_i) begin
        fine_1_q <= extended << (base_shift_i & 6'd7);
        half_1_q <= (ONE << result_shift_i) >> 1;
        aligned_2_q <= (fine_1_q << coarse_to_1_later) & BASE_BITS;
        half_2_q <= half_1_q;
        fine_7_q <= (total_sum >> (shift_to_6_later & 6'd7)) | fine_fill;
        coarse_7_q <= shift_to_6_later & 6'h38;
        shifted_8_q <= (fine_7_q >> coarse_7_q) | coarse_fill;
        result_9_q <= shifted_8_q[15:0];
        too_large_q <= (|outside) && !shifted_8_q[47];
        too_small_q <= (|outside) && shifted_8_q[47];
        result_q <= too_large_q ? MOST : (too_small_q ? LEAST : result_9_q);
        saturated_q <= too_large_q || too_small_q;
    end
endmodule

`default_nettype wire
