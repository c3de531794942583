// value x factor + addend in one DSP48E1 with all of its registers: the sum stands on the output three cycles after value_i and
// factor_i, two after addend_i. So a sum can be the addend of the next one, whose value comes two cycles after the value of this one.
`default_nettype none
module edof_scale (
    input  wire               clock_i,
    input  wire signed [17:0] value_i,
    input  wire signed [17:0] factor_i,
    input  wire signed [47:0] addend_i,
    output wire signed [47:0] sum_o
);
    reg signed [17:0] value_q;
    reg signed [17:0] factor_q;
    reg signed [35:0] product_q;
    reg signed [47:0] addend_q;
    reg signed [47:0] sum_q;

    always @(posedge clock_i) begin
        value_q <= value_i;
        factor_q <= factor_i;
        product_q <= value_q * factor_q;
        addend_q <= addend_i;
        sum_q <= addend_q + {{12{product_q[35]}}, product_q};
    end

    assign sum_o = sum_q;
endmodule
`default_nettype wire
