// Which step of which pass is next: over a vector's pairs first, then over the window (F), once a pass, one
// step a cycle. What a pass must know is looked up before it begins, so that the next begins in the cycle after
// the last step of the one before; all that a step reads comes out of registers. In the cycle after
// `steal_next`, no step is issued and the current pass is held. At most two passes are begun and not released.
// The registers that decide whether a pass begins are all in this block, so that the decision crosses no
// distance (docs/fabric.md).
// From crates/edof-hdl/src/blocks/sequencer.rs (Sequencer).
`default_nettype none
module sequencer #(
  parameter INPUTS = 64,
  parameter PAIRS = 0,         // 1 where elements come as pairs of index and value (M, F).
  parameter PARTS = 2,         // Parts of a vector that are read in step (I).
  parameter ROWS = 1,          // Rows of weights in a step (M, F).
  parameter WINDOW_PIXELS = 0, // Pixels of the linear path (F).
  parameter LANES = 16,        // Outputs that are computed at a time.
  parameter OUTPUTS = 16
) (
  input wire clock_i, input wire reset_i, // Back to the start.
  input wire arrived_i,                   // A vector is whole.
  // What must be known of it: steps before its last one (8 bits), one step only, no pairs, an odd number, set.
  input wire [11:0] descriptor_i,
  input wire release_i,                   // A pass is released: one more may begin from the next cycle on.
  input wire steal_next_i,                // No step in the next cycle.
  output wire valid_a_o,                  // There is a step in this cycle, with a first value.
  output wire valid_b_o,                  // With a second one.
  output wire first_o,                    // The step is the first of its pass.
  output wire linear_o,                   // The step belongs to the window (linear path).
  // The odd one of two elements that are read is meant (where one is taken a cycle).
  output wire odd_o,
  output wire set_o,                      // The vector's set.
  output wire [8:0] read_row_o,           // Which two elements of which slot to read.
  output wire [6:0] read_pixels_o,        // Which two pixels of the window to read.
  output wire [11:0] base_o,              // Row of weights of input 0 in this pass.
  // Offset of the step's row of weights after `base`; for a pair, its index is added.
  output wire [11:0] offset_o,
  output wire pass_issued_o,              // The step is the last of its pass.
  output wire finished_o                  // The step is the last of its vector.
);

  localparam TWO_ROWS = ROWS == 2, HAS_LINEAR = WINDOW_PIXELS > 0;
  localparam [31:0] LINEAR_BEFORE_LAST = WINDOW_PIXELS > 0 ? (WINDOW_PIXELS - 1) / ROWS : 0;
  localparam LINEAR_SINGLE = WINDOW_PIXELS == ROWS;
  localparam [31:0] CODES = PAIRS * INPUTS, PASS_ROWS = INPUTS / PARTS + WINDOW_PIXELS,
      SET_ROWS = OUTPUTS / LANES * (INPUTS / PARTS + WINDOW_PIXELS), LAST_PASS = OUTPUTS / LANES - 1;

  reg [1:0] write_slot_q, slot_q, open_q, job_slot_q, slot_q_2;
  reg [11:0] descriptor_0_q, descriptor_1_q, descriptor_2_q, descriptor_3_q, pass_row_q, job_q, job_row_q;
  reg [11:0] base_q;
  reg [2:0] waiting_q;
  reg [5:0] pass_q;
  reg may_begin_q, job_is_last_q, steal_q, active_q, linear_q, at_end_q, first_q, odd_count_q, empty_q, set_q;
  reg is_last_q;
  reg [7:0] remaining_q, step_q;

  // The step of this cycle, and whether a pass begins with the next.
  wire step_valid = active_q && !steal_q;
  wire pass_done = step_valid && at_end_q && (linear_q || !HAS_LINEAR);
  wire grant = may_begin_q && (!active_q || pass_done);
  wire pop = grant && job_is_last_q;
  assign pass_issued_o = pass_done;
  assign finished_o = pass_done && is_last_q;

  reg [11:0] next;
  always @* begin
    case (slot_q)
      2'd1: next = descriptor_1_q;
      2'd2: next = descriptor_2_q;
      2'd3: next = descriptor_3_q;
      default: next = descriptor_0_q;
    endcase
  end

  // What the step reads.
  assign valid_a_o = step_valid && (linear_q || !empty_q);
  assign valid_b_o = step_valid && (linear_q || (!(at_end_q && odd_count_q)));
  assign first_o = step_valid && first_q;
  assign linear_o = linear_q, set_o = set_q, base_o = base_q;
  assign odd_o = !TWO_ROWS && step_q[0];
  assign offset_o = TWO_ROWS ? (CODES[11:0] + {3'd0, step_q, 1'b0}) : (CODES[11:0] + {4'd0, step_q});
  wire [6:0] row = TWO_ROWS ? step_q[6:0] : step_q[7:1];
  assign read_row_o = {slot_q_2, row};
  assign read_pixels_o = row;

  always @(posedge clock_i) begin
    steal_q <= steal_next_i;
    // Vectors that wait.
    if (arrived_i) begin
      write_slot_q <= write_slot_q + 2'd1;
      case (write_slot_q)
        2'd0: descriptor_0_q <= descriptor_i;
        2'd1: descriptor_1_q <= descriptor_i;
        2'd2: descriptor_2_q <= descriptor_i;
        default: descriptor_3_q <= descriptor_i;
      endcase
    end
    if (arrived_i && !pop) waiting_q <= waiting_q + 3'd1;
    else if (pop && !arrived_i) waiting_q <= waiting_q - 3'd1;
    // The pass that begins next.
    if (grant) begin
      pass_q <= pass_q + 6'd1;
      pass_row_q <= pass_row_q + PASS_ROWS[11:0];
      if (job_is_last_q) begin
        {pass_q, pass_row_q} <= 0;
        slot_q <= slot_q + 2'd1;
      end
    end
    if (grant && !release_i) open_q <= open_q + 2'd1;
    else if (release_i && !grant) open_q <= open_q - 2'd1;
    may_begin_q <= (|waiting_q) && !grant && (!open_q[1] || release_i);
    job_q <= next;
    job_slot_q <= slot_q;
    job_is_last_q <= pass_q == LAST_PASS[5:0];
    job_row_q <= next[0] ? (pass_row_q + SET_ROWS[11:0]) : pass_row_q;
    // The step of the next cycle.
    if (step_valid) begin
      first_q <= 1'b0;
      remaining_q <= remaining_q - 8'd1;
      at_end_q <= remaining_q == 8'd1;
      step_q <= step_q + 8'd1;
      if (at_end_q) begin
        linear_q <= 1'b1;
        remaining_q <= LINEAR_BEFORE_LAST[7:0];
        at_end_q <= LINEAR_SINGLE;
        step_q <= 8'd0;
      end
    end
    if (pass_done) active_q <= 1'b0;
    if (grant) begin
      active_q <= 1'b1;
      linear_q <= 1'b0;
      remaining_q <= job_q[11:4];
      at_end_q <= job_q[3];
      step_q <= 8'd0;
      first_q <= 1'b1;
      set_q <= job_q[0];
      odd_count_q <= job_q[1];
      empty_q <= job_q[2];
      slot_q_2 <= job_slot_q;
      base_q <= job_row_q;
      is_last_q <= job_is_last_q;
    end
    if (reset_i) {write_slot_q, waiting_q, slot_q, pass_q, pass_row_q, open_q, may_begin_q, active_q} <= 0;
  end
endmodule
`default_nettype wire
