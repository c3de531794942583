// Empties a clock-domain crossing from either side: a reset of one domain closes both sides, and both open again once each clock has run.
//
// open_o: words may pass on this side. clear_o: the state of this side (pointers, toggles) goes to zero; neither side is open then.
// Four phases between two levels: the sender closes and asks (clear_q), the receiver closes and answers (answers_q), both clear,
// the sender withdraws, the receiver opens and withdraws, the sender opens. A receiver whose domain was reset first asks for it (asks_q).
// Resets need no overlap and no order, and either clock may stand still: the crossing stays closed until both run. Closed from
// the first edge after power-up.
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
    // Sender. Its state is zero for four cycles before it withdraws, so that the receiver sees zero before it opens.
    reg clear_q = 1'b1;
    reg [3:0] cleared_q = 4'd0;
    reg from_open_q;
    wire asks_seen;
    wire answers_seen;
    wire restarts = from_reset_i || asks_seen;

    always @(posedge from_clock_i) begin
        if (clear_q) begin
            clear_q <= !cleared_q[3];
            cleared_q <= (restarts || !answers_seen) ? 4'd0 : {cleared_q[2:0], 1'b1};
            from_open_q <= 1'b0;
        end else begin
            clear_q <= restarts && !answers_seen;
            cleared_q <= 4'd0;
            from_open_q <= !restarts && !answers_seen;
        end
    end
    assign from_open_o = from_open_q;
    assign from_clear_o = cleared_q[0];

    // Receiver.
    reg asks_q = 1'b1;
    reg answers_q = 1'b0;
    reg to_open_q;
    wire clear_seen;

    always @(posedge to_clock_i) begin
        asks_q <= to_reset_i || (asks_q && !clear_seen);
        answers_q <= clear_seen;
        to_open_q <= !to_reset_i && !asks_q && !clear_seen;
    end
    assign to_open_o = to_open_q;
    assign to_clear_o = answers_q;

    edof_sync #(.WIDTH(1)) to_receiver (.clock_i(to_clock_i), .from_i(clear_q), .to_o(clear_seen));
    edof_sync #(.WIDTH(1)) asks_sync (.clock_i(from_clock_i), .from_i(asks_q), .to_o(asks_seen));
    edof_sync #(.WIDTH(1)) answers_sync (.clock_i(from_clock_i), .from_i(answers_q), .to_o(answers_seen));
endmodule

`default_nettype wire
