// All banks of a stage. Each sees the same addresses and values; copied sums are handed down the chain to bank 0, and those of a
// lane's ROWS multipliers are added as they leave.
//
// Counted from a step's address_*_i, value_*_i and first_i (all in one cycle), its product is in its sum seven cycles later at the
// latest edge that a copy_i three cycles later still sees. Sums that a shift_i hands on stand on sum_*_o seven cycles after it.
// A write in the cycle before a step's address takes that step's place where both ports of the memory read (DENSE = 0, ROWS = 2).
// A read_enable_i there reads a row for the host in that step's place, everywhere; its word stands on read_data_o six cycles later,
// and one more for each eight banks before it, for one cycle. At all other times that is 0.
// Writes and reads reach the banks in registers of their own for every eight of them, and so what was read comes back.
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

    wire [99:0] values = {value_d_i, value_c_i, value_b_i, value_a_i};
    // Values and starts reach the banks by a tree: registers of their own for every eight of them.
    reg [25*ROWS-1:0] values_q;
    reg first_q;
    always @(posedge clock_i) begin
        values_q <= values[25*ROWS-1:0];
        first_q <= first_i;
    end

    // The host's writes on their way: bit 18 to 13 bank, 12 half, 11 to 0 row; what is written follows a cycle later. There is none at
    // first, so that no image is spoilt.
    localparam GROUPS = (BANKS + 7) / 8;
    wire [GROUPS-1:0] writes;
    wire [GROUPS-1:0] reads;
    wire [18:0] places_later [0:GROUPS-1];
    wire [25*ROWS-1:0] values_near [0:GROUPS-1];
    wire [GROUPS-1:0] first_near;
    wire [19*GROUPS-1:0] places;
    wire [32*GROUPS-1:0] written;
    genvar group;
    generate
        for (group = 0; group < GROUPS; group = group + 1) begin : groups
            edof_delay #(.WIDTH(25 * ROWS), .CYCLES(1)) near (
                .clock_i(clock_i),
                .now_i(values_q),
                .later_o(values_near[group])
            );
            edof_delay #(.WIDTH(1), .CYCLES(1)) starts (
                .clock_i(clock_i),
                .now_i(first_q),
                .later_o(first_near[group])
            );
            (* keep = "true", dont_touch = "true" *) reg write_q = 1'b0;
            `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) write_q <= write_enable_i;
            assign writes[group] = write_q;
            edof_delay #(.WIDTH(1), .CYCLES(1)) read (
                .clock_i(clock_i),
                .now_i(read_enable_i),
                .later_o(reads[group])
            );
            // What was read, when the row is there: bit 18 that it was, 17 to 12 bank, 11 to 0 row.
            edof_delay #(.WIDTH(19), .CYCLES(2)) place_later (
                .clock_i(clock_i),
                .now_i({reads[group], places[19*group+13 +: 6], places[19*group +: 12]}),
                .later_o(places_later[group])
            );
            edof_delay #(.WIDTH(19), .CYCLES(1)) place (
                .clock_i(clock_i),
                .now_i({write_bank_i, write_half_i, write_row_i}),
                .later_o(places[19*group +: 19])
            );
            edof_delay #(.WIDTH(32), .CYCLES(2)) data (
                .clock_i(clock_i),
                .now_i(write_data_i),
                .later_o(written[32*group +: 32])
            );
        end
    endgenerate

    wire [ROWS*SUM-1:0] even [0:BANKS];
    wire [ROWS*SUM-1:0] odd [0:BANKS];
    assign even[BANKS] = {(ROWS * SUM){1'b0}};
    assign odd[BANKS] = {(ROWS * SUM){1'b0}};

    // What is read for the host is handed down from eight banks to eight.
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
            edof_macc_bank #(
                .BANK(bank),
                .DEPTH(DEPTH),
                .ROWS(ROWS),
                .DENSE(DENSE),
                .SUM(SUM),
                .INIT(INIT)
            ) lanes (
                .clock_i(clock_i),
                .first_i(first_near[bank/8]),
                .address_a_i(address_a_i),
                .address_b_i(address_b_i),
                .value_i(values_near[bank/8]),
                .copy_i(copy_i),
                .shift_i(shift_i),
                .drain_even_i(even[bank+1]),
                .drain_odd_i(odd[bank+1]),
                .drain_even_o(even[bank]),
                .drain_odd_o(odd[bank]),
                .back_i(mine),
                .back_o(read[64*bank +: 64]),
                .read_i(reads[bank/8]),
                .write_i(writes[bank/8]),
                .write_bank_i(places[19*(bank/8)+13 +: 6]),
                .write_half_i(places[19*(bank/8)+12]),
                .write_address_i(places[19*(bank/8) +: 12]),
                .write_data_q_i(written[32*(bank/8) +: 32])
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
    wire [4*48-1:0] even_rows;
    wire [4*48-1:0] odd_rows;
    genvar row;
    generate
        for (row = 0; row < 4; row = row + 1) begin : extended
            if (row >= ROWS) begin : nothing
                assign even_rows[48*row +: 48] = 48'd0;
                assign odd_rows[48*row +: 48] = 48'd0;
            end else if (SUM == 48) begin : whole
                assign even_rows[48*row +: 48] = even_q[SUM*row +: SUM];
                assign odd_rows[48*row +: 48] = odd_q[SUM*row +: SUM];
            end else begin : signed_
                assign even_rows[48*row +: 48] = {{(48 - SUM){even_q[SUM*row+SUM-1]}}, even_q[SUM*row +: SUM]};
                assign odd_rows[48*row +: 48] = {{(48 - SUM){odd_q[SUM*row+SUM-1]}}, odd_q[SUM*row +: SUM]};
            end
        end
    endgenerate
    edof_add4 even_sum (.clock_i(clock_i), .rows_i(even_rows), .sum_o(sum_even_o));
    edof_add4 odd_sum (.clock_i(clock_i), .rows_i(odd_rows), .sum_o(sum_odd_o));
endmodule

`default_nettype wire
