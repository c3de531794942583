// read_agent, whatever frames become the newest and however the memory and the receiver take their time, resets apart: the rules of AXI4; the
// bursts of a frame are its words in order, all in the buffer that is read; no more words are asked for than there is room for; pixels
// are those of the words in the order of their addresses, marked at the ends of lines and frames; from a word with an error on
// the frame is black, and the next one is not. If no channel of the memory waits for more than a cycle, a pixel waits for at most 10 in a
// frame, whatever its receiver does.
//
// The frame is made small for the proof: 2 lines of WORDS pixels, two pixels a word, bursts of two words, room for four; counters have four
// bits. Of each pixel one bit is looked at; without DATA none, in a frame that does not fit the room.
module prove #(
    parameter WORDS = 3,
    parameter DATA = 1
) (
    input wire       clock_i,
    input wire [1:0] newest_i,
    input wire       repeats_i,
    input wire       ar_ready_i,
    input wire       r_valid_i,
    input wire [1:0] r_bits_i,
    input wire       r_wrong_i,
    input wire       out_ready_i
);
    // The RAM holds four words, and a register the word whose pixels go.
    localparam BURST = 2, DEPTH = 4 + 1, LONGEST = 10;
    wire ar_valid, r_ready, valid, user, last;
    wire [31:0] ar_addr;
    wire [7:0] ar_len;
    wire [1:0] reading;
    wire [15:0] pixel;
    reg started = 0;
    read_agent_w512 #(.BASE_0(0), .BASE_1(1024), .BASE_2(2048)) dut (
        .clock_i(clock_i), .reset_i(!started), .newest_i(newest_i), .repeats_i(repeats_i), .reading_o(reading), .dram_ar_addr_o(ar_addr), .dram_ar_len_o(ar_len),
        .dram_ar_valid_o(ar_valid), .dram_ar_ready_i(ar_ready_i), .dram_r_data_i(DATA ? {495'd0, r_bits_i[1], 15'd0, r_bits_i[0]} : 512'd0),
        .dram_r_resp_i({DATA && r_wrong_i, 1'b0}), .dram_r_valid_i(r_valid_i), .dram_r_ready_o(r_ready), .pixels_valid_o(valid),
        .pixels_data_o(pixel), .pixels_user_o(user), .pixels_last_o(last), .pixels_ready_i(out_ready_i)
    );
    (* hierconn *) wire \dut.busy_q , \dut.has_word_q , \dut.is_last_lane_q ;
    (* hierconn *) wire [1:0] \dut.reading_q ;
    (* hierconn *) wire [23:0] \dut.remaining_q ;
    (* hierconn *) wire [31:0] \dut.address_q ;
    (* hierconn *) wire [3:0] \dut.request_words_q , \dut.reserved_q , \dut.read_ptr_q , \dut.read_ptr_next_q , \dut.write_ptr_q , \dut.received_q ;
    (* hierconn *) wire [3:0] \dut.column_q , \dut.row_q ;
    (* hierconn *) wire [5:0] \dut.lane_q ;

    // Words of this frame that were announced; words that the memory owes; words that came and did not go yet, the oldest first.
    reg offered = 0;
    reg [2:0] announced = 0;
    reg [3:0] owed = 0, inside = 0;
    reg [2*DEPTH-1:0] waiting = 0;
    reg [DEPTH-1:0] wrong = 0;
    // The pixel that comes next.
    reg [3:0] place = 0;
    reg black = 0, after_black = 0;
    wire announces = ar_valid && !offered;
    wire asks = ar_valid && ar_ready_i;
    wire goes = valid && out_ready_i;
    wire word_goes = goes && place[0];
    wire [3:0] at = inside - word_goes;
    // The word of the pixel that is offered is wrong, or one before it was.
    wire now_black = black || wrong[0];
    wire [2*DEPTH-1:0] waiting_left = word_goes ? waiting >> 2 : waiting;
    wire [DEPTH-1:0] wrong_left = word_goes ? wrong >> 1 : wrong;
    // A memory that lets a request and a word wait for at most a cycle, if the prover likes, and cycles in which a frame has no pixel.
    (* anyconst *) reg fair;
    reg request_waits = 0, word_waits = 0;
    reg [4:0] starved = 0;
    // Words that were reserved, came, and were seen, beyond those that went into the register.
    wire [3:0] reserved = \dut.reserved_q - \dut.read_ptr_q ;
    wire [3:0] came = \dut.write_ptr_q - \dut.read_ptr_q ;
    wire [3:0] seen = \dut.received_q - \dut.read_ptr_q ;
    wire [3:0] requested = ar_valid ? \dut.request_words_q : 0;
    wire [3:0] begun = WORDS - \dut.remaining_q ;
    wire [3:0] known = begun - (announces ? requested : 0);
    always @(posedge clock_i) begin
        started <= 1;
        offered <= started && ar_valid && !ar_ready_i;
        assume (!r_valid_i || owed != 0);
        assume (!started || newest_i != 3 || $past(newest_i == 3) || !$past(started));
        request_waits <= started && ar_valid && !ar_ready_i;
        word_waits <= started && owed != 0 && !r_valid_i;
        if (fair) assume (!(request_waits && ar_valid && !ar_ready_i) && !(word_waits && owed != 0 && !r_valid_i));
        starved <= !started || !\dut.busy_q || valid ? 0 : starved + 1;
        if (!started) {announced, owed, inside, place, black, wrong} <= 0;
        else begin
            if (announces) announced <= announced + ar_len[2:0] + 1 == WORDS ? 0 : announced + ar_len[2:0] + 1;
            owed <= owed + (asks ? ar_len[2:0] + 1 : 0) - r_valid_i;
            waiting <= r_valid_i ? (waiting_left & ~(10'd3 << 2 * at)) | ({8'd0, r_bits_i} << 2 * at) : waiting_left;
            wrong <= r_valid_i ? (wrong_left & ~(5'd1 << at)) | ({4'd0, r_wrong_i} << at) : wrong_left;
            inside <= at + r_valid_i;
            if (goes) begin
                place <= place == 2 * WORDS - 1 ? 0 : place + 1;
                black <= place == 2 * WORDS - 1 ? 0 : now_black;
                if (place == 2 * WORDS - 1) after_black <= now_black;
            end
        end

        if (started) begin
            in_order: assert (!announces || ar_addr == {reading, 10'd0} + 64 * announced);
            of_one_buffer: assert (!ar_valid || reading != 3);
            bursts: assert (!ar_valid || ar_len < BURST);
            whole_bursts: assert (!announces || ar_len == BURST - 1 || announced + ar_len + 1 == WORDS);
            room: assert (inside + owed + (ar_valid ? ar_len + 1 : 0) <= DEPTH);
            never_waits: assert (r_ready);
            some: assert (!valid || inside != 0);
            marks: assert (!valid || (user == (place == 0) && last == (place == WORDS - 1 || place == 2 * WORDS - 1)));
            if (DATA) its_pixel: assert (!valid || (now_black ? pixel == 16'h8010 : pixel == waiting[place[0]]));
            while_read: assert (!valid || \dut.busy_q );
            pixels_come: assert (!fair || starved <= LONGEST);
            if ($past(started)) begin
                if ($past(ar_valid && !ar_ready_i)) request_stands: assert (ar_valid && $stable(ar_addr) && $stable(ar_len));
                if ($past(valid && !out_ready_i)) pixel_stands: assert (valid && $stable(pixel) && $stable(user) && $stable(last));
                if (reading != $past(reading)) between_frames: assert (place == 0 && inside == 0 && owed == 0 && announced == 0);
            end
        end
        // How the states of the agent and of the counts above belong together: without that, a step from any state could go wrong.
        if (started) begin
            reserves: assert (reserved <= 4 && reserved == owed + requested + inside - valid);
            arrives: assert (came == inside - valid && seen <= came && came <= 4);
            sees: assert (!\dut.has_word_q || seen != 0);
            successor: assert (\dut.read_ptr_next_q == 4'd1 + \dut.read_ptr_q );
            lanes: assert (\dut.lane_q == place[0] && (!valid || \dut.is_last_lane_q == place[0]) && (valid || !place[0]));
            pixels: assert (\dut.row_q <= 1 && \dut.column_q < WORDS && place == (\dut.row_q [0] ? WORDS : 0) + \dut.column_q );
            every_word: assert (!\dut.busy_q || \dut.remaining_q + requested + owed + inside + place[3:1] == WORDS);
            rest: assert (\dut.busy_q || (\dut.remaining_q == 0 && !ar_valid && owed == 0 && inside == 0 && place == 0));
            few_words: assert (\dut.remaining_q <= WORDS && requested <= BURST);
            one_word: assert (!ar_valid || requested != 0);
            tells: assert (announced == (known == WORDS ? 0 : known));
            next_burst: assert (\dut.remaining_q == 0 || \dut.address_q == {\dut.reading_q , 10'd0} + 64 * begun);
            this_burst: assert (!ar_valid || ar_addr == {\dut.reading_q , 10'd0} + 64 * (begun - requested));
            buffer: assert (!\dut.busy_q || \dut.reading_q != 3);
        end
        if (DATA) second_frame: cover (fair && place == 3 && valid && !now_black && reading == 1 && after_black);
        else full: cover (fair && inside == DEPTH && announced == 0);
    end
endmodule
