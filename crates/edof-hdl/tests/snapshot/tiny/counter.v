// Counts up to two a cycle; its reset comes through a register of its own.
//
// From crates/edof-hdl/src/blocks/counters.rs (Counter).
`default_nettype none

module counter (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        enable_i,
    input  wire [1:0]  events_i,
    output wire [31:0] count_o
);

    reg  reset_q_now;
    wire reset_q_later;
    reg  [1:0] more_q;
    reg  [1:0] more_d;
    reg  [31:0] count_q_q;
    reg  [31:0] count_q_d;

    edof_delay #(
        .WIDTH(1),
        .CYCLES(1)
    ) reset_q (
        .clock_i(clock_i),
        .now_i(reset_q_now),
        .later_o(reset_q_later)
    );

    always @* begin
        reset_q_now = 1'b0;
        if (reset_i) begin
            reset_q_now = 1'b1;
        end
    end

    always @* begin
        more_d = 2'd0;
        if (enable_i) begin
            more_d = {1'b0, events_i[0]} + {1'b0, events_i[1]};
        end
    end

    always @* begin
        count_q_d = count_q_q + {30'd0, more_q};
        if (reset_q_later) begin
            count_q_d = 32'd0;
        end
    end

    assign count_o = count_q_q;

    always @(posedge clock_i) begin
        more_q <= more_d;
        count_q_q <= count_q_d;
    end
endmodule

`default_nettype wire
