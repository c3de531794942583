// Addresses and values for the multipliers, pass by pass: first the pairs of the waiting vector, then the window (F).
// A pass begins when it may_start and then takes one step a cycle; a vector without pairs takes one idle step.
// A step's pair is read in the next cycle and stands at the multipliers one later, shifted left where F aligns its two sums.
//
// From crates/edof-hdl/src/blocks/sequencer.rs (Sequencer).
`default_nettype none

module sequencer (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        available_i,
    input  wire [8:0]  count_i,
    input  wire        set_i,
    input  wire        may_start_i,
    input  wire [3:0]  code_shift_i,
    input  wire [3:0]  linear_shift_i,
    output wire        shift_set_o,
    output reg  [7:0]  read_pair_o,
    input  wire [24:0] even_pair_i,
    input  wire [24:0] odd_pair_i,
    output reg  [7:0]  read_pixel_o,
    input  wire [31:0] pixels_i,
    output wire        pass_issued_o,
    output wire        finished_o,
    output wire        busy_o,
    output wire        first_o,
    output wire [11:0] address_a_o,
    output wire [24:0] value_a_o,
    output wire [11:0] address_b_o,
    output wire [24:0] value_b_o
);

    localparam TWO_ROWS = 1'h1;
    localparam [9:0] LINEAR_STEPS = 10'h0;
    localparam [11:0] CODES = 12'h40;
    localparam [11:0] PASS_ROWS = 12'h40;
    localparam [11:0] SET_ROWS = 12'h40;
    localparam [5:0] LAST_PASS = 6'h0;

    reg  [9:0] wanted_steps;
    reg  [9:0] code_steps;
    wire [9:0] linear_step;
    wire in_codes;
    wire issue;
    wire at_end;
    reg  [24:0] pair_a;
    reg  [15:0] pixel_a;
    reg  [24:0] extended_a;
    reg  [24:0] extended_b;
    reg  [3:0] shift;
    reg  [9:0] step_q;
    reg  [9:0] step_d;
    reg  [5:0] pass_q;
    reg  [5:0] pass_d;
    reg  [11:0] pass_row_q;
    reg  [11:0] pass_row_d;
    reg  valid_a_q_q;
    reg  valid_a_q_d;
    reg  valid_b_q_q;
    reg  valid_b_q_d;
    reg  first_q_q;
    reg  first_q_d;
    reg  linear_q_q;
    wire linear_q_d;
    reg  odd_q_q;
    reg  odd_q_d;
    reg  set_q_q;
    reg  [11:0] row_q_q;
    reg  [11:0] row_q_d;
    reg  [11:0] linear_row_q_q;
    reg  [11:0] linear_row_q_d;
    reg  first_q2_q;
    reg  busy_q2_q;
    reg  [11:0] address_a_q2_q;
    reg  [11:0] address_a_q2_d;
    reg  [24:0] value_a_q2_q;
    reg  [24:0] value_a_q2_d;
    reg  [11:0] address_b_q2_q;
    reg  [11:0] address_b_q2_d;
    reg  [24:0] value_b_q2_q;
    reg  [24:0] value_b_q2_d;

    // Only a part of what follows is used.
    /* verilator lint_off UNUSED */
    wire [9:0] read_pair_o_shifted = step_q >> 1;
    wire [9:0] read_pixel_o_shifted = linear_step >> 1;
    /* verilator lint_on UNUSED */

    always @* begin
        wanted_steps = {1'b0, count_i};
        if (TWO_ROWS) begin
            wanted_steps = ({1'b0, count_i} + 10'd1) >> 1;
        end
    end

    always @* begin
        code_steps = wanted_steps;
        if (wanted_steps == 10'd0) begin
            code_steps = 10'd1;
        end
    end

    assign in_codes = step_q < code_steps;
    assign linear_step = step_q - code_steps;
    assign issue = available_i && ((|step_q) || may_start_i);
    assign at_end = (step_q + 10'd1) == (code_steps + LINEAR_STEPS);
    assign pass_issued_o = issue && at_end;
    assign finished_o = (issue && at_end) && (pass_q == LAST_PASS);

    always @* begin
        step_d = step_q;
        pass_d = pass_q;
        pass_row_d = pass_row_q;
        if (issue) begin
            step_d = step_q + 10'd1;
            if (at_end) begin
                step_d = 10'd0;
                pass_d = pass_q + 6'd1;
                pass_row_d = pass_row_q + PASS_ROWS;
                if (pass_q == LAST_PASS) begin
                    pass_d = 6'd0;
                    pass_row_d = 12'd0;
                end
            end
        end
        read_pair_o = read_pair_o_shifted[7:0];
        read_pixel_o = read_pixel_o_shifted[7:0];
        odd_q_d = step_q[0];
        if (!in_codes) begin
            odd_q_d = linear_step[0];
        end
        valid_a_q_d = issue;
        if (in_codes) begin
            valid_a_q_d = issue && (step_q < {1'b0, count_i});
        end
        valid_b_q_d = 1'b0;
        linear_row_q_d = CODES + {2'd0, linear_step};
        if (TWO_ROWS) begin
            read_pair_o = step_q[7:0];
            read_pixel_o = linear_step[7:0];
            odd_q_d = 1'b0;
            valid_b_q_d = issue;
            if (in_codes) begin
                valid_a_q_d = issue && (|count_i);
                valid_b_q_d = issue && (((step_q << 1) + 10'd1) < {1'b0, count_i});
            end
            linear_row_q_d = CODES + ({2'd0, linear_step} << 1);
        end
        first_q_d = issue && (!(|step_q));
        if (reset_i) begin
            step_d = 10'd0;
            pass_d = 6'd0;
            pass_row_d = 12'd0;
            valid_a_q_d = 1'b0;
            valid_b_q_d = 1'b0;
            first_q_d = 1'b0;
        end
    end

    assign linear_q_d = !in_codes;

    always @* begin
        row_q_d = pass_row_q;
        if (set_i) begin
            row_q_d = pass_row_q + SET_ROWS;
        end
    end

    assign shift_set_o = set_q_q;

    always @* begin
        shift = code_shift_i;
        address_a_q2_d = row_q_q + {3'd0, pair_a[24:16]};
        address_b_q2_d = row_q_q + {3'd0, odd_pair_i[24:16]};
        extended_a = {9'd0, pair_a[15:0]};
        if (pair_a[15]) begin
            extended_a = {9'd0, pair_a[15:0]} | 25'h1ff0000;
        end
        extended_b = {9'd0, odd_pair_i[15:0]};
        if (odd_pair_i[15]) begin
            extended_b = {9'd0, odd_pair_i[15:0]} | 25'h1ff0000;
        end
        if (linear_q_q) begin
            shift = linear_shift_i;
            address_a_q2_d = row_q_q + linear_row_q_q;
            address_b_q2_d = (row_q_q + linear_row_q_q) + 12'd1;
            extended_a = {9'd0, pixel_a};
            extended_b = {9'd0, pixels_i[31:16]};
        end
    end

    always @* begin
        pair_a = even_pair_i;
        pixel_a = pixels_i[15:0];
        if (odd_q_q) begin
            pair_a = odd_pair_i;
            pixel_a = pixels_i[31:16];
        end
    end

    always @* begin
        value_a_q2_d = 25'd0;
        if (valid_a_q_q) begin
            value_a_q2_d = extended_a << shift;
        end
    end

    always @* begin
        value_b_q2_d = 25'd0;
        if (valid_b_q_q) begin
            value_b_q2_d = extended_b << shift;
        end
    end

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
        valid_a_q_q <= valid_a_q_d;
        valid_b_q_q <= valid_b_q_d;
        first_q_q <= first_q_d;
        linear_q_q <= linear_q_d;
        odd_q_q <= odd_q_d;
        set_q_q <= set_i;
        row_q_q <= row_q_d;
        linear_row_q_q <= linear_row_q_d;
        first_q2_q <= first_q_q;
        busy_q2_q <= valid_a_q_q;
        address_a_q2_q <= address_a_q2_d;
        value_a_q2_q <= value_a_q2_d;
        address_b_q2_q <= address_b_q2_d;
        value_b_q2_q <= value_b_q2_d;
    end
endmodule

`default_nettype wire
