// The soft threshold of one element, a cycle later: sign(b) max(|b| - theta, 0) where two_sided, else max(b - theta, 0).
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
    wire [16:0] above;
    wire [16:0] below;
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

    assign above = wide_code - wide_threshold;
    assign below = wide_code + wide_threshold;

    always @* begin
        result_q_d = 16'd0;
        saturated_q_d = 1'b0;
        if ((|above) && (!above[16])) begin
            result_q_d = above[15:0];
            if (above > MOST) begin
                result_q_d = result_q_d_value[15:0];
                saturated_q_d = 1'b1;
            end
        end else if (TWO_SIDED && below[16]) begin
            result_q_d = below[15:0];
        end
    end

    assign result_o = result_q_q;
    assign saturated_o = saturated_q_q;

    always @(posedge clock_i) begin
        result_q_q <= result_q_d;
        saturated_q_q <= saturated_q_d;
    end
endmodule

`default_nettype wire
