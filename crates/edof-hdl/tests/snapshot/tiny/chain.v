// The stages of a design, I, each M, F: windows in, patches out. Where F has a linear path it takes the window
// with I. The outputs `between_*` show what stands between the stages, for observation; they cost nothing where
// they are left open.
// From crates/edof-hdl/src/blocks/chain.rs (Chain).
`default_nettype none
module chain (
  // Forgets every vector and what was written to registers; held for 48 cycles or more, and two more pass until
  // something can be taken.
  input wire clock_i, input wire reset_i,
  input wire flush_i,                     // Drops every vector and nothing else; held for as long as `reset`.
  input wire window_valid_i,              // Two input pixels of a window are valid.
  output wire window_ready_o,             // The chain accepts a valid window beat in this cycle.
  input wire [31:0] window_data_i,        // Two pixels, the even one low.
  input wire window_last_i,               // The beat is the last of its window.
  input wire window_set_i,                // The set of weights for this window.
  output wire patch_valid_o,              // Two output words of a patch are valid.
  input wire patch_ready_i,               // The receiver accepts the output in this cycle.
  output wire [31:0] patch_data_o,        // Two words of the patch, the even one low.
  output wire patch_last_o,               // The beat is the last of its patch.
  output wire patch_set_o,                // The set that it was made with.
  // The word to write is valid (`edof_device::design::memory::address`).
  input wire write_valid_i,
  input wire [24:0] write_address_i,      // Address of the word to write.
  input wire [31:0] write_data_i,         // Word to write.
  // What to show: bit 6 counters or what was read back, then stage (4 bits; 15 for the windows that come in),
  // then which (2 bits).
  input wire [6:0] status_address_i,
  // Word that `status_address` selected, one cycle later; counters have the values of the last snapshot.
  output wire [31:0] status_o,
  // A window was too short or too long, since the last reset or snapshot of the counters.
  output wire window_fault_o,
  output wire between_valid_0_o,          // A stage offers a beat to the next (observation only).
  output wire between_valid_1_o,
  output wire between_valid_2_o,
  output wire between_ready_0_o,          // The next takes it.
  output wire between_ready_1_o,
  output wire between_ready_2_o,
  output wire [31:0] between_data_0_o,    // Two words of the beat, the even one low.
  output wire [31:0] between_data_1_o,
  output wire [31:0] between_data_2_o,
  output wire [31:0] between_base_0_o,    // Base words of the same two elements.
  output wire [31:0] between_base_1_o,
  output wire [31:0] between_base_2_o,
  output wire between_last_0_o,           // The beat is the last of its vector.
  output wire between_last_1_o,
  output wire between_last_2_o,
  output wire between_set_0_o,            // The vector's set.
  output wire between_set_1_o,
  output wire between_set_2_o
);

  localparam [3:0] WHOLE_CHAIN = 4'd15;

  wire stages_0_ready, stages_3_window_ready;
  reg guard_reset_q, guard_reset_counters_q, guard_snapshot_1_q, guard_snapshot_q;
  reg [31:0] guard_status_q;

  wire guard_out_valid, guard_out_last, guard_out_set;
  wire [31:0] guard_out_data, too_short, too_long;
  window_guard guard (
    .clock_i(clock_i), .reset_i(guard_reset_q), .reset_counters_i(guard_reset_counters_q),
    .valid_i(window_valid_i), .ready_o(window_ready_o), .data_i(window_data_i), .last_i(window_last_i),
    .set_i(window_set_i), .out_valid_o(guard_out_valid),
    .out_ready_i(stages_0_ready && stages_3_window_ready), .out_data_o(guard_out_data),
    .out_last_o(guard_out_last), .out_set_o(guard_out_set), .fault_o(window_fault_o),
    .snapshot_i(guard_snapshot_q), .too_short_o(too_short), .too_long_o(too_long)
  );

  wire stages_0_valid = guard_out_valid && stages_3_window_ready;
  wire stages_0_window_ready_unused;
  wire [31:0] stages_0_status;
  stage #(
    .ID(4'd0), .INPUTS(64), .WINDOW_PIXELS(0), .PARTS(2), .LANES(16), .OUTPUTS(16), .FEEDS_M(1),
    .TWO_ROWS(1'b0), .DENSE(1), .MACC_ROWS(2), .MACC_INIT("stage0_bank"), .ALIGNS(1'b0), .WINDOWS(0),
    .PAIRS(0), .SEQUENCER_ROWS(1), .HAS_BASE(0), .SHRINKS(1'b1), .RESULTS_INIT("stage0_thresholds.mem"),
    .BASE_BITS(48'd0), .REGISTERS_INIT("stage0_shifts.mem"), .LAST_BEAT(28'd383)
  ) stages_0 (
    .clock_i(clock_i), .reset_i(reset_i), .flush_i(flush_i), .valid_i(stages_0_valid),
    .ready_o(stages_0_ready), .data_i(guard_out_data), .base_i(32'd0), .last_i(guard_out_last),
    .set_i(guard_out_set), .window_valid_i(1'b0), .window_ready_o(stages_0_window_ready_unused),
    .window_data_i(32'd0), .window_last_i(1'b0), .out_valid_o(between_valid_0_o),
    .out_ready_i(between_ready_0_o), .out_data_o(between_data_0_o), .out_base_o(between_base_0_o),
    .out_last_o(between_last_0_o), .out_set_o(between_set_0_o), .write_valid_i(write_valid_i),
    .write_address_i(write_address_i), .write_data_i(write_data_i), .status_address_i(status_address_i),
    .status_o(stages_0_status)
  );

  wire stages_1_window_ready_unused;
  wire [31:0] stages_1_status;
  stage #(
    .ID(4'd1), .INPUTS(16), .WINDOW_PIXELS(0), .PARTS(1), .LANES(8), .OUTPUTS(16), .FEEDS_M(1),
    .TWO_ROWS(1'b0), .DENSE(0), .MACC_ROWS(1), .MACC_INIT("stage1_bank"), .ALIGNS(1'b0), .WINDOWS(0),
    .PAIRS(1), .SEQUENCER_ROWS(1), .HAS_BASE(1), .SHRINKS(1'b1), .RESULTS_INIT("stage1_thresholds.mem"),
    .BASE_BITS(48'hffffffffffff), .REGISTERS_INIT("stage1_shifts.mem"), .LAST_BEAT(28'd383)
  ) stages_1 (
    .clock_i(clock_i), .reset_i(reset_i), .flush_i(flush_i), .valid_i(between_valid_0_o),
    .ready_o(between_ready_0_o), .data_i(between_data_0_o), .base_i(between_base_0_o),
    .last_i(between_last_0_o), .set_i(between_set_0_o), .window_valid_i(1'b0),
    .window_ready_o(stages_1_window_ready_unused), .window_data_i(32'd0), .window_last_i(1'b0),
    .out_valid_o(between_valid_1_o), .out_ready_i(between_ready_1_o), .out_data_o(between_data_1_o),
    .out_base_o(between_base_1_o), .out_last_o(between_last_1_o), .out_set_o(between_set_1_o),
    .write_valid_i(write_valid_i), .write_address_i(write_address_i), .write_data_i(write_data_i),
    .status_address_i(status_address_i), .status_o(stages_1_status)
  );

  wire stages_2_window_ready_unused;
  wire [31:0] stages_2_status;
  stage #(
    .ID(4'd2), .INPUTS(16), .WINDOW_PIXELS(0), .PARTS(1), .LANES(8), .OUTPUTS(16), .FEEDS_M(0),
    .TWO_ROWS(1'b0), .DENSE(0), .MACC_ROWS(1), .MACC_INIT("stage2_bank"), .ALIGNS(1'b0), .WINDOWS(0),
    .PAIRS(1), .SEQUENCER_ROWS(1), .HAS_BASE(1), .SHRINKS(1'b1), .RESULTS_INIT("stage2_thresholds.mem"),
    .BASE_BITS(48'hffffffffffff), .REGISTERS_INIT("stage2_shifts.mem"), .LAST_BEAT(28'd383)
  ) stages_2 (
    .clock_i(clock_i), .reset_i(reset_i), .flush_i(flush_i), .valid_i(between_valid_1_o),
    .ready_o(between_ready_1_o), .data_i(between_data_1_o), .base_i(between_base_1_o),
    .last_i(between_last_1_o), .set_i(between_set_1_o), .window_valid_i(1'b0),
    .window_ready_o(stages_2_window_ready_unused), .window_data_i(32'd0), .window_last_i(1'b0),
    .out_valid_o(between_valid_2_o), .out_ready_i(between_ready_2_o), .out_data_o(between_data_2_o),
    .out_base_o(between_base_2_o), .out_last_o(between_last_2_o), .out_set_o(between_set_2_o),
    .write_valid_i(write_valid_i), .write_address_i(write_address_i), .write_data_i(write_data_i),
    .status_address_i(status_address_i), .status_o(stages_2_status)
  );

  wire stages_3_window_valid = guard_out_valid && stages_0_ready;
  wire [31:0] stages_3_out_base_unused, stages_3_status;
  stage #(
    .ID(4'd3), .INPUTS(16), .WINDOW_PIXELS(64), .PARTS(1), .LANES(32), .OUTPUTS(128), .FEEDS_M(0),
    .TWO_ROWS(1'b1), .DENSE(0), .MACC_ROWS(2), .MACC_INIT("stage3_bank"), .ALIGNS(1'b1), .WINDOWS(32),
    .PAIRS(1), .SEQUENCER_ROWS(2), .HAS_BASE(0), .SHRINKS(1'b0), .RESULTS_INIT(""), .BASE_BITS(48'd0),
    .REGISTERS_INIT("stage3_shifts.mem"), .LAST_BEAT(28'd3071)
  ) stages_3 (
    .clock_i(clock_i), .reset_i(reset_i), .flush_i(flush_i), .valid_i(between_valid_2_o),
    .ready_o(between_ready_2_o), .data_i(between_data_2_o), .base_i(between_base_2_o),
    .last_i(between_last_2_o), .set_i(between_set_2_o), .window_valid_i(stages_3_window_valid),
    .window_ready_o(stages_3_window_ready), .window_data_i(guard_out_data),
    .window_last_i(guard_out_last), .out_valid_o(patch_valid_o), .out_ready_i(patch_ready_i),
    .out_data_o(patch_data_o), .out_base_o(stages_3_out_base_unused), .out_last_o(patch_last_o),
    .out_set_o(patch_set_o), .write_valid_i(write_valid_i), .write_address_i(write_address_i),
    .write_data_i(write_data_i), .status_address_i(status_address_i), .status_o(stages_3_status)
  );

  wire [31:0] status_word = guard_status_q | stages_0_status | stages_1_status | stages_2_status
      | stages_3_status;
  assign status_o = status_word;

  always @(posedge clock_i) begin
    guard_reset_q <= reset_i || flush_i;
    guard_reset_counters_q <= reset_i;
    guard_snapshot_1_q <= write_valid_i && (write_address_i[24:21] == WHOLE_CHAIN)
        && (write_address_i[20:19] == 2'd3);
    guard_snapshot_q <= guard_snapshot_1_q;
    // The host.
    guard_status_q <= 32'd0;
    if (status_address_i[5:2] == WHOLE_CHAIN) guard_status_q <= status_address_i[0] ? too_long : too_short;
  end
endmodule
`default_nettype wire
