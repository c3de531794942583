// When sums are copied out of the multipliers, and when the copies are taken, two a cycle.
// A pass's sums stand ready seven cycles after its last step and are copied with the last take of the drain
// before, or later. A drain
// begins when all that it takes has room in the FIFO, and then takes in every cycle, two times at least. Two
// passes may be between
// their start and their release: the next one's sums come so late that a drain may still have some takes to go.
// Copy and take leave a cycle after they are decided.
//
// No output follows an input within the cycle.
//
// From crates/edof-hdl/src/blocks/drain.rs (Drain).
`default_nettype none

module drain #(
  parameter [7:0] BEFORE_LAST_TAKE = 8'd7,
  parameter [7:0] RELEASE_AT = 8'd7,
  parameter [7:0] LAST_BEAT = 8'd7,
  parameter [7:0] WANTED_CREDITS = 8'd8
) (
  input wire clock_i,       // Clock.
  input wire reset_i,       // Forgets everything; held for 48 cycles or more.

  input wire begins_i,      // A pass begins.
  input wire pass_issued_i, // The last step of a pass is issued.
  input wire set_i,         // Its vector's set.
  input wire returned_i,    // A beat has left the stage.
  output wire may_start_o,  // Whether the next pass may begin.
  output wire copy_o,       // Copies the sums of a pass.
  output wire take_o,       // Takes the next two sums.
  output wire [7:0] beat_o, // Which two of the vector they are.
  output wire last_o,       // Whether they are its last.
  output wire taken_set_o   // Its set.
);

  localparam [7:0] ALL_CREDITS = 8'd128;

  wire [1:0] on_the_way_later;
  reg sum_ready_q, sum_set_q, busy_q, loaded_q, on_q, at_last_q, drain_set_q, enough_q, copy_q, take_q, last_q;
  reg set_q;
  reg [1:0] open_q;
  reg [7:0] rest_q, beat_q, credits_q, taken_beat_q;

  // drain.rs:94
  wire [1:0] passed = (pass_issued_i && set_i) ? 2'd3 : (pass_issued_i ? 2'd1 : 2'd0);
  wire copies = sum_ready_q && (!busy_q || (on_q && at_last_q));
  wire pop = on_q || (loaded_q && enough_q);
  wire releases = pop && (rest_q == RELEASE_AT);

  // drain.rs:148: A drain may begin in the cycle after the last take of the one before: that one's credit is
  // spent.
  assign may_start_o = !open_q[1];

  // drain.rs:156: A cycle later.
  assign copy_o = copy_q;
  assign take_o = take_q;
  assign beat_o = taken_beat_q;
  assign last_o = last_q;
  assign taken_set_o = set_q;

  edof_delay #(.WIDTH(2), .CYCLES(6)) on_the_way (
    .clock_i(clock_i), .now_i(passed), .later_o(on_the_way_later)
  );

  always @(posedge clock_i) begin
    // drain.rs:107: A pass whose sums are taken, copied, stand ready: the last take of one may be the copy of
    // the next.
    if (pop) begin
      loaded_q <= 1'b0;
      on_q <= 1'b1;
      rest_q <= rest_q - 8'd1;
      at_last_q <= rest_q == 8'd1;
      if (at_last_q) begin
        on_q <= 1'b0;
        busy_q <= 1'b0;
      end
      beat_q <= beat_q + 8'd1;
      if (beat_q == LAST_BEAT) beat_q <= 8'd0;
    end
    if (copies) begin
      sum_ready_q <= 1'b0;
      busy_q <= 1'b1;
      loaded_q <= 1'b1;
      rest_q <= BEFORE_LAST_TAKE;
      at_last_q <= !(|BEFORE_LAST_TAKE);
      drain_set_q <= sum_set_q;
    end
    if (on_the_way_later[0]) begin
      sum_ready_q <= 1'b1;
      sum_set_q <= on_the_way_later[1];
    end
    // drain.rs:135: Passes that have begun and are not released; room in the FIFO.
    if (begins_i && !releases) open_q <= open_q + 2'd1;
    else if (releases && !begins_i) open_q <= open_q - 2'd1;
    if (pop && !returned_i) credits_q <= credits_q - 8'd1;
    else if (returned_i && !pop) credits_q <= credits_q + 8'd1;
    // drain.rs:146: A drain may begin in the cycle after the last take of the one before: that one's credit is
    // spent.
    enough_q <= (credits_q > WANTED_CREDITS) || ((credits_q == WANTED_CREDITS) && !pop);
    // drain.rs:151: A cycle later.
    copy_q <= copies;
    take_q <= pop;
    taken_beat_q <= beat_q;
    last_q <= beat_q == LAST_BEAT;
    set_q <= drain_set_q;
    if (reset_i) begin
      sum_ready_q <= 1'b0;
      open_q <= 2'd0;
      busy_q <= 1'b0;
      loaded_q <= 1'b0;
      on_q <= 1'b0;
      beat_q <= 8'd0;
      credits_q <= ALL_CREDITS;
    end
  end
endmodule

`default_nettype wire
