// edof_clear: while a side clears it is closed, and while the receiver does, both are; a reset closes its side at once; once both clocks run, both sides open again.
module prove (
    input wire from_reset_i,
    input wire to_reset_i
);
    (* gclk *) wire gclk;
    wire from_clock, to_clock, from_rises, to_rises, from_on, to_on, round;
    two_clocks clocks (
        .from_reset_i(from_reset_i), .to_reset_i(to_reset_i), .from_clock_o(from_clock), .to_clock_o(to_clock),
        .from_rises_o(from_rises), .to_rises_o(to_rises), .from_on_o(from_on), .to_on_o(to_on), .round_o(round)
    );
    wire from_open, from_clear, to_open, to_clear;
    edof_clear dut (
        .from_clock_i(from_clock), .from_reset_i(from_reset_i), .from_open_o(from_open), .from_clear_o(from_clear),
        .to_clock_i(to_clock), .to_reset_i(to_reset_i), .to_open_o(to_open), .to_clear_o(to_clear)
    );

    localparam ENOUGH = 40;
    reg from_reset_was = 0, to_reset_was = 0;
    reg [5:0] rounds = 0;
    wire resets = from_reset_i || to_reset_i || !from_on || !to_on;
    always @(posedge gclk) begin
        from_reset_was <= from_reset_i;
        to_reset_was <= to_reset_i;
        rounds <= resets ? 0 : rounds + (round && rounds != ENOUGH);
        if (from_on && to_on) begin
            closed_while_writer_clears: assert (!from_clear || !from_open);
            closed_while_reader_clears: assert (!to_clear || (!from_open && !to_open));
        end
        if (from_rises && from_reset_was) from_closes: assert (!from_open);
        if (to_rises && to_reset_was) to_closes: assert (!to_open);
        opens: assert (rounds != ENOUGH || (from_open && to_open));
        reopens: cover (from_open && to_open && rounds != 0);
    end
endmodule
