// When sums are copied out of the multipliers, and when the copies are taken, two a cycle.
// A pass's sums stand ready seven cycles after its last step and are copied with the last take of the drain before, or later. A drain
// begins when all that it takes has room in the FIFO, and then takes in every cycle, two times at least. Two passes may be between
// their start and their release: the next one's sums come so late that a drain may still have some takes to go.
// Copy and take leave a cycle after they are decided.
//
// From crates/edof-hdl/src/blocks/drain.rs (Drain).
`default_nettype none

module drain #(
    parameter [7:0] BEFORE_LAST_TAKE = 8'd7,
    parameter [7:0] RELEASE_AT = 8'd7,
    parameter [7:0] LAST_BEAT = 8'd7,
    parameter [7:0] WANTED_CREDITS = 8'd8
) (
    input  wire       clock_i,       // Clock.
    input  wire       reset_i,       // Forgets everything; held for 48 cycles or more.
    input  wire       begins_i,      // A pass begins.
    input  wire       pass_issued_i, // The last step of a pass is issued.
    input  wire       set_i,         // Its vector's set.
    input  wire       returned_i,    // A beat has left the stage.
    output wire       may_start_o,   // Whether the next pass may begin.
    output wire       copy_o,        // Copies the sums of a pass.
    output wire       take_o,        // Takes the next two sums.
    output wire [7:0] beat_o,        // Which two of the vector they are.
    output wire       last_o,        // Whether they are its last.
    output wire       taken_set_o    // Its set.
);

    localparam [7:0] ALL_CREDITS = 8'd128;

    wire copies, takes, releases;
    wire [1:0] passed, on_the_way_later;
    reg  sum_ready_q, sum_ready_d, sum_set_q;
    reg  [1:0] open_q, open_d;
    reg  busy_q, busy_d, loaded_q, loaded_d, on_q, on_d;
    reg  [7:0] rest_q;
    reg  at_last_q;
    reg  [7:0] beat_q, beat_d;
    reg  drain_set_q;
    reg  [7:0] credits_q, credits_d;
    reg  enough_q, copy_q, take_q;
    reg  [7:0] taken_beat_q;
    reg  last_q, set_q;

    edof_delay #(.WIDTH(2), .CYCLES(6)) on_the_way (
        .clock_i(clock_i), .now_i(passed), .later_o(on_the_way_later)
    );

    assign passed = (pass_issued_i && set_i) ? 2'd3 : (pass_issued_i ? 2'd1 : 2'd0);
    assign copies = sum_ready_q && (!busy_q || (on_q && at_last_q));
    assign takes = on_q || (loaded_q && enough_q);
    assign releases = takes && (rest_q == RELEASE_AT);

    always @* begin
        sum_ready_d = sum_ready_q;
        if (copies) begin
            sum_ready_d = 1'b0;
        end
        if (on_the_way_later[0]) begin
            sum_ready_d = 1'b1;
        end
        if (reset_i) begin
            sum_ready_d = 1'b0;
        end
    end

    always @* begin
        open_d = open_q;
        if (begins_i && !releases) begin
            open_d = open_q + 2'd1;
        end else if (releases && !begins_i) begin
            open_d = open_q - 2'd1;
        end
        if (reset_i) begin
            open_d = 2'd0;
        end
    end

    always @* begin
        busy_d = busy_q;
        if (takes) begin
            if (at_last_q) begin
                busy_d = 1'b0;
            end
        end
        if (copies) begin
            busy_d = 1'b1;
        end
        if (reset_i) begin
            busy_d = 1'b0;
        end
    end

    always @* begin
        loaded_d = loaded_q;
        if (takes) begin
            loaded_d = 1'b0;
        end
        if (copies) begin
            loaded_d = 1'b1;
        end
        if (reset_i) begin
            loaded_d = 1'b0;
        end
    end

    always @* begin
        on_d = on_q;
        if (takes) begin
            on_d = 1'b1;
            if (at_last_q) begin
                on_d = 1'b0;
            end
        end
        if (reset_i) begin
            on_d = 1'b0;
        end
    end

    always @* begin
        beat_d = beat_q;
        if (takes) begin
            beat_d = beat_q + 8'd1;
            if (beat_q == LAST_BEAT) begin
                beat_d = 8'd0;
            end
        end
        if (reset_i) begin
            beat_d = 8'd0;
        end
    end

    always @* begin
        credits_d = credits_q;
        if (takes && !returned_i) begin
            credits_d = credits_q - 8'd1;
        end else if (returned_i && !takes) begin
            credits_d = credits_q + 8'd1;
        end
        if (reset_i) begin
            credits_d = ALL_CREDITS;
        end
    end

    assign may_start_o = !open_q[1];
    assign copy_o = copy_q;
    assign take_o = take_q;
    assign beat_o = taken_beat_q;
    assign last_o = last_q;
    assign taken_set_o = set_q;

    always @(posedge clock_i) begin
        sum_ready_q <= sum_ready_d;
        sum_set_q <= on_the_way_later[0] ? on_the_way_later[1] : sum_set_q;
        open_q <= open_d;
        busy_q <= busy_d;
        loaded_q <= loaded_d;
        on_q <= on_d;
        rest_q <= copies ? BEFORE_LAST_TAKE : (takes ? (rest_q - 8'd1) : rest_q);
        at_last_q <= copies ? (!(|BEFORE_LAST_TAKE)) : (takes ? (rest_q == 8'd1) : at_last_q);
        beat_q <= beat_d;
        drain_set_q <= copies ? sum_set_q : drain_set_q;
        credits_q <= credits_d;
        enough_q <= (credits_q > WANTED_CREDITS) || ((credits_q == WANTED_CREDITS) && !takes);
        copy_q <= copies;
        take_q <= takes;
        taken_beat_q <= beat_q;
        last_q <= beat_q == LAST_BEAT;
        set_q <= drain_set_q;
    end
endmodule

`default_nettype wire
