// One stage of the calculator, I, M or F: vectors in, vectors out, two elements a beat; docs/calculator.md has its cycles.
// Pairs are multiplied as they come out of the pair buffer; sums are copied, drained, rounded, shrunk and sent on.
//
// From crates/edof-hdl/src/blocks/stage.rs (Stage).
`default_nettype none

module stage_2 (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        valid_i,
    output wire        ready_o,
    input  wire [31:0] data_i,
    input  wire [31:0] base_i,
    input  wire        last_i,
    input  wire        set_i,
    input  wire        window_valid_i,
    output wire        window_ready_o,
    input  wire [31:0] window_data_i,
    input  wire        window_last_i,
    output wire        out_valid_o,
    input  wire        out_ready_i,
    output wire [31:0] out_data_o,
    output wire [31:0] out_base_o,
    output wire        out_last_o,
    output wire        out_set_o,
    input  wire        write_valid_i,
    output wire        write_ready_o,
    input  wire [24:0] write_address_i,
    input  wire [31:0] write_data_i,
    input  wire [5:0]  status_address_i,
    output reg  [31:0] status_o
);

    localparam [3:0] ID = 4'h1;
    localparam TWO_ROWS = 1'h0;

    wire accept;
    wire leaves;
    wire selected;
    wire blocked;
    reg  [19:0] shifts;
    wire [15:0] pairs_even;
    wire [15:0] pairs_odd;
    wire pairs_available;
    wire [8:0] pairs_count;
    wire pairs_front_set;
    wire [24:0] pairs_even_pair;
    wire [24:0] pairs_odd_pair;
    wire [3:0] sequencer_code_shift;
    wire [3:0] sequencer_linear_shift;
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
    wire [5:0] macc_write_bank;
    wire macc_write_half;
    wire [11:0] macc_write_row;
    wire drain_may_start;
    wire drain_copy;
    wire drain_take;
    wire [7:0] drain_beat;
    wire drain_last;
    wire drain_taken_set;
    wire results_write_thresholds;
    wire results_write_previous;
    wire [11:0] results_write_row;
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
    wire [11:0] registers_write_row;
    wire [19:0] registers_shifts_0;
    wire [19:0] registers_shifts_1;
    wire registers_skip_zeros;
    wire [1:0] counters_select;
    wire [31:0] counters_value;

    pair_buffer_2 pairs (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .skip_zeros_i(registers_skip_zeros),
        .valid_i(valid_i),
        .ready_o(ready_o),
        .even_i(pairs_even),
        .odd_i(pairs_odd),
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

    sequencer_2 sequencer (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .available_i(pairs_available),
        .count_i(pairs_count),
        .set_i(pairs_front_set),
        .may_start_i(drain_may_start),
        .code_shift_i(sequencer_code_shift),
        .linear_shift_i(sequencer_linear_shift),
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

    macc_array_2 macc (
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
        .write_bank_i(macc_write_bank),
        .write_half_i(macc_write_half),
        .write_row_i(macc_write_row),
        .write_data_i(write_data_i)
    );

    drain_2 drain (
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

    results_2 results (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .take_i(drain_take),
        .beat_i(drain_beat),
        .last_i(drain_last),
        .set_i(drain_taken_set),
        .sum_even_i(macc_drain_even),
        .sum_odd_i(macc_drain_odd),
        .shifts_0_i(registers_shifts_0),
        .shifts_1_i(registers_shifts_1),
        .base_write_i(accept),
        .base_words_i(base_i),
        .write_thresholds_i(results_write_thresholds),
        .write_previous_i(results_write_previous),
        .write_row_i(results_write_row),
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

    registers_2 registers (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .write_enable_i(registers_write_enable),
        .write_row_i(registers_write_row),
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
        .select_i(counters_select),
        .value_o(counters_value)
    );

    assign pairs_even = data_i[15:0];
    assign pairs_odd = data_i[31:16];
    assign accept = valid_i && ready_o;
    assign window_ready_o = 1'b1;

    always @* begin
        shifts = registers_shifts_0;
        if (sequencer_shift_set) begin
            shifts = registers_shifts_1;
        end
    end

    assign sequencer_code_shift = shifts[15:12];
    assign sequencer_linear_shift = shifts[19:16];
    assign leaves = out_valid_o && out_ready_i;
    assign selected = write_valid_i && (write_address_i[24:21] == ID);
    assign blocked = (TWO_ROWS && sequencer_busy) && (write_address_i[20:19] == 2'd0);
    assign write_ready_o = !(selected && blocked);
    assign macc_write_enable = (selected && (!blocked)) && (write_address_i[20:19] == 2'd0);
    assign macc_write_bank = write_address_i[18:13];
    assign macc_write_half = write_address_i[0];
    assign macc_write_row = write_address_i[12:1];
    assign results_write_thresholds = selected && (write_address_i[20:19] == 2'd1);
    assign results_write_previous = selected && (write_address_i[20:19] == 2'd2);
    assign results_write_row = write_address_i[12:1];
    assign registers_write_enable = selected && (write_address_i[20:19] == 2'd3);
    assign registers_write_row = write_address_i[12:1];
    assign counters_select = status_address_i[1:0];

    always @* begin
        status_o = 32'd0;
        if (status_address_i[5:2] == ID) begin
            status_o = counters_value;
        end
    end
endmodule

`default_nettype wire
