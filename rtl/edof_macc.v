// One multiplier and its sum, written so that all of it is one DSP48E1: registers before and after the multiplier, the sum inside.
// Three cycles after weight_i and value_i their product is in sum_o; first_i comes a cycle after them. Its register stands before the DSP's
// operation mode and is free to be the DSP's own (docs/decisions/0035): nothing keeps it.
`default_nettype none
module edof_macc (
    input  wire               clock_i,
    input  wire               first_i,
    input  wire signed [15:0] weight_i,
    input  wire signed [24:0] value_i,
    output wire signed [47:0] sum_o
);
    reg signed [15:0] weight_q;
    reg signed [24:0] value_q;
    reg signed [40:0] product_q;
    reg first_q;
    reg signed [47:0] sum_q;

    always @(posedge clock_i) begin
        weight_q <= weight_i;
        value_q <= value_i;
        product_q <= weight_q * value_q;
        first_q <= first_i;
        sum_q <= (first_q ? 48'sd0 : sum_q) + {{7{product_q[40]}}, product_q};
    end

    assign sum_o = sum_q;
endmodule
`default_nettype wire
