// Two bits per cycle to each pin as edof_ddr_out of rtl/, by the output cell of an ECP5 pad.
`default_nettype none
module edof_ddr_out #(
    parameter WIDTH = 1
) (
    input  wire             clock_i,
    input  wire [WIDTH-1:0] first_i,
    input  wire [WIDTH-1:0] second_i,
    output wire [WIDTH-1:0] pins_o
);
    genvar pin;
    generate
        for (pin = 0; pin < WIDTH; pin = pin + 1) begin : pins
            ODDRX1F pad (.SCLK(clock_i), .RST(1'b0), .D0(first_i[pin]), .D1(second_i[pin]), .Q(pins_o[pin]));
        end
    endgenerate
endmodule
`default_nettype wire
