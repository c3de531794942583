// sequencer, whatever vectors arrive, however often a step is taken from it, and whenever a pass is released: each vector has all its passes,
// each pass all its steps, in order, of the vector's own slot and rows; a pass begins in the very cycle that the equation of start in
// docs/calculator.md says, and ends with its last step.
//
// Vectors have at most three steps a pass here, the linear path LINEAR of them (0: none).
module prove #(
    parameter TWO_ROWS = 0,
    parameter LINEAR = 0,
    parameter PASSES = 2
) (
    input wire        clock_i,
    input wire        reset_i,
    input wire        arrived_i,
    input wire [11:0] descriptor_i,
    input wire        release_i,
    input wire        steal_next_i
);
    localparam ROWS = 1 + TWO_ROWS, CODES = 3 * ROWS, PASS_ROWS = CODES + ROWS * LINEAR, SET_ROWS = PASSES * PASS_ROWS;
    wire valid_a, valid_b, first, linear, odd, set, pass_issued, finished;
    wire [8:0] read_row;
    wire [6:0] read_pixels;
    wire [11:0] base, offset;
    sequencer #(
        .INPUTS(CODES), .PAIRS(1), .PARTS(1), .ROWS(ROWS), .WINDOW_PIXELS(ROWS * LINEAR), .LANES(1), .OUTPUTS(PASSES)
    ) dut (
        .clock_i(clock_i), .reset_i(reset_i), .arrived_i(arrived_i), .descriptor_i(descriptor_i), .release_i(release_i),
        .steal_next_i(steal_next_i), .valid_a_o(valid_a), .valid_b_o(valid_b), .first_o(first), .linear_o(linear), .odd_o(odd),
        .set_o(set), .read_row_o(read_row), .read_pixels_o(read_pixels), .base_o(base), .offset_o(offset), .pass_issued_o(pass_issued),
        .finished_o(finished)
    );

    reg started = 0;
    // Vectors that have arrived and have a pass still to begin, the oldest lowest: steps before the last, empty, odd, set.
    reg [4:0] waits_0, waits_1, waits_2, waits_3;
    reg [2:0] waiting = 0, waiting_late = 0, held = 0;
    reg [2:0] pass = 0;
    reg [1:0] slot = 0;
    reg began_late = 0, steal = 0;
    // Passes begun and not released.
    reg [1:0] open = 0;
    // The pass that steps, and the step that is next.
    reg active = 0, is_last = 0;
    reg [4:0] now = 0;
    reg [2:0] now_pass = 0;
    reg [1:0] now_slot = 0;
    reg [2:0] step = 0;
    wire [4:0] arrives = {descriptor_i[5:4], descriptor_i[2:0]};
    wire [2:0] own_steps = now[4:3] + 1;
    wire is_linear = step >= own_steps;
    wire [2:0] place = is_linear ? step - own_steps : step;
    wire steps = active && !steal;
    wire ends = steps && step == own_steps + LINEAR - 1;
    // start[n] is a cycle later: after the last step before, two cycles after start[n - 1], two after the vector came.
    wire begins = open < 2 && (!active || ends) && !began_late && waiting_late != 0;
    wire pops = begins && pass == PASSES - 1;
    wire [2:0] left = waiting - pops;
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || reset_i);
        // The store: at most four vectors; what it says of them (pair_store.sv, dense_store.sv). Reset there is reset here.
        assume (!release_i || (open != 0 && !reset_i));
        steal <= steal_next_i;
        assume (!arrived_i || (held < 4 && !reset_i));
        assume (descriptor_i[11:6] == 0 && descriptor_i[5:4] != 3);
        assume (descriptor_i[3] == (descriptor_i[5:4] == 0));
        assume (!descriptor_i[2] || (descriptor_i[5:4] == 0 && descriptor_i[1]));
        if (reset_i) begin
            {waiting, waiting_late, held, pass, slot, began_late, active, open} <= 0;
        end else begin
            held <= held + arrived_i - finished;
            waiting <= left + arrived_i;
            waiting_late <= waiting;
            if (pops) {waits_0, waits_1, waits_2} <= {waits_1, waits_2, waits_3};
            if (arrived_i && left == 0) waits_0 <= arrives;
            if (arrived_i && left == 1) waits_1 <= arrives;
            if (arrived_i && left == 2) waits_2 <= arrives;
            if (arrived_i && left == 3) waits_3 <= arrives;
            open <= open + begins - release_i;
            began_late <= begins;
            if (begins) pass <= pops ? 0 : pass + 1;
            if (pops) slot <= slot + 1;
            if (steps) step <= step + 1;
            if (ends) active <= 0;
            if (begins) begin
                active <= 1;
                step <= 0;
                now <= waits_0;
                now_pass <= pass;
                now_slot <= slot;
                is_last <= pops;
            end

            stepped: assert (valid_a == (steps && (is_linear || !now[2])));
            second: assert (valid_b == (steps && (is_linear || !(step == own_steps - 1 && now[1]))));
            first_step: assert (first == (steps && step == 0));
            last_step: assert (pass_issued == ends && finished == (ends && is_last));
            if (steps) begin
                path: assert (linear == is_linear && set == now[0]);
                weights: assert (base == now_pass * PASS_ROWS + (now[0] ? SET_ROWS : 0));
                after: assert (offset == CODES + (TWO_ROWS ? 2 * place : place));
                elements: assert (read_row == {now_slot, TWO_ROWS ? {4'd0, place} : {5'd0, place[2:1]}} && read_pixels == read_row[6:0]);
                which: assert (odd == (!TWO_ROWS && place[0]));
            end
        end
        again: cover (started && finished && held == 4 && now_slot == 1 && begins);
        stolen: cover (started && active && steal && step == 1 && now[0]);
    end
endmodule
