// data_o is data_i of CYCLES cycles ago. The last register is kept: tools neither merge it with registers of the same value nor make it
// part of a shift register in LUTs, whose output is four times as slow. With CYCLES 0 there is no register, and data_o is 0.
`ifndef EDOF_KEEP_IN_YOSYS
`ifdef YOSYS
`define EDOF_KEEP_IN_YOSYS (* keep *)
`else
`define EDOF_KEEP_IN_YOSYS
`endif
`endif
`default_nettype none
module edof_delay #(
    parameter WIDTH = 1,
    parameter CYCLES = 1
) (
    input  wire             clock_i,
    input  wire [WIDTH-1:0] data_i,
    output wire [WIDTH-1:0] data_o
);
    generate
        if (CYCLES == 0) begin : none
            wire unused = ^{clock_i, data_i};
            assign data_o = {WIDTH{1'b0}};
        end else begin : some
            wire [WIDTH-1:0] tail;
            if (CYCLES == 1) begin : one
                assign tail = data_i;
            end else begin : more
                reg [WIDTH-1:0] row_q [0:CYCLES-2];
                integer i;
                always @(posedge clock_i) begin
                    row_q[0] <= data_i;
                    for (i = 1; i < CYCLES - 1; i = i + 1) row_q[i] <= row_q[i-1];
                end
                assign tail = row_q[CYCLES-2];
            end

            (* keep = "true", shreg_extract = "no" *) reg [WIDTH-1:0] last_q;
            `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) last_q <= tail;
            assign data_o = last_q;
        end
    endgenerate
endmodule
`default_nettype wire
