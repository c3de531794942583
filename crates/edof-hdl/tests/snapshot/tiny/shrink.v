// The soft threshold of one element, three cycles later: sign(b) max(|b| - theta, 0) where two_sided, else max(b - theta, 0).
//
// From crates/edof-hdl/src/blocks/shrink.rs (Shrink).
`default_nettype none

module shrink (
    input  wire        clock_i,     // Clock.
    input  wire [15:0] code_i,      // b.
    input  wire [15:0] threshold_i, // θ.
    output wire [15:0] result_o,    // z.
    output wire        saturated_o  // Whether it did not fit (a negative θ).
);

    localparam TWO_SIDED = 1'b0;
    localparam [16:0] MOST = 17'h7fff;

    wire [16:0] wide_code, wide_threshold;
    reg  [16:0] above_1_q, below_1_q;
    reg  [15:0] above_2_q, below_2_q;
    reg  is_above_q, is_below_q, too_large_q;
    reg  [15:0] result_q, result_d;
    reg  saturated_q;

    wire [16:0] result_d_value = MOST;

    assign wide_code = code_i[15] ? ({1'b0, code_i} | 17'h10000) : {1'b0, code_i};
    assign wide_threshold = threshold_i[15] ? ({1'b0, threshold_i} | 17'h10000) : {1'b0, threshold_i};

    always @* begin
        result_d = 16'd0;
        if (is_above_q) begin
            result_d = above_2_q;
            if (too_large_q) begin
                result_d = result_d_value[15:0];
            end
        end else if (is_below_q) begin
            result_d = below_2_q;
        end
    end

    assign result_o = result_q;
    assign saturated_o = saturated_q;

    always @(posedge clock_i) begin
        above_1_q <= wide_code - wide_threshold;
        below_1_q <= wide_code + wide_threshold;
        above_2_q <= above_1_q[15:0];
        below_2_q <= below_1_q[15:0];
        is_above_q <= (|above_1_q) && !above_1_q[16];
        is_below_q <= TWO_SIDED && below_1_q[16];
        too_large_q <= above_1_q > MOST;
        result_q <= result_d;
        saturated_q <= is_above_q ? too_large_q : 1'b0;
    end

    // Not every bit of these is read.
    wire unused = ^result_d_value;
endmodule

`default_nettype wire
