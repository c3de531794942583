// From sums to the words that go on, two elements a cycle. Counted from `take`: 1 sums and base are read, 2 to 6 base, rounding,
// shift and saturation, 7 threshold, 8 difference or wait. Nothing in here ever stalls.
//
// From crates/edof-hdl/src/blocks/results.rs (Results).
`default_nettype none

module results_f (
    input  wire        clock_i,               // Clock.
    input  wire        take_i,                // Two sums are taken in this cycle, and stand on the inputs in the next.
    input  wire [7:0]  beat_i,                // Which two of their vector.
    input  wire        last_i,                // Whether they are its last.
    input  wire        set_i,                 // Its set.
    input  wire [47:0] sum_even_i,            // The even sum, a cycle after `take`.
    input  wire [47:0] sum_odd_i,             // The odd one.
    input  wire [19:0] shifts_0_i,            // Shifts of set 0.
    input  wire [19:0] shifts_1_i,            // Shifts of set 1.
    output wire        push_o,                // A beat is done, eight cycles after `take`.
    output wire [31:0] data_o,                // Its two words.
    output wire [31:0] base_o,                // Their base words for the next stage.
    output wire        done_last_o,           // Whether it is its vector's last.
    output wire        done_set_o,            // Its set.
    output wire [1:0]  nonzero_o,             // Which words are not zero.
    output wire [1:0]  result_saturated_o,    // Which results did not fit.
    output wire [1:0]  code_saturated_o,      // Which thresholded codes did not fit.
    output wire [1:0]  difference_saturated_o // Which differences did not fit.
);

    reg  [2:0] marks;
    wire [19:0] shifts;
    wire [31:0] base_word;
    wire [31:0] result;
    wire [31:0] sent;
    wire [2:0] to_1_later;
    wire [2:0] to_2_later;
    wire [2:0] to_5_later;
    wire [2:0] to_8_later;
    wire [7:0] beat_to_5_later_unused;
    reg  [47:0] sum_even_q;
    reg  [47:0] sum_odd_q;
    wire [15:0] requantize_even_result;
    wire requantize_even_saturated;
    wire [15:0] requantize_odd_result;
    wire requantize_odd_saturated;
    reg  [1:0] result_flags_now;
    wire [31:0] results_to_8_later;

    delay_w3_n1 to_1 (
        .clock_i(clock_i),
        .now_i(marks),
        .later_o(to_1_later)
    );

    delay_w3_n1 to_2 (
        .clock_i(clock_i),
        .now_i(to_1_later),
        .later_o(to_2_later)
    );

    delay_w3_n3 to_5 (
        .clock_i(clock_i),
        .now_i(to_2_later),
        .later_o(to_5_later)
    );

    delay_w3_n3 to_8 (
        .clock_i(clock_i),
        .now_i(to_5_later),
        .later_o(to_8_later)
    );

    delay_w8_n5 beat_to_5 (
        .clock_i(clock_i),
        .now_i(beat_i),
        .later_o(beat_to_5_later_unused)
    );

    requantize #(
        .HAS_BASE(1'b0)
    ) requantize_even (
        .clock_i(clock_i),
        .sum_i(sum_even_q),
        .base_i(base_word[15:0]),
        .base_shift_i(shifts[11:6]),
        .result_shift_i(shifts[5:0]),
        .result_o(requantize_even_result),
        .saturated_o(requantize_even_saturated)
    );

    requantize #(
        .HAS_BASE(1'b0)
    ) requantize_odd (
        .clock_i(clock_i),
        .sum_i(sum_odd_q),
        .base_i(base_word[31:16]),
        .base_shift_i(shifts[11:6]),
        .result_shift_i(shifts[5:0]),
        .result_o(requantize_odd_result),
        .saturated_o(requantize_odd_saturated)
    );

    delay_w2_n2 result_flags (
        .clock_i(clock_i),
        .now_i(result_flags_now),
        .later_o(result_saturated_o)
    );

    delay_w32_n2 results_to_8 (
        .clock_i(clock_i),
        .now_i(result),
        .later_o(results_to_8_later)
    );

    always @* begin
        marks = 3'd0;
        if (take_i) begin
            marks = marks | 3'd1;
        end
        if (last_i) begin
            marks = marks | 3'd2;
        end
        if (set_i) begin
            marks = marks | 3'd4;
        end
    end

    assign base_word = 32'd0;
    assign shifts = to_2_later[2] ? shifts_1_i : shifts_0_i;
    assign result = {requantize_odd_result, requantize_even_result};

    always @* begin
        result_flags_now = 2'd0;
        if (requantize_even_saturated && requantize_odd_saturated) begin
            result_flags_now = 2'd3;
        end else if (requantize_even_saturated) begin
            result_flags_now = 2'd1;
        end else if (requantize_odd_saturated) begin
            result_flags_now = 2'd2;
        end
    end

    assign code_saturated_o = 2'd0;
    assign sent = results_to_8_later;
    assign difference_saturated_o = 2'd0;
    assign base_o = 32'd0;
    assign data_o = sent;
    assign push_o = to_8_later[0];
    assign done_last_o = to_8_later[1];
    assign done_set_o = to_8_later[2];
    assign nonzero_o = ((|sent[15:0]) && (|sent[31:16])) ? 2'd3 : ((|sent) ? 2'd1 : 2'd0);

    always @(posedge clock_i) begin
        sum_even_q <= sum_even_i;
        sum_odd_q <= sum_odd_i;
    end

    // Not every bit of these is read.
    wire unused = ^shifts;
endmodule

`default_nettype wire
