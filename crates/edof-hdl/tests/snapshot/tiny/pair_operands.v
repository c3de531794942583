// From what a step read to rows of weights and values, four cycles after the step: pairs, or pixels of the window (F), shifted left
// where F aligns its two sums. A value without work is 0.
//
// From crates/edof-hdl/src/blocks/pair_operands.rs (PairOperands).
`default_nettype none

module pair_operands #(
    parameter ALIGNS = 1'b0,
    parameter TWO_ROWS = 1'b0
) (
    input  wire        clock_i,      // Clock.
    input  wire        valid_a_i,    // There is a step, with a first value.
    input  wire        valid_b_i,    // With a second one.
    input  wire        first_i,      // It is the first of its pass.
    input  wire        linear_i,     // It is one of the window's.
    input  wire        odd_i,        // The odd one of two elements is meant.
    input  wire        set_i,        // The vector's set.
    input  wire [11:0] base_i,       // Row of weights of input 0.
    input  wire [11:0] offset_i,     // What the row of weights of a pixel is after it.
    input  wire [24:0] even_pair_i,  // The even pair, two cycles after the step.
    input  wire [24:0] odd_pair_i,   // The odd one.
    input  wire [31:0] pixels_i,     // Two pixels, likewise.
    input  wire [7:0]  shifts_0_i,   // Left shifts of set 0: of codes, of pixels.
    input  wire [7:0]  shifts_1_i,   // Of set 1.
    output wire        step_first_o, // The step is the first of its pass.
    output wire [11:0] address_a_o,  // Row of weights.
    output wire [11:0] address_b_o,  // Of the second value.
    output wire [24:0] value_a_o,    // Value.
    output wire [24:0] value_b_o     // The second one.
);

    reg  [5:0] flags;
    wire [24:0] pair_a;
    wire [15:0] pixel_a;
    wire [7:0] shifts;
    wire [24:0] wide_a, wide_b;
    wire [5:0] flags_to_2_later;
    wire [23:0] rows_to_2_now, rows_to_2_later;
    reg  [15:0] value_a_3_q, value_a_3_d, value_b_3_q, value_b_3_d;
    reg  [11:0] base_3_q, offset_a_3_q, offset_a_3_d, offset_b_3_q, offset_b_3_d;
    reg  [3:0] shift_3_q;
    reg  [11:0] address_a_4_q, address_b_4_q;
    reg  [24:0] value_a_4_q, value_b_4_q;

    edof_delay #(.WIDTH(6), .CYCLES(2)) flags_to_2 (
        .clock_i(clock_i), .now_i(flags), .later_o(flags_to_2_later)
    );
    edof_delay #(.WIDTH(24), .CYCLES(2)) rows_to_2 (
        .clock_i(clock_i), .now_i(rows_to_2_now), .later_o(rows_to_2_later)
    );
    edof_delay #(.WIDTH(1), .CYCLES(2)) first_to_4 (
        .clock_i(clock_i), .now_i(flags_to_2_later[0]), .later_o(step_first_o)
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

    assign rows_to_2_now = {base_i, offset_i};
    assign pair_a = flags_to_2_later[4] ? odd_pair_i : even_pair_i;
    assign pixel_a = flags_to_2_later[4] ? pixels_i[31:16] : pixels_i[15:0];

    always @* begin
        value_a_3_d = pair_a[15:0];
        if (flags_to_2_later[3]) begin
            value_a_3_d = pixel_a;
        end
        if (!flags_to_2_later[1]) begin
            value_a_3_d = 16'd0;
        end
    end

    always @* begin
        value_b_3_d = odd_pair_i[15:0];
        if (flags_to_2_later[3]) begin
            value_b_3_d = pixels_i[31:16];
        end
        if (!(TWO_ROWS && flags_to_2_later[2])) begin
            value_b_3_d = 16'd0;
        end
    end

    always @* begin
        offset_a_3_d = {3'd0, pair_a[24:16]};
        if (flags_to_2_later[3]) begin
            offset_a_3_d = rows_to_2_later[11:0];
        end
        if (!flags_to_2_later[1]) begin
            offset_a_3_d = 12'd0;
        end
    end

    always @* begin
        offset_b_3_d = {3'd0, odd_pair_i[24:16]};
        if (flags_to_2_later[3]) begin
            offset_b_3_d = rows_to_2_later[11:0] | 12'd1;
        end
        if (!(TWO_ROWS && flags_to_2_later[2])) begin
            offset_b_3_d = 12'd0;
        end
    end

    assign shifts = flags_to_2_later[5] ? shifts_1_i : shifts_0_i;
    assign wide_a = value_a_3_q[15] ? ({9'd0, value_a_3_q} | 25'h1ff0000) : {9'd0, value_a_3_q};
    assign wide_b = value_b_3_q[15] ? ({9'd0, value_b_3_q} | 25'h1ff0000) : {9'd0, value_b_3_q};
    assign address_a_o = address_a_4_q;
    assign address_b_o = address_b_4_q;
    assign value_a_o = value_a_4_q;
    assign value_b_o = value_b_4_q;

    always @(posedge clock_i) begin
        value_a_3_q <= value_a_3_d;
        value_b_3_q <= value_b_3_d;
        base_3_q <= rows_to_2_later[23:12];
        offset_a_3_q <= offset_a_3_d;
        offset_b_3_q <= offset_b_3_d;
        shift_3_q <= flags_to_2_later[3] ? shifts[7:4] : shifts[3:0];
        address_a_4_q <= base_3_q + offset_a_3_q;
        address_b_4_q <= base_3_q + offset_b_3_q;
        value_a_4_q <= ALIGNS ? (wide_a << shift_3_q) : wide_a;
        value_b_4_q <= ALIGNS ? (wide_b << shift_3_q) : wide_b;
    end
endmodule

`default_nettype wire
