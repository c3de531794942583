// From a sum to a rounded word: saturate((sum + (base << base_shift) + half) >> result_shift), four cycles later.
// half is 2^(result_shift - 1), or 0 for a shift of 0. Numbers are in two's complement; `most` and `least` bound the result.
//
// From crates/edof-hdl/src/blocks/requantize.rs (Requantize).
`default_nettype none

module requantize #(
    parameter HAS_BASE = 1'b0
) (
    input  wire        clock_i,        // Clock.
    input  wire [47:0] sum_i,          // Sum out of the multipliers.
    input  wire [15:0] base_i,         // Base word of the same element.
    input  wire [5:0]  base_shift_i,   // Its left shift.
    input  wire [5:0]  result_shift_i, // Right shift of all.
    output wire [15:0] result_o,       // Result.
    output wire        saturated_o     // Whether it did not fit.
);

    localparam [47:0] ONE = 48'd1;
    localparam [47:0] ONES = 48'hffffffffffff;
    localparam [47:0] SIGN_BITS = 48'hffffffff0000;
    localparam [47:0] MOST = 48'h7fff;
    localparam [47:0] LEAST = 48'hffffffff8000;

    wire [47:0] extended;
    wire [47:0] half;
    wire [47:0] fill;
    reg  [47:0] sum_q;
    reg  [47:0] aligned_q;
    wire [47:0] aligned_d;
    reg  [47:0] total_q;
    wire [47:0] total_d;
    reg  [47:0] shifted_q;
    wire [47:0] shifted_d;
    reg  [15:0] result_q;
    reg  [15:0] result_d;
    reg  saturated_q;
    reg  saturated_d;
    wire [5:0] shift_later_later;

    wire [47:0] result_d_value = LEAST;
    wire [47:0] result_d_value_2 = MOST;

    delay_w6_n2 shift_later (
        .clock_i(clock_i),
        .now_i(result_shift_i),
        .later_o(shift_later_later)
    );

    assign extended = base_i[15] ? ({32'd0, base_i} | SIGN_BITS) : {32'd0, base_i};
    assign half = (ONE << result_shift_i) >> 1;
    assign aligned_d = HAS_BASE ? ((extended << base_shift_i) + half) : half;
    assign total_d = sum_q + aligned_q;
    assign fill = total_q[47] ? (~(ONES >> shift_later_later)) : 48'd0;
    assign shifted_d = (total_q >> shift_later_later) | fill;

    always @* begin
        result_d = shifted_q[15:0];
        if (shifted_q[47]) begin
            if (shifted_q < LEAST) begin
                result_d = result_d_value[15:0];
            end
        end else if (shifted_q > MOST) begin
            result_d = result_d_value_2[15:0];
        end
    end

    always @* begin
        saturated_d = 1'b0;
        if (shifted_q[47]) begin
            if (shifted_q < LEAST) begin
                saturated_d = 1'b1;
            end
        end else if (shifted_q > MOST) begin
            saturated_d = 1'b1;
        end
    end

    assign result_o = result_q;
    assign saturated_o = saturated_q;

    always @(posedge clock_i) begin
        sum_q <= sum_i;
        aligned_q <= aligned_d;
        total_q <= total_d;
        shifted_q <= shifted_d;
        result_q <= result_d;
        saturated_q <= saturated_d;
    end

    // Not every bit of these is read.
    wire unused = ^{result_d_value, result_d_value_2};
endmodule

`default_nettype wire
