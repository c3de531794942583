// window_reorder, whatever the host chooses at whatever moment: all windows of a frame are for one bank, that which was chosen when its first
// beat was made. (The bit travels with its beat to the output through edof_delay and edof_queue, which have proofs of their own.)
module prove (
    input wire clock_i,
    input wire reset_i,
    input wire pixels_valid_i,
    input wire set_i,
    input wire out_ready_i
);
    window_reorder dut (
        .clock_i(clock_i), .reset_i(reset_i), .pixels_valid_i(pixels_valid_i), .pixels_data_i(16'd0), .set_i(set_i), .out_ready_i(out_ready_i)
    );
    (* hierconn *) wire \dut.frame_ends ;
    (* hierconn *) wire [2:0] \dut.marks_1_q ;

    reg started = 0, was_reset = 1, ended = 1, inside = 0, now_set = 0;
    reg [2:0] chosen = 0;
    // A beat was made in the cycle before.
    wire made = \dut.marks_1_q [0];
    wire set = \dut.marks_1_q [2];
    always @(posedge clock_i) begin
        started <= 1;
        was_reset <= reset_i;
        assume (started || reset_i);
        chosen <= {chosen[1:0], set_i};
        ended <= !reset_i && \dut.frame_ends ;
        if (reset_i) inside <= 0;
        else if (made) inside <= !ended;
        if (made) now_set <= set;
        if (started && !was_reset && !reset_i && made && inside) one_bank: assert (set == now_set);
        if (started && !was_reset && !reset_i && made && !inside) the_chosen: assert (set == chosen[1]);
        swapped: cover (started && made && inside && now_set && set != chosen[0]);
    end
endmodule
