// The sum of four numbers of 48 bits, four cycles later.
`default_nettype none
module edof_add4 (
    input  wire         clock_i,
    input  wire [191:0] rows_i,
    output wire [47:0]  sum_o
);
    wire [47:0] first_two;
    wire [47:0] last_two;
    edof_add first (.clock_i(clock_i), .a_i(rows_i[47:0]), .b_i(rows_i[95:48]), .sum_o(first_two));
    edof_add last (.clock_i(clock_i), .a_i(rows_i[143:96]), .b_i(rows_i[191:144]), .sum_o(last_two));
    edof_add all (.clock_i(clock_i), .a_i(first_two), .b_i(last_two), .sum_o(sum_o));
endmodule
`default_nettype wire
