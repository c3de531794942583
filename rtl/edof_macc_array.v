// All banks of a stage, in groups of eight. Each bank sees the same addresses and values; copied sums are handed down the chain to bank 0,
// and those of a lane's ROWS multipliers are added as they leave.
//
// Everything passes from group to group: it enters at the highest one, and each group hands it to the one below a cycle later, in registers
// of its own. Group n therefore does all that it does a cycle after group n + 1, sums pass a register between them, and all leaves at bank 0.
// No register leads to banks of two groups.
//
// Counted from a step's address_*_i, value_*_i and first_i (all in one cycle), its product is in its sum seven cycles later at the
// latest edge that a copy_i three cycles later still sees. Sums that a shift_i hands on are valid on sum_*_o 7 + GROUPS cycles after it.
// A write in the cycle before a step's address takes that step's place where both ports of the memory read (DENSE = 0, ROWS = 2).
// A read_enable_i there reads a row for the host in that step's place, everywhere; its word is valid on read_data_o 6 + GROUPS cycles later,
// for one cycle. At all other times that is 0.
`ifndef EDOF_KEEP_IN_YOSYS
`ifdef YOSYS
`define EDOF_KEEP_IN_YOSYS (* keep *)
`else
`define EDOF_KEEP_IN_YOSYS
`endif
`endif
`default_nettype none
module edof_macc_array #(
    parameter BANKS = 4,
    parameter DEPTH = 384,
    parameter ROWS = 1,
    parameter DENSE = 0,
    parameter SUM = 48,
    parameter INIT = ""
) (
    input  wire               clock_i,
    input  wire               first_i,
    input  wire        [11:0] address_a_i,
    input  wire        [11:0] address_b_i,
    input  wire        [24:0] value_a_i,
    input  wire        [24:0] value_b_i,
    input  wire        [24:0] value_c_i,
    input  wire        [24:0] value_d_i,
    input  wire               copy_i,
    input  wire               shift_i,
    output wire        [47:0] sum_even_o,
    output wire        [47:0] sum_odd_o,
    input  wire               write_enable_i,
    input  wire        [5:0]  write_bank_i,
    input  wire               write_half_i,
    input  wire        [11:0] write_row_i,
    input  wire        [31:0] write_data_i,
    input  wire               read_enable_i,
    output wire        [63:0] read_data_o
);
    localparam WORDS = (DENSE != 0) ? ROWS : 1;
    localparam PART_BITS = $clog2(WORDS);
    localparam GROUPS = (BANKS + 7) / 8;
    localparam BITS = $clog2(DEPTH);
    // The second port's address, where there is one.
    localparam PORTS = (DENSE == 0 && ROWS == 2) ? 2 : 1;

    wire [99:0] values = {value_d_i, value_c_i, value_b_i, value_a_i};
    wire [2*BITS-1:0] addresses = {address_b_i[BITS-1:0], address_a_i[BITS-1:0]};

    // What each group hands to the one below it; GROUPS is what enters. Steps: bit 0 starts a sum, the rest values. Control: bit 1 copy, 0 shift.
    wire [25*ROWS:0] steps [0:GROUPS];
    wire [PORTS*BITS-1:0] address [0:GROUPS];
    wire [1:0] control [0:GROUPS];
    // The host's words: bit 18 to 13 bank, 12 half, 11 to 0 row; what is written follows a cycle later.
    wire [GROUPS:0] writes;
    wire [GROUPS:0] reads;
    wire [18:0] places [0:GROUPS];
    wire [31:0] written [0:GROUPS];
    wire [18:0] places_read [0:GROUPS-1];
    wire [18:0] places_later [0:GROUPS-1];

    // Values come two cycles after their row's address, writes a cycle after they are due.
    edof_delay #(.WIDTH(25 * ROWS + 1), .CYCLES(2)) step_enters (
        .clock_i(clock_i), .data_i({values[25*ROWS-1:0], first_i}), .data_o(steps[GROUPS])
    );
    assign address[GROUPS] = addresses[PORTS*BITS-1:0];
    assign control[GROUPS] = {copy_i, shift_i};
    // Write enables power up as 0, so that no write corrupts the memory image before reset arrives.
    (* keep = "true" *) reg enters_q = 1'b0;
    `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) enters_q <= write_enable_i;
    assign writes[GROUPS] = enters_q;
    edof_delay #(.WIDTH(20), .CYCLES(1)) place_enters (
        .clock_i(clock_i), .data_i({read_enable_i, write_bank_i, write_half_i, write_row_i}), .data_o({reads[GROUPS], places[GROUPS]})
    );
    edof_delay #(.WIDTH(32), .CYCLES(2)) data_enters (
        .clock_i(clock_i), .data_i(write_data_i), .data_o(written[GROUPS])
    );

    genvar group;
    generate
        for (group = 0; group < GROUPS; group = group + 1) begin : groups
            edof_delay #(.WIDTH(25 * ROWS + 1), .CYCLES(1)) step (
                .clock_i(clock_i), .data_i(steps[group+1]), .data_o(steps[group])
            );
            edof_delay #(.WIDTH(PORTS * BITS), .CYCLES(1)) row (
                .clock_i(clock_i), .data_i(address[group+1]), .data_o(address[group])
            );
            edof_delay #(.WIDTH(2), .CYCLES(1)) control_delay (
                .clock_i(clock_i), .data_i(control[group+1]), .data_o(control[group])
            );
            (* keep = "true" *) reg write_q = 1'b0;
            `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) write_q <= writes[group+1];
            assign writes[group] = write_q;
            edof_delay #(.WIDTH(20), .CYCLES(1)) place (
                .clock_i(clock_i), .data_i({reads[group+1], places[group+1]}), .data_o({reads[group], places[group]})
            );
            edof_delay #(.WIDTH(32), .CYCLES(1)) data (
                .clock_i(clock_i), .data_i(written[group+1]), .data_o(written[group])
            );
            // What was read, when the row is there: bit 18 that it was, 17 to 12 bank, 11 to 0 row. Both registers are this group's own: tools
            // would make the first of a delay of two cycles of the one that the group below has for places, which led up again then.
            edof_delay #(.WIDTH(19), .CYCLES(1)) place_read (
                .clock_i(clock_i), .data_i({reads[group], places[group][18:13], places[group][11:0]}), .data_o(places_read[group])
            );
            edof_delay #(.WIDTH(19), .CYCLES(1)) place_later (
                .clock_i(clock_i), .data_i(places_read[group]), .data_o(places_later[group])
            );
        end
    endgenerate

    wire [ROWS*SUM-1:0] even [0:BANKS];
    wire [ROWS*SUM-1:0] odd [0:BANKS];
    assign even[BANKS] = {(ROWS * SUM){1'b0}};
    assign odd[BANKS] = {(ROWS * SUM){1'b0}};

    // What is read for the host is handed down from group to group, as the sums are.
    wire [64*8*GROUPS-1:0] read;
    wire [63:0] back [0:GROUPS];
    assign back[GROUPS] = 64'd0;
    assign read_data_o = back[0];
    generate
        for (group = 0; group < GROUPS; group = group + 1) begin : gathered
            wire [64*8-1:0] of = read[64*8*group +: 64*8];
            reg [63:0] back_q;
            always @(posedge clock_i)
                back_q <= back[group+1] | of[0 +: 64] | of[64 +: 64] | of[128 +: 64] | of[192 +: 64]
                        | of[256 +: 64] | of[320 +: 64] | of[384 +: 64] | of[448 +: 64];
            assign back[group] = back_q;
        end
        if (8 * GROUPS > BANKS) begin : no_banks
            assign read[64*8*GROUPS-1:64*BANKS] = {(64 * (8 * GROUPS - BANKS)){1'b0}};
        end
    endgenerate

    // Sums of the group above, a cycle later: that group moved a cycle before.
    wire [2*ROWS*SUM-1:0] drained [0:BANKS-1];

    genvar bank;
    genvar word;
    generate
        for (bank = 0; bank < BANKS; bank = bank + 1) begin : banks
            localparam [5:0] NUMBER = bank;
            wire [18:0] place = places_later[bank/8];
            wire [WORDS-1:0] mine;
            for (word = 0; word < WORDS; word = word + 1) begin : words
                localparam [11:0] PART = word;
                assign mine[word] = place[18] && place[17:12] == NUMBER && (place[11:0] & (12'd1 << PART_BITS) - 12'd1) == PART;
            end
            if (bank % 8 == 7 && bank + 1 < BANKS) begin : from_above
                reg [2*ROWS*SUM-1:0] drained_q;
                always @(posedge clock_i) drained_q <= {odd[bank+1], even[bank+1]};
                assign drained[bank] = drained_q;
            end else begin : from_neighbour
                assign drained[bank] = {odd[bank+1], even[bank+1]};
            end
            edof_macc_bank #(.BANK(bank), .DEPTH(DEPTH), .ROWS(ROWS), .DENSE(DENSE), .SUM(SUM), .INIT(INIT)) lanes (
                .clock_i(clock_i), .first_i(steps[bank/8][0]), .address_a_i(address[bank/8][BITS-1:0]),
                .address_b_i(address[bank/8][PORTS*BITS-1 -: BITS]), .value_i(steps[bank/8][25*ROWS:1]),
                .copy_i(control[bank/8][1]), .shift_i(control[bank/8][0]),
                .drain_even_i(drained[bank][ROWS*SUM-1:0]), .drain_odd_i(drained[bank][2*ROWS*SUM-1 -: ROWS*SUM]),
                .drain_even_o(even[bank]), .drain_odd_o(odd[bank]), .back_i(mine), .back_o(read[64*bank +: 64]),
                .read_i(reads[bank/8]), .write_i(writes[bank/8]), .write_bank_i(places[bank/8][18:13]),
                .write_half_i(places[bank/8][12]), .write_address_i(places[bank/8][11:0]),
                .write_data_q_i(written[bank/8])
            );
        end
    endgenerate

    // The sums of a lane's rows, extended to 48 bits; rows that are not there are zero.
    reg [ROWS*SUM-1:0] even_q;
    reg [ROWS*SUM-1:0] odd_q;
    always @(posedge clock_i) begin
        even_q <= even[0];
        odd_q <= odd[0];
    end
    wire [2*ROWS*SUM-1:0] sums = {odd_q, even_q};
    wire [2*4*48-1:0] extended;
    genvar row;
    generate
        for (row = 0; row < 8; row = row + 1) begin : rows
            if (row % 4 < ROWS) begin : some
                wire [SUM-1:0] sum = sums[SUM*(ROWS*(row/4) + row%4) +: SUM];
                assign extended[48*row +: 48] = {{(49 - SUM){sum[SUM-1]}}, sum[SUM-2:0]};
            end else begin : none
                assign extended[48*row +: 48] = 48'd0;
            end
        end
    endgenerate
    edof_add4 even_sum (.clock_i(clock_i), .rows_i(extended[4*48-1:0]), .sum_o(sum_even_o));
    edof_add4 odd_sum (.clock_i(clock_i), .rows_i(extended[2*4*48-1:4*48]), .sum_o(sum_odd_o));
endmodule
`default_nettype wire
