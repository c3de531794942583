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

    wire [31:0] count_nonzero_count;
    wire [31:0] count_results_count;
    wire [31:0] count_codes_count;
    wire [31:0] count_differences_count;

    counter count_nonzero (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .enable_i(enable_i),
        .events_i(nonzero_i),
        .count_o(count_nonzero_count)
    );

    counter count_results (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .enable_i(enable_i),
        .events_i(results_i),
        .count_o(count_results_count)
    );

    counter count_codes (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .enable_i(enable_i),
        .events_i(codes_i),
        .count_o(count_codes_count)
    );

    counter count_differences (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .enable_i(enable_i),
        .events_i(differences_i),
        .count_o(count_differences_count)
    );

    always @* begin
        value_o = count_nonzero_count;
        if (select_i == 2'd1) begin
            value_o = count_results_count;
        end else if (select_i == 2'd2) begin
            value_o = count_codes_count;
        end else if (select_i == 2'd3) begin
            value_o = count_differences_count;
        end
    end
endmodule

`default_nettype wire
