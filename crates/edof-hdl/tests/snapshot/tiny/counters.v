// What the host sees of a stage: non-zero words sent (0), saturated results (1), codes (2) and differences (3).
//
// From crates/edof-hdl/src/blocks/counters.rs (Counters).
`default_nettype none

module counters (
    input  wire        clock_i,       // Clock.
    input  wire        reset_i,       // Back to zero.
    input  wire        enable_i,      // A beat enters the FIFO.
    input  wire [1:0]  nonzero_i,     // Which of its two words are not zero.
    input  wire [1:0]  results_i,     // Which results did not fit.
    input  wire [1:0]  codes_i,       // Which thresholded codes did not fit.
    input  wire [1:0]  differences_i, // Which differences did not fit.
    input  wire [1:0]  select_i,      // Which counter to show: 0 non-zeros, 1 results, 2 codes, 3 differences.
    output reg  [31:0] value_o        // It.
);

    reg  [31:0] nonzero_q;
    reg  [31:0] nonzero_d;
    reg  [31:0] results_q;
    reg  [31:0] results_d;
    reg  [31:0] codes_q;
    reg  [31:0] codes_d;
    reg  [31:0] differences_q;
    reg  [31:0] differences_d;

    always @* begin
        nonzero_d = nonzero_q;
        if (enable_i) begin
            nonzero_d = nonzero_q + ({31'd0, nonzero_i[0]} + {31'd0, nonzero_i[1]});
        end
        if (reset_i) begin
            nonzero_d = 32'd0;
        end
    end

    always @* begin
        results_d = results_q;
        if (enable_i) begin
            results_d = results_q + ({31'd0, results_i[0]} + {31'd0, results_i[1]});
        end
        if (reset_i) begin
            results_d = 32'd0;
        end
    end

    always @* begin
        codes_d = codes_q;
        if (enable_i) begin
            codes_d = codes_q + ({31'd0, codes_i[0]} + {31'd0, codes_i[1]});
        end
        if (reset_i) begin
            codes_d = 32'd0;
        end
    end

    always @* begin
        differences_d = differences_q;
        if (enable_i) begin
            differences_d = differences_q + ({31'd0, differences_i[0]} + {31'd0, differences_i[1]});
        end
        if (reset_i) begin
            differences_d = 32'd0;
        end
    end

    always @* begin
        value_o = nonzero_q;
        if (select_i == 2'd1) begin
            value_o = results_q;
        end else if (select_i == 2'd2) begin
            value_o = codes_q;
        end else if (select_i == 2'd3) begin
            value_o = differences_q;
        end
    end

    always @(posedge clock_i) begin
        nonzero_q <= nonzero_d;
        results_q <= results_d;
        codes_q <= codes_d;
        differences_q <= differences_d;
    end
endmodule

`default_nettype wire
