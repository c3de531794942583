// edof_fifo: nothing lost, doubled, reordered; never over credit; a word stands while it is stalled; every word comes out.
module prove #(
    parameter DEPTH = 4
) (
    input wire       clock_i,
    input wire       reset_i,
    input wire       push_i,
    input wire [1:0] data_i,
    input wire       ready_i
);
    wire valid_o;
    wire [1:0] data_o;
    edof_fifo #(.WIDTH(2), .DEPTH(DEPTH)) dut (
        .clock_i(clock_i), .reset_i(reset_i), .push_i(push_i), .data_i(data_i),
        .valid_o(valid_o), .ready_i(ready_i), .data_o(data_o)
    );

    wire push = push_i && !reset_i;
    wire pop = valid_o && ready_i && !reset_i;
    wire second_popped;
    tags tags (
        .clock_i(clock_i), .push_i(push), .push_tag_i(data_i), .pop_i(pop), .pop_tag_i(data_o),
        .lost_i(reset_i), .emptied_i(reset_i), .second_popped_o(second_popped)
    );

    reg started = 0;
    reg [$clog2(DEPTH)+1:0] inside = 0;
    reg [1:0] waited = 0;
    always @(posedge clock_i) begin
        started <= 1;
        // The producer counts credits: DEPTH words. A pushed word is not pushed in reset.
        assume (started || reset_i);
        assume (!push_i || (inside != DEPTH && !reset_i));
        inside <= reset_i ? 0 : inside + push - pop;
        waited <= (reset_i || inside == 0 || valid_o) ? 0 : waited + 1;
        if (started && !reset_i) begin
            never_empty: assert (!pop || inside != 0);
            never_over: assert (inside <= DEPTH);
            comes_out: assert (waited < 2);
            if ($past(started && valid_o && !ready_i && !reset_i)) begin
                stands: assert (valid_o && data_o == $past(data_o));
            end
        end
        full: cover (inside == DEPTH && valid_o && !ready_i);
        both: cover (second_popped);
    end
endmodule
