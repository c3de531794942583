// Multiply and accumulate, cleared by `first_i`.
module macc #(parameter WIDTH = 16) (
    input  wire                    clock_i,
    input  wire                    first_i,
    input  wire signed [WIDTH-1:0] a_i,
    input  wire signed [WIDTH-1:0] b_i,
    output wire signed [47:0]      sum_o
);
    reg signed [WIDTH-1:0] a_q;
    reg signed [WIDTH-1:0] b_q;
    reg signed [2*WIDTH-1:0] product_q;
    reg signed [47:0] sum_q;
    reg first_q;
    reg first_qq;
    always @(posedge clock_i) begin
        a_q <= a_i;
        b_q <= b_i;
        first_q <= first_i;
        first_qq <= first_q;
        product_q <= a_q * b_q;
        sum_q <= (first_qq ? 48'sd0 : sum_q) + {{(48-2*WIDTH){product_q[2*WIDTH-1]}}, product_q};
    end
    assign sum_o = sum_q;
endmodule
