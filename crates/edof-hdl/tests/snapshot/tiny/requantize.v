// From a sum to a rounded word: saturate((sum + (base << base_shift) + half) >> result_shift), ten cycles later.
// half is 2^(result_shift - 1), or 0 for a shift of 0. Numbers are in two's complement. Shifts are made in two cycles each, by less
// than eight and by eights; additions in two, half by half; what does not fit is known a cycle before it is replaced.
//
// From crates/edof-hdl/src/blocks/requantize.rs (Requantize).
`default_nettype none

module requantize (
    input  wire        clock_i,
    input  wire [47:0] sum_i,
    input  wire [15:0] base_i,
    input  wire [5:0]  base_shift_i,
    input  wire [5:0]  result_shift_i,
    output wire [15:0] result_o,
    output wire        saturated_o
);

    localparam [47:0] BASE_BITS = 48'h0;
    localparam [47:0] ONE = 48'h1;
    localparam [47:0] ONES = 48'hffffffffffff;
    localparam [47:0] SIGN_BITS = 48'hffffffff0000;
    localparam [47:0] BEYOND = 48'hffffffff8000;
    localparam [15:0] MOST = 16'h7fff;
    localparam [15:0] LEAST = 16'h8000;

    reg  [47:0] extended;
    reg  [47:0] fine_fill;
    reg  [47:0] coarse_fill;
    reg  [47:0] outside;
    wire [47:0] sum_to_4_later;
    wire [5:0] shift_to_6_later;
    reg  [47:0] fine_1_q;
    wire [47:0] fine_1_d;
    reg  [5:0] coarse_1_q;
    wire [5:0] coarse_1_d;
    reg  [47:0] half_1_q;
    wire [47:0] half_1_d;
    reg  [47:0] aligned_2_q;
    wire [47:0] aligned_2_d;
    reg  [47:0] half_2_q;
    wire [47:0] with_half_sum;
    wire [47:0] total_sum;
    reg  [47:0] fine_7_q;
    wire [47:0] fine_7_d;
    reg  [5:0] coarse_7_q;
    wire [5:0] coarse_7_d;
    reg  [47:0] shifted_8_q;
    wire [47:0] shifted_8_d;
    reg  [15:0] result_9_q;
    wire [15:0] result_9_d;
    reg  too_large_q;
    wire too_large_d;
    reg  too_small_q;
    wire too_small_d;
    reg  [15:0] result_q_q;
    reg  [15:0] result_q_d;
    reg  saturated_q_q;
    wire saturated_q_d;

    edof_delay #(
        .WIDTH(48),
        .CYCLES(4)
    ) sum_to_4 (
        .clock_i(clock_i),
        .now_i(sum_i),
        .later_o(sum_to_4_later)
    );

    edof_delay #(
        .WIDTH(6),
        .CYCLES(6)
    ) shift_to_6 (
        .clock_i(clock_i),
        .now_i(result_shift_i),
        .later_o(shift_to_6_later)
    );

    edof_add with_half (
        .clock_i(clock_i),
        .a_i(aligned_2_q),
        .b_i(half_2_q),
        .sum_o(with_half_sum)
    );

    edof_add total (
        .clock_i(clock_i),
        .a_i(sum_to_4_later),
        .b_i(with_half_sum),
        .sum_o(total_sum)
    );

    always @* begin
        extended = {32'd0, base_i};
        if (base_i[15]) begin
            extended = {32'd0, base_i} | SIGN_BITS;
        end
    end

    assign fine_1_d = extended << (base_shift_i & 6'd7);
    assign coarse_1_d = base_shift_i & 6'h38;
    assign half_1_d = (ONE << result_shift_i) >> 1;
    assign aligned_2_d = (fine_1_q << coarse_1_q) & BASE_BITS;

    always @* begin
        fine_fill = 48'd0;
        if (total_sum[47]) begin
            fine_fill = ~(ONES >> (shift_to_6_later & 6'd7));
        end
    end

    assign fine_7_d = (total_sum >> (shift_to_6_later & 6'd7)) | fine_fill;
    assign coarse_7_d = shift_to_6_later & 6'h38;

    always @* begin
        coarse_fill = 48'd0;
        if (fine_7_q[47]) begin
            coarse_fill = ~(ONES >> coarse_7_q);
        end
    end

    assign shifted_8_d = (fine_7_q >> coarse_7_q) | coarse_fill;

    always @* begin
        outside = shifted_8_q & BEYOND;
        if (shifted_8_q[47]) begin
            outside = (~shifted_8_q) & BEYOND;
        end
    end

    assign result_9_d = shifted_8_q[15:0];
    assign too_large_d = (|outside) && (!shifted_8_q[47]);
    assign too_small_d = (|outside) && shifted_8_q[47];

    always @* begin
        result_q_d = result_9_q;
        if (too_large_q) begin
            result_q_d = MOST;
        end else if (too_small_q) begin
            result_q_d = LEAST;
        end
    end

    assign saturated_q_d = too_large_q || too_small_q;
    assign result_o = result_q_q;
    assign saturated_o = saturated_q_q;

    always @(posedge clock_i) begin
        fine_1_q <= fine_1_d;
        coarse_1_q <= coarse_1_d;
        half_1_q <= half_1_d;
        aligned_2_q <= aligned_2_d;
        half_2_q <= half_1_q;
        fine_7_q <= fine_7_d;
        coarse_7_q <= coarse_7_d;
        shifted_8_q <= shifted_8_d;
        result_9_q <= result_9_d;
        too_large_q <= too_large_d;
        too_small_q <= too_small_d;
        result_q_q <= result_q_d;
        saturated_q_q <= saturated_q_d;
    end
endmodule

`default_nettype wire
