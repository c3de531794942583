// write_agent, whatever pixels come and however a lawful memory answers, resets apart: addresses and words stand until they are taken;
// bursts stay inside of their span; each word belongs to a burst that was announced before, the last of each is marked; at most eight bursts
// wait for an answer; the buffer that is written is neither the newest whole one nor the one that is read; a buffer becomes the newest
// only when all its words are written and answered. If no channel of the memory waits for more than WAIT cycles, a pixel waits for at most
// LONGEST, except for one that begins a frame within another.
//
// The frame is made small for the proof: 3 lines of 4 pixels, two pixels a word, bursts of four words, so one full burst and a short one.
module prove #(
    parameter WAIT = 1,
    parameter LONGEST = 19
) (
    input wire        clock_i,
    input wire        reset_i,
    input wire        pixels_valid_i,
    input wire [15:0] pixels_data_i,
    input wire        pixels_user_i,
    input wire        pixels_last_i,
    input wire        aw_ready_i,
    input wire        w_ready_i,
    input wire [1:0]  b_resp_i,
    input wire        b_valid_i,
    input wire        corrupted_i,
    input wire        reader_moves_i
);
    localparam WORDS = 6, SPAN = 256;
    wire ready, aw_valid, w_last, w_valid, b_ready;
    wire [31:0] aw_addr, frames;
    wire [7:0] aw_len;
    wire [511:0] w_data;
    wire [63:0] w_strb;
    wire [1:0] newest;
    reg [1:0] reading = 3;
    write_agent_w512_s64 #(.BASE_0(0), .BASE_1(1024), .BASE_2(2048)) dut (
        .clock_i(clock_i), .reset_i(reset_i), .pixels_valid_i(pixels_valid_i), .pixels_data_i(pixels_data_i),
        .pixels_user_i(pixels_user_i), .pixels_last_i(pixels_last_i), .pixels_ready_o(ready),
        .dram_aw_addr_o(aw_addr), .dram_aw_len_o(aw_len), .dram_aw_valid_o(aw_valid), .dram_aw_ready_i(aw_ready_i),
        .dram_w_data_o(w_data), .dram_w_strb_o(w_strb), .dram_w_last_o(w_last), .dram_w_valid_o(w_valid), .dram_w_ready_i(w_ready_i),
        .dram_b_resp_i(b_resp_i), .dram_b_valid_i(b_valid_i), .dram_b_ready_o(b_ready), .corrupted_i(corrupted_i),
        .reading_i(reading), .newest_o(newest), .frames_o(frames)
    );
    (* hierconn *) wire [1:0] \dut.phase_q ;
    (* hierconn *) wire [1:0] \dut.target_q ;
    (* hierconn *) wire [3:0] \dut.outstanding_q ;
    (* hierconn *) wire [11:0] \dut.column_q , \dut.row_q , \dut.write_ptr_q , \dut.announced_q , \dut.sent_q , \dut.sent_next_q , \dut.waiting_q ;
    (* hierconn *) wire [11:0] \dut.request_words_q ;
    (* hierconn *) wire [5:0] \dut.lane_q ;
    (* hierconn *) wire \dut.push_q , \dut.has_word_q , \dut.is_whole_q ;
    (* hierconn *) wire [31:0] \dut.address_q ;

    reg started = 0, offered = 0;
    // A memory that lets each of its channels wait for at most WAIT cycles, if the prover likes.
    (* anyconst *) reg fair;
    reg [1:0] address_waits = 0, word_waits = 0, answer_waits = 0;
    // Cycles in which the agent takes no pixel, except for those in which a frame begins before its predecessor has ended.
    reg [5:0] stalled = 0;
    // Words of the bursts that were announced and not yet written, the oldest first.
    reg [2:0] now = 0, next = 0;
    reg [1:0] accepted = 0, written = 0;
    // Words of this frame that the memory took.
    reg [3:0] words = 0;
    wire announces = aw_valid && !offered;
    wire w_passes = w_valid && w_ready_i;
    wire finished = w_passes && now == 1;
    wire between = \dut.phase_q == 0;
    wire [2:0] now_left = w_passes ? now - 1 : now;
    // Answers to bursts of this frame.
    reg [1:0] answered = 0;
    wire complete_phase = \dut.phase_q == 2;
    // Words of the bursts that `now` and `next` know: those of a new one follow a cycle later.
    wire [2:0] known = \dut.announced_q - (announces ? \dut.request_words_q : 0);
    wire [1:0] asked = (\dut.announced_q == 0 ? 0 : \dut.announced_q == 4 ? 1 : 2) - aw_valid;
    wire [1:0] sent_bursts = words < 4 ? 0 : words < WORDS ? 1 : 2;
    always @(posedge clock_i) begin
        started <= 1;
        assume (reset_i == !started);
        offered <= started && aw_valid && !aw_ready_i;
        if (!started) {now, next} <= 0;
        else if (announces && now_left == 0) {now, next} <= {aw_len[2:0] + 3'd1, 3'd0};
        else if (announces) {now, next} <= {now_left, aw_len[2:0] + 3'd1};
        else if (finished) {now, next} <= {next, 3'd0};
        else now <= now_left;
        // The memory: an answer to a burst of which it took address and words.
        accepted <= !started ? 0 : accepted + (aw_valid && aw_ready_i) - b_valid_i;
        written <= !started ? 0 : written + (w_passes && w_last) - b_valid_i;
        assume (!b_valid_i || (accepted != 0 && written != 0));
        address_waits <= started && aw_valid && !aw_ready_i ? address_waits + 1 : 0;
        word_waits <= started && w_valid && !w_ready_i ? word_waits + 1 : 0;
        answer_waits <= started && accepted != 0 && written != 0 && !b_valid_i ? answer_waits + 1 : 0;
        if (fair) assume (address_waits <= WAIT && word_waits <= WAIT && answer_waits <= WAIT);
        stalled <= !started || ready || (\dut.phase_q == 1 && pixels_user_i) ? 0 : stalled + 1;
        // The reader changes to the newest buffer at any time.
        if (started && reader_moves_i) reading <= newest;
        words <= between || !started ? 0 : words + w_passes;
        answered <= between || !started ? 0 : answered + b_valid_i;

        if (started) begin
            inside: assert (!aw_valid || (aw_len < 4 && aw_addr[7:0] == 0));
            one_ahead: assert (!announces || next == 0);
            announced: assert (!w_valid || now != 0);
            marked: assert (!w_valid || w_last == (now == 1));
            whole: assert (!w_valid || (&w_strb));
            few: assert (\dut.outstanding_q <= 8);
            not_the_newest: assert (between || \dut.target_q != newest);
            not_the_one_read: assert (between || \dut.target_q != reading);
            takes_a_pixel: assert (!fair || stalled <= LONGEST);
            if ($past(started) && newest != $past(newest)) complete: assert ($past(words) == WORDS && accepted == 0 && written == 0);
            if ($past(started && aw_valid && !aw_ready_i)) address_stands: assert (aw_valid && $stable(aw_addr) && $stable(aw_len));
            if ($past(started && w_valid && !w_ready_i)) word_stands: assert (w_valid && $stable(w_last) && w_data[0] == $past(w_data[0]));
        end
        // How the states of the agent and of the counts above belong together: without that, a step from any state could go wrong.
        if (started) begin
            pixels: assert (\dut.column_q < 4 && \dut.row_q <= 3 && (\dut.row_q != 3 || \dut.column_q == 0) && \dut.lane_q == \dut.column_q [0]);
            packed_words: assert (\dut.write_ptr_q == 2 * \dut.row_q + \dut.column_q [1]);
            frame_begun: assert ((\dut.phase_q == 0) == (\dut.row_q == 0 && \dut.column_q == 0));
            frame_whole: assert (!complete_phase || \dut.row_q == 3);
            frame_open: assert (\dut.phase_q != 1 || \dut.row_q != 3);
            bursts: assert ((\dut.announced_q == 0 || \dut.announced_q == 4 || complete_phase && \dut.announced_q == WORDS) && \dut.announced_q <= \dut.write_ptr_q );
            no_word_waits: assert (!complete_phase || !\dut.is_whole_q || aw_valid || \dut.waiting_q == WORDS - \dut.announced_q );
            enough_wait: assert (aw_valid || \dut.waiting_q <= \dut.write_ptr_q - \dut.announced_q );
            burst_asked: assert (!aw_valid || \dut.request_words_q == (\dut.announced_q == 4 ? 4 : 2) && \dut.announced_q != 0);
            successor: assert (\dut.sent_next_q == \dut.sent_q + 1);
            words_ahead: assert (\dut.sent_q + \dut.has_word_q <= known);
            words_taken: assert (between || words == \dut.sent_q - w_valid);
            last_word: assert (!w_valid || w_last == (\dut.sent_q == 4 || \dut.sent_q == WORDS));
            counts: assert (between || (now == (words < 4 && known != 0 ? 4 - words : known - words) && next == (words < 4 && known == WORDS ? 2 : 0)));
            waits: assert (\dut.outstanding_q == accepted);
            addresses: assert (between || accepted == asked - answered && answered <= asked);
            ends: assert (between || written == sent_bursts - answered && answered <= sent_bursts);
            target: assert (between || \dut.target_q != 3);
            aligned: assert (between || \dut.address_q [7:0] == 0);
            if (between) rest: assert (!aw_valid && !w_valid && !\dut.push_q && !\dut.has_word_q && accepted == 0 && written == 0 && {now, next} == 0
                && \dut.waiting_q == 0 && \dut.sent_q == 0 && \dut.announced_q == 0);
        end
        second_frame: cover (frames == 2 && fair);
    end
endmodule
