// Words that wait for their receiver: DEPTH in LUT RAM, a power of two, and one in the register that is the output.
//
// A word stands on the output two cycles after push_i at the earliest, and until ready_i. A pipeline that ends here takes in only while
// room_o: SLACK words may follow it, which is enough for SLACK - 2 cycles of latency at one word a cycle. So nothing in a pipeline has
// to stall, and neither valid_o nor room_o hangs on logic.
`default_nettype none

module edof_queue #(
    parameter WIDTH = 32,
    parameter DEPTH = 32,
    parameter SLACK = 8
) (
    input  wire             clock_i,
    input  wire             reset_i,
    input  wire             push_i,
    input  wire [WIDTH-1:0] data_i,
    output wire             room_o,
    output wire             valid_o,
    input  wire             ready_i,
    output wire [WIDTH-1:0] data_o
);
    localparam BITS = $clog2(DEPTH);
    localparam [BITS:0] MOST = DEPTH - SLACK;

    (* ram_style = "distributed" *) reg [WIDTH-1:0] memory [0:DEPTH-1];
    reg [BITS:0] pushed_q;
    reg [BITS:0] popped_q;
    reg room_q;
    reg valid_q;
    reg [WIDTH-1:0] front_q;

    wire moves = !valid_q || ready_i;
    wire waits = pushed_q != popped_q;
    wire [BITS:0] held = pushed_q - popped_q;

    always @(posedge clock_i) begin
        if (push_i) memory[pushed_q[BITS-1:0]] <= data_i;
        if (moves) front_q <= memory[popped_q[BITS-1:0]];
        if (reset_i) begin
            pushed_q <= {(BITS + 1){1'b0}};
            popped_q <= {(BITS + 1){1'b0}};
            room_q <= 1'b0;
            valid_q <= 1'b0;
        end else begin
            if (push_i) pushed_q <= pushed_q + {{BITS{1'b0}}, 1'b1};
            if (moves && waits) popped_q <= popped_q + {{BITS{1'b0}}, 1'b1};
            room_q <= held <= MOST;
            if (moves) valid_q <= waits;
        end
    end

    assign room_o = room_q;
    assign valid_o = valid_q;
    assign data_o = front_q;
endmodule

`default_nettype wire
