// From sums to output words, two elements per cycle. Counted from `take`: 7 sums and base stand here, 8 to 17
// base, rounding, shift and saturation, 18 to 20 threshold, 21 to 23 difference or wait. Nothing in here ever
// stalls. A memory of depth 0 and a delay of 0 cycles are absent: what only other stages need costs nothing.
// From crates/edof-hdl/src/blocks/results.rs (Results).
`default_nettype none
module results #(
  parameter OUTPUTS = 16,
  parameter HAS_BASE = 0,   // 1 where a base is added (M).
  parameter FEEDS_M = 1,    // 1 where the next stage is an M, so that base words are sent.
  parameter SHRINKS = 1'b1, // Codes are sent (I, M), not results (F).
  parameter INIT = "stage0_thresholds.mem", parameter [47:0] BASE_BITS = 48'd0, parameter INPUTS = 64
) (
  input wire clock_i, input wire reset_i,  // Forgets everything.
  input wire take_i,                       // Two sums are taken, and stand on the inputs seven cycles later.
  input wire [7:0] beat_i,                 // Which two of their vector.
  input wire last_i,                       // The two sums are the last of their vector.
  input wire set_i,                        // Set of the vector of the two sums.
  input wire [47:0] sum_even_i,            // The even sum, seven cycles after `take`.
  input wire [47:0] sum_odd_i,             // The odd one.
  input wire [19:0] shifts_0_i,            // Shifts of set 0.
  input wire [19:0] shifts_1_i,            // Shifts of set 1.
  input wire base_write_i,                 // A beat with base words arrives at the stage.
  input wire [31:0] base_words_i,          // Two base words of the beat.
  input wire write_thresholds_i,           // Writes two thresholds.
  input wire [11:0] write_row_i,           // Address of the word to write.
  input wire [31:0] write_data_i,          // Word to write.
  // Two thresholds are to be read back in a cycle in which no beat needs any.
  input wire read_wanted_i,
  input wire [11:0] read_row_i,            // Row of the two thresholds to read.
  output wire read_valid_o,                // The two thresholds that were read are valid.
  output wire [31:0] read_thresholds_o,    // The two thresholds that were read.
  output wire [31:0] read_previous_o,      // Thresholds of the stage before.
  output wire push_o,                      // A beat is done, 23 cycles after `take`.
  output wire [31:0] data_o,               // Two words of the beat, the even one low.
  output wire [1:0] done_o,                // Bit 0 whether it is its vector's last, bit 1 its set.
  output wire base_push_o,                 // Base words for the next stage are done, no later than their beat.
  output wire [31:0] base_o,               // Base words for the next stage.
  output wire [1:0] nonzero_o,             // Which words are not zero.
  output wire [1:0] result_saturated_o,    // Which results did not fit.
  output wire [1:0] code_saturated_o,      // Which thresholded codes did not fit.
  output wire [1:0] difference_saturated_o // Which differences did not fit.
);

  localparam DIFFERS = 0;                      // 1 where the difference to the codes before is sent.
  localparam [31:0] SET_ROWS = OUTPUTS / 2;
  localparam PASSES_BASE = HAS_BASE > DIFFERS; // Base words for the next stage are those that came in.

  reg read_16_q, read_17_q, base_mark_q;
  reg [11:0] threshold_row_q, shifts_q;
  wire [31:0] base_ring_front;

  // What travels with a beat: bit 0 it is one, bit 1 last, bit 2 set.
  wire [2:0] marks = {set_i, last_i, take_i};
  wire [9:0] place = {take_i, set_i, beat_i};

  wire [2:0] marks_to_5_delayed;
  edof_delay #(.WIDTH(3), .CYCLES(5))
    marks_to_5 (.clock_i(clock_i), .data_i(marks), .data_o(marks_to_5_delayed));
  wire [2:0] marks_to_6_delayed;
  edof_delay #(.WIDTH(3), .CYCLES(1))
    marks_to_6 (.clock_i(clock_i), .data_i(marks_to_5_delayed), .data_o(marks_to_6_delayed));
  wire [2:0] marks_to_23_delayed;
  edof_delay #(.WIDTH(3), .CYCLES(17))
    marks_to_23 (.clock_i(clock_i), .data_i(marks_to_6_delayed), .data_o(marks_to_23_delayed));
  wire [9:0] place_to_15_delayed;
  edof_delay #(.WIDTH(10), .CYCLES(15))
    place_to_15 (.clock_i(clock_i), .data_i(place), .data_o(place_to_15_delayed));

  wire [15:0] requantize_even_result;
  wire requantize_even_saturated;
  requantize #(.BASE_BITS(BASE_BITS)) requantize_even (
    .clock_i(clock_i), .sum_i(sum_even_i), .base_i(base_ring_front[15:0]), .base_shift_i(shifts_q[11:6]),
    .result_shift_i(shifts_q[5:0]), .result_o(requantize_even_result),
    .saturated_o(requantize_even_saturated)
  );

  wire [15:0] requantize_odd_result;
  wire requantize_odd_saturated;
  requantize #(.BASE_BITS(BASE_BITS)) requantize_odd (
    .clock_i(clock_i), .sum_i(sum_odd_i), .base_i(base_ring_front[31:16]), .base_shift_i(shifts_q[11:6]),
    .result_shift_i(shifts_q[5:0]), .result_o(requantize_odd_result),
    .saturated_o(requantize_odd_saturated)
  );

  wire [31:0] result = {requantize_odd_result, requantize_even_result};
  assign read_valid_o = read_17_q, read_previous_o = 32'd0;

  edof_delay #(.WIDTH(2), .CYCLES(6)) result_flags (
    .clock_i(clock_i), .data_i({requantize_odd_saturated, requantize_even_saturated}),
    .data_o(result_saturated_o)
  );

  base_ring #(.HAS_BASE(HAS_BASE), .INPUTS(INPUTS)) base_ring (
    .clock_i(clock_i), .reset_i(reset_i), .write_i(base_write_i), .words_i(base_words_i),
    .read_i(marks_to_5_delayed[0]), .front_o(base_ring_front)
  );

  edof_ram #(.WIDTH(32), .DEPTH(SHRINKS ? OUTPUTS : 0), .BLOCK(0), .INIT(INIT)) thresholds (
    .clock_i(clock_i), .read_address_i(threshold_row_q), .read_data_o(read_thresholds_o),
    .write_enable_i(write_thresholds_i), .write_address_i(write_row_i), .write_data_i(write_data_i)
  );

  wire [15:0] shrink_even_result;
  wire shrink_even_saturated;
  shrink shrink_even (
    .clock_i(clock_i), .code_i(requantize_even_result), .threshold_i(read_thresholds_o[15:0]),
    .result_o(shrink_even_result), .saturated_o(shrink_even_saturated)
  );

  wire [15:0] shrink_odd_result;
  wire shrink_odd_saturated;
  shrink shrink_odd (
    .clock_i(clock_i), .code_i(requantize_odd_result), .threshold_i(read_thresholds_o[31:16]),
    .result_o(shrink_odd_result), .saturated_o(shrink_odd_saturated)
  );

  wire [31:0] code = {shrink_odd_result, shrink_even_result};

  edof_delay #(.WIDTH(2), .CYCLES(SHRINKS ? 3 : 0)) code_flags (
    .clock_i(clock_i), .data_i({shrink_odd_saturated, shrink_even_saturated}), .data_o(code_saturated_o)
  );
  wire [31:0] codes_to_23_delayed;
  edof_delay #(.WIDTH(32), .CYCLES(SHRINKS ? 3 - 3 * DIFFERS : 0))
    codes_to_23 (.clock_i(clock_i), .data_i(code), .data_o(codes_to_23_delayed));
  wire [31:0] result_to_23_delayed;
  edof_delay #(.WIDTH(32), .CYCLES(SHRINKS ? 0 : 6))
    result_to_23 (.clock_i(clock_i), .data_i(result), .data_o(result_to_23_delayed));

  wire [31:0] sent = SHRINKS ? codes_to_23_delayed : result_to_23_delayed;
  assign difference_saturated_o = {1'b0, 1'b0};
  assign base_push_o = PASSES_BASE ? base_mark_q : marks_to_23_delayed[0];

  wire [31:0] base_to_23_delayed;
  edof_delay #(.WIDTH(32), .CYCLES(PASSES_BASE ? 0 : 6 * FEEDS_M))
    base_to_23 (.clock_i(clock_i), .data_i(result), .data_o(base_to_23_delayed));

  assign base_o = PASSES_BASE ? base_ring_front : base_to_23_delayed;
  assign data_o = sent, push_o = marks_to_23_delayed[0], done_o = marks_to_23_delayed[2:1];
  assign nonzero_o = {|sent[31:16], |sent[15:0]};

  always @(posedge clock_i) begin
    shifts_q <= marks_to_6_delayed[2] ? shifts_1_i[11:0] : shifts_0_i[11:0];
    // Cycles 18 to 20: thresholds, read in cycle 17.
    threshold_row_q <= {4'd0, place_to_15_delayed[7:0]};
    if (place_to_15_delayed[8]) threshold_row_q <= {4'd0, place_to_15_delayed[7:0]} + SET_ROWS[11:0];
    read_16_q <= read_wanted_i;
    if (place_to_15_delayed[9]) read_16_q <= 1'b0;
    else threshold_row_q <= read_row_i;
    read_17_q <= read_16_q;
    base_mark_q <= marks_to_6_delayed[0];
  end

  wire unused = ^{shifts_0_i, shifts_1_i}; // Not every bit is read.
endmodule
`default_nettype wire
