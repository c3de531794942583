// Passes whole windows only. A window whose `last` is early is filled with zeros, one beat per cycle. If `last`
// is late, the excess beats are discarded. Both kinds are counted, and the beat after `last` is the first of
// the next window. A correct window passes within the cycle.
//
// Within the cycle: out_ready_i -> ready_o
// Within the cycle: valid_i -> out_valid_o
// Within the cycle: data_i -> out_data_o
// Within the cycle: set_i -> out_set_o
// From crates/edof-hdl/src/blocks/window_guard.rs (WindowGuard).
`default_nettype none
module window_guard (
  input wire clock_i, input wire reset_i, // Waits for a window's first beat.
  input wire reset_counters_i,            // Counters back to zero.
  input wire valid_i,                     // The input beat is valid.
  output wire ready_o,                    // The block accepts a valid input in this cycle.
  input wire [31:0] data_i,               // Two pixels of the beat, the left one low.
  input wire last_i,                      // The sender marks the beat as the last of its window.
  input wire set_i,                       // The set of weights for this window.
  output wire out_valid_o,                // The output beat is valid.
  input wire out_ready_i,                 // The receiver accepts the output in this cycle.
  output wire [31:0] out_data_o,          // Two pixels of the beat, the left one low.
  output wire out_last_o,                 // The beat is the last of its window.
  output wire out_set_o,                  // The window's set.
  // Whether a window was too short or too long since the last reset or snapshot.
  output wire fault_o,
  input wire snapshot_i,                  // Copies the counters to be shown, and starts them anew.
  output wire [31:0] too_short_o,         // Windows that were too short, as copied.
  output wire [31:0] too_long_o           // Windows that were too long.
);

  localparam [6:0] BEFORE_LAST = 7'd30;

  reg [6:0] beat_q;
  reg at_end_q, fill_q, drop_q, set_q, fault_q, short_q, long_q;

  wire is_available = fill_q || (valid_i && !drop_q);
  wire advance = is_available && out_ready_i;
  wire accept = advance && !fill_q;
  assign ready_o = drop_q || (out_ready_i && !fill_q);
  assign out_valid_o = is_available;
  assign out_data_o = fill_q ? 32'd0 : data_i;
  assign out_set_o = fill_q ? set_q : set_i;
  assign out_last_o = at_end_q, fault_o = fault_q;

  counter count_short (
    .clock_i(clock_i), .reset_i(reset_counters_i), .enable_i(short_q), .events_i(2'd1),
    .snapshot_i(snapshot_i), .count_o(too_short_o)
  );
  counter count_long (
    .clock_i(clock_i), .reset_i(reset_counters_i), .enable_i(long_q), .events_i(2'd1),
    .snapshot_i(snapshot_i), .count_o(too_long_o)
  );

  always @(posedge clock_i) begin
    {short_q, long_q} <= 0;
    if (advance) begin
      beat_q <= beat_q + 7'd1;
      at_end_q <= beat_q == BEFORE_LAST;
      if (at_end_q) {beat_q, fill_q} <= 0;
    end
    if (accept) begin
      set_q <= set_i;
      fill_q <= last_i && !at_end_q;
      short_q <= last_i && !at_end_q;
      drop_q <= at_end_q && !last_i;
      long_q <= at_end_q && !last_i;
    end
    if (drop_q && valid_i && last_i) drop_q <= 1'b0;
    fault_q <= (!(reset_counters_i || snapshot_i)) && (fault_q || short_q || long_q);
    if (reset_i) {beat_q, at_end_q, fill_q, drop_q, short_q, long_q} <= 0;
  end
endmodule
`default_nettype wire
