// Maps a table of the display, a port that reads and one that writes or looks, onto ECP5 block RAMs of 16,384 rows of a bit with both ports' output
// registers: a read takes two cycles, and the registers that follow the memory are taken out (output_register.v). Yosys by itself takes two copies, since it
// does not know that a row which is read in the cycle of its write may show anything.
//
// Of 18 bits of contents each ninth is used by words of nine bits alone.
module \$mem_v2 (RD_CLK, RD_EN, RD_ARST, RD_SRST, RD_ADDR, RD_DATA, WR_CLK, WR_EN, WR_ADDR, WR_DATA);
    parameter MEMID = "";
    parameter signed SIZE = 4;
    parameter signed OFFSET = 0;
    parameter signed ABITS = 2;
    parameter signed WIDTH = 8;
    parameter signed INIT = 1'bx;
    parameter signed RD_PORTS = 2;
    parameter RD_CLK_ENABLE = 2'b11;
    parameter RD_CLK_POLARITY = 2'b11;
    parameter RD_TRANSPARENCY_MASK = 2'b00;
    parameter RD_COLLISION_X_MASK = 2'b00;
    parameter RD_WIDE_CONTINUATION = 2'b00;
    parameter RD_CE_OVER_SRST = 2'b00;
    parameter RD_ARST_VALUE = 1'b0;
    parameter RD_SRST_VALUE = 1'b0;
    parameter RD_INIT_VALUE = 1'b0;
    parameter signed WR_PORTS = 1;
    parameter WR_CLK_ENABLE = 1'b1;
    parameter WR_CLK_POLARITY = 1'b1;
    parameter WR_PRIORITY_MASK = 1'b0;
    parameter WR_WIDE_CONTINUATION = 1'b0;
    parameter _TECHMAP_BITS_CONNMAP_ = 0;
    parameter [RD_PORTS*ABITS*_TECHMAP_BITS_CONNMAP_-1:0] _TECHMAP_CONNMAP_RD_ADDR_ = 0;
    parameter [WR_PORTS*ABITS*_TECHMAP_BITS_CONNMAP_-1:0] _TECHMAP_CONNMAP_WR_ADDR_ = 0;

    input [RD_PORTS-1:0] RD_CLK;
    input [RD_PORTS-1:0] RD_EN;
    input [RD_PORTS-1:0] RD_ARST;
    input [RD_PORTS-1:0] RD_SRST;
    input [RD_PORTS*ABITS-1:0] RD_ADDR;
    output [RD_PORTS*WIDTH-1:0] RD_DATA;
    input [WR_PORTS-1:0] WR_CLK;
    input [WR_PORTS*WIDTH-1:0] WR_EN;
    input [WR_PORTS*ABITS-1:0] WR_ADDR;
    input [WR_PORTS*WIDTH-1:0] WR_DATA;

    // The port that looks has the address of the one that writes.
    localparam NAMES = ABITS * _TECHMAP_BITS_CONNMAP_;
    localparam LOOKS = _TECHMAP_CONNMAP_RD_ADDR_[NAMES-1:0] == _TECHMAP_CONNMAP_WR_ADDR_ ? 0 : 1;
    wire _TECHMAP_FAIL_ = RD_PORTS != 2 || WR_PORTS != 1 || RD_CLK_ENABLE != 3 || WR_CLK_ENABLE != 1 || (SIZE != 16384 && SIZE != 32768)
        || _TECHMAP_CONNMAP_RD_ADDR_[LOOKS*NAMES +: NAMES] != _TECHMAP_CONNMAP_WR_ADDR_;

    localparam PART = 256 * WIDTH;
    localparam HALVES = SIZE / 16384;
    wire [14:0] read = RD_ADDR[(1-LOOKS)*ABITS +: ABITS];
    wire [14:0] looked = WR_ADDR;
    wire [WIDTH-1:0] found [0:1], seen [0:1];

    // 256 rows as the primitive has them: 16 words of 18 bits, each in 20 bits.
    function [319:0] rows(input integer column, input [256*WIDTH-1:0] entries);
        integer row;
        begin
            rows = 320'd0;
            for (row = 0; row < 256; row = row + 1) rows[20 * (row / 16) + 9 * (row / 8 % 2) + row % 8] = entries[WIDTH * row + column];
        end
    endfunction

    genvar half, column;
    generate
        for (half = 0; half < 2; half = half + 1) begin : halves
            for (column = 0; column < WIDTH; column = column + 1) if (half < HALVES) begin : bits
                DP16KD #(
                    .DATA_WIDTH_A(1), .DATA_WIDTH_B(1), .REGMODE_A("OUTREG"), .REGMODE_B("OUTREG"), .WRITEMODE_A("READBEFOREWRITE"),
                    .WRITEMODE_B("READBEFOREWRITE"), .CSDECODE_A("0b000"), .CSDECODE_B("0b000"), .GSR("DISABLED"),
                    .INITVAL_00(rows(column, INIT[PART*(64*half + 0) +: PART])), .INITVAL_01(rows(column, INIT[PART*(64*half + 1) +: PART])),
                    .INITVAL_02(rows(column, INIT[PART*(64*half + 2) +: PART])), .INITVAL_03(rows(column, INIT[PART*(64*half + 3) +: PART])),
                    .INITVAL_04(rows(column, INIT[PART*(64*half + 4) +: PART])), .INITVAL_05(rows(column, INIT[PART*(64*half + 5) +: PART])),
                    .INITVAL_06(rows(column, INIT[PART*(64*half + 6) +: PART])), .INITVAL_07(rows(column, INIT[PART*(64*half + 7) +: PART])),
                    .INITVAL_08(rows(column, INIT[PART*(64*half + 8) +: PART])), .INITVAL_09(rows(column, INIT[PART*(64*half + 9) +: PART])),
                    .INITVAL_0A(rows(column, INIT[PART*(64*half + 10) +: PART])), .INITVAL_0B(rows(column, INIT[PART*(64*half + 11) +: PART])),
                    .INITVAL_0C(rows(column, INIT[PART*(64*half + 12) +: PART])), .INITVAL_0D(rows(column, INIT[PART*(64*half + 13) +: PART])),
                    .INITVAL_0E(rows(column, INIT[PART*(64*half + 14) +: PART])), .INITVAL_0F(rows(column, INIT[PART*(64*half + 15) +: PART])),
                    .INITVAL_10(rows(column, INIT[PART*(64*half + 16) +: PART])), .INITVAL_11(rows(column, INIT[PART*(64*half + 17) +: PART])),
                    .INITVAL_12(rows(column, INIT[PART*(64*half + 18) +: PART])), .INITVAL_13(rows(column, INIT[PART*(64*half + 19) +: PART])),
                    .INITVAL_14(rows(column, INIT[PART*(64*half + 20) +: PART])), .INITVAL_15(rows(column, INIT[PART*(64*half + 21) +: PART])),
                    .INITVAL_16(rows(column, INIT[PART*(64*half + 22) +: PART])), .INITVAL_17(rows(column, INIT[PART*(64*half + 23) +: PART])),
                    .INITVAL_18(rows(column, INIT[PART*(64*half + 24) +: PART])), .INITVAL_19(rows(column, INIT[PART*(64*half + 25) +: PART])),
                    .INITVAL_1A(rows(column, INIT[PART*(64*half + 26) +: PART])), .INITVAL_1B(rows(column, INIT[PART*(64*half + 27) +: PART])),
                    .INITVAL_1C(rows(column, INIT[PART*(64*half + 28) +: PART])), .INITVAL_1D(rows(column, INIT[PART*(64*half + 29) +: PART])),
                    .INITVAL_1E(rows(column, INIT[PART*(64*half + 30) +: PART])), .INITVAL_1F(rows(column, INIT[PART*(64*half + 31) +: PART])),
                    .INITVAL_20(rows(column, INIT[PART*(64*half + 32) +: PART])), .INITVAL_21(rows(column, INIT[PART*(64*half + 33) +: PART])),
                    .INITVAL_22(rows(column, INIT[PART*(64*half + 34) +: PART])), .INITVAL_23(rows(column, INIT[PART*(64*half + 35) +: PART])),
                    .INITVAL_24(rows(column, INIT[PART*(64*half + 36) +: PART])), .INITVAL_25(rows(column, INIT[PART*(64*half + 37) +: PART])),
                    .INITVAL_26(rows(column, INIT[PART*(64*half + 38) +: PART])), .INITVAL_27(rows(column, INIT[PART*(64*half + 39) +: PART])),
                    .INITVAL_28(rows(column, INIT[PART*(64*half + 40) +: PART])), .INITVAL_29(rows(column, INIT[PART*(64*half + 41) +: PART])),
                    .INITVAL_2A(rows(column, INIT[PART*(64*half + 42) +: PART])), .INITVAL_2B(rows(column, INIT[PART*(64*half + 43) +: PART])),
                    .INITVAL_2C(rows(column, INIT[PART*(64*half + 44) +: PART])), .INITVAL_2D(rows(column, INIT[PART*(64*half + 45) +: PART])),
                    .INITVAL_2E(rows(column, INIT[PART*(64*half + 46) +: PART])), .INITVAL_2F(rows(column, INIT[PART*(64*half + 47) +: PART])),
                    .INITVAL_30(rows(column, INIT[PART*(64*half + 48) +: PART])), .INITVAL_31(rows(column, INIT[PART*(64*half + 49) +: PART])),
                    .INITVAL_32(rows(column, INIT[PART*(64*half + 50) +: PART])), .INITVAL_33(rows(column, INIT[PART*(64*half + 51) +: PART])),
                    .INITVAL_34(rows(column, INIT[PART*(64*half + 52) +: PART])), .INITVAL_35(rows(column, INIT[PART*(64*half + 53) +: PART])),
                    .INITVAL_36(rows(column, INIT[PART*(64*half + 54) +: PART])), .INITVAL_37(rows(column, INIT[PART*(64*half + 55) +: PART])),
                    .INITVAL_38(rows(column, INIT[PART*(64*half + 56) +: PART])), .INITVAL_39(rows(column, INIT[PART*(64*half + 57) +: PART])),
                    .INITVAL_3A(rows(column, INIT[PART*(64*half + 58) +: PART])), .INITVAL_3B(rows(column, INIT[PART*(64*half + 59) +: PART])),
                    .INITVAL_3C(rows(column, INIT[PART*(64*half + 60) +: PART])), .INITVAL_3D(rows(column, INIT[PART*(64*half + 61) +: PART])),
                    .INITVAL_3E(rows(column, INIT[PART*(64*half + 62) +: PART])), .INITVAL_3F(rows(column, INIT[PART*(64*half + 63) +: PART]))
                ) ram (
                    .CLKA(RD_CLK[1-LOOKS]), .CEA(1'b1), .OCEA(1'b1), .WEA(1'b0), .RSTA(1'b0), .CSA0(1'b0), .CSA1(1'b0), .CSA2(1'b0),
                    .ADA0(read[0]), .ADA1(read[1]), .ADA2(read[2]), .ADA3(read[3]), .ADA4(read[4]), .ADA5(read[5]), .ADA6(read[6]),
                    .ADA7(read[7]), .ADA8(read[8]), .ADA9(read[9]), .ADA10(read[10]), .ADA11(read[11]), .ADA12(read[12]), .ADA13(read[13]),
                    .DIA0(1'b0), .DIA1(1'b0), .DIA2(1'b0), .DIA3(1'b0), .DIA4(1'b0), .DIA5(1'b0), .DIA6(1'b0), .DIA7(1'b0), .DIA8(1'b0),
                    .DIA9(1'b0), .DIA10(1'b0), .DIA11(1'b0), .DIA12(1'b0), .DIA13(1'b0), .DIA14(1'b0), .DIA15(1'b0), .DIA16(1'b0),
                    .DIA17(1'b0), .DOA0(found[half][column]), .CLKB(WR_CLK), .CEB(1'b1), .OCEB(1'b1),
                    .WEB(WR_EN[column] && (HALVES == 1 || looked[14] == half)), .RSTB(1'b0), .CSB0(1'b0), .CSB1(1'b0), .CSB2(1'b0),
                    .ADB0(looked[0]), .ADB1(looked[1]), .ADB2(looked[2]), .ADB3(looked[3]), .ADB4(looked[4]), .ADB5(looked[5]),
                    .ADB6(looked[6]), .ADB7(looked[7]), .ADB8(looked[8]), .ADB9(looked[9]), .ADB10(looked[10]), .ADB11(looked[11]),
                    .ADB12(looked[12]), .ADB13(looked[13]), .DIB0(WR_DATA[column]), .DIB1(1'b0), .DIB2(1'b0), .DIB3(1'b0), .DIB4(1'b0),
                    .DIB5(1'b0), .DIB6(1'b0), .DIB7(1'b0), .DIB8(1'b0), .DIB9(1'b0), .DIB10(1'b0), .DIB11(1'b0), .DIB12(1'b0),
                    .DIB13(1'b0), .DIB14(1'b0), .DIB15(1'b0), .DIB16(1'b0), .DIB17(1'b0), .DOB0(seen[half][column])
                );
            end else begin : none
                assign found[half][column] = 1'b0;
                assign seen[half][column] = 1'b0;
            end
        end
        if (HALVES == 1) begin : one
            assign RD_DATA[(1-LOOKS)*WIDTH +: WIDTH] = found[0];
            assign RD_DATA[LOOKS*WIDTH +: WIDTH] = seen[0];
        end else begin : two
            reg [1:0] read_q, looked_q;
            always @(posedge WR_CLK) begin
                read_q <= {read_q[0], read[14]};
                looked_q <= {looked_q[0], looked[14]};
            end
            assign RD_DATA[(1-LOOKS)*WIDTH +: WIDTH] = found[read_q[1]];
            assign RD_DATA[LOOKS*WIDTH +: WIDTH] = seen[looked_q[1]];
        end
    endgenerate
endmodule
