// From what a step read to rows of weights and values, four cycles after the step: pairs, or pixels of the window (F), shifted left
// where F aligns its two sums. A value without work is 0.
//
// From crates/edof-hdl/src/blocks/pair_operands.rs (PairOperands).
`default_nettype none

module pair_operands_2 (
    input  wire        clock_i,
    input  wire        valid_a_i,
    input  wire        valid_b_i,
    input  wire        first_i,
    input  wire        linear_i,
    input  wire        odd_i,
    input  wire        set_i,
    input  wire [11:0] base_i,
    input  wire [11:0] offset_i,
    input  wire [24:0] even_pair_i,
    input  wire [24:0] odd_pair_i,
    input  wire [31:0] pixels_i,
    input  wire [7:0]  shifts_0_i,
    input  wire [7:0]  shifts_1_i,
    output wire        step_first_o,
    output wire [11:0] address_a_o,
    output wire [11:0] address_b_o,
    output wire [24:0] value_a_o,
    output wire [24:0] value_b_o
);

    localparam ALIGNS = 1'h1;
    localparam TWO_ROWS = 1'h1;

    reg  [5:0] flags;
    reg  [24:0] pair_a;
    reg  [15:0] pixel_a;
    reg  [7:0] shifts;
    reg  [24:0] wide_a;
    reg  [24:0] wide_b;
    wire [5:0] flags_to_2_later;
    wire [23:0] rows_to_2_now;
    wire [23:0] rows_to_2_later;
    wire first_to_4_now;
    wire first_to_4_later;
    reg  [15:0] value_a_3_q;
    reg  [15:0] value_a_3_d;
    reg  [15:0] value_b_3_q;
    reg  [15:0] value_b_3_d;
    reg  [11:0] base_3_q;
    wire [11:0] base_3_d;
    reg  [11:0] offset_a_3_q;
    reg  [11:0] offset_a_3_d;
    reg  [11:0] offset_b_3_q;
    reg  [11:0] offset_b_3_d;
    reg  [3:0] shift_3_q;
    reg  [3:0] shift_3_d;
    reg  [11:0] address_a_4_q;
    wire [11:0] address_a_4_d;
    reg  [11:0] address_b_4_q;
    wire [11:0] address_b_4_d;
    reg  [24:0] value_a_4_q;
    reg  [24:0] value_a_4_d;
    reg  [24:0] value_b_4_q;
    reg  [24:0] value_b_4_d;

    edof_delay #(
        .WIDTH(6),
        .CYCLES(2)
    ) flags_to_2 (
        .clock_i(clock_i),
        .now_i(flags),
        .later_o(flags_to_2_later)
    );

    edof_delay #(
        .WIDTH(24),
        .CYCLES(2)
    ) rows_to_2 (
        .clock_i(clock_i),
        .now_i(rows_to_2_now),
        .later_o(rows_to_2_later)
    );

    edof_delay #(
        .WIDTH(1),
        .CYCLES(2)
    ) first_to_4 (
        .clock_i(clock_i),
        .now_i(first_to_4_now),
        .later_o(first_to_4_later)
    );

    always @* begin
        flags = 6'd0;
        if (first_i) begin
            flags = flags | 6'd1;
        end
        if (valid_a_i) begin
            flags = flags | 6'd2;
        end
        if (valid_b_i) begin
            flags = flags | 6'd4;
        end
        if (linear_i) begin
            flags = flags | 6'd8;
        end
        if (odd_i) begin
            flags = flags | 6'h10;
        end
        if (set_i) begin
            flags = flags | 6'h20;
        end
    end

    assign rows_to_2_now = ({12'd0, base_i} << 12) | {12'd0, offset_i};

    always @* begin
        pair_a = even_pair_i;
        pixel_a = pixels_i[15:0];
        if (flags_to_2_later[4]) begin
            pair_a = odd_pair_i;
            pixel_a = pixels_i[31:16];
        end
    end

    always @* begin
        value_a_3_d = pair_a[15:0];
        value_b_3_d = odd_pair_i[15:0];
        offset_a_3_d = {3'd0, pair_a[24:16]};
        offset_b_3_d = {3'd0, odd_pair_i[24:16]};
        shift_3_d = shifts[3:0];
        if (flags_to_2_later[3]) begin
            value_a_3_d = pixel_a;
            value_b_3_d = pixels_i[31:16];
            offset_a_3_d = rows_to_2_later[11:0];
            offset_b_3_d = rows_to_2_later[11:0] | 12'd1;
            shift_3_d = shifts[7:4];
        end
        if (!flags_to_2_later[1]) begin
            value_a_3_d = 16'd0;
            offset_a_3_d = 12'd0;
        end
        if (!(TWO_ROWS && flags_to_2_later[2])) begin
            value_b_3_d = 16'd0;
            offset_b_3_d = 12'd0;
        end
    end

    always @* begin
        shifts = shifts_0_i;
        if (flags_to_2_later[5]) begin
            shifts = shifts_1_i;
        end
    end

    assign base_3_d = rows_to_2_later[23:12];

    always @* begin
        wide_a = {9'd0, value_a_3_q};
        if (value_a_3_q[15]) begin
            wide_a = {9'd0, value_a_3_q} | 25'h1ff0000;
        end
    end

    always @* begin
        wide_b = {9'd0, value_b_3_q};
        if (value_b_3_q[15]) begin
            wide_b = {9'd0, value_b_3_q} | 25'h1ff0000;
        end
    end

    always @* begin
        value_a_4_d = wide_a;
        value_b_4_d = wide_b;
        if (ALIGNS) begin
            value_a_4_d = wide_a << shift_3_q;
            value_b_4_d = wide_b << shift_3_q;
        end
    end

    assign address_a_4_d = base_3_q + offset_a_3_q;
    assign address_b_4_d = base_3_q + offset_b_3_q;
    assign first_to_4_now = flags_to_2_later[0];
    assign step_first_o = first_to_4_later;
    assign address_a_o = address_a_4_q;
    assign address_b_o = address_b_4_q;
    assign value_a_o = value_a_4_q;
    assign value_b_o = value_b_4_q;

    always @(posedge clock_i) begin
        value_a_3_q <= value_a_3_d;
        value_b_3_q <= value_b_3_d;
        base_3_q <= base_3_d;
        offset_a_3_q <= offset_a_3_d;
        offset_b_3_q <= offset_b_3_d;
        shift_3_q <= shift_3_d;
        address_a_4_q <= address_a_4_d;
        address_b_4_q <= address_b_4_d;
        value_a_4_q <= value_a_4_d;
        value_b_4_q <= value_b_4_d;
    end
endmodule

`default_nettype wire
