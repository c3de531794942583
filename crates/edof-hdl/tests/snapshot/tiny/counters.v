// What the host sees of a stage: non-zero words sent (0), saturated results (1), codes (2) and differences (3).
//
// From crates/edof-hdl/src/blocks/counters.rs (Counters).
`default_nettype none

module counters (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        enable_i,
    input  wire [1:0]  nonzero_i,
    input  wire [1:0]  results_i,
    input  wire [1:0]  codes_i,
    input  wire [1:0]  differences_i,
    input  wire [1:0]  select_i,
    output reg  [31:0] value_o
);

    reg  [31:0] nonzero_q_q;
    reg  [31:0] nonzero_q_d;
    reg  [31:0] results_q_q;
    reg  [31:0] results_q_d;
    reg  [31:0] codes_q_q;
    reg  [31:0] codes_q_d;
    reg  [31:0] differences_q_q;
    reg  [31:0] differences_q_d;

    always @* begin
        nonzero_q_d = nonzero_q_q;
        results_q_d = results_q_q;
        codes_q_d = codes_q_q;
        differences_q_d = differences_q_q;
        if (enable_i) begin
            nonzero_q_d = nonzero_q_q + ({31'd0, nonzero_i[0]} + {31'd0, nonzero_i[1]});
            results_q_d = results_q_q + ({31'd0, results_i[0]} + {31'd0, results_i[1]});
            codes_q_d = codes_q_q + ({31'd0, codes_i[0]} + {31'd0, codes_i[1]});
            differences_q_d = differences_q_q + ({31'd0, differences_i[0]} + {31'd0, differences_i[1]});
        end
        if (reset_i) begin
            nonzero_q_d = 32'd0;
            results_q_d = 32'd0;
            codes_q_d = 32'd0;
            differences_q_d = 32'd0;
        end
    end

    always @* begin
        value_o = nonzero_q_q;
        if (select_i == 2'd1) begin
            value_o = results_q_q;
        end else if (select_i == 2'd2) begin
            value_o = codes_q_q;
        end else if (select_i == 2'd3) begin
            value_o = differences_q_q;
        end
    end

    always @(posedge clock_i) begin
        nonzero_q_q <= nonzero_q_d;
        results_q_q <= results_q_d;
        codes_q_q <= codes_q_d;
        differences_q_q <= differences_q_d;
    end
endmodule

`default_nettype wire
