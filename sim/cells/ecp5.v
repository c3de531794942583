// Functional models of ECP5 cells that Yosys has as empty modules alone: what is instantiated here, and nothing more. A use that they do not model
// stops the simulation. Sources: FPGA-TN-02205 (multipliers), FPGA-TN-02035 (pads: ODDRX1F sends D0 first; three edges as in the vendor's own model), FPGA-TN-02204 (memories: PDPW16KD, DP16KD); for which half of a word is at which output, Yosys
// (techlibs/ecp5/brams_connect.py, bram_conn_36; lattice/brams_map_16kd.v) and nextpnr (ecp5/pack.cc).
// verilator lint_off DECLFILENAME
// verilator lint_off UNUSEDPARAM

// 18 x 18 bits, signed, with registers at both inputs and at the output.
module MULT18X18D (
    input A0, input A1, input A2, input A3, input A4, input A5, input A6, input A7, input A8, input A9, input A10, input A11, input A12,
    input A13, input A14, input A15, input A16, input A17, input B0, input B1, input B2, input B3, input B4, input B5, input B6, input B7,
    input B8, input B9, input B10, input B11, input B12, input B13, input B14, input B15, input B16, input B17, input C0, input C1,
    input C2, input C3, input C4, input C5, input C6, input C7, input C8, input C9, input C10, input C11, input C12, input C13, input C14,
    input C15, input C16, input C17, input SIGNEDA, input SIGNEDB, input SOURCEA, input SOURCEB, input CLK0, input CLK1, input CLK2,
    input CLK3, input CE0, input CE1, input CE2, input CE3, input RST0, input RST1, input RST2, input RST3, output P0, output P1,
    output P2, output P3, output P4, output P5, output P6, output P7, output P8, output P9, output P10, output P11, output P12, output P13,
    output P14, output P15, output P16, output P17, output P18, output P19, output P20, output P21, output P22, output P23, output P24,
    output P25, output P26, output P27, output P28, output P29, output P30, output P31, output P32, output P33, output P34, output P35
);
    parameter REG_INPUTA_CLK = "NONE", REG_INPUTA_CE = "CE0", REG_INPUTA_RST = "RST0";
    parameter REG_INPUTB_CLK = "NONE", REG_INPUTB_CE = "CE0", REG_INPUTB_RST = "RST0";
    parameter REG_OUTPUT_CLK = "NONE", REG_OUTPUT_CE = "CE0", REG_OUTPUT_RST = "RST0";
    parameter GSR = "ENABLED";

    wire [17:0] a = {A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0};
    wire [17:0] b = {B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0};
    reg signed [17:0] a_q, b_q;
    reg signed [35:0] product_q;
    assign {P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17, P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0} = product_q;
    always @(posedge CLK0) begin
        a_q <= a;
        b_q <= b;
        product_q <= a_q * b_q;
    end

    wire is_modelled = REG_INPUTA_CLK == "CLK0" && REG_INPUTB_CLK == "CLK0" && REG_OUTPUT_CLK == "CLK0"
        && {CE0, RST0, SIGNEDA, SIGNEDB, SOURCEA, SOURCEB} == 6'b101100;
    always @(posedge CLK0) if (!is_modelled) $fatal(1, "%m: no model of this use");
    wire unused = &{1'b0, C0, C1, C2, C3, C4, C5, C6, C7, C8, C9, C10, C11, C12, C13, C14, C15, C16, C17,
        CLK1, CLK2, CLK3, CE1, CE2, CE3, RST1, RST2, RST3};
endmodule

// Two bits per cycle to a pad: D0 while the clock is high, D1 while it is low.
module ODDRX1F (input SCLK, input RST, input D0, input D1, output Q);
    parameter GSR = "ENABLED";
    reg [1:0] pair_1_q, pair_2_q, pair_3_q;
    always @(posedge SCLK) begin
        pair_1_q <= {D1, D0};
        pair_2_q <= pair_1_q;
        pair_3_q <= pair_2_q;
        if (RST) $fatal(1, "%m: no model of this use");
    end
    assign Q = SCLK ? pair_3_q[0] : pair_3_q[1];
