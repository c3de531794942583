// The sum of two numbers of 48 bits, two cycles later: the lower half first, so that no carry runs through more than 24 bits.
`ifndef EDOF_KEEP_IN_YOSYS
`ifdef YOSYS
`define EDOF_KEEP_IN_YOSYS (* keep *)
`else
`define EDOF_KEEP_IN_YOSYS
`endif
`endif
`default_nettype none
module edof_add (
    input  wire        clock_i,
    input  wire [47:0] a_i,
    input  wire [47:0] b_i,
    output wire [47:0] sum_o
);
    reg [24:0] low_q;
    reg [23:0] high_a_q;
    reg [23:0] high_b_q;
    // Where one number is 0 it would else be a shift register in LUTs, whose output is slow.
    (* shreg_extract = "no" *) reg [47:0] sum_q;

    always @(posedge clock_i) begin
        low_q <= {1'b0, a_i[23:0]} + {1'b0, b_i[23:0]};
        high_a_q <= a_i[47:24];
        high_b_q <= b_i[47:24];
    end
    `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) begin
        sum_q[23:0] <= low_q[23:0];
        sum_q[47:24] <= high_a_q + high_b_q + {23'd0, low_q[24]};
    end

    assign sum_o = sum_q;
endmodule
`default_nettype wire
