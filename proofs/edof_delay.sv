// edof_delay: what came in CYCLES ago.
module prove #(
    parameter CYCLES = 3
) (
    input wire       clock_i,
    input wire [1:0] now_i
);
    wire [1:0] later_o;
    edof_delay #(.WIDTH(2), .CYCLES(CYCLES)) dut (.clock_i(clock_i), .now_i(now_i), .later_o(later_o));

    reg [2*CYCLES-1:0] row = 0;
    reg [3:0] steps = 0;
    always @(posedge clock_i) begin
        row <= {row, now_i};
        if (steps <= CYCLES) steps <= steps + 1;
        if (steps >= CYCLES) same: assert (later_o == row[2*CYCLES-1:2*CYCLES-2]);
        came: cover (steps >= CYCLES && later_o == 2);
    end
endmodule
