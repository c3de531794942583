// axi_ram, however those before it take their time, resets apart: AXI4's rules for what a memory offers; a burst of writes has one answer, after its last
// word, and an error exactly when a word was written in part; a burst of reads has all its words and no more, the last one marked; a word
// comes within 7 cycles while the receiver takes all. A row that nobody writes meanwhile is read as it was written.
//
// Bursts that are read have up to eight words, of which one bit stands for all; the queue has four places; of the memory one row is there, which the prover chooses.
module prove (
    input wire        clock_i,
    input wire        aw_id_i,
    input wire [3:0]  aw_row_i,
    input wire        aw_valid_i,
    input wire        w_data_i,
    input wire [15:0] w_strb_i,
    input wire        w_last_i,
    input wire        w_valid_i,
    input wire        b_ready_i,
    input wire        ar_id_i,
    input wire [3:0]  ar_row_i,
    input wire [2:0]  ar_len_i,
    input wire        ar_valid_i,
    input wire        r_ready_i
);
    wire aw_ready, w_ready, b_id, b_valid, ar_ready, r_id, r_data, r_last, r_valid;
    wire [1:0] b_resp, r_resp;
    reg started = 0;
    axi_ram_w128_s16 dut (
        .clock_i(clock_i), .reset_i(!started), .write_aw_id_i(aw_id_i), .write_aw_addr_i({24'd0, aw_row_i, 4'd0}), .write_aw_valid_i(aw_valid_i),
        .write_aw_ready_o(aw_ready), .write_w_data_i(w_data_i), .write_w_strb_i(w_strb_i), .write_w_last_i(w_last_i),
        .write_w_valid_i(w_valid_i), .write_w_ready_o(w_ready), .write_b_id_o(b_id), .write_b_resp_o(b_resp), .write_b_valid_o(b_valid),
        .write_b_ready_i(b_ready_i), .read_ar_id_i(ar_id_i), .read_ar_addr_i({24'd0, ar_row_i, 4'd0}), .read_ar_len_i({5'd0, ar_len_i}),
        .read_ar_valid_i(ar_valid_i), .read_ar_ready_o(ar_ready), .read_r_id_o(r_id), .read_r_data_o(r_data), .read_r_resp_o(r_resp),
        .read_r_last_o(r_last), .read_r_valid_o(r_valid), .read_r_ready_i(r_ready_i)
    );
    (* hierconn *) wire \dut.queue.space_q , \dut.asked_1_q , \dut.asked_2_q , \dut.store_q , \dut.store_word_q ;
    (* hierconn *) wire \dut.is_partial_q , \dut.write_id_q , \dut.read_id_q ;
    (* hierconn *) wire [8:0] \dut.to_ask_q ;
    (* hierconn *) wire [7:0] \dut.to_follow_q ;
    (* hierconn *) wire [2:0] \dut.queue.pushed_q , \dut.queue.popped_q ;
    (* hierconn *) wire [3:0] \dut.queue.memory ;
    (* hierconn *) wire \dut.memory.read_q , \dut.read_data ;
    (* hierconn *) wire [15:0] \dut.read_row_q , \dut.write_row_q , \dut.store_row_q ;
    (* hierconn *) wire [12:0] \dut.memory.row ;
    (* hierconn *) wire \dut.memory.word ;

    // A burst that is written: its words are still to come, or it is to be answered; the place of its next word.
    reg open = 0, ended = 0, partial = 0, write_id = 0;
    reg [2:0] sent = 0;
    reg [3:0] write_first = 0;
    // A burst that is read: words that are still to leave, and the row of the next one.
    reg [3:0] owed = 0;
    reg read_id = 0;
    reg [4:0] read_row = 0;
    // The chosen row: what was written last; it was not written since the address of the burst that is read.
    reg known = 0, word = 0, untouched = 0;
    reg [3:0] waits = 0;
    wire aw = aw_valid_i && aw_ready, w = w_valid_i && w_ready, b = b_valid && b_ready_i;
    wire ar = ar_valid_i && ar_ready, r = r_valid && r_ready_i;
    wire [4:0] write_row = write_first + sent;
    wire writes_row = w && w_strb_i == 16'hffff && write_row == \dut.memory.row ;
    // Words between the memory and the receiver.
    wire [2:0] held = \dut.queue.pushed_q - \dut.queue.popped_q ;
    wire [3:0] inside = \dut.asked_1_q + \dut.asked_2_q + held + r_valid;
    // The place of the chosen row among them, the oldest first, and its word.
    wire [12:0] place = \dut.memory.row - read_row;
    wire [12:0] in_queue = place - r_valid;
    wire [1:0] at = \dut.queue.popped_q + in_queue;
    wire found = r_valid && place == 0 ? r_data : in_queue < held ? \dut.queue.memory [at]
        : in_queue == held && \dut.asked_2_q ? \dut.read_data : \dut.memory.read_q ;

    always @(posedge clock_i) begin
        started <= 1;
        // A burst has at most four words.
        assume (!w || sent != 3 || w_last_i);
        if (started) begin
            if (aw) begin
                open <= 1;
                write_id <= aw_id_i;
                write_first <= aw_row_i;
                {sent, partial} <= 0;
            end
            if (w) begin
                sent <= sent + 1;
                partial <= partial || (w_strb_i != 0 && w_strb_i != 16'hffff);
                ended <= w_last_i;
            end
            if (b) {open, ended} <= 0;
            if (ar) begin
                owed <= ar_len_i + 1;
                read_id <= ar_id_i;
                read_row <= ar_row_i;
                // A word that is stored in this cycle is there when the row is read.
                untouched <= !open;
            end
            if (r) begin
                owed <= owed - 1;
                read_row <= read_row + 1;
            end
            if (writes_row) begin
                known <= 1;
                word <= w_data_i;
                untouched <= 0;
            end
            waits <= owed == 0 || r_valid ? 0 : waits + 1;

            one_burst: assert (!aw_ready || !open);
            words_after_address: assert (w_ready == (open && !ended));
            answer_after_last: assert (b_valid == (open && ended));
            answer: assert (!b_valid || (b_id == write_id && b_resp == (partial ? 2 : 0)));
            words_of_a_burst: assert (!r_valid || owed != 0);
            last: assert (!r_valid || r_last == (owed == 1));
            whose: assert (!r_valid || (r_id == read_id && r_resp == 0));
            one_burst_read: assert (ar_ready == (owed == 0));
            in_time: assert (waits <= 7);
            as_written: assert (!(r_valid && known && untouched && read_row == \dut.memory.row ) || r_data == word);

            // How the registers belong together.
            writing: assert (open ? \dut.is_partial_q == partial && \dut.write_id_q == write_id && sent < 4 + ended : !ended);
            reading: assert (owed == 0 || ( \dut.to_follow_q == owed - 1 && \dut.read_id_q == read_id && read_row + owed <= 23));
            all_inside: assert ( \dut.to_ask_q <= owed && owed == \dut.to_ask_q + inside);
            room: assert (held + \dut.asked_1_q + \dut.asked_2_q <= ( \dut.queue.space_q ? 3 : 4));
            on_its_way: assert (!(known && untouched && owed != 0 && place < inside) || found == word);
            settled: assert (open || ! \dut.store_q );
            next_read: assert (owed == 0 || \dut.read_row_q == read_row + inside);
            next_write: assert (!open || \dut.write_row_q == write_row);
            stored: assert (!known || ( \dut.store_q && \dut.store_row_q == \dut.memory.row ? \dut.store_word_q : \dut.memory.word ) == word);
            known_is_stored: assert (! \dut.store_q || \dut.store_row_q != \dut.memory.row || known);
        end
        if (started && $past(started)) begin
            if ($past(b_valid && !b_ready_i)) answer_stands: assert (b_valid && b_id == $past(b_id) && b_resp == $past(b_resp));
            if ($past(r_valid && !r_ready_i)) word_stands: assert (r_valid && r_data == $past(r_data) && r_last == $past(r_last));
        end
        both: cover (started && b && r && r_last && known && read_row == \dut.memory.row );
        wrong: cover (started && b && b_resp == 2);
    end
endmodule
