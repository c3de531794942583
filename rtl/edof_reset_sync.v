// The reset of a clock domain: high as soon as its clock runs and reset_i was high, low CYCLES cycles after reset_i fell.
//
// reset_i may change at any time and be as short as a flip-flop sees. It is caught while the clock stands still; reset_o itself
// changes with the clock only. It is high from power-up on.
`default_nettype none
module edof_reset_sync #(
    parameter CYCLES = 64
) (
    input  wire clock_i,
    input  wire reset_i,
    output wire reset_o
);
    (* ASYNC_REG = "TRUE" *) reg first_q = 1'b1;
    (* ASYNC_REG = "TRUE" *) reg second_q = 1'b1;
    reg [CYCLES-1:0] held_q = {CYCLES{1'b1}};

    always @(posedge clock_i or posedge reset_i) begin
        if (reset_i) begin
            first_q <= 1'b1;
            second_q <= 1'b1;
        end else begin
            first_q <= 1'b0;
            second_q <= first_q;
        end
    end

    always @(posedge clock_i) held_q <= second_q ? {CYCLES{1'b1}} : {held_q[CYCLES-2:0], 1'b0};

    assign reset_o = held_q[CYCLES-1];
endmodule
`default_nettype wire
