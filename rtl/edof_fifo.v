// A FIFO: DEPTH words in LUT RAM, a power of two, and one word in the output register. With DEPTH 0 there is no memory, and the output
// is 0.
//
// A word is valid on the output two cycles after push_i at the earliest, and held until ready_i. The producer must ensure free space (it
// counts credits). The pointers are separate registers, so that they drive only the loads of this FIFO.
`ifndef EDOF_KEEP_IN_YOSYS
`ifdef YOSYS
`define EDOF_KEEP_IN_YOSYS (* keep *)
`else
`define EDOF_KEEP_IN_YOSYS
`endif
`endif
`default_nettype none
module edof_fifo #(
    parameter WIDTH = 34,
    parameter DEPTH = 128
) (
    input  wire             clock_i,
    input  wire             reset_i,
    input  wire             push_i,
    input  wire [WIDTH-1:0] data_i,
    output wire             valid_o,
    input  wire             ready_i,
    output wire [WIDTH-1:0] data_o
);
    generate
        if (DEPTH == 0) begin : none
            wire unused = ^{clock_i, reset_i, push_i, data_i, ready_i};
            assign valid_o = 1'b0;
            assign data_o = {WIDTH{1'b0}};
        end else begin : some
            localparam BITS = $clog2(DEPTH);

            (* ram_style = "distributed" *) reg [WIDTH-1:0] memory [0:DEPTH-1];
            (* keep = "true" *) reg [BITS:0] pushed_q;
            (* keep = "true" *) reg [BITS:0] popped_q;
            (* keep = "true" *) reg valid_q;
            reg [WIDTH-1:0] front_q;

            wire advance = !valid_q || ready_i;
            wire not_empty = pushed_q != popped_q;

            always @(posedge clock_i) if (push_i) memory[pushed_q[BITS-1:0]] <= data_i;

            // The word is undefined in reset and in the cycle after it. With three inputs the enable is too large for Yosys to merge it,
            // and ready_i with it, into the logic before each bit.
            (* keep = "true" *) reg reset_q;
            `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) reset_q <= reset_i;
            always @(posedge clock_i) if (advance || reset_q) front_q <= memory[popped_q[BITS-1:0]];

            `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) begin
                if (reset_i) pushed_q <= {(BITS + 1){1'b0}};
                else if (push_i) pushed_q <= pushed_q + {{BITS{1'b0}}, 1'b1};
            end

            `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) begin
                if (reset_i) popped_q <= {(BITS + 1){1'b0}};
                else if (advance && not_empty) popped_q <= popped_q + {{BITS{1'b0}}, 1'b1};
            end

            `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) begin
                if (reset_i) valid_q <= 1'b0;
                else if (advance) valid_q <= not_empty;
            end

            assign valid_o = valid_q;
            assign data_o = front_q;
        end
    endgenerate
endmodule
`default_nettype wire
