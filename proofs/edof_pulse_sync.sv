// edof_pulse_sync, two free clocks, resets at any moment: a pulse for a pulse, none from nothing, none lost but by a reset.
module prove (
    input wire from_reset_i,
    input wire pulse_i,
    input wire to_reset_i
);
    (* gclk *) wire gclk;
    wire from_clock, to_clock, from_rises, to_rises, from_on, to_on, round;
    two_clocks clocks (
        .from_reset_i(from_reset_i), .to_reset_i(to_reset_i), .from_clock_o(from_clock), .to_clock_o(to_clock),
        .from_rises_o(from_rises), .to_rises_o(to_rises), .from_on_o(from_on), .to_on_o(to_on), .round_o(round)
    );
    wire ready, pulse;
    edof_pulse_sync dut (
        .from_clock_i(from_clock), .from_reset_i(from_reset_i), .pulse_i(pulse_i), .ready_o(ready),
        .to_clock_i(to_clock), .to_reset_i(to_reset_i), .pulse_o(pulse)
    );

    (* hierconn *) wire \dut.to_open ;

    reg open_was = 0, push_was = 0, from_reset_was = 0, to_reset_was = 0;
    // One pulse at most is on its way; dropped: a reset may have taken it.
    reg flies = 0, came = 0;
    reg dropped = 0;
    wire push = from_rises && push_was && from_on;
    wire pop = to_rises && pulse && to_on;
    always @(posedge gclk) begin
        open_was <= \dut.to_open ;
        push_was <= pulse_i && ready && !from_reset_i;
        from_reset_was <= from_reset_i;
        to_reset_was <= to_reset_i;
        if ((from_rises && from_reset_was) || (to_rises && to_reset_was)) dropped <= flies || push;
        else if (push && !open_was) dropped <= 1;
        else if (push || pop) dropped <= 0;
        if (push) flies <= 1;
        else if (pop) flies <= 0;
        if (pop) none_from_nothing: assert (flies);
        if (push && !dropped) none_lost: assert (!flies);
        if (pop) came <= 1;
        again: cover (came && ready && from_on);
    end
endmodule
