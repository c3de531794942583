// One stage of the calculator, I, M or F: vectors in, vectors out, two elements a beat; docs/calculator.md has its cycles.
// Values are multiplied as they come out of the store; sums are copied, drained, rounded, shrunk and sent on.
//
// From crates/edof-hdl/src/blocks/stage.rs (Stage).
`default_nettype none

module stage_4 (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        valid_i,
    output wire        ready_o,
    input  wire [31:0] data_i,
    input  wire [31:0] base_i,
    input  wire        last_i,
    input  wire        set_i,
    input  wire        window_valid_i,
    output reg         window_ready_o,
    input  wire [31:0] window_data_i,
    input  wire        window_last_i,
    output wire        out_valid_o,
    input  wire        out_ready_i,
    output wire [31:0] out_data_o,
    output wire [31:0] out_base_o,
    output wire        out_last_o,
    output wire        out_set_o,
    input  wire        write_valid_i,
    input  wire [24:0] write_address_i,
    input  wire [31:0] write_data_i,
    input  wire [5:0]  status_address_i,
    output wire [31:0] status_o
);

    localparam [3:0] ID = 4'h3;
    localparam BOTH_PORTS = 1'h1;

    reg  resets;
    reg  ready_in;
    reg  arrived;
    reg  [11:0] descriptor;
    reg  first;
    reg  [11:0] address_a;
    reg  [11:0] address_b;
    reg  [24:0] value_a;
    reg  [24:0] value_b;
    wire [24:0] value_c;
    wire [24:0] value_d;
    reg  [33:0] finished_word;
    wire selected;
    reg  [51:0] weights_word;
    wire reset_store_later;
    wire reset_ring_later;
    wire reset_sequencer_later;
    wire reset_drain_later;
    wire reset_results_later;
    wire reset_out_later;
    wire reset_registers_later;
    wire pairs_0_reset;
    wire pairs_0_ready;
    wire [15:0] pairs_0_even;
    wire [15:0] pairs_0_odd;
    wire pairs_0_arrived;
    wire [11:0] pairs_0_descriptor;
    wire [24:0] pairs_0_even_pair;
    wire [24:0] pairs_0_odd_pair;
    reg  [31:0] pair_operands_0_pixels;
    wire [7:0] pair_operands_0_shifts_0;
    wire [7:0] pair_operands_0_shifts_1;
    wire pair_operands_0_step_first;
    wire [11:0] pair_operands_0_address_a;
    wire [11:0] pair_operands_0_address_b;
    wire [24:0] pair_operands_0_value_a;
    wire [24:0] pair_operands_0_value_b;
    wire ring_0_reset;
    wire ring_0_ready;
    wire [31:0] ring_0_read_pixels;
    wire sequencer_reset;
    wire sequencer_steal;
    wire sequencer_begins;
    wire sequencer_valid_a;
    wire sequencer_valid_b;
    wire sequencer_first;
    wire sequencer_linear;
    wire sequencer_odd;
    wire sequencer_set;
    wire [8:0] sequencer_read_row;
    wire [6:0] sequencer_read_pixels;
    wire [11:0] sequencer_base;
    wire [11:0] sequencer_offset;
    wire sequencer_pass_issued;
    wire sequencer_finished;
    wire [47:0] macc_sum_even;
    wire [47:0] macc_sum_odd;
    wire macc_write_enable;
    wire [5:0] macc_write_bank;
    wire macc_write_half;
    wire [11:0] macc_write_row;
    wire [31:0] macc_write_data;
    wire drain_reset;
    wire drain_returned;
    wire drain_may_start;
    wire drain_copy;
    wire drain_take;
    wire [7:0] drain_beat;
    wire drain_last;
    wire drain_taken_set;
    wire results_reset;
    wire results_base_write;
    wire results_write_thresholds;
    wire results_write_previous;
    wire [11:0] results_write_row;
    wire results_push;
    wire [31:0] results_data;
    wire [31:0] results_base_unused;
    wire results_done_last;
    wire results_done_set;
    wire [1:0] results_nonzero;
    wire [1:0] results_result_saturated;
    wire [1:0] results_code_saturated;
    wire [1:0] results_difference_saturated;
    wire fifo_reset;
    wire [33:0] fifo_front_data;
    wire registers_reset;
    wire [11:0] registers_write_row;
    wire [19:0] registers_shifts_0;
    wire [19:0] registers_shifts_1;
    wire registers_skip_zeros;
    wire counters_reset;
    wire [1:0] counters_select;
    wire [31:0] counters_value;
    reg  [31:0] status_q_q;
    reg  [31:0] status_q_d;
    reg  write_1_q;
    reg  [24:0] address_1_q;
    reg  [31:0] data_1_q;
    reg  weights_2_q;
    wire weights_2_d;
    reg  thresholds_2_q;
    wire thresholds_2_d;
    reg  previous_2_q;
    wire previous_2_d;
    reg  registers_2_q;
    wire registers_2_d;
    reg  [18:0] address_2_q;
    wire [18:0] address_2_d;
    reg  [31:0] data_2_q;
    wire [51:0] weights_to_6_later;

    edof_delay #(
        .WIDTH(1),
        .CYCLES(1)
    ) reset_store (
        .clock_i(clock_i),
        .now_i(resets),
        .later_o(reset_store_later)
    );

    edof_delay #(
        .WIDTH(1),
        .CYCLES(1)
    ) reset_ring (
        .clock_i(clock_i),
        .now_i(resets),
        .later_o(reset_ring_later)
    );

    edof_delay #(
        .WIDTH(1),
        .CYCLES(1)
    ) reset_sequencer (
        .clock_i(clock_i),
        .now_i(resets),
        .later_o(reset_sequencer_later)
    );

    edof_delay #(
        .WIDTH(1),
        .CYCLES(1)
    ) reset_drain (
        .clock_i(clock_i),
        .now_i(resets),
        .later_o(reset_drain_later)
    );

    edof_delay #(
        .WIDTH(1),
        .CYCLES(1)
    ) reset_results (
        .clock_i(clock_i),
        .now_i(resets),
        .later_o(reset_results_later)
    );

    edof_delay #(
        .WIDTH(1),
        .CYCLES(1)
    ) reset_out (
        .clock_i(clock_i),
        .now_i(resets),
        .later_o(reset_out_later)
    );

    edof_delay #(
        .WIDTH(1),
        .CYCLES(1)
    ) reset_registers (
        .clock_i(clock_i),
        .now_i(resets),
        .later_o(reset_registers_later)
    );

    pair_store_2 pairs_0 (
        .clock_i(clock_i),
        .reset_i(pairs_0_reset),
        .skip_zeros_i(registers_skip_zeros),
        .valid_i(valid_i),
        .ready_o(pairs_0_ready),
        .even_i(pairs_0_even),
        .odd_i(pairs_0_odd),
        .last_i(last_i),
        .set_i(set_i),
        .arrived_o(pairs_0_arrived),
        .descriptor_o(pairs_0_descriptor),
        .read_row_i(sequencer_read_row),
        .even_pair_o(pairs_0_even_pair),
        .odd_pair_o(pairs_0_odd_pair),
        .finished_i(sequencer_finished)
    );

    pair_operands_2 pair_operands_0 (
        .clock_i(clock_i),
        .valid_a_i(sequencer_valid_a),
        .valid_b_i(sequencer_valid_b),
        .first_i(sequencer_first),
        .linear_i(sequencer_linear),
        .odd_i(sequencer_odd),
        .set_i(sequencer_set),
        .base_i(sequencer_base),
        .offset_i(sequencer_offset),
        .even_pair_i(pairs_0_even_pair),
        .odd_pair_i(pairs_0_odd_pair),
        .pixels_i(pair_operands_0_pixels),
        .shifts_0_i(pair_operands_0_shifts_0),
        .shifts_1_i(pair_operands_0_shifts_1),
        .step_first_o(pair_operands_0_step_first),
        .address_a_o(pair_operands_0_address_a),
        .address_b_o(pair_operands_0_address_b),
        .value_a_o(pair_operands_0_value_a),
        .value_b_o(pair_operands_0_value_b)
    );

    window_ring ring_0 (
        .clock_i(clock_i),
        .reset_i(ring_0_reset),
        .valid_i(window_valid_i),
        .ready_o(ring_0_ready),
        .pixels_i(window_data_i),
        .last_i(window_last_i),
        .read_pair_i(sequencer_read_pixels),
        .read_pixels_o(ring_0_read_pixels),
        .finished_i(sequencer_finished)
    );

    sequencer_3 sequencer (
        .clock_i(clock_i),
        .reset_i(sequencer_reset),
        .arrived_i(arrived),
        .descriptor_i(descriptor),
        .may_start_i(drain_may_start),
        .steal_i(sequencer_steal),
        .begins_o(sequencer_begins),
        .valid_a_o(sequencer_valid_a),
        .valid_b_o(sequencer_valid_b),
        .first_o(sequencer_first),
        .linear_o(sequencer_linear),
        .odd_o(sequencer_odd),
        .set_o(sequencer_set),
        .read_row_o(sequencer_read_row),
        .read_pixels_o(sequencer_read_pixels),
        .base_o(sequencer_base),
        .offset_o(sequencer_offset),
        .pass_issued_o(sequencer_pass_issued),
        .finished_o(sequencer_finished)
    );

    edof_macc_array #(
        .BANKS(8),
        .DEPTH(640),
        .ROWS(2),
        .DENSE(0),
        .SUM(48),
        .INIT("mem/stage3_bank")
    ) macc (
        .clock_i(clock_i),
        .first_i(first),
        .address_a_i(address_a),
        .address_b_i(address_b),
        .value_a_i(value_a),
        .value_b_i(value_b),
        .value_c_i(value_c),
        .value_d_i(value_d),
        .copy_i(drain_copy),
        .shift_i(drain_take),
        .sum_even_o(macc_sum_even),
        .sum_odd_o(macc_sum_odd),
        .write_enable_i(macc_write_enable),
        .write_bank_i(macc_write_bank),
        .write_half_i(macc_write_half),
        .write_row_i(macc_write_row),
        .write_data_i(macc_write_data)
    );

    drain_3 drain (
        .clock_i(clock_i),
        .reset_i(drain_reset),
        .begins_i(sequencer_begins),
        .pass_issued_i(sequencer_pass_issued),
        .set_i(sequencer_set),
        .returned_i(drain_returned),
        .may_start_o(drain_may_start),
        .copy_o(drain_copy),
        .take_o(drain_take),
        .beat_o(drain_beat),
        .last_o(drain_last),
        .taken_set_o(drain_taken_set)
    );

    results_4 results (
        .clock_i(clock_i),
        .reset_i(results_reset),
        .take_i(drain_take),
        .beat_i(drain_beat),
        .last_i(drain_last),
        .set_i(drain_taken_set),
        .sum_even_i(macc_sum_even),
        .sum_odd_i(macc_sum_odd),
        .shifts_0_i(registers_shifts_0),
        .shifts_1_i(registers_shifts_1),
        .base_write_i(results_base_write),
        .base_words_i(base_i),
        .write_thresholds_i(results_write_thresholds),
        .write_previous_i(results_write_previous),
        .write_row_i(results_write_row),
        .write_data_i(data_2_q),
        .push_o(results_push),
        .data_o(results_data),
        .base_o(results_base_unused),
        .done_last_o(results_done_last),
        .done_set_o(results_done_set),
        .nonzero_o(results_nonzero),
        .result_saturated_o(results_result_saturated),
        .code_saturated_o(results_code_saturated),
        .difference_saturated_o(results_difference_saturated)
    );

    edof_fifo #(
        .WIDTH(34),
        .DEPTH(128)
    ) fifo (
        .clock_i(clock_i),
        .reset_i(fifo_reset),
        .push_i(results_push),
        .data_i(finished_word),
        .valid_o(out_valid_o),
        .ready_i(out_ready_i),
        .data_o(fifo_front_data)
    );

    registers_4 registers (
        .clock_i(clock_i),
        .reset_i(registers_reset),
        .write_enable_i(registers_2_q),
        .write_row_i(registers_write_row),
        .write_data_i(data_2_q),
        .shifts_0_o(registers_shifts_0),
        .shifts_1_o(registers_shifts_1),
        .skip_zeros_o(registers_skip_zeros)
    );

    counters counters (
        .clock_i(clock_i),
        .reset_i(counters_reset),
        .enable_i(results_push),
        .nonzero_i(results_nonzero),
        .results_i(results_result_saturated),
        .codes_i(results_code_saturated),
        .differences_i(results_difference_saturated),
        .select_i(counters_select),
        .value_o(counters_value)
    );

    edof_delay #(
        .WIDTH(52),
        .CYCLES(4)
    ) weights_to_6 (
        .clock_i(clock_i),
        .now_i(weights_word),
        .later_o(weights_to_6_later)
    );

    always @* begin
        resets = 1'b0;
        if (reset_i) begin
            resets = 1'b1;
        end
    end

    assign sequencer_reset = reset_sequencer_later;
    assign drain_reset = reset_drain_later;
    assign results_reset = reset_results_later;
    assign fifo_reset = reset_out_later;
    assign registers_reset = reset_registers_later;
    assign counters_reset = reset_registers_later;

    always @* begin
        ready_in = 1'b0;
        ready_in = pairs_0_ready;
    end

    always @* begin
        arrived = 1'b0;
        arrived = pairs_0_arrived;
    end

    always @* begin
        descriptor = 12'd0;
        descriptor = pairs_0_descriptor;
    end

    always @* begin
        pair_operands_0_pixels = 32'd0;
        pair_operands_0_pixels = ring_0_read_pixels;
    end

    assign pairs_0_reset = reset_store_later;
    assign pairs_0_even = data_i[15:0];
    assign pairs_0_odd = data_i[31:16];
    assign ready_o = ready_in;
    assign results_base_write = valid_i && ready_in;

    always @* begin
        window_ready_o = 1'b1;
        window_ready_o = ring_0_ready;
    end

    assign ring_0_reset = reset_ring_later;
    assign sequencer_steal = weights_2_q && BOTH_PORTS;

    always @* begin
        first = 1'b0;
        first = pair_operands_0_step_first;
    end

    always @* begin
        address_a = 12'd0;
        address_a = pair_operands_0_address_a;
    end

    always @* begin
        address_b = 12'd0;
        address_b = pair_operands_0_address_b;
    end

    always @* begin
        value_a = 25'd0;
        value_a = pair_operands_0_value_a;
    end

    always @* begin
        value_b = 25'd0;
        value_b = pair_operands_0_value_b;
    end

    assign value_c = 25'd0;
    assign value_d = 25'd0;
    assign pair_operands_0_shifts_0 = registers_shifts_0[19:12];
    assign pair_operands_0_shifts_1 = registers_shifts_1[19:12];

    always @* begin
        finished_word = {2'd0, results_data} << 2;
        if (results_done_last) begin
            finished_word = finished_word | 34'd1;
        end
        if (results_done_set) begin
            finished_word = finished_word | 34'd2;
        end
    end

    assign drain_returned = out_valid_o && out_ready_i;
    assign out_data_o = fifo_front_data[33:2];
    assign out_last_o = fifo_front_data[0];
    assign out_set_o = fifo_front_data[1];
    assign out_base_o = 32'd0;
    assign selected = write_1_q && (address_1_q[24:21] == ID);
    assign weights_2_d = selected && (address_1_q[20:19] == 2'd0);
    assign thresholds_2_d = selected && (address_1_q[20:19] == 2'd1);
    assign previous_2_d = selected && (address_1_q[20:19] == 2'd2);
    assign registers_2_d = selected && (address_1_q[20:19] == 2'd3);
    assign address_2_d = address_1_q[18:0];

    always @* begin
        weights_word = ({33'd0, address_2_q} << 33) | ({20'd0, data_2_q} << 1);
        if (weights_2_q) begin
            weights_word = (({33'd0, address_2_q} << 33) | ({20'd0, data_2_q} << 1)) | 52'd1;
        end
    end

    assign macc_write_enable = weights_to_6_later[0] && (!reset_i);
    assign macc_write_bank = weights_to_6_later[51:46];
    assign macc_write_row = weights_to_6_later[45:34];
    assign macc_write_half = weights_to_6_later[33];
    assign macc_write_data = weights_to_6_later[32:1];
    assign results_write_thresholds = thresholds_2_q && (!reset_i);
    assign results_write_previous = previous_2_q && (!reset_i);
    assign results_write_row = address_2_q[12:1];
    assign registers_write_row = address_2_q[12:1];
    assign counters_select = status_address_i[1:0];

    always @* begin
        status_q_d = 32'd0;
        if (status_address_i[5:2] == ID) begin
            status_q_d = counters_value;
        end
    end

    assign status_o = status_q_q;

    always @(posedge clock_i) begin
        status_q_q <= status_q_d;
        write_1_q <= write_valid_i;
        address_1_q <= write_address_i;
        data_1_q <= write_data_i;
        weights_2_q <= weights_2_d;
        thresholds_2_q <= thresholds_2_d;
        previous_2_q <= previous_2_d;
        registers_2_q <= registers_2_d;
        address_2_q <= address_2_d;
        data_2_q <= data_1_q;
    end
endmodule

`default_nettype wire
