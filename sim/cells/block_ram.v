// Block RAMs of a 7-series FPGA, as far as a netlist of Yosys uses them (UG473): functional models, for Yosys' own are empty.
//
// Both ports have the width of their memory's words; what else there is (words of two widths, cascades, error correction, inverted clocks)
// stops the simulation. A port that reads a row while the other one writes it gets the row as it was where the writer is READ_FIRST, and the
// row inverted where it is not: the data sheet guarantees nothing there.

module edof_block_ram #(
    parameter BITS = 15,
    // One port that reads (A), one that writes (B), each up to twice as wide.
    parameter SIMPLE = 0,
    parameter [1:0] REGISTERS = 0,
    parameter READ_A = 0,
    parameter READ_B = 0,
    parameter WRITE_A = 0,
    parameter WRITE_B = 0,
    // 0 READ_FIRST, 1 WRITE_FIRST, 2 NO_CHANGE.
    parameter MODE_A = 0,
    parameter MODE_B = 0,
    parameter [(1<<BITS)-1:0] WORDS = 0,
    parameter [(1<<(BITS-3))-1:0] PARITIES = 0
) (
    input wire clock_a_i,
    input wire clock_b_i,
    input wire [1:0] enables_i,
    input wire [1:0] resets_i,
    input wire [1:0] register_enables_i,
    input wire [BITS-1:0] address_a_i,
    input wire [BITS-1:0] address_b_i,
    input wire [7:0] write_a_i,
    input wire [7:0] write_b_i,
    input wire [31:0] data_a_i,
    input wire [31:0] data_b_i,
    input wire [3:0] parity_a_i,
    input wire [3:0] parity_b_i,
    output wire [31:0] data_a_o,
    output wire [31:0] data_b_o,
    output wire [3:0] parity_a_o,
    output wire [3:0] parity_b_o
);
    // Bits of a word, with its parity; without it; bytes of it.
    localparam A = READ_A > WRITE_A ? READ_A : WRITE_A;
    localparam B = READ_B > WRITE_B ? READ_B : WRITE_B;
    localparam WIDTH = A > B ? A : B > 0 ? B : 1;
    localparam DATA = WIDTH >= 9 ? WIDTH / 9 * 8 : WIDTH;
    localparam LANES = WIDTH >= 9 ? WIDTH / 9 : 1;
    localparam LANE = WIDTH >= 9 ? 9 : WIDTH;
    localparam SHIFT = $clog2(DATA);
    localparam ROWS = BITS - SHIFT;
    // Half of a memory's word, and of its bytes: in the simple mode the widest words are on both ports.
    localparam WIDE = SIMPLE != 0 && LANES == (1 << BITS - 12);

    initial if ((READ_A != 0 && READ_A != WIDTH) || (READ_B != 0 && READ_B != WIDTH) || (WRITE_A != 0 && WRITE_A != WIDTH)
            || (WRITE_B != 0 && WRITE_B != WIDTH) || (SIMPLE != 0 && (READ_B != 0 || WRITE_A != 0)))
        $fatal(1, "%m: words of two widths are not modelled");

    wire [ROWS-1:0] row_a = address_a_i[BITS-1:SHIFT];
    wire [ROWS-1:0] row_b = address_b_i[BITS-1:SHIFT];
    wire [71:0] word_a, word_b;
    wire [71:0] write_a = lanes(data_a_i, parity_a_i);
    wire [71:0] write_b = WIDE ? (LANES == 8 ? both(data_b_i, parity_b_i, data_a_i, parity_a_i) : halves(data_b_i, parity_b_i, data_a_i, parity_a_i))
                               : lanes(data_b_i, parity_b_i);

    function [71:0] lanes(input [31:0] data, input [3:0] parity);
        lanes = WIDTH < 9 ? {40'd0, data} : {36'd0, parity[3], data[31:24], parity[2], data[23:16], parity[1], data[15:8], parity[0], data[7:0]};
    endfunction

    // Of 72 bits: the upper 36 on port B, the lower on A.
    function [71:0] both(input [31:0] upper, input [3:0] upper_parity, input [31:0] lower, input [3:0] lower_parity);
        reg [71:0] a, b;
        begin
            a = lanes(lower, lower_parity);
            b = lanes(upper, upper_parity);
            both = {b[35:0], a[35:0]};
        end
    endfunction

    // Of 36 bits of the smaller block: the upper 18 on port B, the lower on A.
    function [71:0] halves(input [31:0] upper, input [3:0] upper_parity, input [31:0] lower, input [3:0] lower_parity);
        reg [71:0] a, b;
        begin
            a = lanes(lower, lower_parity);
            b = lanes(upper, upper_parity);
            halves = {36'd0, b[17:0], a[17:0]};
        end
    endfunction

    genvar lane;
    generate
        for (lane = 0; lane < 8; lane = lane + 1) begin : bytes
            if (lane >= LANES) begin : nothing
                assign word_a[9*lane +: 9] = 9'd0;
                assign word_b[9*lane +: 9] = 9'd0;
            end else begin : there
                reg [LANE-1:0] rows [0:(1<<ROWS)-1];
                integer row;
                initial for (row = 0; row < (1 << ROWS); row = row + 1) begin
                    if (WIDTH >= 9) rows[row] = {PARITIES[row*LANES + lane], WORDS[row*DATA + 8*lane +: 8]};
                    else rows[row] = WORDS[row*DATA +: LANE];
                end
                wire writes_a = WRITE_A != 0 && SIMPLE == 0 && enables_i[0] && write_a_i[lane];
                wire writes_b = WRITE_B != 0 && enables_i[1] && write_b_i[lane];
                reg [LANE-1:0] read_a_q, read_b_q, later_a_q, later_b_q;
                wire [LANE-1:0] now_a = rows[row_a];
                wire [LANE-1:0] now_b = rows[row_b];
                wire meet_a = writes_b && MODE_B != 0 && row_a == row_b;
                wire meet_b = writes_a && MODE_A != 0 && row_a == row_b;
                always @(posedge clock_a_i) begin
                    if (writes_a) rows[row_a] <= write_a[9*lane +: LANE];
                    if (enables_i[0] && !(writes_a && MODE_A == 2))
                        read_a_q <= resets_i[0] ? {LANE{1'b0}} : writes_a && MODE_A == 1 ? write_a[9*lane +: LANE] : meet_a ? ~now_a : now_a;
                    if (register_enables_i[0]) later_a_q <= read_a_q;
                end
                always @(posedge clock_b_i) begin
                    if (writes_b) rows[row_b] <= write_b[9*lane +: LANE];
                    if (enables_i[1] && !(writes_b && MODE_B == 2))
                        read_b_q <= resets_i[1] ? {LANE{1'b0}} : writes_b && MODE_B == 1 ? write_b[9*lane +: LANE] : meet_b ? ~now_b : now_b;
                    if (register_enables_i[1]) later_b_q <= read_b_q;
                end
                assign word_a[9*lane +: 9] = REGISTERS[0] ? later_a_q : read_a_q;
                assign word_b[9*lane +: 9] = REGISTERS[1] ? later_b_q : read_b_q;
            end
        end
    endgenerate

    // In the simple mode the widest words leave on both ports, the upper half on B.
    wire [71:0] upper = WIDE ? word_a >> (LANES == 8 ? 36 : 18) : word_b;
    assign data_a_o = WIDTH < 9 ? word_a[31:0] : {word_a[34:27], word_a[25:18], word_a[16:9], word_a[7:0]};
    assign data_b_o = WIDTH < 9 ? upper[31:0] : {upper[34:27], upper[25:18], upper[16:9], upper[7:0]};
    assign parity_a_o = {word_a[35], word_a[26], word_a[17], word_a[8]};
    assign parity_b_o = {upper[35], upper[26], upper[17], upper[8]};
endmodule

module RAMB18E1 (
    input CLKARDCLK, input CLKBWRCLK, input ENARDEN, input ENBWREN, input REGCEAREGCE, input REGCEB,
    input RSTRAMARSTRAM, input RSTRAMB, input RSTREGARSTREG, input RSTREGB,
    input [13:0] ADDRARDADDR, input [13:0] ADDRBWRADDR,
    input [15:0] DIADI, input [15:0] DIBDI, input [1:0] DIPADIP, input [1:0] DIPBDIP,
    input [1:0] WEA, input [3:0] WEBWE,
    output [15:0] DOADO, output [15:0] DOBDO, output [1:0] DOPADOP, output [1:0] DOPBDOP
);
    parameter integer DOA_REG = 0, DOB_REG = 0, READ_WIDTH_A = 0, READ_WIDTH_B = 0, WRITE_WIDTH_A = 0, WRITE_WIDTH_B = 0;
    parameter RAM_MODE = "TDP", WRITE_MODE_A = "WRITE_FIRST", WRITE_MODE_B = "WRITE_FIRST";
    parameter RDADDR_COLLISION_HWCONFIG = "DELAYED_WRITE", RSTREG_PRIORITY_A = "RSTREG", RSTREG_PRIORITY_B = "RSTREG";
    parameter SIM_COLLISION_CHECK = "ALL", SIM_DEVICE = "7SERIES", INIT_FILE = "NONE";
    parameter [17:0] INIT_A = 0, INIT_B = 0, SRVAL_A = 0, SRVAL_B = 0;
    parameter IS_CLKARDCLK_INVERTED = 1'b0, IS_CLKBWRCLK_INVERTED = 1'b0, IS_ENARDEN_INVERTED = 1'b0, IS_ENBWREN_INVERTED = 1'b0;
    parameter IS_RSTRAMARSTRAM_INVERTED = 1'b0, IS_RSTRAMB_INVERTED = 1'b0, IS_RSTREGARSTREG_INVERTED = 1'b0, IS_RSTREGB_INVERTED = 1'b0;
    parameter [255:0]
        INIT_00 = 0, INIT_01 = 0, INIT_02 = 0, INIT_03 = 0, INIT_04 = 0, INIT_05 = 0,
        INIT_06 = 0, INIT_07 = 0, INIT_08 = 0, INIT_09 = 0, INIT_0A = 0, INIT_0B = 0,
        INIT_0C = 0, INIT_0D = 0, INIT_0E = 0, INIT_0F = 0, INIT_10 = 0, INIT_11 = 0,
        INIT_12 = 0, INIT_13 = 0, INIT_14 = 0, INIT_15 = 0, INIT_16 = 0, INIT_17 = 0,
        INIT_18 = 0, INIT_19 = 0, INIT_1A = 0, INIT_1B = 0, INIT_1C = 0, INIT_1D = 0,
        INIT_1E = 0, INIT_1F = 0, INIT_20 = 0, INIT_21 = 0, INIT_22 = 0, INIT_23 = 0,
        INIT_24 = 0, INIT_25 = 0, INIT_26 = 0, INIT_27 = 0, INIT_28 = 0, INIT_29 = 0,
        INIT_2A = 0, INIT_2B = 0, INIT_2C = 0, INIT_2D = 0, INIT_2E = 0, INIT_2F = 0,
        INIT_30 = 0, INIT_31 = 0, INIT_32 = 0, INIT_33 = 0, INIT_34 = 0, INIT_35 = 0,
        INIT_36 = 0, INIT_37 = 0, INIT_38 = 0, INIT_39 = 0, INIT_3A = 0, INIT_3B = 0,
        INIT_3C = 0, INIT_3D = 0, INIT_3E = 0, INIT_3F = 0;
    parameter [255:0]
        INITP_00 = 0, INITP_01 = 0, INITP_02 = 0, INITP_03 = 0, INITP_04 = 0, INITP_05 = 0,
        INITP_06 = 0, INITP_07 = 0;
    initial if (IS_CLKARDCLK_INVERTED || IS_CLKBWRCLK_INVERTED) $fatal(1, "%m: inverted clocks are not modelled");
    wire [31:0] data_a, data_b;
    wire [3:0] parity_a, parity_b;
    assign {DOADO, DOBDO, DOPADOP, DOPBDOP} = {data_a[15:0], data_b[15:0], parity_a[1:0], parity_b[1:0]};
    edof_block_ram #(
        .BITS(14),
        .SIMPLE(RAM_MODE == "SDP"),
        .REGISTERS({DOB_REG != 0, DOA_REG != 0}),
        .READ_A(READ_WIDTH_A),
        .READ_B(READ_WIDTH_B),
        .WRITE_A(WRITE_WIDTH_A),
        .WRITE_B(WRITE_WIDTH_B),
        .MODE_A(WRITE_MODE_A == "READ_FIRST" ? 0 : WRITE_MODE_A == "WRITE_FIRST" ? 1 : 2),
        .MODE_B(WRITE_MODE_B == "READ_FIRST" ? 0 : WRITE_MODE_B == "WRITE_FIRST" ? 1 : 2),
        .WORDS({
            INIT_3F, INIT_3E, INIT_3D, INIT_3C, INIT_3B, INIT_3A, INIT_39, INIT_38,
            INIT_37, INIT_36, INIT_35, INIT_34, INIT_33, INIT_32, INIT_31, INIT_30,
            INIT_2F, INIT_2E, INIT_2D, INIT_2C, INIT_2B, INIT_2A, INIT_29, INIT_28,
            INIT_27, INIT_26, INIT_25, INIT_24, INIT_23, INIT_22, INIT_21, INIT_20,
            INIT_1F, INIT_1E, INIT_1D, INIT_1C, INIT_1B, INIT_1A, INIT_19, INIT_18,
            INIT_17, INIT_16, INIT_15, INIT_14, INIT_13, INIT_12, INIT_11, INIT_10,
            INIT_0F, INIT_0E, INIT_0D, INIT_0C, INIT_0B, INIT_0A, INIT_09, INIT_08,
            INIT_07, INIT_06, INIT_05, INIT_04, INIT_03, INIT_02, INIT_01, INIT_00
        }),
        .PARITIES({
            INITP_07, INITP_06, INITP_05, INITP_04, INITP_03, INITP_02, INITP_01, INITP_00
        })
    ) model (
        .clock_a_i(CLKARDCLK),
        .clock_b_i(CLKBWRCLK),
        .enables_i({ENBWREN ^ IS_ENBWREN_INVERTED, ENARDEN ^ IS_ENARDEN_INVERTED}),
        .resets_i({RSTRAMB ^ IS_RSTRAMB_INVERTED, RSTRAMARSTRAM ^ IS_RSTRAMARSTRAM_INVERTED}),
        .register_enables_i({REGCEB, REGCEAREGCE}),
        .address_a_i(ADDRARDADDR[13:0]),
        .address_b_i(ADDRBWRADDR[13:0]),
        .write_a_i({6'd0, WEA}),
        .write_b_i({4'd0, WEBWE}),
        .data_a_i({16'd0, DIADI}),
        .data_b_i({16'd0, DIBDI}),
        .parity_a_i({2'd0, DIPADIP}),
        .parity_b_i({2'd0, DIPBDIP}),
        .data_a_o(data_a),
        .data_b_o(data_b),
        .parity_a_o(parity_a),
        .parity_b_o(parity_b)
    );
endmodule

module RAMB36E1 (
    input CLKARDCLK, input CLKBWRCLK, input ENARDEN, input ENBWREN, input REGCEAREGCE, input REGCEB,
    input RSTRAMARSTRAM, input RSTRAMB, input RSTREGARSTREG, input RSTREGB,
    input CASCADEINA, input CASCADEINB, output CASCADEOUTA, output CASCADEOUTB,
    input INJECTDBITERR, input INJECTSBITERR, output DBITERR, output SBITERR, output [7:0] ECCPARITY, output [8:0] RDADDRECC,
    input [15:0] ADDRARDADDR, input [15:0] ADDRBWRADDR,
    input [31:0] DIADI, input [31:0] DIBDI, input [3:0] DIPADIP, input [3:0] DIPBDIP,
    input [3:0] WEA, input [7:0] WEBWE,
    output [31:0] DOADO, output [31:0] DOBDO, output [3:0] DOPADOP, output [3:0] DOPBDOP
);
    parameter integer DOA_REG = 0, DOB_REG = 0, READ_WIDTH_A = 0, READ_WIDTH_B = 0, WRITE_WIDTH_A = 0, WRITE_WIDTH_B = 0;
    parameter RAM_MODE = "TDP", WRITE_MODE_A = "WRITE_FIRST", WRITE_MODE_B = "WRITE_FIRST";
    parameter RDADDR_COLLISION_HWCONFIG = "DELAYED_WRITE", RSTREG_PRIORITY_A = "RSTREG", RSTREG_PRIORITY_B = "RSTREG";
    parameter SIM_COLLISION_CHECK = "ALL", SIM_DEVICE = "7SERIES", INIT_FILE = "NONE";
    parameter RAM_EXTENSION_A = "NONE", RAM_EXTENSION_B = "NONE", EN_ECC_READ = "FALSE", EN_ECC_WRITE = "FALSE";
    parameter [35:0] INIT_A = 0, INIT_B = 0, SRVAL_A = 0, SRVAL_B = 0;
    parameter IS_CLKARDCLK_INVERTED = 1'b0, IS_CLKBWRCLK_INVERTED = 1'b0, IS_ENARDEN_INVERTED = 1'b0, IS_ENBWREN_INVERTED = 1'b0;
    parameter IS_RSTRAMARSTRAM_INVERTED = 1'b0, IS_RSTRAMB_INVERTED = 1'b0, IS_RSTREGARSTREG_INVERTED = 1'b0, IS_RSTREGB_INVERTED = 1'b0;
    parameter [255:0]
        INIT_00 = 0, INIT_01 = 0, INIT_02 = 0, INIT_03 = 0, INIT_04 = 0, INIT_05 = 0,
        INIT_06 = 0, INIT_07 = 0, INIT_08 = 0, INIT_09 = 0, INIT_0A = 0, INIT_0B = 0,
        INIT_0C = 0, INIT_0D = 0, INIT_0E = 0, INIT_0F = 0, INIT_10 = 0, INIT_11 = 0,
        INIT_12 = 0, INIT_13 = 0, INIT_14 = 0, INIT_15 = 0, INIT_16 = 0, INIT_17 = 0,
        INIT_18 = 0, INIT_19 = 0, INIT_1A = 0, INIT_1B = 0, INIT_1C = 0, INIT_1D = 0,
        INIT_1E = 0, INIT_1F = 0, INIT_20 = 0, INIT_21 = 0, INIT_22 = 0, INIT_23 = 0,
        INIT_24 = 0, INIT_25 = 0, INIT_26 = 0, INIT_27 = 0, INIT_28 = 0, INIT_29 = 0,
        INIT_2A = 0, INIT_2B = 0, INIT_2C = 0, INIT_2D = 0, INIT_2E = 0, INIT_2F = 0,
        INIT_30 = 0, INIT_31 = 0, INIT_32 = 0, INIT_33 = 0, INIT_34 = 0, INIT_35 = 0,
        INIT_36 = 0, INIT_37 = 0, INIT_38 = 0, INIT_39 = 0, INIT_3A = 0, INIT_3B = 0,
        INIT_3C = 0, INIT_3D = 0, INIT_3E = 0, INIT_3F = 0, INIT_40 = 0, INIT_41 = 0,
        INIT_42 = 0, INIT_43 = 0, INIT_44 = 0, INIT_45 = 0, INIT_46 = 0, INIT_47 = 0,
        INIT_48 = 0, INIT_49 = 0, INIT_4A = 0, INIT_4B = 0, INIT_4C = 0, INIT_4D = 0,
        INIT_4E = 0, INIT_4F = 0, INIT_50 = 0, INIT_51 = 0, INIT_52 = 0, INIT_53 = 0,
        INIT_54 = 0, INIT_55 = 0, INIT_56 = 0, INIT_57 = 0, INIT_58 = 0, INIT_59 = 0,
        INIT_5A = 0, INIT_5B = 0, INIT_5C = 0, INIT_5D = 0, INIT_5E = 0, INIT_5F = 0,
        INIT_60 = 0, INIT_61 = 0, INIT_62 = 0, INIT_63 = 0, INIT_64 = 0, INIT_65 = 0,
        INIT_66 = 0, INIT_67 = 0, INIT_68 = 0, INIT_69 = 0, INIT_6A = 0, INIT_6B = 0,
        INIT_6C = 0, INIT_6D = 0, INIT_6E = 0, INIT_6F = 0, INIT_70 = 0, INIT_71 = 0,
        INIT_72 = 0, INIT_73 = 0, INIT_74 = 0, INIT_75 = 0, INIT_76 = 0, INIT_77 = 0,
        INIT_78 = 0, INIT_79 = 0, INIT_7A = 0, INIT_7B = 0, INIT_7C = 0, INIT_7D = 0,
        INIT_7E = 0, INIT_7F = 0;
    parameter [255:0]
        INITP_00 = 0, INITP_01 = 0, INITP_02 = 0, INITP_03 = 0, INITP_04 = 0, INITP_05 = 0,
        INITP_06 = 0, INITP_07 = 0, INITP_08 = 0, INITP_09 = 0, INITP_0A = 0, INITP_0B = 0,
        INITP_0C = 0, INITP_0D = 0, INITP_0E = 0, INITP_0F = 0;
    assign {CASCADEOUTA, CASCADEOUTB, DBITERR, SBITERR, ECCPARITY, RDADDRECC} = 0;
    initial if (RAM_EXTENSION_A != "NONE" || RAM_EXTENSION_B != "NONE") $fatal(1, "%m: block RAMs in cascade are not modelled");
    initial if (IS_CLKARDCLK_INVERTED || IS_CLKBWRCLK_INVERTED) $fatal(1, "%m: inverted clocks are not modelled");
    edof_block_ram #(
        .BITS(15),
        .SIMPLE(RAM_MODE == "SDP"),
        .REGISTERS({DOB_REG != 0, DOA_REG != 0}),
        .READ_A(READ_WIDTH_A),
        .READ_B(READ_WIDTH_B),
        .WRITE_A(WRITE_WIDTH_A),
        .WRITE_B(WRITE_WIDTH_B),
        .MODE_A(WRITE_MODE_A == "READ_FIRST" ? 0 : WRITE_MODE_A == "WRITE_FIRST" ? 1 : 2),
        .MODE_B(WRITE_MODE_B == "READ_FIRST" ? 0 : WRITE_MODE_B == "WRITE_FIRST" ? 1 : 2),
        .WORDS({
            INIT_7F, INIT_7E, INIT_7D, INIT_7C, INIT_7B, INIT_7A, INIT_79, INIT_78,
            INIT_77, INIT_76, INIT_75, INIT_74, INIT_73, INIT_72, INIT_71, INIT_70,
            INIT_6F, INIT_6E, INIT_6D, INIT_6C, INIT_6B, INIT_6A, INIT_69, INIT_68,
            INIT_67, INIT_66, INIT_65, INIT_64, INIT_63, INIT_62, INIT_61, INIT_60,
            INIT_5F, INIT_5E, INIT_5D, INIT_5C, INIT_5B, INIT_5A, INIT_59, INIT_58,
            INIT_57, INIT_56, INIT_55, INIT_54, INIT_53, INIT_52, INIT_51, INIT_50,
            INIT_4F, INIT_4E, INIT_4D, INIT_4C, INIT_4B, INIT_4A, INIT_49, INIT_48,
            INIT_47, INIT_46, INIT_45, INIT_44, INIT_43, INIT_42, INIT_41, INIT_40,
            INIT_3F, INIT_3E, INIT_3D, INIT_3C, INIT_3B, INIT_3A, INIT_39, INIT_38,
            INIT_37, INIT_36, INIT_35, INIT_34, INIT_33, INIT_32, INIT_31, INIT_30,
            INIT_2F, INIT_2E, INIT_2D, INIT_2C, INIT_2B, INIT_2A, INIT_29, INIT_28,
            INIT_27, INIT_26, INIT_25, INIT_24, INIT_23, INIT_22, INIT_21, INIT_20,
            INIT_1F, INIT_1E, INIT_1D, INIT_1C, INIT_1B, INIT_1A, INIT_19, INIT_18,
            INIT_17, INIT_16, INIT_15, INIT_14, INIT_13, INIT_12, INIT_11, INIT_10,
            INIT_0F, INIT_0E, INIT_0D, INIT_0C, INIT_0B, INIT_0A, INIT_09, INIT_08,
            INIT_07, INIT_06, INIT_05, INIT_04, INIT_03, INIT_02, INIT_01, INIT_00
        }),
        .PARITIES({
            INITP_0F, INITP_0E, INITP_0D, INITP_0C, INITP_0B, INITP_0A, INITP_09, INITP_08,
            INITP_07, INITP_06, INITP_05, INITP_04, INITP_03, INITP_02, INITP_01, INITP_00
        })
    ) model (
        .clock_a_i(CLKARDCLK),
        .clock_b_i(CLKBWRCLK),
        .enables_i({ENBWREN ^ IS_ENBWREN_INVERTED, ENARDEN ^ IS_ENARDEN_INVERTED}),
        .resets_i({RSTRAMB ^ IS_RSTRAMB_INVERTED, RSTRAMARSTRAM ^ IS_RSTRAMARSTRAM_INVERTED}),
        .register_enables_i({REGCEB, REGCEAREGCE}),
        .address_a_i(ADDRARDADDR[14:0]),
        .address_b_i(ADDRBWRADDR[14:0]),
        .write_a_i({4'd0, WEA}),
        .write_b_i(WEBWE),
        .data_a_i({DIADI}),
        .data_b_i({DIBDI}),
        .parity_a_i({DIPADIP}),
        .parity_b_i({DIPBDIP}),
        .data_a_o(DOADO),
        .data_b_o(DOBDO),
        .parity_a_o(DOPADOP),
        .parity_b_o(DOPBDOP)
    );
endmodule
