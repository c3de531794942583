// Counts up to two a cycle; its reset comes through a register of its own.
//
// From crates/edof-hdl/src/blocks/counters.rs (Counter).
`default_nettype none

module counter (
    input  wire        clock_i,  // Clock.
    input  wire        reset_i,  // Back to zero.
    input  wire        enable_i, // Whether to count.
    input  wire [1:0]  events_i, // What: as many as there are ones.
    output wire [31:0] count_o   // How many there were.
);

    wire reset_q_later;
    reg  [1:0] more_q;
    reg  [31:0] count_q;

    edof_delay #(.WIDTH(1), .CYCLES(1)) reset_q (
        .clock_i(clock_i), .now_i(reset_i), .later_o(reset_q_later)
    );

    assign count_o = count_q;

    always @(posedge clock_i) begin
        more_q <= enable_i ? ({1'b0, events_i[0]} + {1'b0, events_i[1]}) : 2'd0;
        count_q <= reset_q_later ? 32'd0 : (count_q + {30'd0, more_q});
    end
endmodule

`default_nettype wire
