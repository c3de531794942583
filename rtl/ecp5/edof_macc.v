// One multiplier and its sum as edof_macc of rtl/, of ECP5 cells: the registers before and after the multiplier are its own, and the sum is a carry
// chain whose LUTs start it anew. A value has 18 bits: shifts of more than two bits need another multiplier, and have none (the board's check of a network).
`default_nettype none

module edof_macc (
    input  wire               clock_i,
    input  wire               first_i,
    input  wire signed [15:0] weight_i,
    input  wire signed [24:0] value_i,
    output wire signed [47:0] sum_o
);
    wire [17:0] weight = {{2{weight_i[15]}}, weight_i};
    wire [17:0] value = value_i[17:0];
    wire [35:0] product;
    MULT18X18D #(
        .REG_INPUTA_CLK("CLK0"), .REG_INPUTA_CE("CE0"), .REG_INPUTA_RST("RST0"),
        .REG_INPUTB_CLK("CLK0"), .REG_INPUTB_CE("CE0"), .REG_INPUTB_RST("RST0"),
        .REG_OUTPUT_CLK("CLK0"), .REG_OUTPUT_CE("CE0"), .REG_OUTPUT_RST("RST0"), .GSR("DISABLED")
    ) multiplier (
        .A0(weight[0]), .A1(weight[1]), .A2(weight[2]), .A3(weight[3]), .A4(weight[4]), .A5(weight[5]), .A6(weight[6]), .A7(weight[7]),
        .A8(weight[8]), .A9(weight[9]), .A10(weight[10]), .A11(weight[11]), .A12(weight[12]), .A13(weight[13]), .A14(weight[14]),
        .A15(weight[15]), .A16(weight[16]), .A17(weight[17]), .B0(value[0]), .B1(value[1]), .B2(value[2]), .B3(value[3]), .B4(value[4]),
        .B5(value[5]), .B6(value[6]), .B7(value[7]), .B8(value[8]), .B9(value[9]), .B10(value[10]), .B11(value[11]), .B12(value[12]),
        .B13(value[13]), .B14(value[14]), .B15(value[15]), .B16(value[16]), .B17(value[17]), .C0(1'b0), .C1(1'b0), .C2(1'b0), .C3(1'b0),
        .C4(1'b0), .C5(1'b0), .C6(1'b0), .C7(1'b0), .C8(1'b0), .C9(1'b0), .C10(1'b0), .C11(1'b0), .C12(1'b0), .C13(1'b0), .C14(1'b0),
        .C15(1'b0), .C16(1'b0), .C17(1'b0), .SIGNEDA(1'b1), .SIGNEDB(1'b1), .SOURCEA(1'b0), .SOURCEB(1'b0), .CLK0(clock_i), .CLK1(1'b0),
        .CLK2(1'b0), .CLK3(1'b0), .CE0(1'b1), .CE1(1'b1), .CE2(1'b1), .CE3(1'b1), .RST0(1'b0), .RST1(1'b0), .RST2(1'b0), .RST3(1'b0),
        .P0(product[0]), .P1(product[1]), .P2(product[2]), .P3(product[3]), .P4(product[4]), .P5(product[5]), .P6(product[6]),
        .P7(product[7]), .P8(product[8]), .P9(product[9]), .P10(product[10]), .P11(product[11]), .P12(product[12]), .P13(product[13]),
        .P14(product[14]), .P15(product[15]), .P16(product[16]), .P17(product[17]), .P18(product[18]), .P19(product[19]),
        .P20(product[20]), .P21(product[21]), .P22(product[22]), .P23(product[23]), .P24(product[24]), .P25(product[25]),
        .P26(product[26]), .P27(product[27]), .P28(product[28]), .P29(product[29]), .P30(product[30]), .P31(product[31]),
        .P32(product[32]), .P33(product[33]), .P34(product[34]), .P35(product[35])
    );

    // Two bits a cell: product ^ (sum, or 0 where a sum starts) ^ carry.
    reg first_q;
    reg [47:0] sum_q;
    wire [47:0] added = {{12{product[35]}}, product};
    wire [47:0] next;
    wire [24:0] carry;
    wire unused = &{1'b0, value_i[24:18], carry[24]};
    assign carry[0] = 1'b0;
    genvar i;
    generate
        for (i = 0; i < 24; i = i + 1) begin : bits
            CCU2C #(.INIT0(16'hA6AA), .INIT1(16'hA6AA), .INJECT1_0("NO"), .INJECT1_1("NO")) add (
                .CIN(carry[i]), .COUT(carry[i+1]),
                .A0(added[2*i]), .B0(sum_q[2*i]), .C0(first_q), .D0(1'b1), .S0(next[2*i]),
                .A1(added[2*i+1]), .B1(sum_q[2*i+1]), .C1(first_q), .D1(1'b1), .S1(next[2*i+1])
            );
        end
    endgenerate

    always @(posedge clock_i) begin
        first_q <= first_i;
        sum_q <= next;
    end

    assign sum_o = sum_q;
endmodule

`default_nettype wire
