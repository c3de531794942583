// The calculator between a chain of registers that feeds its inputs and one that folds its outputs, with two data pins: to place and route it by
// itself. Windows are of set 0.
`default_nettype none

module chain_top (
    input  wire clock,
    input  wire in,
    output wire out
);
    reg [101:0] fed_q;
    wire [68:0] given;
    reg [68:0] taken_q, folded_q;
    always @(posedge clock) begin
        fed_q <= {fed_q[100:0], in};
        taken_q <= given;
        folded_q <= {folded_q[67:0], 1'b0} ^ taken_q;
    end
    assign out = folded_q[68];

    chain chain (
        .clock_i(clock),
        .reset_i(fed_q[0]),
        .flush_i(fed_q[1]),
        .window_valid_i(fed_q[2]),
        .window_ready_o(given[0]),
        .window_data_i(fed_q[34:3]),
        .window_last_i(fed_q[35]),
        .window_set_i(1'b0),
        .patch_valid_o(given[1]),
        .patch_ready_i(fed_q[36]),
        .patch_data_o(given[33:2]),
        .patch_last_o(given[34]),
        .patch_set_o(given[35]),
        .write_valid_i(fed_q[37]),
        .write_address_i(fed_q[62:38]),
        .write_data_i(fed_q[94:63]),
        .status_address_i(fed_q[101:95]),
        .status_o(given[67:36]),
        .window_fault_o(given[68])
    );
endmodule

`default_nettype wire
