// One stage of the calculator, I, M or F: vectors in, vectors out, two elements a beat; docs/calculator.md has
// its cycles. Values are multiplied as they come out of the store; sums are copied, drained, rounded, shrunk
// and sent on.
// From crates/edof-hdl/src/blocks/stage.rs (Stage).
`default_nettype none
module stage #(
  parameter [3:0] ID = 4'd0, parameter INPUTS = 64,
  parameter WINDOW_PIXELS = 0,  // Pixels of the linear path (F).
  parameter PARTS = 2,          // Parts of a vector that are read in step (I).
  parameter LANES = 16,         // Outputs that are computed at a time.
  parameter OUTPUTS = 16,
  parameter FEEDS_M = 1,        // 1 where the next stage is an M, so that base words are sent.
  parameter TWO_ROWS = 1'b0,    // Both ports of a bank's memory read two rows a step (M, F).
  parameter DENSE = 1,          // 1 where dense vectors come in (I), 0 where pairs are made of them (M, F).
  parameter MACC_ROWS = 2, parameter MACC_INIT = "stage0_bank", parameter ALIGNS = 1'b0,
  parameter WINDOWS = 0,        // Windows that are kept.
  parameter PAIRS = 0,          // 1 where elements come as pairs of index and value (M, F).
  parameter SEQUENCER_ROWS = 1, // Rows of weights in a step (M, F).
  parameter HAS_BASE = 0,       // 1 where a base is added (M).
  parameter SHRINKS = 1'b1,     // Codes are sent (I, M), not results (F).
  parameter RESULTS_INIT = "stage0_thresholds.mem", parameter [47:0] BASE_BITS = 48'd0,
  parameter REGISTERS_INIT = "stage0_shifts.mem", parameter [27:0] LAST_BEAT = 28'd383
) (
  // Forgets every vector and what was written to registers; held for 48 cycles or more, and two more pass until
  // something can be taken.
  input wire clock_i, input wire reset_i,
  input wire flush_i,                     // Drops every vector and nothing else; held for as long as `reset`.
  input wire valid_i,                     // The input beat is valid.
  output wire ready_o,                    // The block accepts a valid input in this cycle.
  input wire [31:0] data_i,               // Two words of the beat, the even one low.
  input wire [31:0] base_i,               // Base words of the same two elements (M).
  input wire last_i,                      // The beat is the last of its vector.
  input wire set_i,                       // The vector's set.
  input wire window_valid_i,              // Two pixels on the window input are valid (F with a linear path).
  output wire window_ready_o,             // The block accepts a valid input in this cycle.
  input wire [31:0] window_data_i,        // Two pixels of the window, the left one low.
  input wire window_last_i,               // The beat is the last of its window.
  output wire out_valid_o,                // The output beat is valid.
  input wire out_ready_i,                 // The receiver accepts the output in this cycle.
  output wire [31:0] out_data_o,          // Two words of the beat, the even one low.
  output wire [31:0] out_base_o,          // Base words of the same two elements.
  output wire out_last_o,                 // The beat is the last of its vector.
  output wire out_set_o,                  // The vector's set.
  // The word to write is valid (`edof_device::design::memory::address`).
  input wire write_valid_i,
  input wire [24:0] write_address_i,      // Address of the word to write.
  input wire [31:0] write_data_i,         // Word to write.
  // What to show: bit 6 counters or what was read back, then stage (4 bits), then which (2 bits).
  input wire [6:0] status_address_i,
  // Word that `status_address` selected, one cycle later; 0 from all other stages.
  output wire [31:0] status_o
);

  localparam [3:0] WHOLE_CHAIN = 4'd15;
  localparam [11:0] READ_REGISTER = 12'd3;
  localparam [31:0] SKIP_BIT = 32'd1;
  localparam SETS = 2;                       // Sets of weights.
  localparam IS_DENSE = DENSE > 0;
  localparam HAS_LINEAR = WINDOW_PIXELS > 0; // A linear path: windows come in, too (F).

  wire [31:0] ring_read_pixels;
  wire valid_a, valid_b, sequencer_first, linear, sequencer_odd, sequencer_set, finished, release_, drain_copy;
  wire drain_take, skip_zeros, request_weights, request_thresholds;
  wire [8:0] read_row;
  wire [6:0] sequencer_read_pixels;
  wire [11:0] sequencer_base, offset, reader_row;
  wire [19:0] shifts_0, shifts_1;
  reg [31:0] status_q, data_1_q, data_2_q;
  reg write_1_q, weights_2_q, thresholds_2_q, previous_2_q, registers_2_q, command_2_q, snapshot_2_q, read_2_q;
  reg [24:0] address_1_q;
  reg [18:0] address_2_q;
  wire [52:0] weights_to_5_delayed;

  // Each part has a register for its reset.
  wire [7:0] resets = (reset_i || flush_i) ? 8'hff : 8'd0;
  wire [7:0] reset_parts_delayed;
  edof_delay #(.WIDTH(8), .CYCLES(1))
    reset_parts (.clock_i(clock_i), .data_i(resets), .data_o(reset_parts_delayed));
  wire reset_registers_delayed;
  edof_delay #(.WIDTH(1), .CYCLES(1))
    reset_registers (.clock_i(clock_i), .data_i(reset_i), .data_o(reset_registers_delayed));

  wire pairs_ready, pairs_arrived;
  wire [11:0] pairs_descriptor;
  wire [24:0] even_pair, odd_pair;
  pair_store #(.DENSE(DENSE), .TWO_ROWS(TWO_ROWS)) pairs (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[0]), .skip_zeros_i(skip_zeros), .valid_i(valid_i),
    .ready_o(pairs_ready), .even_i(data_i[15:0]), .odd_i(data_i[31:16]), .last_i(last_i), .set_i(set_i),
    .arrived_o(pairs_arrived), .descriptor_o(pairs_descriptor), .read_row_i(read_row),
    .even_pair_o(even_pair), .odd_pair_o(odd_pair), .finished_i(finished)
  );

  wire pair_operands_step_first;
  wire [11:0] address_a, address_b;
  wire [24:0] pair_operands_value_a, pair_operands_value_b;
  pair_operands #(.ALIGNS(ALIGNS), .TWO_ROWS(TWO_ROWS), .DENSE(DENSE)) pair_operands (
    .clock_i(clock_i), .valid_a_i(valid_a), .valid_b_i(valid_b), .first_i(sequencer_first),
    .linear_i(linear), .odd_i(sequencer_odd), .set_i(sequencer_set), .base_i(sequencer_base),
    .offset_i(offset), .even_pair_i(even_pair), .odd_pair_i(odd_pair), .pixels_i(ring_read_pixels),
    .shifts_0_i(shifts_0[19:12]), .shifts_1_i(shifts_1[19:12]), .step_first_o(pair_operands_step_first),
    .address_a_o(address_a), .address_b_o(address_b), .value_a_o(pair_operands_value_a),
    .value_b_o(pair_operands_value_b)
  );

  wire vectors_ready, vectors_arrived;
  wire [11:0] vectors_descriptor;
  wire [31:0] pair_a, pair_b, pair_c, pair_d;
  dense_store #(.DENSE(DENSE)) vectors (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[0]), .valid_i(valid_i), .ready_o(vectors_ready),
    .data_i(data_i), .last_i(last_i), .set_i(set_i), .arrived_o(vectors_arrived),
    .descriptor_o(vectors_descriptor), .read_row_i(read_row), .pair_a_o(pair_a), .pair_b_o(pair_b),
    .pair_c_o(pair_c), .pair_d_o(pair_d), .finished_i(finished)
  );

  wire ready_in = IS_DENSE ? vectors_ready : pairs_ready;
  assign ready_o = ready_in;

  wire dense_operands_step_first;
  wire [11:0] address;
  wire [24:0] dense_operands_value_a, dense_operands_value_b, value_c, value_d;
  dense_operands #(.DENSE(DENSE)) dense_operands (
    .clock_i(clock_i), .valid_i(valid_a), .first_i(sequencer_first), .odd_i(sequencer_odd),
    .base_i(sequencer_base), .offset_i(offset), .pair_a_i(pair_a), .pair_b_i(pair_b), .pair_c_i(pair_c),
    .pair_d_i(pair_d), .step_first_o(dense_operands_step_first), .address_o(address),
    .value_a_o(dense_operands_value_a), .value_b_o(dense_operands_value_b), .value_c_o(value_c),
    .value_d_o(value_d)
  );

  wire ring_ready;
  window_ring #(.WINDOW_PIXELS(WINDOW_PIXELS), .WINDOWS(WINDOWS)) ring (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[1]), .valid_i(window_valid_i), .ready_o(ring_ready),
    .pixels_i(window_data_i), .last_i(window_last_i), .read_pair_i(sequencer_read_pixels),
    .read_pixels_o(ring_read_pixels), .finished_i(finished)
  );

  assign window_ready_o = !HAS_LINEAR || ring_ready;
  wire sequencer_arrived = IS_DENSE ? vectors_arrived : pairs_arrived;
  wire [11:0] sequencer_descriptor = IS_DENSE ? vectors_descriptor : pairs_descriptor;
  wire selected = write_1_q && (address_1_q[24:21] == ID);

  // A row is read back in a cycle without a write, whatever that would write.
  wire reads = request_weights && !write_1_q;
  wire sequencer_steal_next = reads || (TWO_ROWS && selected && (address_1_q[20:19] == 2'd0));

  wire pass_issued;
  sequencer #(
    .INPUTS(INPUTS), .PAIRS(PAIRS), .PARTS(PARTS), .ROWS(SEQUENCER_ROWS), .WINDOW_PIXELS(WINDOW_PIXELS),
    .LANES(LANES), .OUTPUTS(OUTPUTS)
  ) sequencer (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[2]), .arrived_i(sequencer_arrived),
    .descriptor_i(sequencer_descriptor), .release_i(release_), .steal_next_i(sequencer_steal_next),
    .valid_a_o(valid_a), .valid_b_o(valid_b), .first_o(sequencer_first), .linear_o(linear),
    .odd_o(sequencer_odd), .set_o(sequencer_set), .read_row_o(read_row),
    .read_pixels_o(sequencer_read_pixels), .base_o(sequencer_base), .offset_o(offset),
    .pass_issued_o(pass_issued), .finished_o(finished)
  );

  wire macc_first = IS_DENSE ? dense_operands_step_first : pair_operands_step_first;
  wire [11:0] macc_address_a = IS_DENSE ? address : address_a;
  wire [24:0] macc_value_a = IS_DENSE ? dense_operands_value_a : pair_operands_value_a;
  wire [24:0] macc_value_b = IS_DENSE ? dense_operands_value_b : pair_operands_value_b;

  wire [47:0] sum_even, sum_odd;
  wire [63:0] read_data;
  edof_macc_array #(
    .BANKS(LANES / 4), .DEPTH(SETS * (OUTPUTS / LANES) * (INPUTS / PARTS + WINDOW_PIXELS)),
    .ROWS(MACC_ROWS), .DENSE(DENSE), .SUM(48), .INIT(MACC_INIT)
  ) macc (
    .clock_i(clock_i), .first_i(macc_first), .address_a_i(macc_address_a), .address_b_i(address_b),
    .value_a_i(macc_value_a), .value_b_i(macc_value_b), .value_c_i(value_c), .value_d_i(value_d),
    .copy_i(drain_copy), .shift_i(drain_take), .sum_even_o(sum_even), .sum_odd_o(sum_odd),
    .write_enable_i(weights_to_5_delayed[0] && !reset_i), .write_bank_i(weights_to_5_delayed[52:47]),
    .write_half_i(weights_to_5_delayed[34]), .write_row_i(weights_to_5_delayed[46:35]),
    .write_data_i(weights_to_5_delayed[33:2]), .read_enable_i(weights_to_5_delayed[1]),
    .read_data_o(read_data)
  );

  wire [7:0] drain_beat;
  wire drain_last, take_set;
  drain #(.LANES(LANES), .OUTPUTS(OUTPUTS)) drain (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[3]), .pass_issued_i(pass_issued),
    .set_i(sequencer_set), .credit_return_i(out_valid_o && out_ready_i), .release_o(release_),
    .copy_o(drain_copy), .take_o(drain_take), .beat_o(drain_beat), .last_o(drain_last),
    .take_set_o(take_set)
  );

  // What belongs to two sums waits while these pass the groups of banks: bit 0 taken, 1 last, 2 set, then
  // which.
  wire [10:0] marks = {drain_beat, take_set, drain_last, drain_take};
  wire [10:0] marks_to_groups_delayed;
  edof_delay #(.WIDTH(11), .CYCLES((LANES + 31) / 32))
    marks_to_groups (.clock_i(clock_i), .data_i(marks), .data_o(marks_to_groups_delayed));

  wire read_valid, results_push, base_push;
  wire [31:0] read_thresholds, read_previous, results_data, results_base;
  wire [1:0] results_done, nonzero, result_saturated, code_saturated, difference_saturated;
  results #(
    .OUTPUTS(OUTPUTS), .HAS_BASE(HAS_BASE), .FEEDS_M(FEEDS_M), .SHRINKS(SHRINKS), .INIT(RESULTS_INIT),
    .BASE_BITS(BASE_BITS), .INPUTS(INPUTS)
  ) results (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[4]), .take_i(marks_to_groups_delayed[0]),
    .beat_i(marks_to_groups_delayed[10:3]), .last_i(marks_to_groups_delayed[1]),
    .set_i(marks_to_groups_delayed[2]), .sum_even_i(sum_even), .sum_odd_i(sum_odd), .shifts_0_i(shifts_0),
    .shifts_1_i(shifts_1), .base_write_i(valid_i && ready_in), .base_words_i(base_i),
    .write_thresholds_i(thresholds_2_q && !reset_i), .write_row_i(address_2_q[12:1]),
    .write_data_i(data_2_q), .read_wanted_i(request_thresholds), .read_row_i(reader_row),
    .read_valid_o(read_valid), .read_thresholds_o(read_thresholds), .read_previous_o(read_previous),
    .push_o(results_push), .data_o(results_data), .done_o(results_done), .base_push_o(base_push),
    .base_o(results_base), .nonzero_o(nonzero), .result_saturated_o(result_saturated),
    .code_saturated_o(code_saturated), .difference_saturated_o(difference_saturated)
  );

  // Out.
  wire [33:0] finished_word = {results_data, results_done};
  wire [33:0] fifo_front_data;
  edof_fifo #(.WIDTH(34), .DEPTH(128)) fifo (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[5]), .push_i(results_push), .data_i(finished_word),
    .valid_o(out_valid_o), .ready_i(out_ready_i), .data_o(fifo_front_data)
  );

  assign out_data_o = fifo_front_data[33:2], out_last_o = fifo_front_data[0], out_set_o = fifo_front_data[1];

  // Bit 0 writes, bit 1 reads.
  wire [52:0] weights_word = {address_2_q, data_2_q, 2'd0};
  wire [52:0] weights_marks = weights_2_q ? 53'd1 : {51'd0, read_2_q, 1'b0};

  wire base_fifo_front_valid_unused;
  edof_fifo #(.WIDTH(32), .DEPTH(128 * FEEDS_M)) base_fifo (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[5]), .push_i(base_push), .data_i(results_base),
    .valid_o(base_fifo_front_valid_unused), .ready_i(out_valid_o && out_ready_i), .data_o(out_base_o)
  );

  registers #(.INIT(REGISTERS_INIT)) registers (
    .clock_i(clock_i), .reset_i(reset_registers_delayed), .write_enable_i(registers_2_q),
    .write_row_i(address_2_q[12:1]), .write_data_i(data_2_q), .shifts_0_o(shifts_0),
    .shifts_1_o(shifts_1), .skip_zeros_o(skip_zeros)
  );

  wire [31:0] counters_value;
  counters counters (
    .clock_i(clock_i), .reset_i(reset_registers_delayed), .enable_i(results_push), .nonzero_i(nonzero),
    .results_i(result_saturated), .codes_i(code_saturated), .differences_i(difference_saturated),
    .snapshot_i(snapshot_2_q), .select_i(status_address_i[1:0]), .value_o(counters_value)
  );

  wire [31:0] check_crc;
  wire [7:0] frames;
  frame_check #(.LAST_BEAT(LAST_BEAT)) check (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[7]), .valid_i(out_valid_o && out_ready_i),
    .data_i(fifo_front_data[33:2]), .snapshot_i(snapshot_2_q), .crc_o(check_crc), .frames_o(frames)
  );

  // Rows 0 and 1 shifts, 2 control, 4 and 5 what the check of frames shows.
  reg [31:0] reader_register;
  always @* begin
    reader_register = {12'd0, shifts_0};
    if (reader_row[2]) reader_register = reader_row[0] ? {24'd0, frames} : check_crc;
    else if (reader_row[1]) reader_register = skip_zeros ? SKIP_BIT : 32'd0;
    else if (reader_row[0]) reader_register = {12'd0, shifts_1};
  end

  wire [5:0] reader_bank;
  wire [31:0] reader_value;
  reader reader (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[6]), .starts_i(command_2_q), .command_i(data_2_q),
    .request_weights_o(request_weights), .grant_i(reads), .bank_o(reader_bank), .row_o(reader_row),
    .weights_i(read_data), .request_thresholds_o(request_thresholds), .thresholds_valid_i(read_valid),
    .thresholds_i(read_thresholds), .previous_i(read_previous), .register_i(reader_register),
    .select_i(status_address_i[1:0]), .value_o(reader_value)
  );

  wire [31:0] read_word = status_address_i[6] ? reader_value : counters_value;
  assign status_o = status_q;
  wire [52:0] weights_to_5_data = weights_word | weights_marks;

  edof_delay #(.WIDTH(53), .CYCLES(3))
    weights_to_5 (.clock_i(clock_i), .data_i(weights_to_5_data), .data_o(weights_to_5_delayed));

  always @(posedge clock_i) begin
    // The host. A weight that both ports read, or a row that is read back, takes the place of a step, four
    // cycles after that was due.
    write_1_q <= write_valid_i;
    address_1_q <= write_address_i;
    data_1_q <= write_data_i;
    weights_2_q <= selected && (address_1_q[20:19] == 2'd0);
    thresholds_2_q <= selected && (address_1_q[20:19] == 2'd1);
    previous_2_q <= selected && (address_1_q[20:19] == 2'd2);
    registers_2_q <= selected && (address_1_q[20:19] == 2'd3);
    command_2_q <= selected && (address_1_q[20:19] == 2'd3) && (address_1_q[12:1] == READ_REGISTER);
    address_2_q <= address_1_q[18:0];
    data_2_q <= data_1_q;
    read_2_q <= reads;
    if (reads) address_2_q <= {reader_bank, reader_row, 1'b0};
    snapshot_2_q <= write_1_q && (address_1_q[24:21] == WHOLE_CHAIN) && (address_1_q[20:19] == 2'd3);
    status_q <= (status_address_i[5:2] == ID) ? read_word : 32'd0;
  end

  wire unused = ^previous_2_q; // Not every bit is read.
endmodule
`default_nettype wire
