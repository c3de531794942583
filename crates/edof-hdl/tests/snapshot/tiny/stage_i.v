// One stage of the calculator, I, M or F: vectors in, vectors out, two elements a beat; docs/calculator.md has its cycles.
// Pairs are multiplied as they come out of the pair buffer; sums are copied, drained, rounded, shrunk and sent on.
//
// From crates/edof-hdl/src/blocks/stage.rs (Stage).
`default_nettype none

module stage_i (
    input  wire        clock_i,          // Clock.
    input  wire        reset_i,          // Forgets every vector; held for 16 cycles or more.
    input  wire        valid_i,          // A beat stands on the input.
    output wire        ready_o,          // It is taken in this cycle, if there is one.
    input  wire [31:0] data_i,           // Its two words.
    input  wire        last_i,           // Whether it is its vector's last.
    input  wire        set_i,            // The vector's set.
    output wire        window_ready_o,   // They are taken in this cycle, if there are any.
    output wire        out_valid_o,      // A beat stands on the output.
    input  wire        out_ready_i,      // The receiver takes it.
    output wire [31:0] out_data_o,       // Its two words.
    output wire [31:0] out_base_o,       // Their base words.
    output wire        out_last_o,       // Whether it is its vector's last.
    output wire        out_set_o,        // The vector's set.
    input  wire        write_valid_i,    // A word is to be written (`edof_spec::design::memory::address`).
    output wire        write_ready_o,    // It can be, in this cycle.
    input  wire [24:0] write_address_i,  // Where.
    input  wire [31:0] write_data_i,     // What.
    input  wire [5:0]  status_address_i, // Stage and counter to show.
    output wire [31:0] status_o          // The counter, 0 from all other stages.
);

    localparam [3:0] ID = 4'd0;
    localparam TWO_ROWS = 1'b1;

    wire leaves;
    wire selected;
    wire blocked;
    wire [19:0] shifts;
    wire pairs_available;
    wire [8:0] pairs_count;
    wire pairs_front_set;
    wire [24:0] pairs_even_pair;
    wire [24:0] pairs_odd_pair;
    wire sequencer_shift_set;
    wire [7:0] sequencer_read_pair;
    wire [7:0] sequencer_read_pixel_unused;
    wire sequencer_pass_issued;
    wire sequencer_finished;
    wire sequencer_busy;
    wire sequencer_first;
    wire [11:0] sequencer_address_a;
    wire [24:0] sequencer_value_a;
    wire [11:0] sequencer_address_b;
    wire [24:0] sequencer_value_b;
    wire [47:0] macc_drain_even;
    wire [47:0] macc_drain_odd;
    wire macc_write_enable;
    wire drain_may_start;
    wire drain_copy;
    wire drain_take;
    wire [7:0] drain_beat;
    wire drain_last;
    wire drain_taken_set;
    wire results_write_thresholds;
    wire results_push;
    wire [31:0] results_data;
    wire [31:0] results_base;
    wire results_done_last;
    wire results_done_set;
    wire [1:0] results_nonzero;
    wire [1:0] results_result_saturated;
    wire [1:0] results_code_saturated;
    wire [1:0] results_difference_saturated;
    wire registers_write_enable;
    wire [19:0] registers_shifts_0;
    wire [19:0] registers_shifts_1;
    wire registers_skip_zeros;
    wire [31:0] counters_value;

    pair_buffer #(
        .SLOT_ROWS(12'd32),
        .DEPTH(64)
    ) pairs (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .skip_zeros_i(registers_skip_zeros),
        .valid_i(valid_i),
        .ready_o(ready_o),
        .even_i(data_i[15:0]),
        .odd_i(data_i[31:16]),
        .last_i(last_i),
        .set_i(set_i),
        .available_o(pairs_available),
        .count_o(pairs_count),
        .front_set_o(pairs_front_set),
        .read_pair_i(sequencer_read_pair),
        .even_pair_o(pairs_even_pair),
        .odd_pair_o(pairs_odd_pair),
        .finished_i(sequencer_finished)
    );

    sequencer #(
        .TWO_ROWS(1'b1),
        .LINEAR_STEPS(10'd0),
        .CODES(12'd64),
        .PASS_ROWS(12'd64),
        .SET_ROWS(12'd64),
        .LAST_PASS(6'd0)
    ) sequencer (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .available_i(pairs_available),
        .count_i(pairs_count),
        .set_i(pairs_front_set),
        .may_start_i(drain_may_start),
        .code_shift_i(shifts[15:12]),
        .linear_shift_i(shifts[19:16]),
        .shift_set_o(sequencer_shift_set),
        .read_pair_o(sequencer_read_pair),
        .even_pair_i(pairs_even_pair),
        .odd_pair_i(pairs_odd_pair),
        .read_pixel_o(sequencer_read_pixel_unused),
        .pixels_i(32'd0),
        .pass_issued_o(sequencer_pass_issued),
        .finished_o(sequencer_finished),
        .busy_o(sequencer_busy),
        .first_o(sequencer_first),
        .address_a_o(sequencer_address_a),
        .value_a_o(sequencer_value_a),
        .address_b_o(sequencer_address_b),
        .value_b_o(sequencer_value_b)
    );

    macc_array #(
        .BANKS(4),
        .DEPTH(128),
        .ROWS(2),
        .INIT("mem/stage0_bank")
    ) macc (
        .clock_i(clock_i),
        .first_i(sequencer_first),
        .address_a_i(sequencer_address_a),
        .value_a_i(sequencer_value_a),
        .address_b_i(sequencer_address_b),
        .value_b_i(sequencer_value_b),
        .copy_i(drain_copy),
        .shift_i(drain_take),
        .drain_even_o(macc_drain_even),
        .drain_odd_o(macc_drain_odd),
        .write_enable_i(macc_write_enable),
        .write_bank_i(write_address_i[18:13]),
        .write_half_i(write_address_i[0]),
        .write_row_i(write_address_i[12:1]),
        .write_data_i(write_data_i)
    );

    drain #(
        .LAST_TAKE(8'd7),
        .LAST_BEAT(8'd7)
    ) drain (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .pass_issued_i(sequencer_pass_issued),
        .set_i(pairs_front_set),
        .returned_i(leaves),
        .may_start_o(drain_may_start),
        .copy_o(drain_copy),
        .take_o(drain_take),
        .beat_o(drain_beat),
        .last_o(drain_last),
        .taken_set_o(drain_taken_set)
    );

    results_i results (
        .clock_i(clock_i),
        .take_i(drain_take),
        .beat_i(drain_beat),
        .last_i(drain_last),
        .set_i(drain_taken_set),
        .sum_even_i(macc_drain_even),
        .sum_odd_i(macc_drain_odd),
        .shifts_0_i(registers_shifts_0),
        .shifts_1_i(registers_shifts_1),
        .write_thresholds_i(results_write_thresholds),
        .write_row_i(write_address_i[12:1]),
        .write_data_i(write_data_i),
        .push_o(results_push),
        .data_o(results_data),
        .base_o(results_base),
        .done_last_o(results_done_last),
        .done_set_o(results_done_set),
        .nonzero_o(results_nonzero),
        .result_saturated_o(results_result_saturated),
        .code_saturated_o(results_code_saturated),
        .difference_saturated_o(results_difference_saturated)
    );

    edof_fifo #(
        .BASE(1)
    ) fifo (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .push_i(results_push),
        .data_i(results_data),
        .base_i(results_base),
        .last_i(results_done_last),
        .set_i(results_done_set),
        .valid_o(out_valid_o),
        .ready_i(out_ready_i),
        .data_o(out_data_o),
        .base_o(out_base_o),
        .last_o(out_last_o),
        .set_o(out_set_o)
    );

    registers #(
        .START_0(20'd12),
        .START_1(20'd12)
    ) registers (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .write_enable_i(registers_write_enable),
        .write_row_i(write_address_i[12:1]),
        .write_data_i(write_data_i),
        .shifts_0_o(registers_shifts_0),
        .shifts_1_o(registers_shifts_1),
        .skip_zeros_o(registers_skip_zeros)
    );

    counters counters (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .enable_i(results_push),
        .nonzero_i(results_nonzero),
        .results_i(results_result_saturated),
        .codes_i(results_code_saturated),
        .differences_i(results_difference_saturated),
        .select_i(status_address_i[1:0]),
        .value_o(counters_value)
    );

    assign window_ready_o = 1'b1;
    assign shifts = sequencer_shift_set ? registers_shifts_1 : registers_shifts_0;
    assign leaves = out_valid_o && out_ready_i;
    assign selected = write_valid_i && (write_address_i[24:21] == ID);
    assign blocked = TWO_ROWS && sequencer_busy && (write_address_i[20:19] == 2'd0);
    assign write_ready_o = !(selected && blocked);
    assign macc_write_enable = selected && !blocked && (write_address_i[20:19] == 2'd0);
    assign results_write_thresholds = selected && (write_address_i[20:19] == 2'd1);
    assign registers_write_enable = selected && (write_address_i[20:19] == 2'd3);
    assign status_o = (status_address_i[5:2] == ID) ? counters_value : 32'd0;

    // Not every bit of these is read.
    wire unused = ^shifts;
endmodule

`default_nettype wire
