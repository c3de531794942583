// Which step of which pass is next: over a vector's pairs first, then over the window (F), once a pass, one step a cycle.
// What a pass must know is looked up before it begins, so that the next begins in the cycle after the last step of the one before;
// all that a step reads comes out of registers. In a cycle of `steal` there is no step, and nothing moves.
//
// From crates/edof-hdl/src/blocks/sequencer.rs (Sequencer).
`default_nettype none

module sequencer_2 (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        arrived_i,
    input  wire [11:0] descriptor_i,
    input  wire        may_start_i,
    input  wire        steal_i,
    output wire        begins_o,
    output wire        valid_a_o,
    output wire        valid_b_o,
    output wire        first_o,
    output wire        linear_o,
    output reg         odd_o,
    output wire        set_o,
    output wire [8:0]  read_row_o,
    output wire [6:0]  read_pixels_o,
    output wire [11:0] base_o,
    output reg  [11:0] offset_o,
    output wire        pass_issued_o,
    output wire        finished_o
);

    localparam TWO_ROWS = 1'h0;
    localparam HAS_LINEAR = 1'h0;
    localparam [7:0] LINEAR_BEFORE_LAST = 8'h0;
    localparam LINEAR_SINGLE = 1'h0;
    localparam [11:0] CODES = 12'h10;
    localparam [11:0] PASS_ROWS = 12'h10;
    localparam [11:0] SET_ROWS = 12'h20;
    localparam [5:0] LAST_PASS = 6'h1;

    wire goes;
    wire ends;
    wire starts;
    wire leaves;
    reg  [11:0] next;
    reg  [6:0] row;
    reg  [1:0] write_slot_q;
    reg  [1:0] write_slot_d;
    reg  [11:0] descriptor_0_q;
    reg  [11:0] descriptor_0_d;
    reg  [11:0] descriptor_1_q;
    reg  [11:0] descriptor_1_d;
    reg  [11:0] descriptor_2_q;
    reg  [11:0] descriptor_2_d;
    reg  [11:0] descriptor_3_q;
    reg  [11:0] descriptor_3_d;
    reg  [2:0] waiting_q;
    reg  [2:0] waiting_d;
    reg  [1:0] slot_q;
    reg  [1:0] slot_d;
    reg  [5:0] pass_q;
    reg  [5:0] pass_d;
    reg  [11:0] pass_row_q;
    reg  [11:0] pass_row_d;
    reg  known_q;
    reg  known_d;
    reg  [11:0] job_q;
    reg  [11:0] job_row_q;
    reg  [11:0] job_row_d;
    reg  [1:0] job_slot_q;
    reg  job_is_last_q;
    wire job_is_last_d;
    reg  active_q;
    reg  active_d;
    reg  linear_q_q;
    reg  linear_q_d;
    reg  [7:0] left_q;
    reg  [7:0] left_d;
    reg  at_end_q;
    reg  at_end_d;
    reg  [7:0] step_q;
    reg  [7:0] step_d;
    reg  first_q_q;
    reg  first_q_d;
    reg  odd_count_q;
    reg  odd_count_d;
    reg  empty_q;
    reg  empty_d;
    reg  set_q_q;
    reg  set_q_d;
    reg  [1:0] slot_q_q;
    reg  [1:0] slot_q_d;
    reg  [11:0] base_q_q;
    reg  [11:0] base_q_d;
    reg  is_last_q;
    reg  is_last_d;

    assign goes = active_q && (!steal_i);
    assign ends = (goes && at_end_q) && (linear_q_q || (!HAS_LINEAR));
    assign starts = (known_q && may_start_i) && ((!active_q) || ends);
    assign leaves = starts && job_is_last_q;
    assign begins_o = starts;
    assign pass_issued_o = ends;
    assign finished_o = ends && is_last_q;

    always @* begin
        write_slot_d = write_slot_q;
        descriptor_0_d = descriptor_0_q;
        descriptor_1_d = descriptor_1_q;
        descriptor_2_d = descriptor_2_q;
        descriptor_3_d = descriptor_3_q;
        waiting_d = waiting_q;
        slot_d = slot_q;
        pass_d = pass_q;
        pass_row_d = pass_row_q;
        active_d = active_q;
        linear_q_d = linear_q_q;
        left_d = left_q;
        at_end_d = at_end_q;
        step_d = step_q;
        first_q_d = first_q_q;
        odd_count_d = odd_count_q;
        empty_d = empty_q;
        set_q_d = set_q_q;
        slot_q_d = slot_q_q;
        base_q_d = base_q_q;
        is_last_d = is_last_q;
        if (arrived_i) begin
            write_slot_d = write_slot_q + 2'd1;
            if (write_slot_q == 2'd0) begin
                descriptor_0_d = descriptor_i;
            end else if (write_slot_q == 2'd1) begin
                descriptor_1_d = descriptor_i;
            end else if (write_slot_q == 2'd2) begin
                descriptor_2_d = descriptor_i;
            end else begin
                descriptor_3_d = descriptor_i;
            end
        end
        if (arrived_i && (!leaves)) begin
            waiting_d = waiting_q + 3'd1;
        end else if (leaves && (!arrived_i)) begin
            waiting_d = waiting_q - 3'd1;
        end
        if (starts) begin
            pass_d = pass_q + 6'd1;
            pass_row_d = pass_row_q + PASS_ROWS;
            if (job_is_last_q) begin
                pass_d = 6'd0;
                pass_row_d = 12'd0;
                slot_d = slot_q + 2'd1;
            end
        end
        known_d = (|waiting_q) && (!starts);
        if (goes) begin
            first_q_d = 1'b0;
            left_d = left_q - 8'd1;
            at_end_d = left_q == 8'd1;
            step_d = step_q + 8'd1;
            if (at_end_q) begin
                linear_q_d = 1'b1;
                left_d = LINEAR_BEFORE_LAST;
                at_end_d = LINEAR_SINGLE;
                step_d = 8'd0;
            end
        end
        if (ends) begin
            active_d = 1'b0;
        end
        if (starts) begin
            active_d = 1'b1;
            linear_q_d = 1'b0;
            left_d = job_q[11:4];
            at_end_d = job_q[3];
            step_d = 8'd0;
            first_q_d = 1'b1;
            set_q_d = job_q[0];
            odd_count_d = job_q[1];
            empty_d = job_q[2];
            slot_q_d = job_slot_q;
            base_q_d = job_row_q;
            is_last_d = job_is_last_q;
        end
        if (reset_i) begin
            write_slot_d = 2'd0;
            waiting_d = 3'd0;
            slot_d = 2'd0;
            pass_d = 6'd0;
            pass_row_d = 12'd0;
            known_d = 1'b0;
            active_d = 1'b0;
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

    assign job_is_last_d = pass_q == LAST_PASS;

    always @* begin
        job_row_d = pass_row_q;
        if (next[0]) begin
            job_row_d = pass_row_q + SET_ROWS;
        end
    end

    assign valid_a_o = goes && (linear_q_q || (!empty_q));
    assign valid_b_o = goes && (linear_q_q || (!(at_end_q && odd_count_q)));
    assign first_o = goes && first_q_q;
    assign linear_o = linear_q_q;
    assign set_o = set_q_q;
    assign base_o = base_q_q;

    always @* begin
        row = step_q[7:1];
        odd_o = step_q[0];
        offset_o = CODES + {4'd0, step_q};
        if (TWO_ROWS) begin
            row = step_q[6:0];
            odd_o = 1'b0;
            offset_o = CODES + ({4'd0, step_q} << 1);
        end
    end

    assign read_row_o = ({7'd0, slot_q_q} << 7) | {2'd0, row};
    assign read_pixels_o = row;

    always @(posedge clock_i) begin
        write_slot_q <= write_slot_d;
        descriptor_0_q <= descriptor_0_d;
        descriptor_1_q <= descriptor_1_d;
        descriptor_2_q <= descriptor_2_d;
        descriptor_3_q <= descriptor_3_d;
        waiting_q <= waiting_d;
        slot_q <= slot_d;
        pass_q <= pass_d;
        pass_row_q <= pass_row_d;
        known_q <= known_d;
        job_q <= next;
        job_row_q <= job_row_d;
        job_slot_q <= slot_q;
        job_is_last_q <= job_is_last_d;
        active_q <= active_d;
        linear_q_q <= linear_q_d;
        left_q <= left_d;
        at_end_q <= at_end_d;
        step_q <= step_d;
        first_q_q <= first_q_d;
        odd_count_q <= odd_count_d;
        empty_q <= empty_d;
        set_q_q <= set_q_d;
        slot_q_q <= slot_q_d;
        base_q_q <= base_q_d;
        is_last_q <= is_last_d;
    end
endmodule

`default_nettype wire
