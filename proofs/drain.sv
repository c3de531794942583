// drain, whatever the sequencer and the receiver do: the equations of copy, take and release in docs/calculator.md hold in every cycle; takes
// never exceed the credits; no sums are overwritten before they are copied; each `last` closes one whole vector of one set.
//
// Decisions are seen a cycle late here, as the circuit shows them. B takes a pass, VECTOR takes a vector. A reset comes at any moment and is
// held until what was on its way is gone.
module prove #(
    parameter B = 3,
    parameter VECTOR = 6,
    parameter CREDITS = 7
) (
    input wire clock_i,
    input wire reset_i,
    input wire begins_i,
    input wire pass_issued_i,
    input wire set_i,
    input wire returned_i
);
    localparam SUM_LATENCY = 7;
    // Takes of a pass that follow the one that releases the next pass but one.
    localparam AFTER_RELEASE = B > 2 + SUM_LATENCY ? 1 + SUM_LATENCY : B - 1;
    wire released, copy, take, last, taken_set;
    wire [7:0] beat;
    drain #(.LANES(2 * B), .OUTPUTS(2 * VECTOR)) dut (
        .clock_i(clock_i), .reset_i(reset_i), .pass_issued_i(pass_issued_i), .set_i(set_i), .credit_return_i(returned_i),
        .release_o(released), .copy_o(copy), .take_o(take), .beat_o(beat), .last_o(last), .take_set_o(taken_set)
    );

    (* anyseq *) wire again;
    reg [3:0] resets = 0;
    wire runs = resets == 10;
    // The sequencer: passes one after the other; a pass's last step no sooner than a cycle after it begins; passes of a vector have one set.
    reg active = 0, vector_set = 0;
    reg [4:0] pass = 0;
    // Events by age.
    reg [8:0] began = 0, issued = 0, issued_set = 0;
    reg [1:0] returned = 0;
    // Sums that stand ready, and the set of the oldest; takes of the copied pass that are left; passes begun and not released.
    reg [1:0] standing = 0, open = 0;
    reg stood_set = 0, now_set = 0;
    reg [4:0] left = 0;
    // Passes whose first sum came, minus copies.
    reg [1:0] landed = 0;
    reg [4:0] place = 0;
    // Takes that the receiver has not returned; the same, with returns two cycles late.
    reg [5:0] inside = 0, used = 0;
    reg released_late = 0;
    wire ready = issued[SUM_LATENCY];
    wire [1:0] stand_now = standing + ready;
    wire [1:0] open_now = open + began[0] - (take && left == AFTER_RELEASE + 1);
    always @(posedge clock_i) begin
        resets <= again ? 0 : runs ? resets : resets + 1;
        assume (reset_i == !runs);
        assume (runs || (!begins_i && !pass_issued_i && !returned_i));
        assume (!begins_i || (open_now < 2 && (!active || pass_issued_i)));
        assume (!pass_issued_i || active);
        assume (!returned_i || inside != 0);
        assume (!pass_issued_i || pass == 0 || set_i == vector_set);
        active <= runs && (begins_i || (active && !pass_issued_i));
        if (!runs) pass <= 0;
        else if (pass_issued_i) pass <= pass == VECTOR / B - 1 ? 0 : pass + 1;
        if (pass_issued_i && pass == 0) vector_set <= set_i;

        if (!runs) begin
            {began, issued, returned, standing, left, open, landed, place, inside, used, released_late} <= 0;
        end else begin
            released_late <= released;
            began <= {began[7:0], begins_i};
            issued <= {issued[7:0], pass_issued_i};
            issued_set <= {issued_set[7:0], set_i};
            returned <= {returned[0], returned_i};
            standing <= stand_now - copy;
            if (ready) stood_set <= issued_set[SUM_LATENCY];
            if (copy) now_set <= ready ? issued_set[SUM_LATENCY] : stood_set;
            left <= copy ? B : take ? left - 1 : left;
            open <= open_now;
            landed <= landed + began[8] - copy;
            if (take) place <= place == VECTOR - 1 ? 0 : place + 1;
            inside <= inside + take - returned_i;
            used <= used + take - returned[1];

            releases: assert (released_late == (take && left == AFTER_RELEASE + 1));
            one_stands: assert (stand_now < 2);
            not_overwritten: assert (landed + began[8] < 2);
            copies: assert (copy == (stand_now != 0 && (left == 0 || (left == 1 && take))));
            // A drain begins with all its credits, as the receiver had returned them two cycles ago, and then does not pause.
            takes: assert (take == (left == B ? used + B <= CREDITS : left != 0));
            credits: assert (used + take <= CREDITS);
            counted: assert (!take || (beat == place && last == (place == VECTOR - 1)));
            its_set: assert (!take || taken_set == now_set);
        end
        both: cover (runs && open_now == 2 && stand_now == 1 && take && left == 1);
        waited: cover (runs && left == B && !take && used + B > CREDITS);
    end
endmodule
