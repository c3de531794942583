// From a sum to a rounded word: saturate((sum + (base << base_shift) + half) >> result_shift), four cycles later.
// half is 2^(result_shift - 1), or 0 for a shift of 0. Numbers are in two's complement; `most` and `least` bound the result.
//
// From crates/edof-hdl/src/blocks/requantize.rs (Requantize).
`default_nettype none

module requantize_2 (
    input  wire        clock_i,
    input  wire [47:0] sum_i,
    input  wire [15:0] base_i,
    input  wire [5:0]  base_shift_i,
    input  wire [5:0]  result_shift_i,
    output wire [15:0] result_o,
    output wire        saturated_o
);

    localparam HAS_BASE = 1'h1;
    localparam [47:0] ONE = 48'h1;
    localparam [47:0] ONES = 48'hffffffffffff;
    localparam [47:0] SIGN_BITS = 48'hffffffff0000;
    localparam [47:0] MOST = 48'h7fff;
    localparam [47:0] LEAST = 48'hffffffff8000;

    reg  [47:0] extended;
    wire [47:0] half;
    reg  [47:0] fill;
    reg  [47:0] sum_q_q;
    reg  [47:0] aligned_q_q;
    reg  [47:0] aligned_q_d;
    reg  [47:0] total_q_q;
    wire [47:0] total_q_d;
    reg  [47:0] shifted_q_q;
    wire [47:0] shifted_q_d;
    reg  [15:0] result_q_q;
    reg  [15:0] result_q_d;
    reg  saturated_q_q;
    reg  saturated_q_d;
    wire [5:0] shift_later_later;

    // Only a part of what follows is used.
    /* verilator lint_off UNUSED */
    wire [47:0] result_q_d_value = LEAST;
    wire [47:0] result_q_d_value_2 = MOST;
    /* verilator lint_on UNUSED */

    delay_5 shift_later (
        .clock_i(clock_i),
        .now_i(result_shift_i),
        .later_o(shift_later_later)
    );

    always @* begin
        extended = {32'd0, base_i};
        if (base_i[15]) begin
            extended = {32'd0, base_i} | SIGN_BITS;
        end
    end

    assign half = (ONE << result_shift_i) >> 1;

    always @* begin
        aligned_q_d = half;
        if (HAS_BASE) begin
            aligned_q_d = (extended << base_shift_i) + half;
        end
    end

    assign total_q_d = sum_q_q + aligned_q_q;

    always @* begin
        fill = 48'd0;
        if (total_q_q[47]) begin
            fill = ~(ONES >> shift_later_later);
        end
    end

    assign shifted_q_d = (total_q_q >> shift_later_later) | fill;

    always @* begin
        result_q_d = shifted_q_q[15:0];
        saturated_q_d = 1'b0;
        if (shifted_q_q[47]) begin
            if (shifted_q_q < LEAST) begin
                result_q_d = result_q_d_value[15:0];
                saturated_q_d = 1'b1;
            end
        end else if (shifted_q_q > MOST) begin
            result_q_d = result_q_d_value_2[15:0];
            saturated_q_d = 1'b1;
        end
    end

    assign result_o = result_q_q;
    assign saturated_o = saturated_q_q;

    always @(posedge clock_i) begin
        sum_q_q <= sum_i;
        aligned_q_q <= aligned_q_d;
        total_q_q <= total_q_d;
        shifted_q_q <= shifted_q_d;
        result_q_q <= result_q_d;
        saturated_q_q <= saturated_q_d;
    end
endmodule

`default_nettype wire
