// The soft threshold of one element, three cycles later: sign(b) max(|b| - theta, 0) where two_sided, else max(b - theta, 0).
//
// From crates/edof-hdl/src/blocks/shrink.rs (Shrink).
`default_nettype none

module shrink (
    input  wire        clock_i,
    input  wire [15:0] code_i,
    input  wire [15:0] threshold_i,
    output wire [15:0] result_o,
    output wire        saturated_o
);

    localparam TWO_SIDED = 1'h0;
    localparam [16:0] MOST = 17'h7fff;

    reg  [16:0] wide_code;
    reg  [16:0] wide_threshold;
    reg  [16:0] above_1_q;
    wire [16:0] above_1_d;
    reg  [16:0] below_1_q;
    wire [16:0] below_1_d;
    reg  [15:0] above_2_q;
    wire [15:0] above_2_d;
    reg  [15:0] below_2_q;
    wire [15:0] below_2_d;
    reg  is_above_q;
    wire is_above_d;
    reg  is_below_q;
    wire is_below_d;
    reg  too_large_q;
    wire too_large_d;
    reg  [15:0] result_q_q;
    reg  [15:0] result_q_d;
    reg  saturated_q_q;
    reg  saturated_q_d;

    // Only a part of what follows is used.
    /* verilator lint_off UNUSED */
    wire [16:0] result_q_d_value = MOST;
    /* verilator lint_on UNUSED */

    always @* begin
        wide_code = {1'b0, code_i};
        if (code_i[15]) begin
            wide_code = {1'b0, code_i} | 17'h10000;
        end
    end

    always @* begin
        wide_threshold = {1'b0, threshold_i};
        if (threshold_i[15]) begin
            wide_threshold = {1'b0, threshold_i} | 17'h10000;
        end
    end

    assign above_1_d = wide_code - wide_threshold;
    assign below_1_d = wide_code + wide_threshold;
    assign above_2_d = above_1_q[15:0];
    assign below_2_d = below_1_q[15:0];
    assign is_above_d = (|above_1_q) && (!above_1_q[16]);
    assign is_below_d = TWO_SIDED && below_1_q[16];
    assign too_large_d = above_1_q > MOST;

    always @* begin
        result_q_d = 16'd0;
        saturated_q_d = 1'b0;
        if (is_above_q) begin
            result_q_d = above_2_q;
            if (too_large_q) begin
                result_q_d = result_q_d_value[15:0];
                saturated_q_d = 1'b1;
            end
        end else if (is_below_q) begin
            result_q_d = below_2_q;
        end
    end

    assign result_o = result_q_q;
    assign saturated_o = saturated_q_q;

    always @(posedge clock_i) begin
        above_1_q <= above_1_d;
        below_1_q <= below_1_d;
        above_2_q <= above_2_d;
        below_2_q <= below_2_d;
        is_above_q <= is_above_d;
        is_below_q <= is_below_d;
        too_large_q <= too_large_d;
        result_q_q <= result_q_d;
        saturated_q_q <= saturated_q_d;
    end
endmodule

`default_nettype wire
