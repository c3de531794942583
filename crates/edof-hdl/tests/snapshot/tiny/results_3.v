// From sums to the words that go on, two elements a cycle. Counted from `take`: 7 sums and base stand here, 8 to 17 base, rounding,
// shift and saturation, 18 to 20 threshold, 21 to 23 difference or wait. Nothing in here ever stalls.
//
// From crates/edof-hdl/src/blocks/results.rs (Results).
`default_nettype none

module results_3 (
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
    output reg  [1:0]  code_saturated_o,
    output wire [1:0]  difference_saturated_o
);

    localparam [11:0] SET_ROWS = 12'h8;

    reg  [2:0] marks;
    reg  [31:0] base_word;
    wire [31:0] result;
    reg  [15:0] code_even;
    reg  [15:0] code_odd;
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
    wire base_ring_0_read;
    wire [31:0] base_ring_0_front;
    wire [31:0] thresholds_0_read_data;
    wire [15:0] shrink_even_0_threshold;
    wire [15:0] shrink_even_0_result;
    wire shrink_even_0_saturated;
    wire [15:0] shrink_odd_0_threshold;
    wire [15:0] shrink_odd_0_result;
    wire shrink_odd_0_saturated;
    reg  [1:0] code_flags_0_now;
    wire [1:0] code_flags_0_later;
    wire [31:0] codes_to_23_0_later;

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

    requantize_2 requantize_even (
        .clock_i(clock_i),
        .sum_i(sum_even_i),
        .base_i(requantize_even_base),
        .base_shift_i(requantize_even_base_shift),
        .result_shift_i(requantize_even_result_shift),
        .result_o(requantize_even_result),
        .saturated_o(requantize_even_saturated)
    );

    requantize_2 requantize_odd (
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

    base_ring base_ring_0 (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .write_i(base_write_i),
        .words_i(base_words_i),
        .read_i(base_ring_0_read),
        .front_o(base_ring_0_front)
    );

    edof_ram #(
        .WIDTH(32),
        .DEPTH(16),
        .BLOCK(0),
        .INIT("mem/stage2_thresholds.hex")
    ) thresholds_0 (
        .clock_i(clock_i),
        .read_address_i(threshold_row_q),
        .read_data_o(thresholds_0_read_data),
        .write_enable_i(write_thresholds_i),
        .write_address_i(write_row_i),
        .write_data_i(write_data_i)
    );

    shrink shrink_even_0 (
        .clock_i(clock_i),
        .code_i(requantize_even_result),
        .threshold_i(shrink_even_0_threshold),
        .result_o(shrink_even_0_result),
        .saturated_o(shrink_even_0_saturated)
    );

    shrink shrink_odd_0 (
        .clock_i(clock_i),
        .code_i(requantize_odd_result),
        .threshold_i(shrink_odd_0_threshold),
        .result_o(shrink_odd_0_result),
        .saturated_o(shrink_odd_0_saturated)
    );

    edof_delay #(
        .WIDTH(2),
        .CYCLES(3)
    ) code_flags_0 (
        .clock_i(clock_i),
        .now_i(code_flags_0_now),
        .later_o(code_flags_0_later)
    );

    edof_delay #(
        .WIDTH(32),
        .CYCLES(3)
    ) codes_to_23_0 (
        .clock_i(clock_i),
        .now_i(code),
        .later_o(codes_to_23_0_later)
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

    always @* begin
        base_word = 32'd0;
        base_word = base_ring_0_front;
    end

    assign base_ring_0_read = marks_to_5_later[0];

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

    always @* begin
        code_even = 16'd0;
        code_even = shrink_even_0_result;
    end

    always @* begin
        code_odd = 16'd0;
        code_odd = shrink_odd_0_result;
    end

    always @* begin
        code_saturated_o = 2'd0;
        code_saturated_o = code_flags_0_later;
    end

    assign shrink_even_0_threshold = thresholds_0_read_data[15:0];
    assign shrink_odd_0_threshold = thresholds_0_read_data[31:16];

    always @* begin
        code_flags_0_now = 2'd0;
        if (shrink_even_0_saturated && shrink_odd_0_saturated) begin
            code_flags_0_now = 2'd3;
        end else if (shrink_even_0_saturated) begin
            code_flags_0_now = 2'd1;
        end else if (shrink_odd_0_saturated) begin
            code_flags_0_now = 2'd2;
        end
    end

    assign code = ({16'd0, code_odd} << 16) | {16'd0, code_even};

    always @* begin
        sent = 32'd0;
        sent = codes_to_23_0_later;
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
