// Which step of which pass is next: over a vector's pairs first, then over the window (F), once a pass, one step a cycle.
// What a pass must know is looked up before it begins, so that the next begins in the cycle after the last step of the one before;
// all that a step reads comes out of registers. In a cycle of `steal` there is no step, and nothing moves.
//
// From crates/edof-hdl/src/blocks/sequencer.rs (Sequencer).
`default_nettype none

module sequencer #(
    parameter TWO_ROWS = 1'b0,
    parameter HAS_LINEAR = 1'b0,
    parameter [7:0] LINEAR_BEFORE_LAST = 8'd0,
    parameter [11:0] CODES = 12'd0,
    parameter [11:0] PASS_ROWS = 12'd32,
    parameter [11:0] SET_ROWS = 12'd32,
    parameter [5:0] LAST_PASS = 6'd0
) (
    input  wire        clock_i,       // Clock.
    input  wire        reset_i,       // Back to the start.
    input  wire        arrived_i,     // A vector is whole.
    input  wire [11:0] descriptor_i,  // What must be known of it: steps before its last one (8 bits), one step only, no pairs, an odd number, set.
    input  wire        may_start_i,   // Whether a pass may begin.
    input  wire        steal_i,       // No step in this cycle.
    output wire        begins_o,      // A pass begins: its first step is in the next cycle.
    output wire        valid_a_o,     // There is a step in this cycle, with a first value.
    output wire        valid_b_o,     // With a second one.
    output wire        first_o,       // It is the first of its pass.
    output wire        linear_o,      // It is one of the window's.
    output wire        odd_o,         // The odd one of two elements that are read is meant (where one is taken a cycle).
    output wire        set_o,         // The vector's set.
    output wire [8:0]  read_row_o,    // Which two elements of which slot to read.
    output wire [6:0]  read_pixels_o, // Which two pixels of the window to read.
    output wire [11:0] base_o,        // Row of weights of input 0 in this pass.
    output wire [11:0] offset_o,      // What the step's row of weights is after `base`, but for a pair's.
    output wire        pass_issued_o, // It is the last of its pass.
    output wire        finished_o     // It is the last of its vector.
);

    localparam LINEAR_SINGLE = 1'b0;

    wire goes, ends, starts, leaves;
    reg  [11:0] next;
    wire [6:0] row;
    reg  [1:0] write_slot_q;
    reg  [11:0] descriptor_0_q, descriptor_1_q, descriptor_1_d, descriptor_2_q, descriptor_2_d;
    reg  [11:0] descriptor_3_q, descriptor_3_d;
    reg  [2:0] waiting_q, waiting_d;
    reg  [1:0] slot_q;
    reg  [5:0] pass_q, pass_d;
    reg  [11:0] pass_row_q, pass_row_d;
    reg  known_q;
    reg  [11:0] job_q, job_row_q;
    reg  [1:0] job_slot_q;
    reg  job_is_last_q, active_q, active_d, linear_q;
    reg  [7:0] left_q, left_d;
    reg  at_end_q, at_end_d;
    reg  [7:0] step_q, step_d;
    reg  first_q, odd_count_q, empty_q, set_q;
    reg  [1:0] slot_q_2;
    reg  [11:0] base_q;
    reg  is_last_q;

    assign goes = active_q && !steal_i;
    assign ends = goes && at_end_q && (linear_q || !HAS_LINEAR);
    assign starts = known_q && may_start_i && (!active_q || ends);
    assign leaves = starts && job_is_last_q;
    assign begins_o = starts;
    assign pass_issued_o = ends;
    assign finished_o = ends && is_last_q;

    always @* begin
        descriptor_1_d = descriptor_1_q;
        if (arrived_i) begin
            if ((!(write_slot_q == 2'd0)) && (write_slot_q == 2'd1)) begin
                descriptor_1_d = descriptor_i;
            end
        end
    end

    always @* begin
        descriptor_2_d = descriptor_2_q;
        if (arrived_i) begin
            if ((!(write_slot_q == 2'd0)) && ((!(write_slot_q == 2'd1)) && (write_slot_q == 2'd2))) begin
                descriptor_2_d = descriptor_i;
            end
        end
    end

    always @* begin
        descriptor_3_d = descriptor_3_q;
        if (arrived_i) begin
            if ((!(write_slot_q == 2'd0)) && ((!(write_slot_q == 2'd1)) && (!(write_slot_q == 2'd2)))) begin
                descriptor_3_d = descriptor_i;
            end
        end
    end

    always @* begin
        waiting_d = waiting_q;
        if (arrived_i && !leaves) begin
            waiting_d = waiting_q + 3'd1;
        end else if (leaves && !arrived_i) begin
            waiting_d = waiting_q - 3'd1;
        end
        if (reset_i) begin
            waiting_d = 3'd0;
        end
    end

    always @* begin
        pass_d = pass_q;
        if (starts) begin
            pass_d = pass_q + 6'd1;
            if (job_is_last_q) begin
                pass_d = 6'd0;
            end
        end
        if (reset_i) begin
            pass_d = 6'd0;
        end
    end

    always @* begin
        pass_row_d = pass_row_q;
        if (starts) begin
            pass_row_d = pass_row_q + PASS_ROWS;
            if (job_is_last_q) begin
                pass_row_d = 12'd0;
            end
        end
        if (reset_i) begin
            pass_row_d = 12'd0;
        end
    end

    always @* begin
        active_d = active_q;
        if (ends) begin
            active_d = 1'b0;
        end
        if (starts) begin
            active_d = 1'b1;
        end
        if (reset_i) begin
            active_d = 1'b0;
        end
    end

    always @* begin
        left_d = left_q;
        if (goes) begin
            left_d = left_q - 8'd1;
            if (at_end_q) begin
                left_d = LINEAR_BEFORE_LAST;
            end
        end
        if (starts) begin
            left_d = job_q[11:4];
        end
    end

    always @* begin
        at_end_d = at_end_q;
        if (goes) begin
            at_end_d = left_q == 8'd1;
            if (at_end_q) begin
                at_end_d = LINEAR_SINGLE;
            end
        end
        if (starts) begin
            at_end_d = job_q[3];
        end
    end

    always @* begin
        step_d = step_q;
        if (goes) begin
            step_d = step_q + 8'd1;
            if (at_end_q) begin
                step_d = 8'd0;
            end
        end
        if (starts) begin
            step_d = 8'd0;
        end
    end

    always @* begin
        next = descriptor_0_q;
        if (slot_q == 2'd1) begin
            next = descriptor_1_q;
        end else if (slot_q == 2'd2) begin
            next = descriptor_2_q;
        end else if (slot_q == 2'd3) begin
            next = descriptor_3_q;
        end
    end

    assign valid_a_o = goes && (linear_q || !empty_q);
    assign valid_b_o = goes && (linear_q || (!(at_end_q && odd_count_q)));
    assign first_o = goes && first_q;
    assign linear_o = linear_q;
    assign set_o = set_q;
    assign base_o = base_q;
    assign odd_o = TWO_ROWS ? 1'b0 : step_q[0];
    assign offset_o = TWO_ROWS ? (CODES + ({4'd0, step_q} << 1)) : (CODES + {4'd0, step_q});
    assign row = TWO_ROWS ? step_q[6:0] : step_q[7:1];
    assign read_row_o = {slot_q_2, row};
    assign read_pixels_o = row;

    always @(posedge clock_i) begin
        write_slot_q <= reset_i ? 2'd0 : (arrived_i ? (write_slot_q + 2'd1) : write_slot_q);
        descriptor_0_q <= (arrived_i && (write_slot_q == 2'd0)) ? descriptor_i : descriptor_0_q;
        descriptor_1_q <= descriptor_1_d;
        descriptor_2_q <= descriptor_2_d;
        descriptor_3_q <= descriptor_3_d;
        waiting_q <= waiting_d;
        slot_q <= reset_i ? 2'd0 : ((starts && job_is_last_q) ? (slot_q + 2'd1) : slot_q);
        pass_q <= pass_d;
        pass_row_q <= pass_row_d;
        known_q <= reset_i ? 1'b0 : ((|waiting_q) && !starts);
        job_q <= next;
        job_row_q <= next[0] ? (pass_row_q + SET_ROWS) : pass_row_q;
        job_slot_q <= slot_q;
        job_is_last_q <= pass_q == LAST_PASS;
        active_q <= active_d;
        linear_q <= starts ? 1'b0 : ((goes && at_end_q) ? 1'b1 : linear_q);
        left_q <= left_d;
        at_end_q <= at_end_d;
        step_q <= step_d;
        first_q <= starts ? 1'b1 : (goes ? 1'b0 : first_q);
        odd_count_q <= starts ? job_q[1] : odd_count_q;
        empty_q <= starts ? job_q[2] : empty_q;
        set_q <= starts ? job_q[0] : set_q;
        slot_q_2 <= starts ? job_slot_q : slot_q_2;
        base_q <= starts ? job_row_q : base_q;
        is_last_q <= starts ? job_is_last_q : is_last_q;
    end
endmodule

`default_nettype wire
