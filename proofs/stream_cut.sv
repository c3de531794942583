// StreamCut: nothing lost, doubled, reordered; a word and its marks stand while they are stalled; two words fit inside; a word comes out in
// the next cycle; ready does not depend on the receiver in the same cycle.
module prove (
    input wire       clock_i,
    input wire       reset_i,
    input wire       valid_i,
    input wire [1:0] data_i,
    input wire       user_i,
    input wire       last_i,
    input wire       ready_i
);
    wire ready_o, valid_o, user_o, last_o;
    wire [15:0] word_o;
    wire [1:0] data_o = word_o[1:0];
    stream_cut_w16 dut (
        .clock_i(clock_i), .reset_i(reset_i), .from_valid_i(valid_i), .from_data_i({14'd0, data_i}), .from_user_i(user_i), .from_last_i(last_i),
        .from_ready_o(ready_o), .to_valid_o(valid_o), .to_data_o(word_o), .to_user_o(user_o), .to_last_o(last_o), .to_ready_i(ready_i)
    );

    wire push = valid_i && ready_o && !reset_i;
    wire pop = valid_o && ready_i && !reset_i;
    wire second_popped;
    tags tags (
        .clock_i(clock_i), .push_i(push), .push_tag_i(data_i), .pop_i(pop), .pop_tag_i(data_o),
        .lost_i(reset_i), .emptied_i(reset_i), .second_popped_o(second_popped)
    );

    reg started = 0;
    reg [1:0] inside = 0;
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || reset_i);
        // A mark is a bit that passes, like those of the word.
        assume (user_i == data_i[0] && last_i == data_i[1]);
        inside <= reset_i ? 0 : inside + push - pop;
        if (started && !reset_i) begin
            comes_out: assert (valid_o == (inside != 0));
            takes_two: assert (ready_o == (inside < 2));
            marks: assert (!valid_o || (user_o == data_o[0] && last_o == data_o[1]));
            if ($past(started && valid_o && !ready_i && !reset_i)) stands: assert (valid_o && data_o == $past(data_o));
        end
        full: cover (inside == 2 && !ready_i);
        both: cover (second_popped);
    end
endmodule
