// All banks of a stage. Each sees the same addresses and values; copied sums are handed down the chain to bank 0.
//
// From crates/edof-hdl/src/blocks/macc_array.rs (MaccArray).
`default_nettype none

module macc_array_2 (
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

    wire [47:0] banks_1_drain_even;
    wire [47:0] banks_1_drain_odd;

    edof_macc_bank #(
        .DEPTH(64),
        .ROWS(1),
        .SUM(48),
        .INIT("mem/stage1_bank00.hex")
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
        .DEPTH(64),
        .ROWS(1),
        .SUM(48),
        .INIT("mem/stage1_bank01.hex")
    ) banks_1 (
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
        .drain_even_o(banks_1_drain_even),
        .drain_odd_o(banks_1_drain_odd),
        .write_enable_i(write_enable_i),
        .bank_i(BANK_IDS_1),
        .write_bank_i(write_bank_i),
        .write_half_i(write_half_i),
        .write_address_i(write_row_i),
        .write_data_i(write_data_i)
    );
endmodule

`default_nettype wire
