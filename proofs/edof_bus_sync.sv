// edof_bus_sync, two free clocks, resets at any moment: no phantom word, nothing doubled, reordered, or lost but by a reset; the word that
// crosses stands while it is sampled.
module prove (
    input wire       from_reset_i,
    input wire       valid_i,
    input wire [1:0] word_i,
    input wire       to_reset_i
);
    (* gclk *) wire gclk;
    wire from_clock, to_clock, from_rises, to_rises, from_on, to_on, round;
    two_clocks clocks (
        .from_reset_i(from_reset_i), .to_reset_i(to_reset_i), .from_clock_o(from_clock), .to_clock_o(to_clock),
        .from_rises_o(from_rises), .to_rises_o(to_rises), .from_on_o(from_on), .to_on_o(to_on), .round_o(round)
    );
    wire ready, valid;
    wire [1:0] word;
    edof_bus_sync #(.WIDTH(2)) dut (
        .from_clock_i(from_clock), .from_reset_i(from_reset_i), .valid_i(valid_i), .ready_o(ready), .word_i(word_i),
        .to_clock_i(to_clock), .to_reset_i(to_reset_i), .valid_o(valid), .word_o(word)
    );
    (* hierconn *) wire [1:0] \dut.held_q ;
    (* hierconn *) wire \dut.arrival ;
    (* hierconn *) wire \dut.to_open ;

    reg push_was = 0, pop_was = 0, from_reset_was = 0, to_reset_was = 0, arrives_was = 0, open_was = 0;
    reg [1:0] push_tag = 0, pop_tag = 0, held_was = 0, held_at_edge = 0;
    wire second_popped;
    tags tags (
        .clock_i(1'b0), .push_i(from_rises && push_was && from_on), .push_tag_i(push_tag),
        .pop_i(to_rises && pop_was && to_on), .pop_tag_i(pop_tag),
        .lost_i((from_rises && from_reset_was) || (to_rises && to_reset_was) || (from_rises && push_was && !open_was)),
        .emptied_i(to_rises && to_reset_was),
        .second_popped_o(second_popped)
    );
    always @(posedge gclk) begin
        push_was <= valid_i && ready && !from_reset_i;
        push_tag <= word_i;
        open_was <= \dut.to_open ;
        pop_was <= valid && !to_reset_i;
        pop_tag <= word;
        from_reset_was <= from_reset_i;
        to_reset_was <= to_reset_i;
        // From the edge before the one that samples it to that one.
        arrives_was <= \dut.arrival ;
        held_was <= \dut.held_q ;
        if (to_rises) held_at_edge <= held_was;
        if (to_rises && to_on && arrives_was) held_stands: assert (held_was == held_at_edge);
        both: cover (second_popped);
    end
endmodule