endmodule

// A port that writes and a port that reads 512 words of 36 bits, with or without the output register.
module PDPW16KD (
    input DI0, input DI1, input DI2, input DI3, input DI4, input DI5, input DI6, input DI7, input DI8, input DI9, input DI10, input DI11,
    input DI12, input DI13, input DI14, input DI15, input DI16, input DI17, input DI18, input DI19, input DI20, input DI21, input DI22,
    input DI23, input DI24, input DI25, input DI26, input DI27, input DI28, input DI29, input DI30, input DI31, input DI32, input DI33,
    input DI34, input DI35, input ADW0, input ADW1, input ADW2, input ADW3, input ADW4, input ADW5, input ADW6, input ADW7, input ADW8,
    input BE0, input BE1, input BE2, input BE3, input CEW, input CLKW, input CSW0, input CSW1, input CSW2, input ADR0, input ADR1,
    input ADR2, input ADR3, input ADR4, input ADR5, input ADR6, input ADR7, input ADR8, input ADR9, input ADR10, input ADR11, input ADR12,
    input ADR13, input CER, input OCER, input CLKR, input CSR0, input CSR1, input CSR2, input RST, output DO0, output DO1, output DO2,
    output DO3, output DO4, output DO5, output DO6, output DO7, output DO8, output DO9, output DO10, output DO11, output DO12, output DO13,
    output DO14, output DO15, output DO16, output DO17, output DO18, output DO19, output DO20, output DO21, output DO22, output DO23,
    output DO24, output DO25, output DO26, output DO27, output DO28, output DO29, output DO30, output DO31, output DO32, output DO33,
    output DO34, output DO35
);
    parameter DATA_WIDTH_W = 36, DATA_WIDTH_R = 36, GSR = "ENABLED", REGMODE = "NOREG";
    parameter [319:0] INITVAL_00 = 320'd0, INITVAL_01 = 320'd0, INITVAL_02 = 320'd0, INITVAL_03 = 320'd0, INITVAL_04 = 320'd0,
    INITVAL_05 = 320'd0, INITVAL_06 = 320'd0, INITVAL_07 = 320'd0, INITVAL_08 = 320'd0, INITVAL_09 = 320'd0, INITVAL_0A = 320'd0,
    INITVAL_0B = 320'd0, INITVAL_0C = 320'd0, INITVAL_0D = 320'd0, INITVAL_0E = 320'd0, INITVAL_0F = 320'd0, INITVAL_10 = 320'd0,
    INITVAL_11 = 320'd0, INITVAL_12 = 320'd0, INITVAL_13 = 320'd0, INITVAL_14 = 320'd0, INITVAL_15 = 320'd0, INITVAL_16 = 320'd0,
    INITVAL_17 = 320'd0, INITVAL_18 = 320'd0, INITVAL_19 = 320'd0, INITVAL_1A = 320'd0, INITVAL_1B = 320'd0, INITVAL_1C = 320'd0,
    INITVAL_1D = 320'd0, INITVAL_1E = 320'd0, INITVAL_1F = 320'd0, INITVAL_20 = 320'd0, INITVAL_21 = 320'd0, INITVAL_22 = 320'd0,
    INITVAL_23 = 320'd0, INITVAL_24 = 320'd0, INITVAL_25 = 320'd0, INITVAL_26 = 320'd0, INITVAL_27 = 320'd0, INITVAL_28 = 320'd0,
    INITVAL_29 = 320'd0, INITVAL_2A = 320'd0, INITVAL_2B = 320'd0, INITVAL_2C = 320'd0, INITVAL_2D = 320'd0, INITVAL_2E = 320'd0,
    INITVAL_2F = 320'd0, INITVAL_30 = 320'd0, INITVAL_31 = 320'd0, INITVAL_32 = 320'd0, INITVAL_33 = 320'd0, INITVAL_34 = 320'd0,
    INITVAL_35 = 320'd0, INITVAL_36 = 320'd0, INITVAL_37 = 320'd0, INITVAL_38 = 320'd0, INITVAL_39 = 320'd0, INITVAL_3A = 320'd0,
    INITVAL_3B = 320'd0, INITVAL_3C = 320'd0, INITVAL_3D = 320'd0, INITVAL_3E = 320'd0, INITVAL_3F = 320'd0;

    // Of the bits of each initial value, each 18 have 20.
    reg [35:0] words [0:511];
    localparam [64*320-1:0] CONTENTS = {
        INITVAL_3F, INITVAL_3E, INITVAL_3D, INITVAL_3C, INITVAL_3B, INITVAL_3A, INITVAL_39, INITVAL_38, INITVAL_37, INITVAL_36, INITVAL_35,
        INITVAL_34, INITVAL_33, INITVAL_32, INITVAL_31, INITVAL_30, INITVAL_2F, INITVAL_2E, INITVAL_2D, INITVAL_2C, INITVAL_2B, INITVAL_2A,
        INITVAL_29, INITVAL_28, INITVAL_27, INITVAL_26, INITVAL_25, INITVAL_24, INITVAL_23, INITVAL_22, INITVAL_21, INITVAL_20, INITVAL_1F,
        INITVAL_1E, INITVAL_1D, INITVAL_1C, INITVAL_1B, INITVAL_1A, INITVAL_19, INITVAL_18, INITVAL_17, INITVAL_16, INITVAL_15, INITVAL_14,
        INITVAL_13, INITVAL_12, INITVAL_11, INITVAL_10, INITVAL_0F, INITVAL_0E, INITVAL_0D, INITVAL_0C, INITVAL_0B, INITVAL_0A, INITVAL_09,
        INITVAL_08, INITVAL_07, INITVAL_06, INITVAL_05, INITVAL_04, INITVAL_03, INITVAL_02, INITVAL_01, INITVAL_00
    };
    integer row;
    initial for (row = 0; row < 512; row = row + 1)
        words[row] = {CONTENTS[40*row + 20 +: 18], CONTENTS[40*row +: 18]};

    wire [8:0] write_row = {ADW8, ADW7, ADW6, ADW5, ADW4, ADW3, ADW2, ADW1, ADW0};
    wire [8:0] read_row = {ADR13, ADR12, ADR11, ADR10, ADR9, ADR8, ADR7, ADR6, ADR5};
    reg [35:0] read_q, out_q;
    // The halves of a word that is read are the other way round than of one that is written.
    assign {DO17, DO16, DO15, DO14, DO13, DO12, DO11, DO10, DO9, DO8, DO7, DO6, DO5, DO4, DO3, DO2, DO1, DO0,
        DO35, DO34, DO33, DO32, DO31, DO30, DO29, DO28, DO27, DO26, DO25, DO24, DO23, DO22, DO21, DO20, DO19, DO18} = (REGMODE == "OUTREG") ? out_q : read_q;
    always @(posedge CLKW) if (CEW) words[write_row] <= {DI35, DI34, DI33, DI32, DI31, DI30, DI29, DI28, DI27, DI26, DI25, DI24, DI23, DI22, DI21, DI20, DI19, DI18, DI17, DI16, DI15, DI14, DI13, DI12, DI11, DI10, DI9, DI8, DI7, DI6, DI5, DI4, DI3, DI2, DI1, DI0};
    always @(posedge CLKR) begin
        read_q <= words[read_row];
        out_q <= read_q;
    end

    wire is_modelled = DATA_WIDTH_W == 36 && DATA_WIDTH_R == 36 && {BE3, BE2, BE1, BE0} == 4'b1111 && {CSW2, CSW1, CSW0, CSR2, CSR1, CSR0} == 6'd0
        && {CER, OCER, RST} == 3'b110;
    always @(posedge CLKR) if (!is_modelled) $fatal(1, "%m: no model of this use");
    wire unused = &{1'b0, ADR4, ADR3, ADR2, ADR1, ADR0};
endmodule

// Port A writes, and port B reads, 1,024 words of 18 bits or 512 of 36: the lower half of these by DIA and DOA, the upper by DIB and DOB. Words of up to 9
// bits either port reads and writes. A row that is written in the cycle in which the other port reads it is not to be relied on: every bit of it is wrong.
module DP16KD (
    input DIA0, input DIA1, input DIA2, input DIA3, input DIA4, input DIA5, input DIA6, input DIA7, input DIA8, input DIA9, input DIA10, input DIA11,
    input DIA12, input DIA13, input DIA14, input DIA15, input DIA16, input DIA17, input ADA0, input ADA1, input ADA2, input ADA3, input ADA4, input
    ADA5, input ADA6, input ADA7, input ADA8, input ADA9, input ADA10, input ADA11, input ADA12, input ADA13, input CEA, input OCEA, input CLKA, input
    WEA, input RSTA, input CSA0, input CSA1, input CSA2, input DIB0, input DIB1, input DIB2, input DIB3, input DIB4, input DIB5, input DIB6, input
    DIB7, input DIB8, input DIB9, input DIB10, input DIB11, input DIB12, input DIB13, input DIB14, input DIB15, input DIB16, input DIB17, input ADB0,
    input ADB1, input ADB2, input ADB3, input ADB4, input ADB5, input ADB6, input ADB7, input ADB8, input ADB9, input ADB10, input ADB11, input ADB12,
    input ADB13, input CEB, input OCEB, input CLKB, input WEB, input RSTB, input CSB0, input CSB1, input CSB2, output DOA0, output DOA1, output DOA2,
    output DOA3, output DOA4, output DOA5, output DOA6, output DOA7, output DOA8, output DOA9, output DOA10, output DOA11, output DOA12, output DOA13,
    output DOA14, output DOA15, output DOA16, output DOA17, output DOB0, output DOB1, output DOB2, output DOB3, output DOB4, output DOB5, output DOB6,
    output DOB7, output DOB8, output DOB9, output DOB10, output DOB11, output DOB12, output DOB13, output DOB14, output DOB15, output DOB16, output
    DOB17
);
    parameter DATA_WIDTH_A = 18, DATA_WIDTH_B = 18, REGMODE_A = "NOREG", REGMODE_B = "NOREG", RESETMODE = "SYNC", ASYNC_RESET_RELEASE = "SYNC";
    parameter CSDECODE_A = "0b000", CSDECODE_B = "0b000", WRITEMODE_A = "NORMAL", WRITEMODE_B = "NORMAL", CLKAMUX = "CLKA", CLKBMUX = "CLKB";
    parameter GSR = "ENABLED";
    parameter [319:0] INITVAL_00 = 320'd0, INITVAL_01 = 320'd0, INITVAL_02 = 320'd0, INITVAL_03 = 320'd0, INITVAL_04 = 320'd0, INITVAL_05 = 320'd0,
    INITVAL_06 = 320'd0, INITVAL_07 = 320'd0, INITVAL_08 = 320'd0, INITVAL_09 = 320'd0, INITVAL_0A = 320'd0, INITVAL_0B = 320'd0, INITVAL_0C = 320'd0,
    INITVAL_0D = 320'd0, INITVAL_0E = 320'd0, INITVAL_0F = 320'd0, INITVAL_10 = 320'd0, INITVAL_11 = 320'd0, INITVAL_12 = 320'd0, INITVAL_13 = 320'd0,
    INITVAL_14 = 320'd0, INITVAL_15 = 320'd0, INITVAL_16 = 320'd0, INITVAL_17 = 320'd0, INITVAL_18 = 320'd0, INITVAL_19 = 320'd0, INITVAL_1A = 320'd0,
    INITVAL_1B = 320'd0, INITVAL_1C = 320'd0, INITVAL_1D = 320'd0, INITVAL_1E = 320'd0, INITVAL_1F = 320'd0, INITVAL_20 = 320'd0, INITVAL_21 = 320'd0,
    INITVAL_22 = 320'd0, INITVAL_23 = 320'd0, INITVAL_24 = 320'd0, INITVAL_25 = 320'd0, INITVAL_26 = 320'd0, INITVAL_27 = 320'd0, INITVAL_28 = 320'd0,
    INITVAL_29 = 320'd0, INITVAL_2A = 320'd0, INITVAL_2B = 320'd0, INITVAL_2C = 320'd0, INITVAL_2D = 320'd0, INITVAL_2E = 320'd0, INITVAL_2F = 320'd0,
    INITVAL_30 = 320'd0, INITVAL_31 = 320'd0, INITVAL_32 = 320'd0, INITVAL_33 = 320'd0, INITVAL_34 = 320'd0, INITVAL_35 = 320'd0, INITVAL_36 = 320'd0,
    INITVAL_37 = 320'd0, INITVAL_38 = 320'd0, INITVAL_39 = 320'd0, INITVAL_3A = 320'd0, INITVAL_3B = 320'd0, INITVAL_3C = 320'd0, INITVAL_3D = 320'd0,
    INITVAL_3E = 320'd0, INITVAL_3F = 320'd0;

    // Of the bits of each initial value, each 18 have 20.
    reg [17:0] words [0:1023];
    localparam [64*320-1:0] CONTENTS = {
        INITVAL_3F, INITVAL_3E, INITVAL_3D, INITVAL_3C, INITVAL_3B, INITVAL_3A, INITVAL_39, INITVAL_38, INITVAL_37, INITVAL_36, INITVAL_35,
        INITVAL_34, INITVAL_33, INITVAL_32, INITVAL_31, INITVAL_30, INITVAL_2F, INITVAL_2E, INITVAL_2D, INITVAL_2C, INITVAL_2B, INITVAL_2A,
        INITVAL_29, INITVAL_28, INITVAL_27, INITVAL_26, INITVAL_25, INITVAL_24, INITVAL_23, INITVAL_22, INITVAL_21, INITVAL_20, INITVAL_1F,
        INITVAL_1E, INITVAL_1D, INITVAL_1C, INITVAL_1B, INITVAL_1A, INITVAL_19, INITVAL_18, INITVAL_17, INITVAL_16, INITVAL_15, INITVAL_14,
        INITVAL_13, INITVAL_12, INITVAL_11, INITVAL_10, INITVAL_0F, INITVAL_0E, INITVAL_0D, INITVAL_0C, INITVAL_0B, INITVAL_0A, INITVAL_09,
        INITVAL_08, INITVAL_07, INITVAL_06, INITVAL_05, INITVAL_04, INITVAL_03, INITVAL_02, INITVAL_01, INITVAL_00
    };
    integer row;
    initial for (row = 0; row < 1024; row = row + 1) words[row] = CONTENTS[20*row +: 18];

    localparam IS_WIDE = DATA_WIDTH_A == 36;
    wire [9:0] write_row = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4};
    wire [9:0] read_row = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4};
    wire [17:0] low = {DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3, DIA2, DIA1, DIA0};
    wire [17:0] high = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3, DIB2, DIB1, DIB0};
    wire [3:0] bytes = {ADA3, ADA2, ADA1, ADA0};
    wire is_written = CEA && WEA && (IS_WIDE ? bytes != 4'd0 : bytes[1:0] != 2'd0);
    wire is_same = IS_WIDE ? write_row[9:1] == read_row[9:1] : write_row == read_row;
    wire [17:0] wrong = {18{is_written && is_same}};
    reg [17:0] low_q, high_q;
    assign {DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2, DOA1, DOA0} = IS_NARROW ? narrow_a : IS_WIDE ? low_q : 18'd0;
    assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2, DOB1, DOB0} = IS_NARROW ? narrow_b : IS_WIDE ? high_q : low_q;
    always @(posedge CLKA) if (!IS_NARROW && CEA && WEA) begin
        if (bytes[0]) words[IS_WIDE ? {write_row[9:1], 1'b0} : write_row][8:0] <= low[8:0];
        if (bytes[1]) words[IS_WIDE ? {write_row[9:1], 1'b0} : write_row][17:9] <= low[17:9];
        if (IS_WIDE && bytes[2]) words[{write_row[9:1], 1'b1}][8:0] <= high[8:0];
        if (IS_WIDE && bytes[3]) words[{write_row[9:1], 1'b1}][17:9] <= high[17:9];
    end
    always @(posedge CLKB) if (CEB) begin
        low_q <= wrong ^ words[IS_WIDE ? {read_row[9:1], 1'b0} : read_row];
        high_q <= wrong ^ words[{read_row[9:1], 1'b1}];
    end

    // Words of up to 9 bits at either port: of each 18 bits two words of 9, or as many of 4, 2 or 1 in 16 of them, each ninth being left out.
    localparam IS_NARROW = DATA_WIDTH_A <= 9;
    localparam WIDTH = IS_NARROW ? DATA_WIDTH_A : 9;
    wire [13:0] place_a = {write_row, bytes}, place_b = {read_row, ADB3, ADB2, ADB1, ADB0};
    wire [4:0] column_a = 9 * {4'd0, place_a[3]} + {2'd0, place_a[2:0]}, column_b = 9 * {4'd0, place_b[3]} + {2'd0, place_b[2:0]};
    wire writes_a = CEA && WEA, writes_b = CEB && WEB, is_one_place = place_a == place_b;
    reg [WIDTH-1:0] narrow_a_q, narrow_a_q2, narrow_b_q, narrow_b_q2;
    always @(posedge CLKA) if (IS_NARROW) begin
        if (CEA && (!WEA || WRITEMODE_A == "READBEFOREWRITE"))
            narrow_a_q <= words[place_a[13:4]][column_a +: WIDTH] ^ {WIDTH{writes_b && is_one_place}};
        narrow_a_q2 <= narrow_a_q;
        if (writes_a) words[place_a[13:4]][column_a +: WIDTH] <= low[WIDTH-1:0];
    end
    always @(posedge CLKB) if (IS_NARROW) begin
        if (CEB && (!WEB || WRITEMODE_B == "READBEFOREWRITE"))
            narrow_b_q <= words[place_b[13:4]][column_b +: WIDTH] ^ {WIDTH{writes_a && is_one_place}};
        narrow_b_q2 <= narrow_b_q;
        if (writes_b) words[place_b[13:4]][column_b +: WIDTH] <= high[WIDTH-1:0];
    end
    wire [17:0] narrow_a = (REGMODE_A == "OUTREG") ? narrow_a_q2 : narrow_a_q, narrow_b = (REGMODE_B == "OUTREG") ? narrow_b_q2 : narrow_b_q;

    wire is_modelled_narrow = DATA_WIDTH_B == DATA_WIDTH_A && CLKAMUX == "CLKA" && CLKBMUX == "CLKB" && {CSA2, CSA1, CSA0, CSB2, CSB1, CSB0, RSTA, RSTB} == 8'd0
        && {OCEA, OCEB} == 2'b11 && !(writes_a && writes_b);
    wire is_modelled = IS_NARROW ? is_modelled_narrow : DATA_WIDTH_A == DATA_WIDTH_B && (DATA_WIDTH_A == 18 || DATA_WIDTH_A == 36) && REGMODE_B == "NOREG" && CLKAMUX == "CLKA"
        && CLKBMUX == "CLKB" && {CSA2, CSA1, CSA0, CSB2, CSB1, CSB0, RSTA, RSTB, WEB, ADB3, ADB2, ADB1, ADB0} == 13'd0 && OCEB;
    always @(posedge CLKA) if (!is_modelled) $fatal(1, "%m: no model of this use");
    wire unused = &{1'b0, OCEA};
endmodule
