// The last beats of a drain, waiting for their receiver: two words, their two base words (BASE = 1), last and set.
//
// valid_o and the data stand until ready_i; room is the pusher's concern (it counts credits). 16 beats in LUT RAM.
`default_nettype none

module edof_fifo #(
    parameter BASE = 1
) (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        push_i,
    input  wire [31:0] data_i,
    input  wire [31:0] base_i,
    input  wire        last_i,
    input  wire        set_i,
    output wire        valid_o,
    input  wire        ready_i,
    output wire [31:0] data_o,
    output wire [31:0] base_o,
    output wire        last_o,
    output wire        set_o
);
    localparam WIDTH = (BASE != 0) ? 66 : 34;

    (* ram_style = "distributed" *) reg [WIDTH-1:0] memory [0:15];
    reg [4:0] pushed_q;
    reg [4:0] popped_q;
    wire [WIDTH-1:0] front = memory[popped_q[3:0]];

    assign valid_o = pushed_q != popped_q;
    assign {last_o, set_o, data_o} = front[33:0];

    always @(posedge clock_i) begin
        if (reset_i) begin
            pushed_q <= 5'd0;
            popped_q <= 5'd0;
        end else begin
            if (push_i) pushed_q <= pushed_q + 5'd1;
            if (valid_o && ready_i) popped_q <= popped_q + 5'd1;
        end
    end

    generate
        if (BASE != 0) begin : with_base
            assign base_o = front[65:34];
            always @(posedge clock_i) if (push_i) memory[pushed_q[3:0]] <= {base_i, last_i, set_i, data_i};
        end else begin : without_base
            assign base_o = 32'd0;
            always @(posedge clock_i) if (push_i) memory[pushed_q[3:0]] <= {last_i, set_i, data_i};
        end
    endgenerate
endmodule

`default_nettype wire
