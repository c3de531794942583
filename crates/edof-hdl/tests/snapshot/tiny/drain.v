// When sums are copied out of the multipliers, and when the copies are taken, two a cycle.
// A pass's sums stand ready five cycles after its last step and are copied once the drain of the pass before is over.
// Credits bound what is on the way to the FIFO. The next pass may start unless its sums could meet those not yet copied.
//
// From crates/edof-hdl/src/blocks/drain.rs (Drain).
`default_nettype none

module drain #(
    parameter [7:0] LAST_TAKE = 8'd7,
    parameter [7:0] LAST_BEAT = 8'd7
) (
    input  wire       clock_i,       // Clock.
    input  wire       reset_i,       // Forgets everything; held for 16 cycles or more.
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

    localparam [4:0] ALL_CREDITS = 5'd16;

    wire arrives;
    wire copies;
    wire takes;
    wire [1:0] passed;
    wire [1:0] on_the_way_later;
    reg  sum_ready_q;
    reg  sum_ready_d;
    reg  sum_set_q;
    wire sum_set_d;
    reg  [1:0] outstanding_q;
    reg  [1:0] outstanding_d;
    reg  active_q;
    reg  active_d;
    reg  [7:0] taken_q;
    wire [7:0] taken_d;
    reg  [7:0] beat_q;
    reg  [7:0] beat_d;
    reg  drain_set_q;
    wire drain_set_d;
    reg  [4:0] credits_q;
    reg  [4:0] credits_d;

    delay_w2_n4 on_the_way (
        .clock_i(clock_i),
        .now_i(passed),
        .later_o(on_the_way_later)
    );

    assign passed = (pass_issued_i && set_i) ? 2'd3 : (pass_issued_i ? 2'd1 : 2'd0);
    assign arrives = on_the_way_later[0];
    assign copies = sum_ready_q && !active_q;
    assign takes = active_q && (|credits_q);

    always @* begin
        sum_ready_d = sum_ready_q;
        if (copies) begin
            sum_ready_d = 1'b0;
        end
        if (arrives) begin
            sum_ready_d = 1'b1;
        end
        if (reset_i) begin
            sum_ready_d = 1'b0;
        end
    end

    assign sum_set_d = arrives ? on_the_way_later[1] : sum_set_q;

    always @* begin
        outstanding_d = outstanding_q;
        if (pass_issued_i && !copies) begin
            outstanding_d = outstanding_q + 2'd1;
        end else if (copies && !pass_issued_i) begin
            outstanding_d = outstanding_q - 2'd1;
        end
        if (reset_i) begin
            outstanding_d = 2'd0;
        end
    end

    always @* begin
        active_d = active_q;
        if (copies) begin
            active_d = 1'b1;
        end
        if (takes) begin
            if (taken_q == LAST_TAKE) begin
                active_d = 1'b0;
            end
        end
        if (reset_i) begin
            active_d = 1'b0;
        end
    end

    assign taken_d = takes ? (taken_q + 8'd1) : (copies ? 8'd0 : taken_q);

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

    assign drain_set_d = copies ? sum_set_q : drain_set_q;

    always @* begin
        credits_d = credits_q;
        if (takes && !returned_i) begin
            credits_d = credits_q - 5'd1;
        end else if (returned_i && !takes) begin
            credits_d = credits_q + 5'd1;
        end
        if (reset_i) begin
            credits_d = ALL_CREDITS;
        end
    end

    assign may_start_o = (outstanding_q == 2'd0) || ((outstanding_q == 2'd1) && !active_q);
    assign copy_o = copies;
    assign take_o = takes;
    assign beat_o = beat_q;
    assign last_o = beat_q == LAST_BEAT;
    assign taken_set_o = drain_set_q;

    always @(posedge clock_i) begin
        sum_ready_q <= sum_ready_d;
        sum_set_q <= sum_set_d;
        outstanding_q <= outstanding_d;
        active_q <= active_d;
        taken_q <= taken_d;
        beat_q <= beat_d;
        drain_set_q <= drain_set_d;
        credits_q <= credits_d;
    end
endmodule

`default_nettype wire
