// Addresses and values for the multipliers, pass by pass: first the pairs of the waiting vector, then the window (F).
// A pass begins when it may_start and then takes one step a cycle; a vector without pairs takes one idle step.
// A step's pair is read in the next cycle and stands at the multipliers one later, shifted left where F aligns its two sums.
//
// From crates/edof-hdl/src/blocks/sequencer.rs (Sequencer).
`default_nettype none

module sequencer #(
    parameter TWO_ROWS = 1'b1,
    parameter [9:0] LINEAR_STEPS = 10'd0,
    parameter [11:0] CODES = 12'd64,
    parameter [11:0] PASS_ROWS = 12'd64,
    parameter [11:0] SET_ROWS = 12'd64,
    parameter [5:0] LAST_PASS = 6'd0
) (
    input  wire        clock_i,        // Clock.
    input  wire        reset_i,        // Back to the start.
    input  wire        available_i,    // A vector waits.
    input  wire [8:0]  count_i,        // Its pairs.
    input  wire        set_i,          // Its set.
    input  wire        may_start_i,    // Whether a pass may begin.
    input  wire [3:0]  code_shift_i,   // Left shift of code values.
    input  wire [3:0]  linear_shift_i, // Left shift of pixels.
    output wire        shift_set_o,    // Set whose shifts are wanted.
    output wire [7:0]  read_pair_o,    // Which two pairs to read.
    input  wire [24:0] even_pair_i,    // The even one, a cycle later.
    input  wire [24:0] odd_pair_i,     // The odd one.
    output wire [7:0]  read_pixel_o,   // Which two pixels to read.
    input  wire [31:0] pixels_i,       // They, a cycle later.
    output wire        pass_issued_o,  // The last step of a pass is issued.
    output wire        finished_o,     // The last step of a vector is issued.
    output wire        busy_o,         // A row is read, so that none can be written where both ports read.
    output wire        first_o,        // The step is the first of its pass.
    output wire [11:0] address_a_o,    // Row of weights.
    output wire [24:0] value_a_o,      // Value, 0 where there is no work.
    output wire [11:0] address_b_o,    // Row of weights for the second DSP.
    output wire [24:0] value_b_o       // Its value.
);

    wire [9:0] wanted_steps;
    wire [9:0] code_steps;
    wire [9:0] linear_step;
    wire in_codes;
    wire issue;
    wire at_end;
    wire [24:0] pair_a;
    wire [15:0] pixel_a;
    reg  [24:0] extended_a;
    reg  [24:0] extended_b;
    wire [3:0] shift;
    reg  [9:0] step_q;
    reg  [9:0] step_d;
    reg  [5:0] pass_q;
    reg  [5:0] pass_d;
    reg  [11:0] pass_row_q;
    reg  [11:0] pass_row_d;
    reg  valid_a_q;
    reg  valid_a_d;
    reg  valid_b_q;
    reg  valid_b_d;
    reg  first_q;
    wire first_d;
    reg  linear_q;
    wire linear_d;
    reg  odd_q;
    wire odd_d;
    reg  set_q;
    reg  [11:0] row_q;
    wire [11:0] row_d;
    reg  [11:0] linear_row_q;
    reg  [11:0] linear_row_d;
    reg  first_q2_q;
    reg  busy_q2_q;
    reg  [11:0] address_a_q2_q;
    wire [11:0] address_a_q2_d;
    reg  [24:0] value_a_q2_q;
    wire [24:0] value_a_q2_d;
    reg  [11:0] address_b_q2_q;
    reg  [11:0] address_b_q2_d;
    reg  [24:0] value_b_q2_q;
    wire [24:0] value_b_q2_d;

    assign wanted_steps = TWO_ROWS ? (({1'b0, count_i} + 10'd1) >> 1) : {1'b0, count_i};
    assign code_steps = (wanted_steps == 10'd0) ? 10'd1 : wanted_steps;
    assign in_codes = step_q < code_steps;
    assign linear_step = step_q - code_steps;
    assign issue = available_i && ((|step_q) || may_start_i);
    assign at_end = (step_q + 10'd1) == (code_steps + LINEAR_STEPS);
    assign pass_issued_o = issue && at_end;
    assign finished_o = issue && at_end && (pass_q == LAST_PASS);
    assign read_pair_o = TWO_ROWS ? step_q[7:0] : step_q[8:1];
    assign read_pixel_o = TWO_ROWS ? linear_step[7:0] : linear_step[8:1];

    always @* begin
        step_d = step_q;
        if (issue) begin
            step_d = step_q + 10'd1;
            if (at_end) begin
                step_d = 10'd0;
            end
        end
        if (reset_i) begin
            step_d = 10'd0;
        end
    end

    always @* begin
        pass_d = pass_q;
        if (issue) begin
            if (at_end) begin
                pass_d = pass_q + 6'd1;
                if (pass_q == LAST_PASS) begin
                    pass_d = 6'd0;
                end
            end
        end
        if (reset_i) begin
            pass_d = 6'd0;
        end
    end

    always @* begin
        pass_row_d = pass_row_q;
        if (issue) begin
            if (at_end) begin
                pass_row_d = pass_row_q + PASS_ROWS;
                if (pass_q == LAST_PASS) begin
                    pass_row_d = 12'd0;
                end
            end
        end
        if (reset_i) begin
            pass_row_d = 12'd0;
        end
    end

    always @* begin
        valid_a_d = issue;
        if (in_codes) begin
            valid_a_d = issue && (step_q < {1'b0, count_i});
        end
        if (TWO_ROWS) begin
            if (in_codes) begin
                valid_a_d = issue && (|count_i);
            end
        end
        if (reset_i) begin
            valid_a_d = 1'b0;
        end
    end

    always @* begin
        valid_b_d = 1'b0;
        if (TWO_ROWS) begin
            valid_b_d = issue;
            if (in_codes) begin
                valid_b_d = issue && (((step_q << 1) + 10'd1) < {1'b0, count_i});
            end
        end
        if (reset_i) begin
            valid_b_d = 1'b0;
        end
    end

    assign first_d = reset_i ? 1'b0 : (issue && (!(|step_q)));
    assign odd_d = TWO_ROWS ? 1'b0 : (!in_codes ? linear_step[0] : step_q[0]);

    always @* begin
        linear_row_d = CODES + {2'd0, linear_step};
        if (TWO_ROWS) begin
            linear_row_d = CODES + ({2'd0, linear_step} << 1);
        end
    end

    assign linear_d = !in_codes;
    assign row_d = set_i ? (pass_row_q + SET_ROWS) : pass_row_q;
    assign shift_set_o = set_q;

    always @* begin
        extended_a = {9'd0, pair_a[15:0]};
        if (pair_a[15]) begin
            extended_a = {9'd0, pair_a[15:0]} | 25'h1ff0000;
        end
        if (linear_q) begin
            extended_a = {9'd0, pixel_a};
        end
    end

    always @* begin
        extended_b = {9'd0, odd_pair_i[15:0]};
        if (odd_pair_i[15]) begin
            extended_b = {9'd0, odd_pair_i[15:0]} | 25'h1ff0000;
        end
        if (linear_q) begin
            extended_b = {9'd0, pixels_i[31:16]};
        end
    end

    assign shift = linear_q ? linear_shift_i : code_shift_i;
    assign address_a_q2_d = linear_q ? (row_q + linear_row_q) : (row_q + {3'd0, pair_a[24:16]});

    always @* begin
        address_b_q2_d = row_q + {3'd0, odd_pair_i[24:16]};
        if (linear_q) begin
            address_b_q2_d = row_q + linear_row_q + 12'd1;
        end
    end

    assign pair_a = odd_q ? odd_pair_i : even_pair_i;
    assign pixel_a = odd_q ? pixels_i[31:16] : pixels_i[15:0];
    assign value_a_q2_d = valid_a_q ? (extended_a << shift) : 25'd0;
    assign value_b_q2_d = valid_b_q ? (extended_b << shift) : 25'd0;
    assign first_o = first_q2_q;
    assign busy_o = busy_q2_q;
    assign address_a_o = address_a_q2_q;
    assign value_a_o = value_a_q2_q;
    assign address_b_o = address_b_q2_q;
    assign value_b_o = value_b_q2_q;

    always @(posedge clock_i) begin
        step_q <= step_d;
        pass_q <= pass_d;
        pass_row_q <= pass_row_d;
        valid_a_q <= valid_a_d;
        valid_b_q <= valid_b_d;
        first_q <= first_d;
        linear_q <= linear_d;
        odd_q <= odd_d;
        set_q <= set_i;
        row_q <= row_d;
        linear_row_q <= linear_row_d;
        first_q2_q <= first_q;
        busy_q2_q <= valid_a_q;
        address_a_q2_q <= address_a_q2_d;
        value_a_q2_q <= value_a_q2_d;
        address_b_q2_q <= address_b_q2_d;
        value_b_q2_q <= value_b_q2_d;
    end
endmodule

`default_nettype wire
