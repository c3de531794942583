// Counts up to two a cycle, and shows what it had counted when it was last told to. Reset and snapshot come
// through registers of
// their own.
//
// No output follows an input within the cycle.
//
// From crates/edof-hdl/src/blocks/counters.rs (Counter).
`default_nettype none

module counter (
  input wire clock_i,        // Clock.
  input wire reset_i,        // Back to zero.

  input wire enable_i,       // Whether to count.
  input wire [1:0] events_i, // What: as many as there are ones.
  input wire snapshot_i,     // Shows what was counted so far, and counts anew.
  // How many there were between the last two snapshots; before the second, since reset.
  output wire [31:0] count_o
);

  reg [3:0] marks;
  wire [3:0] marks_q_later;
  reg [1:0] more_q;
  reg [31:0] count_q, shown_q;

  // counters.rs:38: Bits 0 and 2 reset, 1 and 3 snapshot: a register for what counts, one for what is shown.
  always @* begin
    marks = 4'd0;
    if (reset_i) marks = marks | 4'd5;
    if (snapshot_i) marks = marks | 4'ha;
  end

  // counters.rs:51: Bits 0 and 2 reset, 1 and 3 snapshot: a register for what counts, one for what is shown.
  wire [31:0] kept = marks_q_later[1] ? 32'd0 : count_q;
  assign count_o = shown_q;

  edof_delay #(.WIDTH(4), .CYCLES(1)) marks_q (.clock_i(clock_i), .now_i(marks), .later_o(marks_q_later));

  always @(posedge clock_i) begin
    // counters.rs:46: Bits 0 and 2 reset, 1 and 3 snapshot: a register for what counts, one for what is shown.
    more_q <= 2'd0;
    if (enable_i) more_q <= {1'b0, events_i[0]} + {1'b0, events_i[1]};
    count_q <= kept + {30'd0, more_q};
    if (marks_q_later[0]) count_q <= 32'd0;
    if (marks_q_later[3]) shown_q <= count_q;
    if (marks_q_later[2]) shown_q <= 32'd0;
  end
endmodule

`default_nettype wire
