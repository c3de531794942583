// When sums are copied out of the multipliers, and when the copies are taken, two a cycle.
// A pass's sums stand ready seven cycles after its last step and are copied once the drain of the pass before is over. A drain begins
// when all that it takes has room in the FIFO, and then takes in every cycle. Two passes may be between their start and their release:
// the next one's sums come so late that a drain may still have some takes to go. Copy and take leave a cycle after they are decided.
//
// From crates/edof-hdl/src/blocks/drain.rs (Drain).
`default_nettype none

module drain_3 (
    input  wire       clock_i,
    input  wire       reset_i,
    input  wire       begins_i,
    input  wire       pass_issued_i,
    input  wire       set_i,
    input  wire       returned_i,
    output wire       may_start_o,
    output wire       copy_o,
    output wire       take_o,
    output wire [7:0] beat_o,
    output wire       last_o,
    output wire       taken_set_o
);

    localparam [7:0] BEFORE_LAST_TAKE = 8'hf;
    localparam [7:0] RELEASE_AT = 8'h7;
    localparam [7:0] LAST_BEAT = 8'h3f;
    localparam [7:0] ALL_CREDITS = 8'h80;
    localparam [7:0] WANTED_CREDITS = 8'h10;

    wire copies;
    wire takes;
    wire releases;
    reg  [1:0] passed;
    wire [1:0] on_the_way_later;
    reg  sum_ready_q;
    reg  sum_ready_d;
    reg  sum_set_q;
    reg  sum_set_d;
    reg  [1:0] open_q;
    reg  [1:0] open_d;
    reg  busy_q;
    reg  busy_d;
    reg  loaded_q;
    reg  loaded_d;
    reg  on_q;
    reg  on_d;
    reg  [7:0] rest_q;
    reg  [7:0] rest_d;
    reg  at_last_q;
    reg  at_last_d;
    reg  [7:0] beat_q_q;
    reg  [7:0] beat_q_d;
    reg  drain_set_q;
    reg  drain_set_d;
    reg  [7:0] credits_q;
    reg  [7:0] credits_d;
    reg  enough_q;
    wire enough_d;
    reg  copy_q_q;
    reg  take_q_q;
    reg  [7:0] taken_beat_q;
    reg  last_q_q;
    wire last_q_d;
    reg  set_q_q;

    edof_delay #(
        .WIDTH(2),
        .CYCLES(6)
    ) on_the_way (
        .clock_i(clock_i),
        .now_i(passed),
        .later_o(on_the_way_later)
    );

    always @* begin
        passed = 2'd0;
        if (pass_issued_i && set_i) begin
            passed = 2'd3;
        end else if (pass_issued_i) begin
            passed = 2'd1;
        end
    end

    assign copies = sum_ready_q && (!busy_q);
    assign takes = on_q || (loaded_q && enough_q);
    assign releases = takes && (rest_q == RELEASE_AT);

    always @* begin
        sum_ready_d = sum_ready_q;
        sum_set_d = sum_set_q;
        open_d = open_q;
        busy_d = busy_q;
        loaded_d = loaded_q;
        on_d = on_q;
        rest_d = rest_q;
        at_last_d = at_last_q;
        beat_q_d = beat_q_q;
        drain_set_d = drain_set_q;
        credits_d = credits_q;
        if (copies) begin
            sum_ready_d = 1'b0;
            busy_d = 1'b1;
            loaded_d = 1'b1;
            rest_d = BEFORE_LAST_TAKE;
            at_last_d = !(|BEFORE_LAST_TAKE);
            drain_set_d = sum_set_q;
        end
        if (on_the_way_later[0]) begin
            sum_ready_d = 1'b1;
            sum_set_d = on_the_way_later[1];
        end
        if (takes) begin
            loaded_d = 1'b0;
            on_d = 1'b1;
            rest_d = rest_q - 8'd1;
            at_last_d = rest_q == 8'd1;
            if (at_last_q) begin
                on_d = 1'b0;
                busy_d = 1'b0;
            end
            beat_q_d = beat_q_q + 8'd1;
            if (beat_q_q == LAST_BEAT) begin
                beat_q_d = 8'd0;
            end
        end
        if (begins_i && (!releases)) begin
            open_d = open_q + 2'd1;
        end else if (releases && (!begins_i)) begin
            open_d = open_q - 2'd1;
        end
        if (takes && (!returned_i)) begin
            credits_d = credits_q - 8'd1;
        end else if (returned_i && (!takes)) begin
            credits_d = credits_q + 8'd1;
        end
        if (reset_i) begin
            sum_ready_d = 1'b0;
            open_d = 2'd0;
            busy_d = 1'b0;
            loaded_d = 1'b0;
            on_d = 1'b0;
            beat_q_d = 8'd0;
            credits_d = ALL_CREDITS;
        end
    end

    assign enough_d = credits_q >= WANTED_CREDITS;
    assign may_start_o = !open_q[1];
    assign last_q_d = beat_q_q == LAST_BEAT;
    assign copy_o = copy_q_q;
    assign take_o = take_q_q;
    assign beat_o = taken_beat_q;
    assign last_o = last_q_q;
    assign taken_set_o = set_q_q;

    always @(posedge clock_i) begin
        sum_ready_q <= sum_ready_d;
        sum_set_q <= sum_set_d;
        open_q <= open_d;
        busy_q <= busy_d;
        loaded_q <= loaded_d;
        on_q <= on_d;
        rest_q <= rest_d;
        at_last_q <= at_last_d;
        beat_q_q <= beat_q_d;
        drain_set_q <= drain_set_d;
        credits_q <= credits_d;
        enough_q <= enough_d;
        copy_q_q <= copies;
        take_q_q <= takes;
        taken_beat_q <= beat_q_q;
        last_q_q <= last_q_d;
        set_q_q <= drain_set_q;
    end
endmodule

`default_nettype wire
