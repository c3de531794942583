// axi_guard at the memory's port: the rules of AXI4 hold whatever those behind it do, resets at any moment; every burst that was announced
// gets all its words, the last one marked; after a reset nothing that belongs to the time before reaches those behind it.
//
// Those behind it end their bursts with `last` at the right word while they are not in reset. The memory answers the requests and nothing else. Data are as wide as in the board; of the wide words one bit stands for all.
module prove (
    input wire         clock_i,
    input wire         reset_i,
    input wire         memory_reset_i,
    input wire         write_aw_id_i,
    input wire [31:0]  write_aw_addr_i,
    input wire [7:0]   write_aw_len_i,
    input wire         write_aw_valid_i,
    input wire [511:0] write_w_data_i,
    input wire [63:0]  write_w_strb_i,
    input wire         write_w_last_i,
    input wire         write_w_valid_i,
    input wire         write_b_ready_i,
    input wire         read_ar_id_i,
    input wire [31:0]  read_ar_addr_i,
    input wire [7:0]   read_ar_len_i,
    input wire         read_ar_valid_i,
    input wire         read_r_ready_i,
    input wire         dram_write_aw_ready_i,
    input wire         dram_write_w_ready_i,
    input wire         dram_write_b_valid_i,
    input wire         dram_read_ar_ready_i,
    input wire         dram_read_r_last_i,
    input wire         dram_read_r_valid_i
);
    wire write_aw_ready, write_w_ready, write_b_valid, read_ar_ready, read_r_valid;
    wire aw_valid, aw_id, w_valid, w_last, b_ready, ar_valid, ar_id, r_ready;
    wire [31:0] aw_addr, ar_addr;
    wire [7:0] aw_len, ar_len;
    wire [511:0] w_data;
    wire [63:0] w_strb;
    axi_guard_w512_s64 dut (
        .clock_i(clock_i), .reset_i(reset_i), .memory_reset_i(memory_reset_i),
        .write_aw_id_i(write_aw_id_i), .write_aw_addr_i(write_aw_addr_i), .write_aw_len_i(write_aw_len_i), .write_aw_size_i(3'd6),
        .write_aw_burst_i(2'd1), .write_aw_valid_i(write_aw_valid_i), .write_aw_ready_o(write_aw_ready),
        .write_w_data_i(write_w_data_i), .write_w_strb_i(write_w_strb_i), .write_w_last_i(write_w_last_i),
        .write_w_valid_i(write_w_valid_i), .write_w_ready_o(write_w_ready),
        .write_b_valid_o(write_b_valid), .write_b_ready_i(write_b_ready_i),
        .read_ar_id_i(read_ar_id_i), .read_ar_addr_i(read_ar_addr_i), .read_ar_len_i(read_ar_len_i), .read_ar_size_i(3'd6),
        .read_ar_burst_i(2'd1), .read_ar_valid_i(read_ar_valid_i), .read_ar_ready_o(read_ar_ready),
        .read_r_valid_o(read_r_valid), .read_r_ready_i(read_r_ready_i),
        .dram_write_aw_id_o(aw_id), .dram_write_aw_addr_o(aw_addr), .dram_write_aw_len_o(aw_len), .dram_write_aw_valid_o(aw_valid),
        .dram_write_aw_ready_i(dram_write_aw_ready_i),
        .dram_write_w_data_o(w_data), .dram_write_w_strb_o(w_strb), .dram_write_w_last_o(w_last), .dram_write_w_valid_o(w_valid),
        .dram_write_w_ready_i(dram_write_w_ready_i),
        .dram_write_b_id_i(1'b0), .dram_write_b_resp_i(2'd0), .dram_write_b_valid_i(dram_write_b_valid_i), .dram_write_b_ready_o(b_ready),
        .dram_read_ar_id_o(ar_id), .dram_read_ar_addr_o(ar_addr), .dram_read_ar_len_o(ar_len), .dram_read_ar_valid_o(ar_valid),
        .dram_read_ar_ready_i(dram_read_ar_ready_i),
        .dram_read_r_id_i(1'b0), .dram_read_r_data_i(512'd0), .dram_read_r_resp_i(2'd0), .dram_read_r_last_i(dram_read_r_last_i),
        .dram_read_r_valid_i(dram_read_r_valid_i), .dram_read_r_ready_o(r_ready)
    );

    reg started = 0;
    wire runs = started && !memory_reset_i;
    wire aw_taken = write_aw_valid_i && write_aw_ready;
    wire w_taken = write_w_valid_i && write_w_ready;

    // Behind it: bursts of at most four words, so that the prover's state is small; the guard's counter is the same for all lengths.
    // left: words that those behind it still owe.
    reg [2:0] left = 0;
    // Answers that the memory owes: bursts whose last word it took and whose address it took; and words of reads.
    reg [2:0] announced = 0, ended = 0, answered = 0, asked = 0;
    // The burst at the memory's port: words that still pass, of this one and of one that was announced after it.
    reg [2:0] now = 0, next = 0;
    reg was_reset = 0;
    wire w_passes = w_valid && dram_write_w_ready_i;
    wire aw_passes = aw_valid && dram_write_aw_ready_i;
    wire b_passes = dram_write_b_valid_i && b_ready;
    wire ar_passes = ar_valid && dram_read_ar_ready_i;
    wire r_ends = dram_read_r_valid_i && r_ready && dram_read_r_last_i;
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || (memory_reset_i && reset_i));
        // A reset of the memory resets those behind it, too.
        assume (!memory_reset_i || reset_i);
        assume (write_aw_len_i < 4 && read_ar_len_i < 4);
        was_reset <= reset_i || memory_reset_i;
        if (reset_i || memory_reset_i) left <= 0;
        else if (aw_taken) left <= write_aw_len_i + 1;
        else if (w_taken) left <= left - 1;
        // Registers behind it see a reset a cycle late.
        assume (!write_w_valid_i || was_reset || (left != 0 && write_w_last_i == (left == 1)));
        // At most six bursts are in flight (the guard holds more).
        assume (announced - answered < 5 || !aw_taken);
        assume (asked < 5 || !(read_ar_valid_i && read_ar_ready));

        // The memory: an answer for a burst of which it has address and words.
        announced <= memory_reset_i ? 0 : announced + aw_passes;
        ended <= memory_reset_i ? 0 : ended + (w_passes && w_last);
        answered <= memory_reset_i ? 0 : answered + b_passes;
        asked <= memory_reset_i ? 0 : asked + ar_passes - r_ends;
        assume (!dram_write_b_valid_i || (announced != answered && ended != answered));
        assume (!dram_read_r_valid_i || asked != 0);

        // The port.
        if (memory_reset_i) begin
            now <= 0;
            next <= 0;
        end else begin
            if (w_passes && now == 1) begin
                now <= next;
                next <= 0;
            end else if (w_passes) now <= now - 1;
            if (aw_taken) begin
                if (now == 0 || (now == 1 && w_passes && next == 0)) now <= write_aw_len_i + 1;
                else next <= write_aw_len_i + 1;
            end
        end
        if (runs) begin
            words_of_a_burst: assert (!w_valid || (now != 0 && w_last == (now == 1)));
            one_burst_ahead: assert (!aw_taken || next == 0);
        end
        if (started && runs && $past(runs)) begin
            if ($past(aw_valid && !dram_write_aw_ready_i)) begin
                address_stands: assert (aw_valid && aw_addr == $past(aw_addr) && aw_len == $past(aw_len) && aw_id == $past(aw_id));
            end
            if ($past(w_valid && !dram_write_w_ready_i)) begin
                word_stands: assert (w_valid && w_last == $past(w_last) && w_data[0] == $past(w_data[0]) && w_strb[0] == $past(w_strb[0]));
            end
            if ($past(ar_valid && !dram_read_ar_ready_i)) begin
                request_stands: assert (ar_valid && ar_addr == $past(ar_addr) && ar_len == $past(ar_len) && ar_id == $past(ar_id));
            end
            // In the cycle after a reset nothing passes to those behind it, until all that was in flight has come.
            if (was_reset) closed: assert (!write_b_valid && !read_r_valid && !write_aw_ready && !read_ar_ready);
        end
        reopens: cover (started && !was_reset && aw_taken && $past(answered == 2));
        drains: cover (started && !reset_i && w_valid && w_strb == 0 && w_last && now == 1);
    end

    // What was asked before the last reset is never answered to those behind it.
    reg [2:0] own_writes = 0, own_reads = 0;
    wire own_answered = write_b_valid && write_b_ready_i && !reset_i;
    wire own_ended = read_r_valid && read_r_ready_i && dram_read_r_last_i && !reset_i;
    wire own_asked = read_ar_valid_i && read_ar_ready;
    always @(posedge clock_i) begin
        own_writes <= (reset_i || memory_reset_i) ? 0 : own_writes + aw_taken - own_answered;
        own_reads <= (reset_i || memory_reset_i) ? 0 : own_reads + own_asked - own_ended;
        if (runs && !reset_i) begin
            own_answers: assert (!write_b_valid || own_writes != 0);
            own_words: assert (!read_r_valid || own_reads != 0);
        end
    end
endmodule
