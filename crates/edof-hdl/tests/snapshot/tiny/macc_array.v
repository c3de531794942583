// All banks of a stage. Each sees the same addresses and values; copied sums are handed down the chain to bank 0.
//
// From crates/edof-hdl/src/blocks/macc_array.rs (MaccArray).
`default_nettype none

module macc_array #(
    parameter BANKS = 4,
    parameter DEPTH = 128,
    parameter ROWS = 2,
    parameter INIT = "mem/stage0_bank"
) (
    input  wire        clock_i,        // Clock.
    input  wire        first_i,        // The step is the first of its pass.
    input  wire [11:0] address_a_i,    // Row of weights.
    input  wire [24:0] value_a_i,      // Value.
    input  wire [11:0] address_b_i,    // Row of weights for the second DSP.
    input  wire [24:0] value_b_i,      // Its value.
    input  wire        copy_i,         // Copies the sums.
    input  wire        shift_i,        // Hands two on.
    output wire [47:0] drain_even_o,   // The two that stand first.
    output wire [47:0] drain_odd_o,    // The odd one.
    input  wire        write_enable_i, // Writes half a row of one bank.
    input  wire [5:0]  write_bank_i,   // Which bank.
    input  wire        write_half_i,   // Which half.
    input  wire [11:0] write_row_i,    // Row.
    input  wire [31:0] write_data_i    // Two weights.
);

    wire [47:0] banks_drain_even [0:BANKS];
    wire [47:0] banks_drain_odd [0:BANKS];

    genvar bank;
    generate
        for (bank = 0; bank < BANKS; bank = bank + 1) begin : banks
            localparam [5:0] NUMBER = bank;
            localparam [15:0] DIGITS = "00" + 256 * (bank / 10) + bank % 10;
            edof_macc_bank #(
                .DEPTH(DEPTH),
                .ROWS(ROWS),
                .SUM(48),
                .INIT({INIT, DIGITS, ".hex"})
            ) element (
                .clock_i(clock_i),
                .first_i(first_i),
                .address_a_i(address_a_i),
                .value_a_i(value_a_i),
                .address_b_i(address_b_i),
                .value_b_i(value_b_i),
                .copy_i(copy_i),
                .shift_i(shift_i),
                .drain_even_i(banks_drain_even[bank + 1]),
                .drain_odd_i(banks_drain_odd[bank + 1]),
                .drain_even_o(banks_drain_even[bank]),
                .drain_odd_o(banks_drain_odd[bank]),
                .write_enable_i(write_enable_i),
                .bank_i(NUMBER),
                .write_bank_i(write_bank_i),
                .write_half_i(write_half_i),
                .write_address_i(write_row_i),
                .write_data_i(write_data_i)
            );
        end
    endgenerate

    assign drain_even_o = banks_drain_even[0];
    assign drain_odd_o = banks_drain_odd[0];

    assign banks_drain_even[BANKS] = 48'd0;
    assign banks_drain_odd[BANKS] = 48'd0;
endmodule

`default_nettype wire
