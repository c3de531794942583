// Ports of every kind of width.
module wide (
    input  wire         clock_i,
    input  wire         a__bit_i,
    input  wire [32:0]  half_i,
    input  wire [63:0]  full_i,
    input  wire [99:0]  wide_i,
    output wire         a__bit_o,
    output wire [32:0]  half_o,
    output wire [63:0]  full_o,
    output wire [99:0]  wide_o
);
    reg [99:0] wide_q;
    always @(posedge clock_i) wide_q <= ~wide_i;
    assign a__bit_o = ~a__bit_i;
    assign half_o = ~half_i;
    assign full_o = ~full_i;
    assign wide_o = wide_q;
endmodule
