// A write agent and the read agent of the same three buffers, whatever pixels come, however the memory answers, resets at any moment: the buffer
// that is written is neither the newest whole one nor the one that is read; the newest becomes one only when all of it was written; a
// frame that is read is the newest of the moment at which it began, and stays the same to its end.
module prove (
    input wire         clock_i,
    input wire         reset_i,
    input wire         repeats_i,
    input wire         pixels_valid_i,
    input wire [15:0]  pixels_data_i,
    input wire         pixels_user_i,
    input wire         pixels_last_i,
    input wire         aw_ready_i,
    input wire         w_ready_i,
    input wire [1:0]   b_resp_i,
    input wire         b_valid_i,
    input wire         corrupted_i,
    input wire         ar_ready_i,
    input wire [511:0] r_data_i,
    input wire [1:0]   r_resp_i,
    input wire         r_valid_i,
    input wire         out_ready_i
);
    wire [1:0] newest, reading;
    write_agent_w512_s64 writer (
        .clock_i(clock_i), .reset_i(reset_i), .pixels_valid_i(pixels_valid_i), .pixels_data_i(pixels_data_i), .pixels_user_i(pixels_user_i),
        .pixels_last_i(pixels_last_i), .dram_aw_ready_i(aw_ready_i), .dram_w_ready_i(w_ready_i), .dram_b_resp_i(b_resp_i),
        .dram_b_valid_i(b_valid_i), .corrupted_i(corrupted_i), .reading_i(reading), .newest_o(newest)
    );
    read_agent_w512 reader (
        .clock_i(clock_i), .reset_i(reset_i), .newest_i(newest), .repeats_i(repeats_i), .reading_o(reading), .dram_ar_ready_i(ar_ready_i), .dram_r_data_i(r_data_i),
        .dram_r_resp_i(r_resp_i), .dram_r_valid_i(r_valid_i), .pixels_ready_i(out_ready_i)
    );
    (* hierconn *) wire [1:0] \writer.phase_q , \writer.target_q ;
    (* hierconn *) wire \writer.failed_q , \reader.busy_q ;
    localparam BETWEEN = 0, COMPLETE = 2;
    wire writes = \writer.phase_q != BETWEEN;
    wire [1:0] target = \writer.target_q ;

    reg started = 0;
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || reset_i);
        if (started) begin
            not_the_newest: assert (!writes || target != newest);
            not_the_one_read: assert (!writes || target != reading);
            one_of_three: assert (!writes || target != 3);
        end
        if (started && $past(started && !reset_i)) begin
            if (newest != $past(newest)) when_whole: assert ($past(\writer.phase_q == COMPLETE && !\writer.failed_q ) && newest == $past(target));
            if (reading != $past(reading)) from_the_start: assert (!$past(\reader.busy_q ) && reading == $past(newest));
        end
        three_in_use: cover (writes && \reader.busy_q && newest != 3 && reading != 3 && newest != reading);
    end
endmodule
