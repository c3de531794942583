// Maps a weight memory of one port that reads and one that writes onto ECP5 block RAMs of 512 rows of 32 bits with their output registers: a read
// takes two cycles, and the register that follows the memory is taken out (output_register.v). Blocks that lie under each other are
// selected behind their registers. A read of a row in the cycle of its write is undefined.
//
// What comes in at DI[17:0] goes out at DO[35:18], and DI[35:18] at DO[17:0]: so Yosys connected this cell (techlibs/ecp5/brams_connect.py, bram_conn_36),
// nextpnr takes DO[35:18] for DOA and DO[17:0] for DOB (ecp5/pack.cc), and Yosys' map of today has the low half at DOA (lattice/brams_map_16kd.v).
module \$mem_v2 (RD_CLK, RD_EN, RD_ARST, RD_SRST, RD_ADDR, RD_DATA, WR_CLK, WR_EN, WR_ADDR, WR_DATA);
    parameter MEMID = "";
    parameter signed SIZE = 4;
    parameter signed OFFSET = 0;
    parameter signed ABITS = 2;
    parameter signed WIDTH = 64;
    parameter signed INIT = 1'bx;
    parameter signed RD_PORTS = 1;
    parameter RD_CLK_ENABLE = 1'b1;
    parameter RD_CLK_POLARITY = 1'b1;
    parameter RD_TRANSPARENCY_MASK = 1'b0;
    parameter RD_COLLISION_X_MASK = 1'b0;
    parameter RD_WIDE_CONTINUATION = 1'b0;
    parameter RD_CE_OVER_SRST = 1'b0;
    parameter RD_ARST_VALUE = 1'b0;
    parameter RD_SRST_VALUE = 1'b0;
    parameter RD_INIT_VALUE = 1'b0;
    parameter signed WR_PORTS = 1;
    parameter WR_CLK_ENABLE = 1'b1;
    parameter WR_CLK_POLARITY = 1'b1;
    parameter WR_PRIORITY_MASK = 1'b0;
    parameter WR_WIDE_CONTINUATION = 1'b0;

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

    wire _TECHMAP_FAIL_ = RD_PORTS != 1 || WR_PORTS != 1 || WIDTH != 64 || RD_CLK_ENABLE != 1 || WR_CLK_ENABLE != 1 || SIZE > 2048;

    localparam BLOCKS = (SIZE + 511) / 512;
    wire [13:0] read = RD_ADDR;
    wire [13:0] write = WR_ADDR;
    wire [63:0] found [0:3];

    // Eight rows of half a block as the primitive has them: two words of 18 bits a row, each in 20 bits.
    function [319:0] rows(input integer block, input integer half, input integer eight);
        integer i, row;
        begin
            rows = 320'd0;
            for (i = 0; i < 8; i = i + 1) begin
                row = 512 * block + 8 * eight + i;
                if (row < SIZE) begin
                    rows[40*i +: 18] = INIT[64*row + 32*half +: 18];
                    rows[40*i + 20 +: 14] = INIT[64*row + 32*half + 18 +: 14];
                end
            end
        end
    endfunction

    genvar block, half;
    generate
        for (block = 0; block < 4; block = block + 1) begin : blocks
            if (block < BLOCKS) begin : some
                for (half = 0; half < 2; half = half + 1) begin : halves
                    wire enable = WR_EN[32*half] && (BLOCKS == 1 || write[10:9] == block);
                    PDPW16KD #(
                        .DATA_WIDTH_W(36), .DATA_WIDTH_R(36), .REGMODE("OUTREG"), .GSR("DISABLED"),
                        .INITVAL_00(rows(block, half, 0)), .INITVAL_01(rows(block, half, 1)), .INITVAL_02(rows(block, half, 2)),
                        .INITVAL_03(rows(block, half, 3)), .INITVAL_04(rows(block, half, 4)), .INITVAL_05(rows(block, half, 5)),
                        .INITVAL_06(rows(block, half, 6)), .INITVAL_07(rows(block, half, 7)), .INITVAL_08(rows(block, half, 8)),
                        .INITVAL_09(rows(block, half, 9)), .INITVAL_0A(rows(block, half, 10)), .INITVAL_0B(rows(block, half, 11)),
                        .INITVAL_0C(rows(block, half, 12)), .INITVAL_0D(rows(block, half, 13)), .INITVAL_0E(rows(block, half, 14)),
                        .INITVAL_0F(rows(block, half, 15)), .INITVAL_10(rows(block, half, 16)), .INITVAL_11(rows(block, half, 17)),
                        .INITVAL_12(rows(block, half, 18)), .INITVAL_13(rows(block, half, 19)), .INITVAL_14(rows(block, half, 20)),
                        .INITVAL_15(rows(block, half, 21)), .INITVAL_16(rows(block, half, 22)), .INITVAL_17(rows(block, half, 23)),
                        .INITVAL_18(rows(block, half, 24)), .INITVAL_19(rows(block, half, 25)), .INITVAL_1A(rows(block, half, 26)),
                        .INITVAL_1B(rows(block, half, 27)), .INITVAL_1C(rows(block, half, 28)), .INITVAL_1D(rows(block, half, 29)),
                        .INITVAL_1E(rows(block, half, 30)), .INITVAL_1F(rows(block, half, 31)), .INITVAL_20(rows(block, half, 32)),
                        .INITVAL_21(rows(block, half, 33)), .INITVAL_22(rows(block, half, 34)), .INITVAL_23(rows(block, half, 35)),
                        .INITVAL_24(rows(block, half, 36)), .INITVAL_25(rows(block, half, 37)), .INITVAL_26(rows(block, half, 38)),
                        .INITVAL_27(rows(block, half, 39)), .INITVAL_28(rows(block, half, 40)), .INITVAL_29(rows(block, half, 41)),
                        .INITVAL_2A(rows(block, half, 42)), .INITVAL_2B(rows(block, half, 43)), .INITVAL_2C(rows(block, half, 44)),
                        .INITVAL_2D(rows(block, half, 45)), .INITVAL_2E(rows(block, half, 46)), .INITVAL_2F(rows(block, half, 47)),
                        .INITVAL_30(rows(block, half, 48)), .INITVAL_31(rows(block, half, 49)), .INITVAL_32(rows(block, half, 50)),
                        .INITVAL_33(rows(block, half, 51)), .INITVAL_34(rows(block, half, 52)), .INITVAL_35(rows(block, half, 53)),
                        .INITVAL_36(rows(block, half, 54)), .INITVAL_37(rows(block, half, 55)), .INITVAL_38(rows(block, half, 56)),
                        .INITVAL_39(rows(block, half, 57)), .INITVAL_3A(rows(block, half, 58)), .INITVAL_3B(rows(block, half, 59)),
                        .INITVAL_3C(rows(block, half, 60)), .INITVAL_3D(rows(block, half, 61)), .INITVAL_3E(rows(block, half, 62)),
                        .INITVAL_3F(rows(block, half, 63))
                    ) ram (
                        .CLKW(WR_CLK), .CEW(enable), .CSW0(1'b0), .CSW1(1'b0), .CSW2(1'b0), .CLKR(RD_CLK), .CER(1'b1), .OCER(1'b1),
                        .CSR0(1'b0), .CSR1(1'b0), .CSR2(1'b0), .RST(1'b0), .BE0(1'b1), .BE1(1'b1), .BE2(1'b1), .BE3(1'b1), .ADW0(write[0]),
                        .ADW1(write[1]), .ADW2(write[2]), .ADW3(write[3]), .ADW4(write[4]), .ADW5(write[5]), .ADW6(write[6]),
                        .ADW7(write[7]), .ADW8(write[8]), .ADR0(1'b0), .ADR1(1'b0), .ADR2(1'b0), .ADR3(1'b0), .ADR4(1'b0), .ADR5(read[0]),
                        .ADR6(read[1]), .ADR7(read[2]), .ADR8(read[3]), .ADR9(read[4]), .ADR10(read[5]), .ADR11(read[6]), .ADR12(read[7]),
                        .ADR13(read[8]), .DI0(WR_DATA[32*half+0]), .DI1(WR_DATA[32*half+1]), .DI2(WR_DATA[32*half+2]),
                        .DI3(WR_DATA[32*half+3]), .DI4(WR_DATA[32*half+4]), .DI5(WR_DATA[32*half+5]), .DI6(WR_DATA[32*half+6]),
                        .DI7(WR_DATA[32*half+7]), .DI8(WR_DATA[32*half+8]), .DI9(WR_DATA[32*half+9]), .DI10(WR_DATA[32*half+10]),
                        .DI11(WR_DATA[32*half+11]), .DI12(WR_DATA[32*half+12]), .DI13(WR_DATA[32*half+13]), .DI14(WR_DATA[32*half+14]),
                        .DI15(WR_DATA[32*half+15]), .DI16(WR_DATA[32*half+16]), .DI17(WR_DATA[32*half+17]), .DI18(WR_DATA[32*half+18]),
                        .DI19(WR_DATA[32*half+19]), .DI20(WR_DATA[32*half+20]), .DI21(WR_DATA[32*half+21]), .DI22(WR_DATA[32*half+22]),
                        .DI23(WR_DATA[32*half+23]), .DI24(WR_DATA[32*half+24]), .DI25(WR_DATA[32*half+25]), .DI26(WR_DATA[32*half+26]),
                        .DI27(WR_DATA[32*half+27]), .DI28(WR_DATA[32*half+28]), .DI29(WR_DATA[32*half+29]), .DI30(WR_DATA[32*half+30]),
                        .DI31(WR_DATA[32*half+31]), .DI32(1'b0), .DI33(1'b0), .DI34(1'b0), .DI35(1'b0), .DO18(found[block][32*half+0]),
                        .DO19(found[block][32*half+1]), .DO20(found[block][32*half+2]), .DO21(found[block][32*half+3]),
                        .DO22(found[block][32*half+4]), .DO23(found[block][32*half+5]), .DO24(found[block][32*half+6]),
                        .DO25(found[block][32*half+7]), .DO26(found[block][32*half+8]), .DO27(found[block][32*half+9]),
                        .DO28(found[block][32*half+10]), .DO29(found[block][32*half+11]), .DO30(found[block][32*half+12]),
                        .DO31(found[block][32*half+13]), .DO32(found[block][32*half+14]), .DO33(found[block][32*half+15]),
                        .DO34(found[block][32*half+16]), .DO35(found[block][32*half+17]), .DO0(found[block][32*half+18]),
                        .DO1(found[block][32*half+19]), .DO2(found[block][32*half+20]), .DO3(found[block][32*half+21]),
                        .DO4(found[block][32*half+22]), .DO5(found[block][32*half+23]), .DO6(found[block][32*half+24]),
                        .DO7(found[block][32*half+25]), .DO8(found[block][32*half+26]), .DO9(found[block][32*half+27]),
                        .DO10(found[block][32*half+28]), .DO11(found[block][32*half+29]), .DO12(found[block][32*half+30]),
                        .DO13(found[block][32*half+31])
                    );
                end
            end else begin : none
                assign found[block] = 64'd0;
            end
        end
        if (BLOCKS == 1) begin : one
            assign RD_DATA = found[0];
        end else begin : several
            reg [1:0] block_q, block_q2;
            always @(posedge RD_CLK) begin
                block_q <= read[10:9];
                block_q2 <= block_q;
            end
            assign RD_DATA = block_q2[1] ? (block_q2[0] ? found[3] : found[2]) : (block_q2[0] ? found[1] : found[0]);
        end
    endgenerate
endmodule
