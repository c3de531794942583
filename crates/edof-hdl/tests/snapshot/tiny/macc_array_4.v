// All banks of a stage. Each sees the same addresses and values; copied sums are handed down the chain to bank 0.
//
// From crates/edof-hdl/src/blocks/macc_array.rs (MaccArray).
`default_nettype none

module macc_array_4 (
    input  wire        clock_i,
    input  wire        first_i,
    input  wire [11:0] address_a_i,
    input  wire [24:0] value_a_i,
    input  wire [11:0] address_b_i,
    input  wire [24:0] value_b_i,
    input  wire        copy_i,
    input  wire        shift_i,
    output wire [47:0] drain_even_o,
    output wire [47:0] drain_odd_o,
    input  wire        write_enable_i,
    input  wire [5:0]  write_bank_i,
    input  wire        write_half_i,
    input  wire [11:0] write_row_i,
    input  wire [31:0] write_data_i
);

    localparam [5:0] BANK_IDS_0 = 6'h0;
    localparam [5:0] BANK_IDS_1 = 6'h1;
    localparam [5:0] BANK_IDS_2 = 6'h2;
    localparam [5:0] BANK_IDS_3 = 6'h3;
    localparam [5:0] BANK_IDS_4 = 6'h4;
    localparam [5:0] BANK_IDS_5 = 6'h5;
    localparam [5:0] BANK_IDS_6 = 6'h6;
    localparam [5:0] BANK_IDS_7 = 6'h7;

    wire [47:0] banks_1_drain_even;
    wire [47:0] banks_1_drain_odd;
    wire [47:0] banks_2_drain_even;
    wire [47:0] banks_2_drain_odd;
    wire [47:0] banks_3_drain_even;
    wire [47:0] banks_3_drain_odd;
    wire [47:0] banks_4_drain_even;
    wire [47:0] banks_4_drain_odd;
    wire [47:0] banks_5_drain_even;
    wire [47:0] banks_5_drain_odd;
    wire [47:0] banks_6_drain_even;
    wire [47:0] banks_6_drain_odd;
    wire [47:0] banks_7_drain_even;
    wire [47:0] banks_7_drain_odd;

    edof_macc_bank #(
        .DEPTH(640),
        .ROWS(2),
        .SUM(48),
        .INIT("mem/stage3_bank00.hex")
    ) banks_0 (
        .clock_i(clock_i),
        .first_i(first_i),
        .address_a_i(address_a_i),
        .value_a_i(value_a_i),
        .address_b_i(address_b_i),
        .value_b_i(value_b_i),
        .copy_i(copy_i),
        .shift_i(shift_i),
        .drain_even_i(banks_1_drain_even),
        .drain_odd_i(banks_1_drain_odd),
        .drain_even_o(drain_even_o),
        .drain_odd_o(drain_odd_o),
        .write_enable_i(write_enable_i),
        .bank_i(BANK_IDS_0),
        .write_bank_i(write_bank_i),
        .write_half_i(write_half_i),
        .write_address_i(write_row_i),
        .write_data_i(write_data_i)
    );

    edof_macc_bank #(
        .DEPTH(640),
        .ROWS(2),
        .SUM(48),
        .INIT("mem/stage3_bank01.hex")
    ) banks_1 (
        .clock_i(clock_i),
        .first_i(first_i),
        .address_a_i(address_a_i),
        .value_a_i(value_a_i),
        .address_b_i(address_b_i),
        .value_b_i(value_b_i),
        .copy_i(copy_i),
        .shift_i(shift_i),
        .drain_even_i(banks_2_drain_even),
        .drain_odd_i(banks_2_drain_odd),
        .drain_even_o(banks_1_drain_even),
        .drain_odd_o(banks_1_drain_odd),
        .write_enable_i(write_enable_i),
        .bank_i(BANK_IDS_1),
        .write_bank_i(write_bank_i),
        .write_half_i(write_half_i),
        .write_address_i(write_row_i),
        .write_data_i(write_data_i)
    );

    edof_macc_bank #(
        .DEPTH(640),
        .ROWS(2),
        .SUM(48),
        .INIT("mem/stage3_bank02.hex")
    ) banks_2 (
        .clock_i(clock_i),
        .first_i(first_i),
        .address_a_i(address_a_i),
        .value_a_i(value_a_i),
        .address_b_i(address_b_i),
        .value_b_i(value_b_i),
        .copy_i(copy_i),
        .shift_i(shift_i),
        .drain_even_i(banks_3_drain_even),
        .drain_odd_i(banks_3_drain_odd),
        .drain_even_o(banks_2_drain_even),
        .drain_odd_o(banks_2_drain_odd),
        .write_enable_i(write_enable_i),
        .bank_i(BANK_IDS_2),
        .write_bank_i(write_bank_i),
        .write_half_i(write_half_i),
        .write_address_i(write_row_i),
        .write_data_i(write_data_i)
    );

    edof_macc_bank #(
        .DEPTH(640),
        .ROWS(2),
        .SUM(48),
        .INIT("mem/stage3_bank03.hex")
    ) banks_3 (
        .clock_i(clock_i),
        .first_i(first_i),
        .address_a_i(address_a_i),
        .value_a_i(value_a_i),
        .address_b_i(address_b_i),
        .value_b_i(value_b_i),
        .copy_i(copy_i),
        .shift_i(shift_i),
        .drain_even_i(banks_4_drain_even),
        .drain_odd_i(banks_4_drain_odd),
        .drain_even_o(banks_3_drain_even),
        .drain_odd_o(banks_3_drain_odd),
        .write_enable_i(write_enable_i),
        .bank_i(BANK_IDS_3),
        .write_bank_i(write_bank_i),
        .write_half_i(write_half_i),
        .write_address_i(write_row_i),
        .write_data_i(write_data_i)
    );

    edof_macc_bank #(
        .DEPTH(640),
        .ROWS(2),
        .SUM(48),
        .INIT("mem/stage3_bank04.hex")
    ) banks_4 (
        .clock_i(clock_i),
        .first_i(first_i),
        .address_a_i(address_a_i),
        .value_a_i(value_a_i),
        .address_b_i(address_b_i),
        .value_b_i(value_b_i),
        .copy_i(copy_i),
        .shift_i(shift_i),
        .drain_even_i(banks_5_drain_even),
        .drain_odd_i(banks_5_drain_odd),
        .drain_even_o(banks_4_drain_even),
        .drain_odd_o(banks_4_drain_odd),
        .write_enable_i(write_enable_i),
        .bank_i(BANK_IDS_4),
        .write_bank_i(write_bank_i),
        .write_half_i(write_half_i),
        .write_address_i(write_row_i),
        .write_data_i(write_data_i)
    );

    edof_macc_bank #(
        .DEPTH(640),
        .ROWS(2),
        .SUM(48),
        .INIT("mem/stage3_bank05.hex")
    ) banks_5 (
        .clock_i(clock_i),
        .first_i(first_i),
        .address_a_i(address_a_i),
        .value_a_i(value_a_i),
        .address_b_i(address_b_i),
        .value_b_i(value_b_i),
        .copy_i(copy_i),
        .shift_i(shift_i),
        .drain_even_i(banks_6_drain_even),
        .drain_odd_i(banks_6_drain_odd),
        .drain_even_o(banks_5_drain_even),
        .drain_odd_o(banks_5_drain_odd),
        .write_enable_i(write_enable_i),
        .bank_i(BANK_IDS_5),
        .write_bank_i(write_bank_i),
        .write_half_i(write_half_i),
        .write_address_i(write_row_i),
        .write_data_i(write_data_i)
    );

    edof_macc_bank #(
        .DEPTH(640),
        .ROWS(2),
        .SUM(48),
        .INIT("mem/stage3_bank06.hex")
    ) banks_6 (
        .clock_i(clock_i),
        .first_i(first_i),
        .address_a_i(address_a_i),
        .value_a_i(value_a_i),
        .address_b_i(address_b_i),
        .value_b_i(value_b_i),
        .copy_i(copy_i),
        .shift_i(shift_i),
        .drain_even_i(banks_7_drain_even),
        .drain_odd_i(banks_7_drain_odd),
        .drain_even_o(banks_6_drain_even),
        .drain_odd_o(banks_6_drain_odd),
        .write_enable_i(write_enable_i),
        .bank_i(BANK_IDS_6),
        .write_bank_i(write_bank_i),
        .write_half_i(write_half_i),
        .write_address_i(write_row_i),
        .write_data_i(write_data_i)
    );

    edof_macc_bank #(
        .DEPTH(640),
        .ROWS(2),
        .SUM(48),
        .INIT("mem/stage3_bank07.hex")
    ) banks_7 (
        .clock_i(clock_i),
        .first_i(first_i),
        .address_a_i(address_a_i),
        .value_a_i(value_a_i),
        .address_b_i(address_b_i),
        .value_b_i(value_b_i),
        .copy_i(copy_i),
        .shift_i(shift_i),
        .drain_even_i(48'd0),
        .drain_odd_i(48'd0),
        .drain_even_o(banks_7_drain_even),
        .drain_odd_o(banks_7_drain_odd),
        .write_enable_i(write_enable_i),
        .bank_i(BANK_IDS_7),
        .write_bank_i(write_bank_i),
        .write_half_i(write_half_i),
        .write_address_i(write_row_i),
        .write_data_i(write_data_i)
    );
endmodule

`default_nettype wire
