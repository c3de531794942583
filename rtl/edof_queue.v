// A FIFO at the end of a pipeline: DEPTH words in LUT RAM, a power of two, and one word in the output register.
//
// A word is valid on the output two cycles after push_i at the earliest, and held until ready_i. The pipeline accepts input only while
// space_o is high. After space_o falls, SLACK words may follow, which is enough for SLACK - 2 cycles of latency at one word per cycle. So
// no stage of the pipeline has to stall, and valid_o and space_o come from registers.
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
    output wire             space_o,
    output wire             valid_o,
    input  wire             ready_i,
    output wire [WIDTH-1:0] data_o
);
    localparam BITS = $clog2(DEPTH);
    localparam [BITS:0] MAX_HELD = DEPTH - SLACK;

    (* ram_style = "distributed" *) reg [WIDTH-1:0] memory [0:DEPTH-1];
    reg [BITS:0] pushed_q;
    reg [BITS:0] popped_q;
    reg space_q;
    reg valid_q;
    reg [WIDTH-1:0] front_q;

    wire advance = !valid_q || ready_i;
    wire not_empty = pushed_q != popped_q;
    wire [BITS:0] held = pushed_q - popped_q;

    always @(posedge clock_i) begin
        if (push_i) memory[pushed_q[BITS-1:0]] <= data_i;
        if (advance) front_q <= memory[popped_q[BITS-1:0]];
        if (reset_i) begin
            pushed_q <= {(BITS + 1){1'b0}};
            popped_q <= {(BITS + 1){1'b0}};
            space_q <= 1'b0;
            valid_q <= 1'b0;
        end else begin
            if (push_i) pushed_q <= pushed_q + {{BITS{1'b0}}, 1'b1};
            if (advance && not_empty) popped_q <= popped_q + {{BITS{1'b0}}, 1'b1};
            space_q <= held <= MAX_HELD;
            if (advance) valid_q <= not_empty;
        end
    end

    assign space_o = space_q;
    assign valid_o = valid_q;
    assign data_o = front_q;
endmodule
`default_nettype wire
