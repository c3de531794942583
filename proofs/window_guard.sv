// window_guard: whatever the sender marks, each window that leaves has all its beats, one `last` at its end, and one set of weights;
// a beat stands while the receiver stalls; a window that is right passes whole; too short and too long are reported.
module prove #(
    parameter BEATS = 32
) (
    input wire        clock_i,
    input wire        reset_i,
    input wire        valid_i,
    input wire [31:0] data_i,
    input wire        last_i,
    input wire        set_i,
    input wire        out_ready_i
);
    wire ready, out_valid, out_last, out_set, fault;
    wire [31:0] out_data;
    window_guard dut (
        .clock_i(clock_i), .reset_i(reset_i), .reset_counters_i(1'b0), .valid_i(valid_i), .ready_o(ready), .data_i(data_i),
        .last_i(last_i), .set_i(set_i), .out_valid_o(out_valid), .out_ready_i(out_ready_i), .out_data_o(out_data),
        .out_last_o(out_last), .out_set_o(out_set), .fault_o(fault), .snapshot_i(1'b0)
    );

    reg started = 0, wrong = 0;
    reg [5:0] beat = 0;
    // Beats of the sender's window that have come, and whether it went on as it came.
    reg [5:0] came = 0;
    reg window_set = 0;
    wire passes = out_valid && out_ready_i;
    wire comes = valid_i && ready;
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || reset_i);
        if (started && $past(valid_i && !ready) && !$past(reset_i)) begin
            assume (valid_i && $stable(data_i) && $stable(last_i) && $stable(set_i));
        end
        // The sender's own windows have one set of weights.
        if (comes && came == 0) window_set <= set_i;
        assume (!valid_i || came == 0 || set_i == window_set);
        came <= reset_i ? 0 : comes ? (last_i ? 0 : came + (came != 63)) : came;
        beat <= reset_i ? 0 : passes ? (beat == BEATS - 1 ? 0 : beat + 1) : beat;
        if (reset_i) wrong <= 0;
        else if (comes && last_i != (came == BEATS - 1)) wrong <= 1;

        if (started && !reset_i) begin
            last_at_the_end: assert (!out_valid || out_last == (beat == BEATS - 1));
            // Up to the first wrong window a beat passes unchanged, in its cycle.
            if (!wrong) as_it_comes: assert (out_valid == valid_i && ready == out_ready_i && (!out_valid || out_data == data_i));
            if ($past(started && !reset_i && out_valid && !out_ready_i)) begin
                stands: assert (out_valid && $stable(out_data) && $stable(out_last) && $stable(out_set));
            end
            if ($past(started && !reset_i && passes && !out_last) && out_valid) one_set: assert (out_set == $past(out_set));
            if (wrong && $past(wrong) && $past(wrong, 2)) is_told: assert (fault);
        end
        filled: cover (started && wrong && passes && out_last);
    end
endmodule
