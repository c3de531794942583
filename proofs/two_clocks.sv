// Two clocks without any relation: in each step of time each may rise, fall or stand, for ever if the prover likes.
//
// rises_o is high in the step in which the clock is high for the first time; registers hold their new values from that step on, and took
// what stood in the step before. Both sides are in reset for the first edges after power-up, as edof_reset_sync sees to; registers
// without a start-up value hold anything until then. A round ends when both have risen since the last one ended.
module two_clocks (
    input  wire from_reset_i,
    input  wire to_reset_i,
    output wire from_clock_o,
    output wire to_clock_o,
    output wire from_rises_o,
    output wire to_rises_o,
    output wire from_on_o,
    output wire to_on_o,
    output wire round_o
);
    (* gclk *) wire gclk;
    (* anyseq *) wire from_clock;
    (* anyseq *) wire to_clock;
    assign from_clock_o = from_clock;
    assign to_clock_o = to_clock;
    reg [2:0] from_edges = 0, to_edges = 0;
    assign from_on_o = from_edges[2];
    assign to_on_o = to_edges[2];
    reg started = 0, from_was = 0, to_was = 0, from_rose = 0, to_rose = 0;
    assign from_rises_o = started && from_clock && !from_was;
    assign to_rises_o = started && to_clock && !to_was;
    assign round_o = (from_rose || from_rises_o) && (to_rose || to_rises_o);
    always @(posedge gclk) begin
        started <= 1;
        from_was <= from_clock;
        to_was <= to_clock;
        from_rose <= !round_o && (from_rose || from_rises_o);
        to_rose <= !round_o && (to_rose || to_rises_o);
        if (from_rises_o && !from_on_o) from_edges <= from_edges + 1;
        if (to_rises_o && !to_on_o) to_edges <= to_edges + 1;
        assume (from_on_o || from_reset_i);
        assume (to_on_o || to_reset_i);
`ifdef COVER
        // One way to get there is enough, and soon found.
        assume (from_clock == (started && !from_was) && to_clock == from_clock);
        assume (from_reset_i == !from_on_o && to_reset_i == !to_on_o);
`endif
        assume (started || (!from_clock && !to_clock));
    end
endmodule
