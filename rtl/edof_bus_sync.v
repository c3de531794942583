// A word of one clock domain, now and then, in another: all its bits at once.
//
// valid_i with ready_o takes a word; valid_o is high for one cycle when it has come, three to four cycles of to_clock_i later, and
// the word stands until the next one. Before the first word it is 0. Both resets come from the same request and overlap.
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
    wire arrives = asked_seen != told_q;
    // It changes only while the receiver does not look.
    reg [WIDTH-1:0] held_q;

    assign ready_o = asked_q == told_seen;
    always @(posedge from_clock_i) begin
        if (from_reset_i) asked_q <= 1'b0;
        else if (valid_i && ready_o) asked_q <= !asked_q;
        if (valid_i && ready_o) held_q <= word_i;
    end

    reg valid_q;
    reg [WIDTH-1:0] word_q;
    always @(posedge to_clock_i) begin
        if (to_reset_i) begin
            told_q <= 1'b0;
            valid_q <= 1'b0;
            word_q <= 0;
        end else begin
            told_q <= asked_seen;
            valid_q <= arrives;
            if (arrives) word_q <= held_q;
        end
    end
    assign valid_o = valid_q;
    assign word_o = word_q;

    edof_sync #(.WIDTH(1)) to_receiver (.clock_i(to_clock_i), .from_i(asked_q), .to_o(asked_seen));
    edof_sync #(.WIDTH(1)) to_sender (.clock_i(from_clock_i), .from_i(told_q), .to_o(told_seen));
endmodule

`default_nettype wire
