// What the host sees of a stage: non-zero words sent (0), saturated results (1), codes (2) and differences (3).
//
// Within the cycle: select_i -> value_o
// From crates/edof-hdl/src/blocks/counters.rs (Counters).
`default_nettype none
module counters (
  input wire clock_i, input wire reset_i, // Sets the count to zero.
  input wire enable_i,                    // A beat enters the FIFO.
  input wire [1:0] nonzero_i,             // Which of its two words are not zero.
  input wire [1:0] results_i,             // Which results did not fit.
  input wire [1:0] codes_i,               // Which thresholded codes did not fit.
  input wire [1:0] differences_i,         // Which differences did not fit.
  input wire snapshot_i,                  // Copies all counters to be shown and starts them anew.
  // Which counter to show: 0 non-zeros, 1 results, 2 codes, 3 differences.
  input wire [1:0] select_i,
  output reg [31:0] value_o               // Value of the selected counter.
);

  wire [31:0] count_nonzero_count;
  counter count_nonzero (
    .clock_i(clock_i), .reset_i(reset_i), .enable_i(enable_i), .events_i(nonzero_i),
    .snapshot_i(snapshot_i), .count_o(count_nonzero_count)
  );
  wire [31:0] count_results_count;
  counter count_results (
    .clock_i(clock_i), .reset_i(reset_i), .enable_i(enable_i), .events_i(results_i),
    .snapshot_i(snapshot_i), .count_o(count_results_count)
  );
  wire [31:0] count_codes_count;
  counter count_codes (
    .clock_i(clock_i), .reset_i(reset_i), .enable_i(enable_i), .events_i(codes_i),
    .snapshot_i(snapshot_i), .count_o(count_codes_count)
  );
  wire [31:0] count_differences_count;
  counter count_differences (
    .clock_i(clock_i), .reset_i(reset_i), .enable_i(enable_i), .events_i(differences_i),
    .snapshot_i(snapshot_i), .count_o(count_differences_count)
  );

  always @* begin
    case (select_i)
      2'd1: value_o = count_results_count;
      2'd2: value_o = count_codes_count;
      2'd3: value_o = count_differences_count;
      default: value_o = count_nonzero_count;
    endcase
  end
endmodule
`default_nettype wire
