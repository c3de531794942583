// Counts up to two a cycle, and shows what it had counted when it was last told to. Reset and snapshot come through registers of
// their own.
//
// From crates/edof-hdl/src/blocks/counters.rs (Counter).
`default_nettype none

module counter (
    input  wire        clock_i,    // Clock.
    input  wire        reset_i,    // Back to zero.
    input  wire        enable_i,   // Whether to count.
    input  wire [1:0]  events_i,   // What: as many as there are ones.
    input  wire        snapshot_i, // Shows what was counted so far, and counts anew.
    output wire [31:0] count_o     // How many there were between the last two snapshots; before the second, since reset.
);

    reg  [3:0] marks;
    wire [31:0] kept;
    wire [3:0] marks_q_later;
    reg  [1:0] more_q;
    reg  [31:0] count_q, shown_q;

    edof_delay #(.WIDTH(4), .CYCLES(1)) marks_q (
        .clock_i(clock_i), .now_i(marks), .later_o(marks_q_later)
    );

    always @* begin
        marks = 4'd0;
        if (reset_i) begin
            marks = marks | 4'd5;
        end
        if (snapshot_i) begin
            marks = marks | 4'ha;
        end
    end

    assign kept = marks_q_later[1] ? 32'd0 : count_q;
    assign count_o = shown_q;

    always @(posedge clock_i) begin
        more_q <= enable_i ? ({1'b0, events_i[0]} + {1'b0, events_i[1]}) : 2'd0;
        count_q <= marks_q_later[0] ? 32'd0 : (kept + {30'd0, more_q});
        shown_q <= marks_q_later[2] ? 32'd0 : (marks_q_later[3] ? count_q : shown_q);
    end
endmodule

`default_nettype wire
