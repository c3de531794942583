// What came in as many cycles ago as there are registers.
//
// From crates/edof-hdl/src/blocks/delay.rs (Delay).
`default_nettype none

module delay_w8_n5 (
    input  wire       clock_i, // Clock.
    input  wire [7:0] now_i,   // In.
    output wire [7:0] later_o  // Out.
);

    reg  [7:0] row_0_q;
    reg  [7:0] row_1_q;
    reg  [7:0] row_2_q;
    reg  [7:0] row_3_q;
    reg  [7:0] row_4_q;

    assign later_o = row_4_q;

    always @(posedge clock_i) begin
        row_0_q <= now_i;
        row_1_q <= row_0_q;
        row_2_q <= row_1_q;
        row_3_q <= row_2_q;
        row_4_q <= row_3_q;
    end
endmodule

`default_nettype wire
