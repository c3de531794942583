// edof_reset_sync: high from power-up on; a reset of any length is caught, also while the clock stands; low again only after CYCLES cycles
// without one.
module prove #(
    parameter CYCLES = 4
) (
    input wire reset_i
);
    (* gclk *) wire gclk;
    (* anyseq *) wire clock;
    wire reset;
    edof_reset_sync #(.CYCLES(CYCLES)) dut (.clock_i(clock), .reset_i(reset_i), .reset_o(reset));

    // Edges since a reset was seen last. It shows at the second of them: first, if the clock stood, then with the clock.
    reg started = 0, clock_was = 0, reset_was = 1;
    reg [3:0] edges = 0;
    wire rises = started && clock && !clock_was;
    always @(posedge gclk) begin
        started <= 1;
        clock_was <= clock;
        reset_was <= reset_i;
        assume (started || !clock);
        if (!started) high_at_power_up: assert (reset);
        if (reset_i || reset_was) edges <= 0;
        else if (rises && edges != CYCLES + 3) edges <= edges + 1;
        caught: assert (edges < 1 || edges > CYCLES || reset);
        released: assert (edges != CYCLES + 3 || !reset);
        fell: cover (!reset);
        again: cover (edges == 2 && reset);
    end
endmodule
