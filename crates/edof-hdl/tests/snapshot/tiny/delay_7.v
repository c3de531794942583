// What came in as many cycles ago as there are registers.
//
// From crates/edof-hdl/src/blocks/delay.rs (Delay).
`default_nettype none

module delay_7 (
    input  wire       clock_i,
    input  wire [1:0] now_i,
    output wire [1:0] later_o
);

    reg  [1:0] row_0_q;

    assign later_o = row_0_q;

    always @(posedge clock_i) begin
        row_0_q <= now_i;
    end
endmodule

`default_nettype wire
