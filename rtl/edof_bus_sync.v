// Transfers a word from one clock domain to another, all bits at once, at a low rate.
//
// valid_i with ready_o accepts a word. valid_o is high for one cycle when the word arrives, three to four cycles of to_clock_i later, and
// word_o is held until the next word. After a reset of the receiver word_o is 0 until a word arrives. A reset of either side drops a word
// in flight, in any order and with either clock stopped (edof_clear).
`default_nettype none
module edof_bus_sync #(
    parameter WIDTH = 32
) (
    input  wire             from_clock_i,
    input  wire             from_reset_i,
    input  wire             valid_i,
    output wire             ready_o,
    input  wire [WIDTH-1:0] word_i,
    input  wire             to_clock_i,
    input  wire             to_reset_i,
    output wire             valid_o,
    output wire [WIDTH-1:0] word_o
);
    reg req_toggle_q;
    reg ack_toggle_q;
    wire req_toggle_seen;
    wire ack_toggle_seen;
    wire from_open;
    wire from_clear;
    wire to_open;
    wire to_clear;
    wire take = valid_i && ready_o && !from_reset_i;
    wire arrival = to_open && req_toggle_seen != ack_toggle_q;
    // The word changes only while the receiver does not sample it.
    reg [WIDTH-1:0] held_q;

    assign ready_o = from_open && req_toggle_q == ack_toggle_seen;
    always @(posedge from_clock_i) begin
        if (from_clear) req_toggle_q <= 1'b0;
        else if (take) req_toggle_q <= !req_toggle_q;
        if (take) held_q <= word_i;
    end

    reg valid_q;
    reg [WIDTH-1:0] word_q;
    always @(posedge to_clock_i) begin
        if (to_clear) ack_toggle_q <= 1'b0;
        else if (arrival) ack_toggle_q <= req_toggle_seen;
        valid_q <= arrival && !to_reset_i;
        if (to_reset_i) word_q <= 0;
        else if (arrival) word_q <= held_q;
    end
    assign valid_o = valid_q;
    assign word_o = word_q;

    edof_sync #(.WIDTH(1)) to_receiver (.clock_i(to_clock_i), .from_i(req_toggle_q), .to_o(req_toggle_seen));
    edof_sync #(.WIDTH(1)) to_sender (.clock_i(from_clock_i), .from_i(ack_toggle_q), .to_o(ack_toggle_seen));
    edof_clear clear (
        .from_clock_i(from_clock_i), .from_reset_i(from_reset_i), .from_open_o(from_open), .from_clear_o(from_clear),
        .to_clock_i(to_clock_i), .to_reset_i(to_reset_i), .to_open_o(to_open), .to_clear_o(to_clear)
    );
endmodule
`default_nettype wire
