// Empties a clock-domain crossing from either side: a reset of one domain closes both sides, and both open again once each clock has run.
//
// open_o: words may pass on this side. clear_o: the state of this side (pointers, toggles) goes to zero; neither side is open then.
// A four-phase handshake: the sender closes and raises clear_q, the receiver closes and raises ack_q, both clear their state, the sender
// lowers clear_q, the receiver opens and lowers ack_q, the sender opens. A receiver whose domain was reset requests this with request_q.
// Resets need no overlap and no order, and either clock may stop: the crossing stays closed until both run. It is closed from the first
// edge after power-up.
`default_nettype none
module edof_clear (
    input  wire from_clock_i,
    input  wire from_reset_i,
    output wire from_open_o,
    output wire from_clear_o,
    input  wire to_clock_i,
    input  wire to_reset_i,
    output wire to_open_o,
    output wire to_clear_o
);
    // Sender. The state is zero for four cycles before clear_q falls, so that the receiver sees zero before it opens.
    reg clear_q = 1'b1;
    reg [3:0] cleared_q = 4'd0;
    reg from_open_q;
    wire request_seen;
    wire ack_seen;
    wire restart = from_reset_i || request_seen;

    always @(posedge from_clock_i) begin
        if (clear_q) begin
            clear_q <= !cleared_q[3];
            cleared_q <= (restart || !ack_seen) ? 4'd0 : {cleared_q[2:0], 1'b1};
            from_open_q <= 1'b0;
        end else begin
            clear_q <= restart && !ack_seen;
            cleared_q <= 4'd0;
            from_open_q <= !restart && !ack_seen;
        end
    end
    assign from_open_o = from_open_q;
    assign from_clear_o = cleared_q[0];

    // Receiver.
    reg request_q = 1'b1;
    reg ack_q = 1'b0;
    reg to_open_q;
    wire clear_seen;

    always @(posedge to_clock_i) begin
        request_q <= to_reset_i || (request_q && !clear_seen);
        ack_q <= clear_seen;
        to_open_q <= !to_reset_i && !request_q && !clear_seen;
    end
    assign to_open_o = to_open_q;
    assign to_clear_o = ack_q;

    edof_sync #(.WIDTH(1)) to_receiver (.clock_i(to_clock_i), .from_i(clear_q), .to_o(clear_seen));
    edof_sync #(.WIDTH(1)) request_sync (.clock_i(from_clock_i), .from_i(request_q), .to_o(request_seen));
    edof_sync #(.WIDTH(1)) ack_sync (.clock_i(from_clock_i), .from_i(ack_q), .to_o(ack_seen));
endmodule
`default_nettype wire
