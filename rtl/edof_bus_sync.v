// A word of one clock domain, now and then, in another: all its bits at once.
//
// valid_i with ready_o takes a word; valid_o is high for one cycle when it has come, three to four cycles of to_clock_i later, and
// the word stands until the next one. After a reset of the receiver it is 0 until a word has come. A reset of either side drops a word
// that is in flight, in any order and with either clock standing still (edof_clear).
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
    reg asked_q;
    reg told_q;
    wire asked_seen;
    wire told_seen;
    wire from_open;
    wire from_clear;
    wire to_open;
    wire to_clear;
    wire take = valid_i && ready_o && !from_reset_i;
    wire arrives = to_open && asked_seen != told_q;
    // It changes only while the receiver does not look.
    reg [WIDTH-1:0] held_q;

    assign ready_o = from_open && asked_q == told_seen;
    always @(posedge from_clock_i) begin
        if (from_clear) asked_q <= 1'b0;
        else if (take) asked_q <= !asked_q;
        if (take) held_q <= word_i;
    end

    reg valid_q;
    reg [WIDTH-1:0] word_q;
    always @(posedge to_clock_i) begin
        if (to_clear) told_q <= 1'b0;
        else if (arrives) told_q <= asked_seen;
        valid_q <= arrives && !to_reset_i;
        if (to_reset_i) word_q <= 0;
        else if (arrives) word_q <= held_q;
    end
    assign valid_o = valid_q;
    assign word_o = word_q;

    edof_sync #(.WIDTH(1)) to_receiver (.clock_i(to_clock_i), .from_i(asked_q), .to_o(asked_seen));
    edof_sync #(.WIDTH(1)) to_sender (.clock_i(from_clock_i), .from_i(told_q), .to_o(told_seen));
    edof_clear clear (
        .from_clock_i(from_clock_i), .from_reset_i(from_reset_i), .from_open_o(from_open), .from_clear_o(from_clear),
        .to_clock_i(to_clock_i), .to_reset_i(to_reset_i), .to_open_o(to_open), .to_clear_o(to_clear)
    );
endmodule

`default_nettype wire
