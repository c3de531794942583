// One stage of the calculator, I, M or F: vectors in, vectors out, two elements a beat; docs/calculator.md has its cycles.
// Values are multiplied as they come out of the store; sums are copied, drained, rounded, shrunk and sent on.
//
// From crates/edof-hdl/src/blocks/stage.rs (Stage).
`default_nettype none

module stage_m #(
    parameter [3:0] ID = 4'd1,
    parameter MACC_INIT = "stage1_bank",
    parameter BASE_FIFO_DEPTH = 128,
    parameter RESULTS_INIT = "stage1_thresholds.mem",
    parameter REGISTERS_INIT = "stage1_shifts.mem"
) (
    input  wire        clock_i,          // Clock.
    input  wire        reset_i,          // Forgets every vector and what was written to registers; held for 48 cycles or more, and two more pass until something can be taken.
    input  wire        flush_i,          // Forgets every vector and nothing else; held likewise.
    input  wire        valid_i,          // A beat stands on the input.
    output wire        ready_o,          // It is taken in this cycle, if there is one.
    input  wire [31:0] data_i,           // Its two words.
    input  wire [31:0] base_i,           // Their base words (M).
    input  wire        last_i,           // Whether it is its vector's last.
    input  wire        set_i,            // The vector's set.
    output wire        window_ready_o,   // They are taken in this cycle, if there are any.
    output wire        out_valid_o,      // A beat stands on the output.
    input  wire        out_ready_i,      // The receiver takes it.
    output wire [31:0] out_data_o,       // Its two words.
    output wire [31:0] out_base_o,       // Their base words.
    output wire        out_last_o,       // Whether it is its vector's last.
    output wire        out_set_o,        // The vector's set.
    input  wire        write_valid_i,    // A word is to be written (`edof_device::design::memory::address`).
    input  wire [24:0] write_address_i,  // Where.
    input  wire [31:0] write_data_i,     // What.
    input  wire [6:0]  status_address_i, // What to show: bit 6 counters or what was read back, then stage (4 bits), then which (2 bits).
    output wire [31:0] status_o          // It, a cycle later; 0 from all other stages.
);

    localparam [3:0] WHOLE_CHAIN = 4'd15;
    localparam BOTH_PORTS = 1'b0;
    localparam [11:0] READ_REGISTER = 12'd3;
    localparam [19:0] SKIP_BIT = 20'd1;

    wire [6:0] resets;
    wire [10:0] marks;
    wire [33:0] finished_word;
    wire selected, reads;
    wire [52:0] weights_word, weights_marks;
    wire [31:0] asked;
    wire [6:0] reset_parts_later;
    wire reset_registers_later, pairs_arrived;
    wire [11:0] pairs_descriptor;
    wire [24:0] pairs_even_pair, pairs_odd_pair;
    wire pair_operands_step_first;
    wire [11:0] pair_operands_address_a, pair_operands_address_b;
    wire [24:0] pair_operands_value_a, pair_operands_value_b;
    wire sequencer_begins, sequencer_valid_a, sequencer_valid_b, sequencer_first, sequencer_linear;
    wire sequencer_odd, sequencer_set;
    wire [8:0] sequencer_read_row;
    wire [6:0] sequencer_read_pixels_unused;
    wire [11:0] sequencer_base, sequencer_offset;
    wire sequencer_pass_issued, sequencer_finished;
    wire [47:0] macc_sum_even, macc_sum_odd;
    wire [63:0] macc_read_data;
    wire drain_may_start, drain_copy, drain_take;
    wire [7:0] drain_beat;
    wire drain_last, drain_taken_set;
    wire [10:0] marks_to_groups_later;
    wire results_read_valid;
    wire [31:0] results_read_thresholds, results_read_previous;
    wire results_push;
    wire [31:0] results_data;
    wire [1:0] results_done;
    wire results_base_push;
    wire [31:0] results_base;
    wire [1:0] results_nonzero, results_result_saturated, results_code_saturated;
    wire [1:0] results_difference_saturated;
    wire [33:0] fifo_front_data;
    wire base_fifo_front_valid_unused, base_fifo_front_ready;
    wire [19:0] registers_shifts_0, registers_shifts_1;
    wire registers_skip_zeros;
    wire [31:0] counters_value;
    wire reader_starts, reader_wants_weights;
    wire [5:0] reader_bank;
    wire [11:0] reader_row;
    wire reader_wants_thresholds;
    reg  [19:0] reader_register;
    wire [31:0] reader_value;
    reg  [31:0] status_q;
    reg  write_1_q;
    reg  [24:0] address_1_q;
    reg  [31:0] data_1_q;
    reg  weights_2_q, thresholds_2_q, previous_2_q, registers_2_q;
    reg  [18:0] address_2_q, address_2_d;
    reg  [31:0] data_2_q;
    reg  snapshot_2_q, read_2_q, steal_2_q;
    wire [52:0] weights_to_5_now, weights_to_5_later;

    edof_delay #(.WIDTH(7), .CYCLES(1)) reset_parts (
        .clock_i(clock_i), .now_i(resets), .later_o(reset_parts_later)
    );
    edof_delay #(.WIDTH(1), .CYCLES(1)) reset_registers (
        .clock_i(clock_i), .now_i(reset_i), .later_o(reset_registers_later)
    );

    pair_store #(.TWO_ROWS(1'b0)) pairs (
        .clock_i(clock_i),
        .reset_i(reset_parts_later[0]),
        .skip_zeros_i(registers_skip_zeros),
        .valid_i(valid_i),
        .ready_o(ready_o),
        .even_i(data_i[15:0]),
        .odd_i(data_i[31:16]),
        .last_i(last_i),
        .set_i(set_i),
        .arrived_o(pairs_arrived),
        .descriptor_o(pairs_descriptor),
        .read_row_i(sequencer_read_row),
        .even_pair_o(pairs_even_pair),
        .odd_pair_o(pairs_odd_pair),
        .finished_i(sequencer_finished)
    );

    pair_operands #(.ALIGNS(1'b0), .TWO_ROWS(1'b0)) pair_operands (
        .clock_i(clock_i),
        .valid_a_i(sequencer_valid_a),
        .valid_b_i(sequencer_valid_b),
        .first_i(sequencer_first),
        .linear_i(sequencer_linear),
        .odd_i(sequencer_odd),
        .set_i(sequencer_set),
        .base_i(sequencer_base),
        .offset_i(sequencer_offset),
        .even_pair_i(pairs_even_pair),
        .odd_pair_i(pairs_odd_pair),
        .pixels_i(32'd0),
        .shifts_0_i(registers_shifts_0[19:12]),
        .shifts_1_i(registers_shifts_1[19:12]),
        .step_first_o(pair_operands_step_first),
        .address_a_o(pair_operands_address_a),
        .address_b_o(pair_operands_address_b),
        .value_a_o(pair_operands_value_a),
        .value_b_o(pair_operands_value_b)
    );

    sequencer #(
        .TWO_ROWS(1'b0),
        .HAS_LINEAR(1'b0),
        .LINEAR_BEFORE_LAST(8'd0),
        .CODES(12'd16),
        .PASS_ROWS(12'd16),
        .SET_ROWS(12'd32),
        .LAST_PASS(6'd1)
    ) sequencer (
        .clock_i(clock_i),
        .reset_i(reset_parts_later[2]),
        .arrived_i(pairs_arrived),
        .descriptor_i(pairs_descriptor),
        .may_start_i(drain_may_start),
        .steal_i(steal_2_q),
        .begins_o(sequencer_begins),
        .valid_a_o(sequencer_valid_a),
        .valid_b_o(sequencer_valid_b),
        .first_o(sequencer_first),
        .linear_o(sequencer_linear),
        .odd_o(sequencer_odd),
        .set_o(sequencer_set),
        .read_row_o(sequencer_read_row),
        .read_pixels_o(sequencer_read_pixels_unused),
        .base_o(sequencer_base),
        .offset_o(sequencer_offset),
        .pass_issued_o(sequencer_pass_issued),
        .finished_o(sequencer_finished)
    );

    edof_macc_array #(
        .BANKS(2),
        .DEPTH(64),
        .ROWS(1),
        .DENSE(0),
        .SUM(48),
        .INIT(MACC_INIT)
    ) macc (
        .clock_i(clock_i),
        .first_i(pair_operands_step_first),
        .address_a_i(pair_operands_address_a),
        .address_b_i(pair_operands_address_b),
        .value_a_i(pair_operands_value_a),
        .value_b_i(pair_operands_value_b),
        .value_c_i(25'd0),
        .value_d_i(25'd0),
        .copy_i(drain_copy),
        .shift_i(drain_take),
        .sum_even_o(macc_sum_even),
        .sum_odd_o(macc_sum_odd),
        .write_enable_i(weights_to_5_later[0] && !reset_i),
        .write_bank_i(weights_to_5_later[52:47]),
        .write_half_i(weights_to_5_later[34]),
        .write_row_i(weights_to_5_later[46:35]),
        .write_data_i(weights_to_5_later[33:2]),
        .read_enable_i(weights_to_5_later[1]),
        .read_data_o(macc_read_data)
    );

    drain #(
        .BEFORE_LAST_TAKE(8'd3),
        .RELEASE_AT(8'd3),
        .LAST_BEAT(8'd7),
        .WANTED_CREDITS(8'd4)
    ) drain (
        .clock_i(clock_i),
        .reset_i(reset_parts_later[3]),
        .begins_i(sequencer_begins),
        .pass_issued_i(sequencer_pass_issued),
        .set_i(sequencer_set),
        .returned_i(out_valid_o && out_ready_i),
        .may_start_o(drain_may_start),
        .copy_o(drain_copy),
        .take_o(drain_take),
        .beat_o(drain_beat),
        .last_o(drain_last),
        .taken_set_o(drain_taken_set)
    );

    edof_delay #(.WIDTH(11), .CYCLES(1)) marks_to_groups (
        .clock_i(clock_i), .now_i(marks), .later_o(marks_to_groups_later)
    );

    results_m #(.INIT(RESULTS_INIT)) results (
        .clock_i(clock_i),
        .reset_i(reset_parts_later[4]),
        .take_i(marks_to_groups_later[0]),
        .beat_i(marks_to_groups_later[10:3]),
        .last_i(marks_to_groups_later[1]),
        .set_i(marks_to_groups_later[2]),
        .sum_even_i(macc_sum_even),
        .sum_odd_i(macc_sum_odd),
        .shifts_0_i(registers_shifts_0),
        .shifts_1_i(registers_shifts_1),
        .base_write_i(valid_i && ready_o),
        .base_words_i(base_i),
        .write_thresholds_i(thresholds_2_q && !reset_i),
        .write_row_i(address_2_q[12:1]),
        .write_data_i(data_2_q),
        .read_wanted_i(reader_wants_thresholds),
        .read_row_i(reader_row),
        .read_valid_o(results_read_valid),
        .read_thresholds_o(results_read_thresholds),
        .read_previous_o(results_read_previous),
        .push_o(results_push),
        .data_o(results_data),
        .done_o(results_done),
        .base_push_o(results_base_push),
        .base_o(results_base),
        .nonzero_o(results_nonzero),
        .result_saturated_o(results_result_saturated),
        .code_saturated_o(results_code_saturated),
        .difference_saturated_o(results_difference_saturated)
    );

    edof_fifo #(.WIDTH(34), .DEPTH(128)) fifo (
        .clock_i(clock_i),
        .reset_i(reset_parts_later[5]),
        .push_i(results_push),
        .data_i(finished_word),
        .valid_o(out_valid_o),
        .ready_i(out_ready_i),
        .data_o(fifo_front_data)
    );

    edof_fifo #(.WIDTH(32), .DEPTH(BASE_FIFO_DEPTH)) base_fifo (
        .clock_i(clock_i),
        .reset_i(reset_parts_later[5]),
        .push_i(results_base_push),
        .data_i(results_base),
        .valid_o(base_fifo_front_valid_unused),
        .ready_i(base_fifo_front_ready),
        .data_o(out_base_o)
    );

    registers #(.INIT(REGISTERS_INIT)) registers (
        .clock_i(clock_i),
        .reset_i(reset_registers_later),
        .write_enable_i(registers_2_q),
        .write_row_i(address_2_q[12:1]),
        .write_data_i(data_2_q),
        .shifts_0_o(registers_shifts_0),
        .shifts_1_o(registers_shifts_1),
        .skip_zeros_o(registers_skip_zeros)
    );

    counters counters (
        .clock_i(clock_i),
        .reset_i(reset_registers_later),
        .enable_i(results_push),
        .nonzero_i(results_nonzero),
        .results_i(results_result_saturated),
        .codes_i(results_code_saturated),
        .differences_i(results_difference_saturated),
        .snapshot_i(snapshot_2_q),
        .select_i(status_address_i[1:0]),
        .value_o(counters_value)
    );

    reader reader (
        .clock_i(clock_i),
        .reset_i(reset_parts_later[6]),
        .starts_i(reader_starts),
        .command_i(data_2_q),
        .wants_weights_o(reader_wants_weights),
        .taken_i(reads),
        .bank_o(reader_bank),
        .row_o(reader_row),
        .weights_i(macc_read_data),
        .wants_thresholds_o(reader_wants_thresholds),
        .thresholds_valid_i(results_read_valid),
        .thresholds_i(results_read_thresholds),
        .previous_i(results_read_previous),
        .register_i(reader_register),
        .select_i(status_address_i[1:0]),
        .value_o(reader_value)
    );

    edof_delay #(.WIDTH(53), .CYCLES(3)) weights_to_5 (
        .clock_i(clock_i), .now_i(weights_to_5_now), .later_o(weights_to_5_later)
    );

    assign resets = (reset_i || flush_i) ? 7'h7f : 7'd0;
    assign window_ready_o = 1'b1;
    assign marks = {drain_beat, drain_taken_set, drain_last, drain_take};
    assign finished_word = {results_data, results_done};
    assign out_data_o = fifo_front_data[33:2];
    assign out_last_o = fifo_front_data[0];
    assign out_set_o = fifo_front_data[1];
    assign base_fifo_front_ready = out_valid_o && out_ready_i;
    assign selected = write_1_q && (address_1_q[24:21] == ID);

    always @* begin
        address_2_d = address_1_q[18:0];
        if (reads) begin
            address_2_d = {reader_bank, reader_row, 1'b0};
        end
    end

    assign reads = reader_wants_weights && !write_1_q;
    assign weights_word = {address_2_q, data_2_q, 2'd0};
    assign weights_marks = weights_2_q ? 53'd1 : (read_2_q ? 53'd2 : 53'd0);
    assign weights_to_5_now = weights_word | weights_marks;
    assign reader_starts = registers_2_q && (address_2_q[12:1] == READ_REGISTER);

    always @* begin
        reader_register = registers_shifts_0;
        if (reader_row[1]) begin
            reader_register = 20'd0;
            if (registers_skip_zeros) begin
                reader_register = SKIP_BIT;
            end
        end else if (reader_row[0]) begin
            reader_register = registers_shifts_1;
        end
    end

    assign asked = status_address_i[6] ? reader_value : counters_value;
    assign status_o = status_q;

    always @(posedge clock_i) begin
        status_q <= (status_address_i[5:2] == ID) ? asked : 32'd0;
        write_1_q <= write_valid_i;
        address_1_q <= write_address_i;
        data_1_q <= write_data_i;
        weights_2_q <= selected && (address_1_q[20:19] == 2'd0);
        thresholds_2_q <= selected && (address_1_q[20:19] == 2'd1);
        previous_2_q <= selected && (address_1_q[20:19] == 2'd2);
        registers_2_q <= selected && (address_1_q[20:19] == 2'd3);
        address_2_q <= address_2_d;
        data_2_q <= data_1_q;
        snapshot_2_q <= write_1_q && (address_1_q[24:21] == WHOLE_CHAIN) && (address_1_q[20:19] == 2'd3);
        read_2_q <= reads;
        steal_2_q <= reads || (BOTH_PORTS && selected && (address_1_q[20:19] == 2'd0));
    end

    // Not every bit of these is read.
    wire unused = ^{reset_parts_later, previous_2_q};
endmodule

`default_nettype wire
