// Four lanes of the calculator and the weight memory that they share.
//
// Each cycle the row at address_a_i is read and each lane adds weight x value_a_i to its sum; with ROWS = 2 a second DSP of each
// lane does the same for address_b_i and value_b_i. first_i starts the sums anew with this product. A cycle without work has value 0.
// Four cycles after its address a product is in its sum. copy_i, one cycle later, copies the sums to the holding registers, of which
// shift_i hands on two a cycle towards drain_*_o, and takes two from drain_*_i. Half a row is written where write_bank_i is bank_i;
// with ROWS = 2 that needs a cycle in which nothing is read.
// Images lie below `EDOF_DIR, which ends in a slash: the working directory, unless it is defined.
`ifndef EDOF_DIR
`define EDOF_DIR "./"
`endif
`default_nettype none

module edof_macc_bank #(
    parameter DEPTH = 384,
    parameter ROWS = 1,
    parameter SUM = 48,
    parameter INIT = ""
) (
    input  wire               clock_i,
    input  wire               first_i,
    input  wire        [11:0] address_a_i,
    input  wire signed [24:0] value_a_i,
    input  wire        [11:0] address_b_i,
    input  wire signed [24:0] value_b_i,
    input  wire               copy_i,
    input  wire               shift_i,
    input  wire        [47:0] drain_even_i,
    input  wire        [47:0] drain_odd_i,
    output wire        [47:0] drain_even_o,
    output wire        [47:0] drain_odd_o,
    input  wire               write_enable_i,
    input  wire        [5:0]  bank_i,
    input  wire        [5:0]  write_bank_i,
    input  wire               write_half_i,
    input  wire        [11:0] write_address_i,
    input  wire        [31:0] write_data_i
);
    localparam BITS = $clog2(DEPTH);

    (* ram_style = "block" *) reg [63:0] weights [0:DEPTH-1];
    initial if (INIT != "") $readmemh({`EDOF_DIR, INIT}, weights);

    wire write = write_enable_i && (write_bank_i == bank_i);
    wire write_low = write && !write_half_i;
    wire write_high = write && write_half_i;

    reg copy_q;
    reg shift_q;
    reg first_q1, first_q2, first_q3;
    always @(posedge clock_i) begin
        copy_q <= copy_i;
        shift_q <= shift_i;
        first_q1 <= first_i;
        first_q2 <= first_q1;
        first_q3 <= first_q2;
    end

    reg [63:0] row_a_q;
    reg signed [24:0] value_a_q;
    always @(posedge clock_i) value_a_q <= value_a_i;

    wire [63:0] row_b;
    wire signed [24:0] value_b;
    generate
        if (ROWS == 2) begin : two_ports
            // The write shares port A, so that both ports of the block RAM can read.
            wire [BITS-1:0] address_a = write ? write_address_i[BITS-1:0] : address_a_i[BITS-1:0];
            reg [63:0] row_b_q;
            reg signed [24:0] value_b_q;
            always @(posedge clock_i) begin
                if (write_low) weights[address_a][31:0] <= write_data_i;
                if (write_high) weights[address_a][63:32] <= write_data_i;
                row_a_q <= weights[address_a];
            end
            always @(posedge clock_i) begin
                row_b_q <= weights[address_b_i[BITS-1:0]];
                value_b_q <= value_b_i;
            end
            assign row_b = row_b_q;
            assign value_b = value_b_q;
        end else begin : one_port
            always @(posedge clock_i) begin
                if (write_low) weights[write_address_i[BITS-1:0]][31:0] <= write_data_i;
                if (write_high) weights[write_address_i[BITS-1:0]][63:32] <= write_data_i;
                row_a_q <= weights[address_a_i[BITS-1:0]];
            end
            assign row_b = 64'd0;
            assign value_b = 25'sd0;
        end
    endgenerate

    wire [SUM-1:0] sum [0:3];
    genvar lane;
    generate
        for (lane = 0; lane < 4; lane = lane + 1) begin : lanes
            wire signed [47:0] sum_a;
            edof_macc macc_a (
                .clock_i(clock_i),
                .first_i(first_q3),
                .weight_i(row_a_q[16*lane +: 16]),
                .value_i(value_a_q),
                .sum_o(sum_a)
            );
            if (ROWS == 2) begin : second
                wire signed [47:0] sum_b;
                edof_macc macc_b (
                    .clock_i(clock_i),
                    .first_i(first_q3),
                    .weight_i(row_b[16*lane +: 16]),
                    .value_i(value_b),
                    .sum_o(sum_b)
                );
                assign sum[lane] = sum_a[SUM-1:0] + sum_b[SUM-1:0];
            end else begin : single
                assign sum[lane] = sum_a[SUM-1:0];
            end
        end
    endgenerate

    reg [SUM-1:0] hold_q [0:3];
    always @(posedge clock_i) begin
        if (copy_q) begin
            hold_q[0] <= sum[0];
            hold_q[1] <= sum[1];
            hold_q[2] <= sum[2];
            hold_q[3] <= sum[3];
        end else if (shift_q) begin
            hold_q[0] <= hold_q[2];
            hold_q[1] <= hold_q[3];
            hold_q[2] <= drain_even_i[SUM-1:0];
            hold_q[3] <= drain_odd_i[SUM-1:0];
        end
    end

    generate
        if (SUM == 48) begin : whole
            assign drain_even_o = hold_q[0];
            assign drain_odd_o = hold_q[1];
        end else begin : extended
            assign drain_even_o = {{(48 - SUM){hold_q[0][SUM-1]}}, hold_q[0]};
            assign drain_odd_o = {{(48 - SUM){hold_q[1][SUM-1]}}, hold_q[1]};
        end
    endgenerate
endmodule

`default_nettype wire
