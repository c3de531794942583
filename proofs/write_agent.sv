// write_agent, whatever pixels come and however a lawful memory answers, resets apart: addresses and words stand until they are taken;
// bursts stay inside of their span; each word belongs to a burst that was announced before, the last of each is marked; at most eight bursts
// wait for an answer; the buffer that is written is neither the newest whole one nor the one that is read; a buffer becomes the newest
// only when all its words are written and answered.
//
// The frame is made small for the proof: 3 lines of 4 pixels, two pixels a word, bursts of four words, so one full burst and a short one.
module prove (
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

    reg started = 0, offered = 0;
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
        // The reader changes to the newest buffer at any time.
        if (started && reader_moves_i) reading <= newest;
        words <= between || !started ? 0 : words + w_passes;

        if (started) begin
            inside: assert (!aw_valid || (aw_len < 4 && aw_addr[7:0] == 0));
            one_ahead: assert (!announces || next == 0);
            announced: assert (!w_valid || now != 0);
            marked: assert (!w_valid || w_last == (now == 1));
            whole: assert (!w_valid || (&w_strb));
            few: assert (\dut.outstanding_q <= 8);
            not_the_newest: assert (between || \dut.target_q != newest);
            not_the_one_read: assert (between || \dut.target_q != reading);
            if ($past(started) && newest != $past(newest)) complete: assert ($past(words) == WORDS && accepted == 0 && written == 0);
            if ($past(started && aw_valid && !aw_ready_i)) address_stands: assert (aw_valid && $stable(aw_addr) && $stable(aw_len));
            if ($past(started && w_valid && !w_ready_i)) word_stands: assert (w_valid && $stable(w_last) && w_data[0] == $past(w_data[0]));
        end
        second_frame: cover (frames == 2);
    end
endmodule
