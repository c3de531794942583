// What a stream of words must keep, seen from outside: two words are marked among all that pass.
//
// The prover draws when they are pushed. A word's tag is 0 except for these two, 1 and 2 in the order of pushing, so that every word is a
// marked one in some run. Circuits that carry a word do not look at it, so two bits stand for any width.
//
// With MANY_CLOCKS defined a step is one of the prover's time, else a cycle. Events are for one step each: pushed and popped with the word's tag; lost: what is inside or comes in may be dropped (a reset of either
// side, or a receiver that has not opened again);
// emptied: what is inside must be dropped (a reset of the reader).
module tags (
    input wire       clock_i,
    input wire       push_i,
    input wire [1:0] push_tag_i,
    input wire       pop_i,
    input wire [1:0] pop_tag_i,
    input wire       lost_i,
    input wire       emptied_i,
    output wire      second_popped_o
);
`ifdef MANY_CLOCKS
    (* gclk *) wire clock;
`else
    wire clock = clock_i;
`endif
    reg first_pushed = 0, second_pushed = 0, first_popped = 0, second_popped = 0;
    reg lost_since_first = 0, first_emptied = 0, second_emptied = 0;
    assign second_popped_o = second_popped;

    always @(posedge clock) begin
        if (push_i) begin
            assume (push_tag_i != 3);
            assume (push_tag_i != 1 || !first_pushed);
            assume (push_tag_i != 2 || (first_pushed && !second_pushed));
            if (push_tag_i == 1) first_pushed <= 1;
            if (push_tag_i == 2) second_pushed <= 1;
        end
        if (pop_i) begin
            if (pop_tag_i == 1) first_popped <= 1;
            if (pop_tag_i == 2) second_popped <= 1;
        end
        if (lost_i && (first_pushed || (push_i && push_tag_i == 1))) lost_since_first <= 1;
        if (emptied_i && first_pushed) first_emptied <= 1;
        if (emptied_i && second_pushed) second_emptied <= 1;

        if (pop_i) begin
            // No phantom, nothing doubled, nothing after it was dropped.
            no_third: assert (pop_tag_i != 3);
            first_once: assert (pop_tag_i != 1 || (first_pushed && !first_popped && !first_emptied));
            second_once: assert (pop_tag_i != 2 || (second_pushed && !second_popped && !second_emptied));
            // In order.
            in_order: assert (pop_tag_i != 1 || !second_popped);
            // Nothing lost: the second comes after the first, unless a reset is between.
            none_lost: assert (pop_tag_i != 2 || first_popped || lost_since_first);
        end
    end
endmodule
