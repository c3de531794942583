// Debounces an asynchronous input such as a push button: level_o follows line_i once line_i has been stable for
// 2^LOG_CYCLES cycles of clock_i (5.2 ms at 200 MHz). Low at first.
`default_nettype none
module edof_debounce #(
    parameter LOG_CYCLES = 20
) (
    input  wire clock_i,
    input  wire line_i,
    output wire level_o
);
    localparam [LOG_CYCLES-1:0] ONE = 1;

    wire line;
    reg level_q = 1'b0;
    reg [LOG_CYCLES-1:0] stable_q = {LOG_CYCLES{1'b0}};

    always @(posedge clock_i) begin
        if (line == level_q) stable_q <= {LOG_CYCLES{1'b0}};
        else stable_q <= stable_q + ONE;
        if (&stable_q) level_q <= line;
    end

    assign level_o = level_q;

    edof_sync #(.WIDTH(1)) line_sync (.clock_i(clock_i), .from_i(line_i), .to_o(line));
endmodule
`default_nettype wire
