// The soft threshold of one element, a cycle later: sign(b) max(|b| - theta, 0) where two_sided, else max(b - theta, 0).
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

    wire [16:0] wide_code;
    wire [16:0] wide_threshold;
    wire [16:0] above;
    wire [16:0] below;
    reg  [15:0] result_q;
    reg  [15:0] result_d;
    reg  saturated_q;
    wire saturated_d;

    wire [16:0] result_d_value = MOST;

    assign wide_code = code_i[15] ? ({1'b0, code_i} | 17'h10000) : {1'b0, code_i};
    assign wide_threshold = threshold_i[15] ? ({1'b0, threshold_i} | 17'h10000) : {1'b0, threshold_i};
    assign above = wide_code - wide_threshold;
    assign below = wide_code + wide_threshold;

    always @* begin
        result_d = 16'd0;
        if ((|above) && !above[16]) begin
            result_d = above[15:0];
            if (above > MOST) begin
                result_d = result_d_value[15:0];
            end
        end else if (TWO_SIDED && below[16]) begin
            result_d = below[15:0];
        end
    end

    assign saturated_d = ((|above) && !above[16] && (above > MOST)) ? 1'b1 : 1'b0;
    assign result_o = result_q;
    assign saturated_o = saturated_q;

    always @(posedge clock_i) begin
        result_q <= result_d;
        saturated_q <= saturated_d;
    end

    // Not every bit of these is read.
    wire unused = ^result_d_value;
endmodule

`default_nettype wire
