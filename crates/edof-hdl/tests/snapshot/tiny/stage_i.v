// One stage of the calculator, I, M or F: vectors in, vectors out, two elements a beat; docs/calculator.md has
// its cycles. Values are multiplied as they come out of the store; sums are copied, drained, rounded, shrunk
// and sent on.
// From crates/edof-hdl/src/blocks/stage.rs (Stage).
`default_nettype none
module stage_i (
  input wire clock_i,                // Clock.
  // Forgets every vector and what was written to registers; held for 48 cycles or more, and two more pass until
  // something can be taken.
  input wire reset_i,
  input wire flush_i,                // Drops every vector and nothing else; held for as long as `reset`.
  input wire valid_i,                // The input beat is valid.
  output wire ready_o,               // The block accepts a valid input in this cycle.
  input wire [31:0] data_i,          // Two words of the beat, the even one low.
  input wire [31:0] base_i,          // Base words of the same two elements (M).
  input wire last_i,                 // The beat is the last of its vector.
  input wire set_i,                  // The vector's set.
  output wire window_ready_o,        // The block accepts a valid input in this cycle.
  output wire out_valid_o,           // The output beat is valid.
  input wire out_ready_i,            // The receiver accepts the output in this cycle.
  output wire [31:0] out_data_o,     // Two words of the beat, the even one low.
  output wire [31:0] out_base_o,     // Base words of the same two elements.
  output wire out_last_o,            // The beat is the last of its vector.
  output wire out_set_o,             // The vector's set.
  input wire write_valid_i,          // The word to write is valid (`edof_device::design::memory::address`).
  input wire [24:0] write_address_i, // Address of the word to write.
  input wire [31:0] write_data_i,    // Word to write.
  // What to show: bit 6 counters or what was read back, then stage (4 bits), then which (2 bits).
  input wire [6:0] status_address_i,
  // Word that `status_address` selected, one cycle later; 0 from all other stages.
  output wire [31:0] status_o
);

  localparam [3:0] ID = 4'd0;
  localparam INPUTS = 64;
  localparam WINDOW_PIXELS = 0; // Pixels of the linear path (F).
  localparam PARTS = 2;         // Parts of a vector that are read in step (I).
  localparam LANES = 16;        // Outputs that are computed at a time.
  localparam OUTPUTS = 16;
  localparam SETS = 2;          // Sets of weights.
  localparam FEEDS_M = 1;       // 1 where the next stage is an M, so that base words are sent.
  localparam [3:0] WHOLE_CHAIN = 4'd15;
  localparam BOTH_PORTS = 1'b0;
  localparam [11:0] READ_REGISTER = 12'd3;
  localparam [31:0] SKIP_BIT = 32'd1;

  wire valid_a, sequencer_first, sequencer_odd, finished, release_, drain_copy, drain_take, request_weights;
  wire request_thresholds;
  wire [8:0] read_row;
  wire [11:0] sequencer_base, offset, reader_row;
  wire [19:0] shifts_0, shifts_1;
  reg [31:0] status_q, data_1_q, data_2_q;
  reg write_1_q, weights_2_q, thresholds_2_q, previous_2_q, registers_2_q, command_2_q, snapshot_2_q, read_2_q;
  reg [24:0] address_1_q;
  reg [18:0] address_2_q;
  wire [52:0] weights_to_5_delayed;

  // Each part has a register for its reset.
  wire [7:0] resets = (reset_i || flush_i) ? 8'hff : 8'd0;
  assign window_ready_o = 1'b1;

  wire [7:0] reset_parts_delayed;
  edof_delay #(.WIDTH(8), .CYCLES(1))
    reset_parts (.clock_i(clock_i), .data_i(resets), .data_o(reset_parts_delayed));
  wire reset_registers_delayed;
  edof_delay #(.WIDTH(1), .CYCLES(1))
    reset_registers (.clock_i(clock_i), .data_i(reset_i), .data_o(reset_registers_delayed));

  wire vectors_arrived;
  wire [11:0] vectors_descriptor;
  wire [31:0] pair_a, pair_b, pair_c, pair_d;
  dense_store vectors (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[0]), .valid_i(valid_i), .ready_o(ready_o),
    .data_i(data_i), .last_i(last_i), .set_i(set_i), .arrived_o(vectors_arrived),
    .descriptor_o(vectors_descriptor), .read_row_i(read_row), .pair_a_o(pair_a), .pair_b_o(pair_b),
    .pair_c_o(pair_c), .pair_d_o(pair_d), .finished_i(finished)
  );

  wire step_first;
  wire [11:0] address;
  wire [24:0] dense_operands_value_a, dense_operands_value_b, dense_operands_value_c, dense_operands_value_d;
  dense_operands dense_operands (
    .clock_i(clock_i), .valid_i(valid_a), .first_i(sequencer_first), .odd_i(sequencer_odd),
    .base_i(sequencer_base), .offset_i(offset), .pair_a_i(pair_a), .pair_b_i(pair_b), .pair_c_i(pair_c),
    .pair_d_i(pair_d), .step_first_o(step_first), .address_o(address), .value_a_o(dense_operands_value_a),
    .value_b_o(dense_operands_value_b), .value_c_o(dense_operands_value_c),
    .value_d_o(dense_operands_value_d)
  );

  wire selected = write_1_q && (address_1_q[24:21] == ID);

  // A row is read back in a cycle without a write, whatever that would write.
  wire reads = request_weights && !write_1_q;
  wire sequencer_steal_next = reads || (BOTH_PORTS && selected && (address_1_q[20:19] == 2'd0));

  wire sequencer_valid_b_unused, sequencer_linear_unused, sequencer_set, pass_issued;
  wire [6:0] sequencer_read_pixels_unused;
  sequencer #(
    .INPUTS(64), .PAIRS(0), .PARTS(2), .ROWS(1), .WINDOW_PIXELS(0), .LANES(16), .OUTPUTS(16)
  ) sequencer (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[2]), .arrived_i(vectors_arrived),
    .descriptor_i(vectors_descriptor), .release_i(release_), .steal_next_i(sequencer_steal_next),
    .valid_a_o(valid_a), .valid_b_o(sequencer_valid_b_unused), .first_o(sequencer_first),
    .linear_o(sequencer_linear_unused), .odd_o(sequencer_odd), .set_o(sequencer_set),
    .read_row_o(read_row), .read_pixels_o(sequencer_read_pixels_unused), .base_o(sequencer_base),
    .offset_o(offset), .pass_issued_o(pass_issued), .finished_o(finished)
  );

  wire [47:0] sum_even, sum_odd;
  wire [63:0] read_data;
  edof_macc_array #(
    .BANKS(LANES / 4), .DEPTH(SETS * (OUTPUTS / LANES) * (INPUTS / PARTS + WINDOW_PIXELS)), .ROWS(2),
    .DENSE(1), .SUM(48), .INIT("stage0_bank")
  ) macc (
    .clock_i(clock_i), .first_i(step_first), .address_a_i(address), .address_b_i(12'd0),
    .value_a_i(dense_operands_value_a), .value_b_i(dense_operands_value_b),
    .value_c_i(dense_operands_value_c), .value_d_i(dense_operands_value_d), .copy_i(drain_copy),
    .shift_i(drain_take), .sum_even_o(sum_even), .sum_odd_o(sum_odd),
    .write_enable_i(weights_to_5_delayed[0] && !reset_i), .write_bank_i(weights_to_5_delayed[52:47]),
    .write_half_i(weights_to_5_delayed[34]), .write_row_i(weights_to_5_delayed[46:35]),
    .write_data_i(weights_to_5_delayed[33:2]), .read_enable_i(weights_to_5_delayed[1]),
    .read_data_o(read_data)
  );

  wire [7:0] drain_beat;
  wire drain_last, take_set;
  drain #(.LANES(16), .OUTPUTS(16)) drain (
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
    .OUTPUTS(16), .HAS_BASE(0), .FEEDS_M(1), .SHRINKS(1'b1), .INIT("stage0_thresholds.mem"),
    .BASE_BITS(48'd0), .INPUTS(64)
  ) results (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[4]), .take_i(marks_to_groups_delayed[0]),
    .beat_i(marks_to_groups_delayed[10:3]), .last_i(marks_to_groups_delayed[1]),
    .set_i(marks_to_groups_delayed[2]), .sum_even_i(sum_even), .sum_odd_i(sum_odd), .shifts_0_i(shifts_0),
    .shifts_1_i(shifts_1), .base_write_i(valid_i && ready_o), .base_words_i(base_i),
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

  wire skip_zeros;
  registers #(.INIT("stage0_shifts.mem")) registers (
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
  frame_check #(.LAST_BEAT(28'd383)) check (
    .clock_i(clock_i), .reset_i(reset_parts_delayed[7]), .valid_i(out_valid_o && out_ready_i),
    .data_i(fifo_front_data[33:2]), .snapshot_i(snapshot_2_q), .crc_o(check_crc), .frames_o(frames)
  );

  // Rows 0 and 1 shifts, 2 control, 4 and 5 what the check of frames shows.
  reg [31:0] reader_register;
  always @* begin
    reader_register = {12'd0, shifts_0};
    if (reader_row[2]) begin
      reader_register = check_crc;
      if (reader_row[0]) reader_register = {24'd0, frames};
    end else if (reader_row[1]) begin
      reader_register = 32'd0;
      if (skip_zeros) reader_register = SKIP_BIT;
    end else if (reader_row[0]) begin
      reader_register = {12'd0, shifts_1};
    end
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
    status_q <= 32'd0;
    if (status_address_i[5:2] == ID) status_q <= read_word;
  end

  wire unused = ^{reset_parts_delayed, previous_2_q}; // Not every bit is read.
endmodule
`default_nettype wire
