// What came in as many cycles ago as there are registers.
//
// From crates/edof-hdl/src/blocks/delay.rs (Delay).
`default_nettype none

module delay_w2_n2 (
    input  wire       clock_i, // Clock.
    input  wire [1:0] now_i,   // In.
    output wire [1:0] later_o  // Out.
);

    reg  [1:0] row_0_q;
    reg  [1:0] row_1_q;

    assign later_o = row_1_q;

    always @(posedge clock_i) begin
        row_0_q <= now_i;
        row_1_q <= row_0_q;
    end
endmodule

`default_nettype wire
