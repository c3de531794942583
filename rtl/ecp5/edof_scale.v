// value x factor + addend as edof_scale of rtl/, of ECP5 cells: the registers before and after the multiplier are its own.
`default_nettype none

module edof_scale (
    input  wire               clock_i,
    input  wire signed [17:0] value_i,
    input  wire signed [17:0] factor_i,
    input  wire signed [47:0] addend_i,
    output wire signed [47:0] sum_o
);
    wire [35:0] product;
    MULT18X18D #(
        .REG_INPUTA_CLK("CLK0"), .REG_INPUTA_CE("CE0"), .REG_INPUTA_RST("RST0"),
        .REG_INPUTB_CLK("CLK0"), .REG_INPUTB_CE("CE0"), .REG_INPUTB_RST("RST0"),
        .REG_OUTPUT_CLK("CLK0"), .REG_OUTPUT_CE("CE0"), .REG_OUTPUT_RST("RST0"), .GSR("DISABLED")
    ) multiplier (
        .A0(value_i[0]), .A1(value_i[1]), .A2(value_i[2]), .A3(value_i[3]), .A4(value_i[4]), .A5(value_i[5]), .A6(value_i[6]),
        .A7(value_i[7]), .A8(value_i[8]), .A9(value_i[9]), .A10(value_i[10]), .A11(value_i[11]), .A12(value_i[12]), .A13(value_i[13]),
        .A14(value_i[14]), .A15(value_i[15]), .A16(value_i[16]), .A17(value_i[17]), .B0(factor_i[0]), .B1(factor_i[1]), .B2(factor_i[2]),
        .B3(factor_i[3]), .B4(factor_i[4]), .B5(factor_i[5]), .B6(factor_i[6]), .B7(factor_i[7]), .B8(factor_i[8]), .B9(factor_i[9]),
        .B10(factor_i[10]), .B11(factor_i[11]), .B12(factor_i[12]), .B13(factor_i[13]), .B14(factor_i[14]), .B15(factor_i[15]),
        .B16(factor_i[16]), .B17(factor_i[17]), .C0(1'b0), .C1(1'b0), .C2(1'b0), .C3(1'b0), .C4(1'b0), .C5(1'b0), .C6(1'b0), .C7(1'b0),
        .C8(1'b0), .C9(1'b0), .C10(1'b0), .C11(1'b0), .C12(1'b0), .C13(1'b0), .C14(1'b0), .C15(1'b0), .C16(1'b0), .C17(1'b0),
        .SIGNEDA(1'b1), .SIGNEDB(1'b1), .SOURCEA(1'b0), .SOURCEB(1'b0), .CLK0(clock_i), .CLK1(1'b0), .CLK2(1'b0), .CLK3(1'b0), .CE0(1'b1),
        .CE1(1'b1), .CE2(1'b1), .CE3(1'b1), .RST0(1'b0), .RST1(1'b0), .RST2(1'b0), .RST3(1'b0), .P0(product[0]), .P1(product[1]),
        .P2(product[2]), .P3(product[3]), .P4(product[4]), .P5(product[5]), .P6(product[6]), .P7(product[7]), .P8(product[8]),
        .P9(product[9]), .P10(product[10]), .P11(product[11]), .P12(product[12]), .P13(product[13]), .P14(product[14]), .P15(product[15]),
        .P16(product[16]), .P17(product[17]), .P18(product[18]), .P19(product[19]), .P20(product[20]), .P21(product[21]),
        .P22(product[22]), .P23(product[23]), .P24(product[24]), .P25(product[25]), .P26(product[26]), .P27(product[27]),
        .P28(product[28]), .P29(product[29]), .P30(product[30]), .P31(product[31]), .P32(product[32]), .P33(product[33]),
        .P34(product[34]), .P35(product[35])
    );

    reg signed [47:0] addend_q;
    reg signed [47:0] sum_q;

    always @(posedge clock_i) begin
        addend_q <= addend_i;
        sum_q <= addend_q + {{12{product[35]}}, product};
    end

    assign sum_o = sum_q;
endmodule

`default_nettype wire
