// Transfers pulses from one clock domain to another, one for one, as long as the sender waits for ready_o between two pulses.
//
// pulse_o comes three to four cycles of to_clock_i later; ready_o is high again two to three cycles of from_clock_i after that.
// A reset of either side drops a pulse that is in flight, in any order and with either clock stopped (edof_clear).
`default_nettype none
module edof_pulse_sync (
    input  wire from_clock_i,
    input  wire from_reset_i,
    input  wire pulse_i,
    output wire ready_o,
    input  wire to_clock_i,
    input  wire to_reset_i,
    output wire pulse_o
);
    reg req_toggle_q;
    reg ack_toggle_q;
    wire req_toggle_seen;
    wire ack_toggle_seen;
    wire from_open;
    wire from_clear;
    wire to_open;
    wire to_clear;
    wire arrival = to_open && req_toggle_seen != ack_toggle_q;

    assign ready_o = from_open && req_toggle_q == ack_toggle_seen;
    always @(posedge from_clock_i) begin
        if (from_clear) req_toggle_q <= 1'b0;
        else if (pulse_i && ready_o && !from_reset_i) req_toggle_q <= !req_toggle_q;
    end

    reg pulse_q;
    always @(posedge to_clock_i) begin
        if (to_clear) ack_toggle_q <= 1'b0;
        else if (arrival) ack_toggle_q <= req_toggle_seen;
        pulse_q <= arrival && !to_reset_i;
    end
    assign pulse_o = pulse_q;

    edof_sync #(.WIDTH(1)) to_receiver (.clock_i(to_clock_i), .from_i(req_toggle_q), .to_o(req_toggle_seen));
    edof_sync #(.WIDTH(1)) to_sender (.clock_i(from_clock_i), .from_i(ack_toggle_q), .to_o(ack_toggle_seen));
    edof_clear clear (
        .from_clock_i(from_clock_i), .from_reset_i(from_reset_i), .from_open_o(from_open), .from_clear_o(from_clear),
        .to_clock_i(to_clock_i), .to_reset_i(to_reset_i), .to_open_o(to_open), .to_clear_o(to_clear)
    );
endmodule
`default_nettype wire
