// Hands on whole windows only. One whose `last` comes too early is filled up with zeros, a beat a cycle; of one
// whose `last` comes
// too late the rest is thrown away. Each is counted, and the beat after its `last` is the first of the next
// window. A window that is
// right passes within the cycle.
//
// Within the cycle: out_ready_i -> ready_o
// Within the cycle: valid_i -> out_valid_o
// Within the cycle: data_i -> out_data_o
// Within the cycle: set_i -> out_set_o
//
// From crates/edof-hdl/src/blocks/window_guard.rs (WindowGuard).
`default_nettype none

module window_guard (
  input wire clock_i,             // Clock.
  input wire reset_i,             // Waits for a window's first beat.

  input wire reset_counters_i,    // Counters back to zero.
  input wire valid_i,             // A beat stands on the input.
  output wire ready_o,            // It is taken in this cycle, if there is one.
  input wire [31:0] data_i,       // Its two pixels.
  input wire last_i,              // Whether the sender says that it is its window's last.
  input wire set_i,               // The set of weights for this window.
  output wire out_valid_o,        // A beat stands on the output.
  input wire out_ready_i,         // The receiver takes it.
  output wire [31:0] out_data_o,  // Its two pixels.
  output wire out_last_o,         // Whether it is its window's last.
  output wire out_set_o,          // The window's set.
  // Whether a window was too short or too long since the last reset or snapshot.
  output wire fault_o,
  input wire snapshot_i,          // Copies the counters to be shown, and starts them anew.
  output wire [31:0] too_short_o, // Windows that were too short, as copied.
  output wire [31:0] too_long_o   // Windows that were too long.
);

  localparam [6:0] BEFORE_LAST = 7'd30;

  reg [6:0] beat_q;
  reg at_end_q, fills_q, drops_q, set_q, fault_q, short_q, long_q;

  // window_guard.rs:82
  wire offers = fills_q || (valid_i && !drops_q);
  wire passes = offers && out_ready_i;
  wire comes = passes && !fills_q;
  assign ready_o = drops_q || (out_ready_i && !fills_q);
  assign out_valid_o = offers;
  assign out_data_o = fills_q ? 32'd0 : data_i;
  assign out_set_o = fills_q ? set_q : set_i;
  assign out_last_o = at_end_q;
  assign fault_o = fault_q;

  counter count_short (
    .clock_i(clock_i), .reset_i(reset_counters_i), .enable_i(short_q), .events_i(2'd1),
    .snapshot_i(snapshot_i), .count_o(too_short_o)
  );

  counter count_long (
    .clock_i(clock_i), .reset_i(reset_counters_i), .enable_i(long_q), .events_i(2'd1),
    .snapshot_i(snapshot_i), .count_o(too_long_o)
  );

  always @(posedge clock_i) begin
    // window_guard.rs:95
    short_q <= 1'b0;
    long_q <= 1'b0;
    if (passes) begin
      beat_q <= beat_q + 7'd1;
      at_end_q <= beat_q == BEFORE_LAST;
      if (at_end_q) begin
        beat_q <= 7'd0;
        fills_q <= 1'b0;
      end
    end
    if (comes) begin
      set_q <= set_i;
      fills_q <= last_i && !at_end_q;
      short_q <= last_i && !at_end_q;
      drops_q <= at_end_q && !last_i;
      long_q <= at_end_q && !last_i;
    end
    if (drops_q && valid_i && last_i) drops_q <= 1'b0;
    fault_q <= fault_q || short_q || long_q;
    if (reset_i) begin
      beat_q <= 7'd0;
      at_end_q <= 1'b0;
      fills_q <= 1'b0;
      drops_q <= 1'b0;
      short_q <= 1'b0;
      long_q <= 1'b0;
    end
    if (reset_counters_i || snapshot_i) fault_q <= 1'b0;
  end
endmodule

`default_nettype wire
