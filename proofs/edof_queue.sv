// edof_queue: nothing lost, doubled, reordered, while the producer continues for at most SLACK words after space_o has fallen.
module prove #(
    parameter DEPTH = 8,
    parameter SLACK = 3
) (
    input wire       clock_i,
    input wire       reset_i,
    input wire       push_i,
    input wire [1:0] data_i,
    input wire       ready_i
);
    wire space_o, valid_o;
    wire [1:0] data_o;
    edof_queue #(.WIDTH(2), .DEPTH(DEPTH), .SLACK(SLACK)) dut (
        .clock_i(clock_i), .reset_i(reset_i), .push_i(push_i), .data_i(data_i), .space_o(space_o),
        .valid_o(valid_o), .ready_i(ready_i), .data_o(data_o)
    );

    wire push = push_i && !reset_i;
    wire pop = valid_o && ready_i && !reset_i;
    wire second_popped;
    tags tags (
        .clock_i(clock_i), .push_i(push), .push_tag_i(data_i), .pop_i(pop), .pop_tag_i(data_o),
        .lost_i(reset_i), .emptied_i(reset_i), .second_popped_o(second_popped)
    );

    // A pipeline of SLACK - 2 stages between taking in and pushing, as the module's head says: it takes in only while space_o.
    localparam STAGES = SLACK - 2;
    reg [STAGES:0] stages = 0;
    wire [STAGES:0] line = {stages[STAGES-1:0], 1'b0};
    (* anyseq *) wire takes;
    wire [STAGES:0] now = line | {{STAGES{1'b0}}, takes && space_o};

    reg started = 0;
    reg [$clog2(DEPTH)+1:0] inside = 0;
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || reset_i);
        stages <= reset_i ? 0 : now;
        assume (push_i == (stages[STAGES-1] && !reset_i));
        inside <= reset_i ? 0 : inside + push - pop;
        if (started && !reset_i) begin
            never_over: assert (inside <= DEPTH + 1);
            if ($past(started && valid_o && !ready_i && !reset_i)) begin
                stands: assert (valid_o && data_o == $past(data_o));
            end
        end
        full: cover (started && inside == DEPTH + 1 && valid_o);
        both: cover (second_popped);
    end
endmodule
