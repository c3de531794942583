// axi_pair, two writers and two readers on one memory: addresses, words and requests stand until they are taken; a burst's words are its
// writer's, in the order of the addresses; an answer reaches only its master; no writer waits for ever
// while the memory and the other writer continue. Reader 1 is overtaken at most once; reader 0 waits for nobody but reader 1.
//
// Bursts have two words here (axi_guard.sv has other lengths). Words of writer 0 have bit 0 clear, those of writer 1 have it set; what
// fills up a burst after a reset has no byte enabled. Each side obeys the rules itself, resets come at any moment.
module prove (
    input wire       clock_i,
    input wire       reset_i,
    input wire       memory_reset_i,
    input wire [1:0] aw_valid_i,
    input wire [1:0] w_valid_i,
    input wire [1:0] b_ready_i,
    input wire [1:0] ar_valid_i,
    input wire [1:0] r_ready_i,
    input wire       dram_aw_ready_i,
    input wire       dram_w_ready_i,
    input wire       dram_b_id_i,
    input wire       dram_b_valid_i,
    input wire       dram_ar_ready_i,
    input wire       dram_r_id_i,
    input wire       dram_r_last_i,
    input wire       dram_r_valid_i
);
    reg [1:0] odd = 0;
    wire [1:0] aw_ready, w_ready, b_valid, ar_ready, r_valid;
    wire aw_id, aw_valid, w_last, w_valid, b_ready, ar_id, ar_valid, r_ready;
    wire [31:0] aw_addr, ar_addr;
    wire [511:0] w_data;
    wire [63:0] w_strb;
    axi_pair_w512_s64 dut (
        .clock_i(clock_i), .reset_i(reset_i), .memory_reset_i(memory_reset_i),
        .write_0_aw_addr_i(32'd0), .write_0_aw_len_i(8'd1), .write_0_aw_size_i(3'd6), .write_0_aw_burst_i(2'd1),
        .write_0_aw_valid_i(aw_valid_i[0]), .write_0_aw_ready_o(aw_ready[0]), .write_0_w_data_i(512'd0),
        .write_0_w_strb_i({64{1'b1}}), .write_0_w_last_i(odd[0]), .write_0_w_valid_i(w_valid_i[0]), .write_0_w_ready_o(w_ready[0]),
        .write_0_b_valid_o(b_valid[0]), .write_0_b_ready_i(b_ready_i[0]),
        .write_1_aw_addr_i(32'd4096), .write_1_aw_len_i(8'd1), .write_1_aw_size_i(3'd6), .write_1_aw_burst_i(2'd1),
        .write_1_aw_valid_i(aw_valid_i[1]), .write_1_aw_ready_o(aw_ready[1]), .write_1_w_data_i(512'd1),
        .write_1_w_strb_i({64{1'b1}}), .write_1_w_last_i(odd[1]), .write_1_w_valid_i(w_valid_i[1]), .write_1_w_ready_o(w_ready[1]),
        .write_1_b_valid_o(b_valid[1]), .write_1_b_ready_i(b_ready_i[1]),
        .read_0_ar_addr_i(32'd0), .read_0_ar_len_i(8'd1), .read_0_ar_size_i(3'd6), .read_0_ar_burst_i(2'd1),
        .read_0_ar_valid_i(ar_valid_i[0]), .read_0_ar_ready_o(ar_ready[0]), .read_0_r_valid_o(r_valid[0]), .read_0_r_ready_i(r_ready_i[0]),
        .read_1_ar_addr_i(32'd4096), .read_1_ar_len_i(8'd1), .read_1_ar_size_i(3'd6), .read_1_ar_burst_i(2'd1),
        .read_1_ar_valid_i(ar_valid_i[1]), .read_1_ar_ready_o(ar_ready[1]), .read_1_r_valid_o(r_valid[1]), .read_1_r_ready_i(r_ready_i[1]),
        .dram_write_aw_id_o(aw_id), .dram_write_aw_addr_o(aw_addr), .dram_write_aw_valid_o(aw_valid), .dram_write_aw_ready_i(dram_aw_ready_i),
        .dram_write_w_data_o(w_data), .dram_write_w_strb_o(w_strb), .dram_write_w_last_o(w_last), .dram_write_w_valid_o(w_valid),
        .dram_write_w_ready_i(dram_w_ready_i),
        .dram_write_b_id_i(dram_b_id_i), .dram_write_b_resp_i(2'd0), .dram_write_b_valid_i(dram_b_valid_i), .dram_write_b_ready_o(b_ready),
        .dram_read_ar_id_o(ar_id), .dram_read_ar_addr_o(ar_addr), .dram_read_ar_valid_o(ar_valid), .dram_read_ar_ready_i(dram_ar_ready_i),
        .dram_read_r_id_i(dram_r_id_i), .dram_read_r_data_i(512'd0), .dram_read_r_resp_i(2'd0), .dram_read_r_last_i(dram_r_last_i),
        .dram_read_r_valid_i(dram_r_valid_i), .dram_read_r_ready_o(r_ready)
    );

    (* anyconst *) wire side;
    // Nobody stands in the way: what fairness is about.
    (* anyconst *) wire goes_on;

    reg started = 0, was_reset = 1;
    wire aw_passes = aw_valid && dram_aw_ready_i;
    wire w_passes = w_valid && dram_w_ready_i;
    wire b_passes = dram_b_valid_i && b_ready;
    wire ar_passes = ar_valid && dram_ar_ready_i;
    wire r_ends = dram_r_valid_i && r_ready && dram_r_last_i;
    // Owners of the bursts whose words still pass, the oldest in bit 0; how many.
    reg [1:0] owners = 0, bursts = 0;
    reg half = 0;
    wire announced = |(aw_valid_i & aw_ready);
    wire announcer = aw_ready[1];
    wire finished = w_passes && w_last;
    // After a reset the guard lets nobody in before all that was in flight has come.
    (* hierconn *) wire \dut.guard.closed_q ;
    reg [3:0] waits = 0, reads_wait = 0;
    // Bursts of reader 0 that were accepted while reader 1 asked.
    reg [1:0] overtaken = 0;
    always @(posedge clock_i) begin
        started <= 1;
        was_reset <= reset_i || memory_reset_i;
        assume (started || (memory_reset_i && reset_i));
        assume (!memory_reset_i || reset_i);
        // Each writer's words end in order: two to a burst.
        odd <= (reset_i || memory_reset_i) ? 0 : odd ^ (w_valid_i & w_ready);
        if ($past(started && !was_reset && !reset_i)) begin
            assume ((aw_valid_i & $past(aw_valid_i & ~aw_ready)) == $past(aw_valid_i & ~aw_ready));
            assume ((ar_valid_i & $past(ar_valid_i & ~ar_ready)) == $past(ar_valid_i & ~ar_ready));
        end

        if (memory_reset_i) begin
            bursts <= 0;
            half <= 0;
        end else begin
            bursts <= bursts + announced - finished;
            if (finished) owners <= {1'b0, owners[1]};
            // Two at most: see `room`.
            if (announced) owners <= (bursts - finished == 0) ? {1'b0, announcer} : {announcer, finished ? owners[1] : owners[0]};
            if (w_passes) half <= !half;
        end

        // Fairness.
        if (goes_on) begin
            assume (dram_aw_ready_i && dram_w_ready_i && (&w_valid_i) && dram_ar_ready_i && (memory_reset_i || started));
        end
        reads_wait <= (reset_i || \dut.guard.closed_q || !ar_valid_i[0] || ar_ready[0] || ar_valid_i[1]) ? 0 : reads_wait + (reads_wait != 15);
        overtaken <= (reset_i || !ar_valid_i[1] || ar_ready[1]) ? 0 : overtaken + (ar_valid_i[0] && ar_ready[0] && !overtaken[1]);
        waits <= (reset_i || \dut.guard.closed_q || !aw_valid_i[side] || aw_ready[side]) ? 0 : waits + (waits != 15);

        if (started && !memory_reset_i) begin
            one_takes: assert (aw_ready != 3 && w_ready != 3 && ar_ready != 3 && b_valid != 3 && r_valid != 3);
            room: assert (bursts < 3);
            of_a_burst: assert (!w_valid || (bursts != 0 && w_last == half));
            the_writers: assert (!w_valid || w_strb == 0 || w_data[0] == owners[0]);
        end
        if (started && $past(started && !memory_reset_i) && !memory_reset_i) begin
            if ($past(aw_valid && !dram_aw_ready_i)) address_stands: assert (aw_valid && aw_id == $past(aw_id) && aw_addr == $past(aw_addr));
            if ($past(w_valid && !dram_w_ready_i))
                word_stands: assert (w_valid && w_last == $past(w_last) && w_data[0] == $past(w_data[0]) && w_strb[0] == $past(w_strb[0]));
            if ($past(ar_valid && !dram_ar_ready_i)) request_stands: assert (ar_valid && ar_id == $past(ar_id) && ar_addr == $past(ar_addr));
        end
        nobody_waits: assert (!goes_on || (waits < 12 && reads_wait < 12));
        goes_first: assert (!overtaken[1]);
        both: cover (started && finished && owners == 2 && bursts == 2);
    end

    // Each side: what the memory owes, and what of it is for those behind.
    genvar of;
    generate
        for (of = 0; of < 2; of = of + 1) begin : sides
            reg [2:0] writes = 0, words = 0, reads = 0, own_writes = 0, own_reads = 0;
            wire b_of = dram_b_id_i == of, r_of = dram_r_id_i == of;
            wire accepted = aw_valid_i[of] && aw_ready[of], asked = ar_valid_i[of] && ar_ready[of];
            always @(posedge clock_i) begin
                // The memory answers bursts of which it took address and last word, and reads that it took.
                writes <= memory_reset_i ? 0 : writes + (aw_passes && aw_id == of) - (b_passes && b_of);
                words <= memory_reset_i ? 0 : words + (finished && owners[0] == of) - (b_passes && b_of);
                reads <= memory_reset_i ? 0 : reads + (ar_passes && ar_id == of) - (r_ends && r_of);
                assume (!dram_b_valid_i || !b_of || (writes != 0 && words != 0));
                assume (!dram_r_valid_i || !r_of || reads != 0);
                // Three in flight are enough; the guard holds more.
                assume (writes < 2 || !accepted);
                assume (reads < 2 || !asked);
                own_writes <= (reset_i || memory_reset_i) ? 0 : own_writes + accepted - (b_valid[of] && b_ready_i[of]);
                own_reads <= (reset_i || memory_reset_i) ? 0 : own_reads + asked - (r_valid[of] && r_ready_i[of] && dram_r_last_i);
                // The turn passes only to who asks.
                if (started && $past(started && !reset_i)) begin
                    if ($past(aw_ready[1 - of] && !aw_valid_i[of])) assert (!aw_ready[of]);
                    if ($past(ar_ready[1 - of] && !ar_valid_i[of])) assert (!ar_ready[of]);
                end
                if (started && !memory_reset_i && !reset_i) begin
                    assert (!b_valid[of] || (own_writes != 0 && b_of));
                    assert (!r_valid[of] || (own_reads != 0 && r_of));
                end
            end
        end
    endgenerate
endmodule
