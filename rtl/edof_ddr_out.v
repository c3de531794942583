// Two bits per cycle to each pin: first_i while the clock is high, second_i while it is low, from the third rising edge on after they came.
//
// Each pin is the sum of two registers, one per edge, of which either makes the sum what the pin shall be: no pulse between two bits.
`default_nettype none
module edof_ddr_out #(
    parameter WIDTH = 1
) (
    input  wire             clock_i,
    input  wire [WIDTH-1:0] first_i,
    input  wire [WIDTH-1:0] second_i,
    output wire [WIDTH-1:0] pins_o
);
    reg [WIDTH-1:0] first_1_q, second_1_q, first_2_q, second_2_q, second_3_q;
    reg [WIDTH-1:0] rise_q = 0;
    reg [WIDTH-1:0] fall_q = 0;

    always @(posedge clock_i) begin
        first_1_q <= first_i;
        second_1_q <= second_i;
        first_2_q <= first_1_q;
        second_2_q <= second_1_q;
        rise_q <= first_2_q ^ fall_q;
        second_3_q <= second_2_q;
    end
    always @(negedge clock_i) fall_q <= second_3_q ^ rise_q;

    assign pins_o = rise_q ^ fall_q;
endmodule
`default_nettype wire
