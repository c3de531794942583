// edof_delay: what came in CYCLES ago.
module prove #(
    parameter CYCLES = 3
) (
    input wire       clock_i,
    input wire [1:0] data_i
);
    wire [1:0] data_o;
    edof_delay #(.WIDTH(2), .CYCLES(CYCLES)) dut (.clock_i(clock_i), .data_i(data_i), .data_o(data_o));

    reg [2*CYCLES-1:0] row = 0;
    reg [3:0] steps = 0;
    always @(posedge clock_i) begin
        row <= {row, data_i};
        if (steps <= CYCLES) steps <= steps + 1;
        if (steps >= CYCLES) same: assert (data_o == row[2*CYCLES-1:2*CYCLES-2]);
        came: cover (steps >= CYCLES && data_o == 2);
    end
endmodule
