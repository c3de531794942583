// When sums are copied out of the multipliers, and when the copies are taken, two a cycle.
// A pass's sums stand ready five cycles after its last step and are copied once the drain of the pass before is over.
// Credits bound what is on the way to the FIFO. The next pass may start unless its sums could meet those not yet copied.
//
// From crates/edof-hdl/src/blocks/drain.rs (Drain).
`default_nettype none

module drain_3 (
    input  wire       clock_i,
    input  wire       reset_i,
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

    localparam [7:0] LAST_TAKE = 8'hf;
    localparam [7:0] LAST_BEAT = 8'h3f;
    localparam [4:0] ALL_CREDITS = 5'h10;

    wire arrives;
    wire copies;
    wire takes;
    reg  [1:0] passed;
    wire [1:0] on_the_way_later;
    reg  sum_ready_q;
    reg  sum_ready_d;
    reg  sum_set_q;
    reg  sum_set_d;
    reg  [1:0] outstanding_q;
    reg  [1:0] outstanding_d;
    reg  active_q;
    reg  active_d;
    reg  [7:0] taken_q;
    reg  [7:0] taken_d;
    reg  [7:0] beat_q_q;
    reg  [7:0] beat_q_d;
    reg  drain_set_q;
    reg  drain_set_d;
    reg  [4:0] credits_q;
    reg  [4:0] credits_d;

    delay on_the_way (
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

    assign arrives = on_the_way_later[0];
    assign copies = sum_ready_q && (!active_q);
    assign takes = active_q && (|credits_q);

    always @* begin
        sum_ready_d = sum_ready_q;
        sum_set_d = sum_set_q;
        outstanding_d = outstanding_q;
        active_d = active_q;
        taken_d = taken_q;
        beat_q_d = beat_q_q;
        drain_set_d = drain_set_q;
        credits_d = credits_q;
        if (copies) begin
            sum_ready_d = 1'b0;
            active_d = 1'b1;
            taken_d = 8'd0;
            drain_set_d = sum_set_q;
        end
        if (arrives) begin
            sum_ready_d = 1'b1;
            sum_set_d = on_the_way_later[1];
        end
        if (pass_issued_i && (!copies)) begin
            outstanding_d = outstanding_q + 2'd1;
        end else if (copies && (!pass_issued_i)) begin
            outstanding_d = outstanding_q - 2'd1;
        end
        if (takes) begin
            taken_d = taken_q + 8'd1;
            if (taken_q == LAST_TAKE) begin
                active_d = 1'b0;
            end
            beat_q_d = beat_q_q + 8'd1;
            if (beat_q_q == LAST_BEAT) begin
                beat_q_d = 8'd0;
            end
        end
        if (takes && (!returned_i)) begin
            credits_d = credits_q - 5'd1;
        end else if (returned_i && (!takes)) begin
            credits_d = credits_q + 5'd1;
        end
        if (reset_i) begin
            sum_ready_d = 1'b0;
            outstanding_d = 2'd0;
            active_d = 1'b0;
            beat_q_d = 8'd0;
            credits_d = ALL_CREDITS;
        end
    end

    assign may_start_o = (outstanding_q == 2'd0) || ((outstanding_q == 2'd1) && (!active_q));
    assign copy_o = copies;
    assign take_o = takes;
    assign beat_o = beat_q_q;
    assign last_o = beat_q_q == LAST_BEAT;
    assign taken_set_o = drain_set_q;

    always @(posedge clock_i) begin
        sum_ready_q <= sum_ready_d;
        sum_set_q <= sum_set_d;
        outstanding_q <= outstanding_d;
        active_q <= active_d;
        taken_q <= taken_d;
        beat_q_q <= beat_q_d;
        drain_set_q <= drain_set_d;
        credits_q <= credits_d;
    end
endmodule

`default_nettype wire
