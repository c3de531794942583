// From sums to the words that go on, two elements a cycle. Counted from `take`: 7 sums and base stand here, 8 to 17 base, rounding,
// shift and saturation, 18 to 20 threshold, 21 to 23 difference or wait. Nothing in here ever stalls.
//
// From crates/edof-hdl/src/blocks/results.rs (Results).
`default_nettype none

module results_4 (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        take_i,
    input  wire [7:0]  beat_i,
    input  wire        last_i,
    input  wire        set_i,
    input  wire [47:0] sum_even_i,
    input  wire [47:0] sum_odd_i,
    input  wire [19:0] shifts_0_i,
    input  wire [19:0] shifts_1_i,
    input  wire        base_write_i,
    input  wire [31:0] base_words_i,
    input  wire        write_thresholds_i,
    input  wire        write_previous_i,
    input  wire [11:0] write_row_i,
    input  wire [31:0] write_data_i,
    output wire        push_o,
    output wire [31:0] data_o,
    output wire [31:0] base_o,
    output wire        done_last_o,
    output wire        done_set_o,
    output reg  [1:0]  nonzero_o,
    output wire [1:0]  result_saturated_o,
    output wire [1:0]  code_saturated_o,
    output wire [1:0]  difference_saturated_o
);

    localparam [11:0] SET_ROWS = 12'h40;

    reg  [2:0] marks;
    wire [31:0] base_word;
    wire [31:0] result;
    wire [15:0] code_even;
    wire [15:0] code_odd;
    wire [31:0] code;
    wire [15:0] change_even;
    wire [15:0] change_odd;
    wire [31:0] change;
    reg  [31:0] sent;
    wire [2:0] marks_to_5_later;
    wire [2:0] marks_to_6_later;
    wire [2:0] marks_to_23_later;
    reg  [8:0] place_to_15_now;
    wire [8:0] place_to_15_later;
    reg  [11:0] threshold_row_q;
    reg  [11:0] threshold_row_d;
    reg  [11:0] shifts_q;
    reg  [11:0] shifts_d;
    wire [15:0] requantize_even_base;
    wire [5:0] requantize_even_base_shift;
    wire [5:0] requantize_even_result_shift;
    wire [15:0] requantize_even_result;
    wire requantize_even_saturated;
    wire [15:0] requantize_odd_base;
    wire [5:0] requantize_odd_base_shift;
    wire [5:0] requantize_odd_result_shift;
    wire [15:0] requantize_odd_result;
    wire requantize_odd_saturated;
    reg  [1:0] result_flags_now;
    wire [31:0] results_to_23_0_later;

    edof_delay #(
        .WIDTH(3),
        .CYCLES(5)
    ) marks_to_5 (
        .clock_i(clock_i),
        .now_i(marks),
        .later_o(marks_to_5_later)
    );

    edof_delay #(
        .WIDTH(3),
        .CYCLES(1)
    ) marks_to_6 (
        .clock_i(clock_i),
        .now_i(marks_to_5_later),
        .later_o(marks_to_6_later)
    );

    edof_delay #(
        .WIDTH(3),
        .CYCLES(17)
    ) marks_to_23 (
        .clock_i(clock_i),
        .now_i(marks_to_6_later),
        .later_o(marks_to_23_later)
    );

    edof_delay #(
        .WIDTH(9),
        .CYCLES(15)
    ) place_to_15 (
        .clock_i(clock_i),
        .now_i(place_to_15_now),
        .later_o(place_to_15_later)
    );

    requantize requantize_even (
        .clock_i(clock_i),
        .sum_i(sum_even_i),
        .base_i(requantize_even_base),
        .base_shift_i(requantize_even_base_shift),
        .result_shift_i(requantize_even_result_shift),
        .result_o(requantize_even_result),
        .saturated_o(requantize_even_saturated)
    );

    requantize requantize_odd (
        .clock_i(clock_i),
        .sum_i(sum_odd_i),
        .base_i(requantize_odd_base),
        .base_shift_i(requantize_odd_base_shift),
        .result_shift_i(requantize_odd_result_shift),
        .result_o(requantize_odd_result),
        .saturated_o(requantize_odd_saturated)
    );

    edof_delay #(
        .WIDTH(2),
        .CYCLES(6)
    ) result_flags (
        .clock_i(clock_i),
        .now_i(result_flags_now),
        .later_o(result_saturated_o)
    );

    edof_delay #(
        .WIDTH(32),
        .CYCLES(6)
    ) results_to_23_0 (
        .clock_i(clock_i),
        .now_i(result),
        .later_o(results_to_23_0_later)
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

    always @* begin
        place_to_15_now = {1'b0, beat_i};
        if (set_i) begin
            place_to_15_now = {1'b0, beat_i} | 9'h100;
        end
    end

    assign base_word = 32'd0;

    always @* begin
        shifts_d = shifts_0_i[11:0];
        if (marks_to_6_later[2]) begin
            shifts_d = shifts_1_i[11:0];
        end
    end

    assign requantize_even_base = base_word[15:0];
    assign requantize_even_base_shift = shifts_q[11:6];
    assign requantize_even_result_shift = shifts_q[5:0];
    assign requantize_odd_base = base_word[31:16];
    assign requantize_odd_base_shift = shifts_q[11:6];
    assign requantize_odd_result_shift = shifts_q[5:0];
    assign result = ({16'd0, requantize_odd_result} << 16) | {16'd0, requantize_even_result};

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

    always @* begin
        threshold_row_d = {4'd0, place_to_15_later[7:0]};
        if (place_to_15_later[8]) begin
            threshold_row_d = {4'd0, place_to_15_later[7:0]} + SET_ROWS;
        end
    end

    assign code_even = 16'd0;
    assign code_odd = 16'd0;
    assign code_saturated_o = 2'd0;
    assign code = ({16'd0, code_odd} << 16) | {16'd0, code_even};

    always @* begin
        sent = 32'd0;
        sent = results_to_23_0_later;
    end

    assign difference_saturated_o = 2'd0;
    assign change_even = 16'd0;
    assign change_odd = 16'd0;
    assign change = ({16'd0, change_odd} << 16) | {16'd0, change_even};
    assign base_o = 32'd0;
    assign data_o = sent;
    assign push_o = marks_to_23_later[0];
    assign done_last_o = marks_to_23_later[1];
    assign done_set_o = marks_to_23_later[2];

    always @* begin
        nonzero_o = 2'd0;
        if ((|sent[15:0]) && (|sent[31:16])) begin
            nonzero_o = 2'd3;
        end else if (|sent) begin
            nonzero_o = 2'd1;
        end
    end

    always @(posedge clock_i) begin
        threshold_row_q <= threshold_row_d;
        shifts_q <= shifts_d;
    end
endmodule

`default_nettype wire
