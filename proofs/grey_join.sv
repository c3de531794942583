// GreyJoin, however its receiver pauses and wherever frames on the cable are cut off: what is offered stands until it is taken, or the mode
// changes; without `grey` pixels pass as they are, from a frame's first one on; with it every word is of two neighbouring pixels, words follow
// in their order, and a frame that comes whole is of an upper half and the lower half right after it, both whole, all marks alike.
//
// The frame is made small for the proof: two lines of two words.
module prove (
    input wire        clock_i,
    input wire        reset_i,
    input wire        grey_i,
    input wire        valid_i,
    input wire [15:0] pixel_i,
    input wire        user_i,
    input wire        ready_i
);
    // Place of the next pixel in its frame on the cable; 8 after the last one.
    reg [3:0] place = 8;
    wire last_i = user_i ? 1'b0 : place[1:0] == 3;
    wire source_ready, valid, user, last;
    wire [15:0] word;
    grey_join dut (
        .clock_i(clock_i), .reset_i(reset_i), .grey_i(grey_i), .source_valid_i(valid_i), .source_data_i(pixel_i), .source_user_i(user_i),
        .source_last_i(last_i), .source_ready_o(source_ready), .pixels_valid_o(valid), .pixels_data_o(word), .pixels_user_o(user),
        .pixels_last_o(last), .pixels_ready_i(ready_i)
    );

    // Grey all the time, as the frames of this proof need it; else it changes whenever the prover likes.
    (* anyconst *) reg is_joined;
    reg started = 0, was_grey = 0, fresh = 1;
    reg [6:0] first = 0;
    reg [15:0] formed = 0;
    reg [1:0] pair = 0;
    // Of the frame on the cable: its half, its second mark, all marks alike so far; whether the frame before it was a whole upper half.
    reg lower = 0, second = 0, alike = 0, after_upper = 0, before = 0;
    // The last lower half that ended was that of the upper half before it.
    reg made = 0;
    // Words of a frame that were taken since its first one.
    reg [3:0] taken = 8;
    wire take = valid_i && source_ready;
    wire mark = pixel_i[9];
    wire fits = place[2] == 0 || mark == (place[1] ? second : lower);
    wire follows = place == 8 && alike && !lower;
    wire [3:0] offered = {1'b0, lower, pair};
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || reset_i);
        if (is_joined) assume (grey_i);
        // A frame on the cable begins with its first pixel and has no more than its pixels.
        assume (!valid_i || user_i || place != 8);
        if (started && $past(started && !reset_i && valid_i && !source_ready))
            assume (valid_i && $stable(pixel_i) && $stable(user_i));
        was_grey <= grey_i && !reset_i;
        if (take) begin
            place <= user_i ? 1 : place + 1;
            if (user_i) begin
                after_upper <= follows;
                before <= second;
            end
            if (user_i || !place[0]) first <= pixel_i[15:9];
            else begin
                formed <= {first, pixel_i[15:10], 3'd0};
                pair <= place[2:1];
                if (place == 1) begin
                    lower <= mark;
                    alike <= 1;
                end else begin
                    if (place == 3) second <= mark;
                    alike <= alike && fits;
                end
                if (place == 7) made <= lower && alike && fits && after_upper && second == before;
            end
        end
        if (valid && ready_i) taken <= user ? 1 : taken == 8 ? 8 : taken + 1;
        if (grey_i != was_grey) fresh <= 1;
        else if (valid && ready_i) fresh <= 0;
        if (reset_i) begin
            place <= 8;
            alike <= 0;
            fresh <= 1;
            taken <= 8;
        end

        if (started && !reset_i) begin
            if ($past(started && !reset_i && valid && !ready_i && grey_i == was_grey))
                stands: assert (valid && $stable(word) && $stable(user) && $stable(last));
            if (!was_grey) passes: assert (!valid || (valid_i && word == pixel_i && user == user_i && last == last_i && source_ready == ready_i));
            from_the_first: assert (!valid || !fresh || user);
            if (is_joined && was_grey && valid) begin
                of_two_pixels: assert (word == formed);
                in_order: assert (user ? pair == 0 : taken == offered);
                ends_lines: assert (last == &pair);
                if (taken == 7 && !user) whole: assert (made);
            end
        end
        joins: cover (started && is_joined && valid && ready_i && !user && taken == 7);
        alone: cover (started && is_joined && valid && user && lower);
    end
endmodule
