// When sums are copied out of the multipliers, and when the copies are taken, two a cycle. A pass's sums stand
// ready seven cycles after its last step and are copied with the last take of the drain before, or later. A
// drain begins when all that it takes has room in the FIFO, and then takes in every cycle, two times at least.
// Two passes may be between their start and their release: the next one's sums come so late that a drain may
// still have some takes to go. Copy and take leave a cycle after they are decided.
// From crates/edof-hdl/src/blocks/drain.rs (Drain).
`default_nettype none
module drain #(
  parameter LANES = 16, // Outputs that are computed at a time.
  parameter OUTPUTS = 16
) (
  input wire clock_i, input wire reset_i, // Forgets everything; held for 48 cycles or more.
  input wire pass_issued_i,               // The last step of a pass is issued.
  input wire set_i,                       // Set of the vector of that pass.
  input wire credit_return_i,             // A beat has left the stage.
  // A pass is released: its sums are taken, or will be before the sums of the next pass but one come.
  output wire release_o,
  output wire copy_o,                     // Copies the sums of a pass.
  output wire take_o,                     // Takes the next two sums.
  output wire [7:0] beat_o,               // Which two of the vector they are.
  output wire last_o,                     // The two sums are the last of their vector.
  output wire take_set_o                  // Set of the vector of the two sums.
);

  localparam [7:0] ALL_CREDITS = 8'd128;
  localparam [31:0] BEFORE_LAST_TAKE = LANES / 2 - 1, RELEASE_AT = LANES > 18 ? 8 : LANES / 2 - 1,
      LAST_BEAT = OUTPUTS / 2 - 1, NEEDED_CREDITS = LANES / 2;

  reg sum_ready_q, sum_set_q, busy_q, loaded_q, is_active_q, at_last_q, drain_set_q, has_credits_q, copy_q;
  reg take_q, last_q, set_q;
  reg [7:0] remaining_q, beat_q, credits_q, taken_beat_q;

  wire [1:0] issued = (pass_issued_i && set_i) ? 2'd3 : {1'b0, pass_issued_i};
  wire copy_now = sum_ready_q && (!busy_q || (is_active_q && at_last_q));
  wire pop = is_active_q || (loaded_q && has_credits_q);
  assign release_o = pop && (remaining_q == RELEASE_AT[7:0]);
  assign copy_o = copy_q, take_o = take_q, beat_o = taken_beat_q, last_o = last_q, take_set_o = set_q;

  wire [1:0] delayed;
  edof_delay #(.WIDTH(2), .CYCLES(6)) in_flight (.clock_i(clock_i), .data_i(issued), .data_o(delayed));

  always @(posedge clock_i) begin
    // A pass whose sums are taken, copied, stand ready: the last take of one may be the copy of the next.
    if (pop) begin
      loaded_q <= 1'b0;
      is_active_q <= 1'b1;
      remaining_q <= remaining_q - 8'd1;
      at_last_q <= remaining_q == 8'd1;
      if (at_last_q) {is_active_q, busy_q} <= 0;
      beat_q <= (beat_q == LAST_BEAT[7:0]) ? 8'd0 : (beat_q + 8'd1);
    end
    if (copy_now) begin
      sum_ready_q <= 1'b0;
      busy_q <= 1'b1;
      loaded_q <= 1'b1;
      remaining_q <= BEFORE_LAST_TAKE[7:0];
      at_last_q <= BEFORE_LAST_TAKE[7:0] == 8'd0;
      drain_set_q <= sum_set_q;
    end
    if (delayed[0]) begin
      sum_ready_q <= 1'b1;
      sum_set_q <= delayed[1];
    end
    // Room in the FIFO.
    if (pop && !credit_return_i) credits_q <= credits_q - 8'd1;
    else if (credit_return_i && !pop) credits_q <= credits_q + 8'd1;
    // A drain may begin in the cycle after the last take of the one before: that one's credit is spent.
    has_credits_q <= (credits_q > NEEDED_CREDITS[7:0]) || ((credits_q == NEEDED_CREDITS[7:0]) && !pop);
    // A cycle later.
    copy_q <= copy_now;
    take_q <= pop;
    taken_beat_q <= beat_q;
    last_q <= beat_q == LAST_BEAT[7:0];
    set_q <= drain_set_q;
    if (reset_i) begin
      {sum_ready_q, busy_q, loaded_q, is_active_q, beat_q} <= 0;
      credits_q <= ALL_CREDITS;
    end
  end
endmodule
`default_nettype wire
