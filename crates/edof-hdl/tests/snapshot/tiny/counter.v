// Counts up to two events per cycle. `count` is the value at the last snapshot. Reset and snapshot pass through
// registers.
// From crates/edof-hdl/src/blocks/counters.rs (Counter).
`default_nettype none
module counter (
  input wire clock_i, input wire reset_i, // Sets the count to zero.
  input wire enable_i,                    // Events are counted in this cycle.
  input wire [1:0] events_i,              // Number of events in this cycle: the count of set bits.
  input wire snapshot_i,                  // Copies the count to `count` and restarts from zero.
  // Events between the last two snapshots; before the second snapshot, events since reset.
  output wire [31:0] count_o
);

  reg [1:0] increment_q;
  reg [31:0] count_q, latched_q;

  wire [3:0] marks = {snapshot_i, reset_i, snapshot_i, reset_i};
  wire [3:0] delayed;
  edof_delay #(.WIDTH(4), .CYCLES(1)) marks_q (.clock_i(clock_i), .data_i(marks), .data_o(delayed));

  wire [31:0] base_count = delayed[1] ? 32'd0 : count_q;
  assign count_o = latched_q;

  always @(posedge clock_i) begin
    increment_q <= enable_i ? ({1'b0, events_i[0]} + {1'b0, events_i[1]}) : 2'd0;
    count_q <= delayed[0] ? 32'd0 : (base_count + {30'd0, increment_q});
    if (delayed[3]) latched_q <= count_q;
    if (delayed[2]) latched_q <= 32'd0;
  end
endmodule
`default_nettype wire
