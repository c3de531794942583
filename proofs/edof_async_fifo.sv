// edof_async_fifo, two free clocks, resets at any moment, either clock may stop: no phantom word, nothing doubled, reordered, or lost but
// by a reset; an offered word stands; pointers change one bit; with both clocks running it opens and words come out.
module prove #(
    parameter LOG_DEPTH = 1
) (
    input wire       write_reset_i,
    input wire       write_valid_i,
    input wire [1:0] write_data_i,
    input wire       read_reset_i,
    input wire       read_ready_i
);
    (* gclk *) wire gclk;
    wire write_clock, read_clock, write_rises, read_rises, from_on, to_on, round;
    two_clocks clocks (
        .from_reset_i(write_reset_i), .to_reset_i(read_reset_i), .from_clock_o(write_clock), .to_clock_o(read_clock),
        .from_rises_o(write_rises), .to_rises_o(read_rises), .from_on_o(from_on), .to_on_o(to_on), .round_o(round)
    );
    wire write_ready, read_valid;
    wire [1:0] read_data;
    edof_async_fifo #(.WIDTH(2), .LOG_DEPTH(LOG_DEPTH)) dut (
        .write_clock_i(write_clock), .write_reset_i(write_reset_i), .write_valid_i(write_valid_i), .write_ready_o(write_ready),
        .write_data_i(write_data_i), .read_clock_i(read_clock), .read_reset_i(read_reset_i), .read_valid_o(read_valid),
        .read_ready_i(read_ready_i), .read_data_o(read_data)
    );
    (* hierconn *) wire [LOG_DEPTH:0] \dut.write_gray_q ;
    (* hierconn *) wire [LOG_DEPTH:0] \dut.read_gray_q ;
    (* hierconn *) wire \dut.write_clear ;
    (* hierconn *) wire \dut.read_clear ;
    (* hierconn *) wire \dut.read_open ;

    // What stood in the step before a clock rises is what its edge takes.
    reg push_was = 0, pop_was = 0, write_reset_was = 0, read_reset_was = 0, stands = 0, open_was = 0;
    reg [1:0] push_tag = 0, pop_tag = 0;
    always @(posedge gclk) begin
        push_was <= write_valid_i && write_ready && !write_reset_i;
        push_tag <= write_data_i;
        pop_was <= read_valid && read_ready_i && !read_reset_i;
        stands <= read_valid && !read_ready_i && !read_reset_i;
        open_was <= \dut.read_open ;
        pop_tag <= read_data;
        write_reset_was <= write_reset_i;
        read_reset_was <= read_reset_i;
    end
    wire second_popped;
    tags tags (
        .clock_i(1'b0), .push_i(write_rises && push_was && from_on), .push_tag_i(push_tag),
        .pop_i(read_rises && pop_was && to_on), .pop_tag_i(pop_tag),
        .lost_i((write_rises && write_reset_was) || (read_rises && read_reset_was) || (write_rises && push_was && !open_was)),
        .emptied_i(read_rises && read_reset_was), .second_popped_o(second_popped)
    );

    reg [LOG_DEPTH:0] write_gray_was = 0, read_gray_was = 0;
    reg write_clear_was = 0, read_clear_was = 0;
    reg write_settled = 0, read_settled = 0;
    function one_bit(input [LOG_DEPTH:0] change);
        one_bit = (change & (change - 1)) == 0;
    endfunction
    always @(posedge gclk) begin
        write_gray_was <= \dut.write_gray_q ;
        read_gray_was <= \dut.read_gray_q ;
        write_clear_was <= \dut.write_clear ;
        read_clear_was <= \dut.read_clear ;
        // Before the first clearing pointers are what they are.
        if (\dut.write_clear && write_rises) write_settled <= 1;
        if (\dut.read_clear && read_rises) read_settled <= 1;
        if (write_settled && write_rises && !write_clear_was) one_bit_written: assert (one_bit(\dut.write_gray_q ^ write_gray_was));
        if (read_settled && read_rises && !read_clear_was) one_bit_read: assert (one_bit(\dut.read_gray_q ^ read_gray_was));
        if (read_rises && to_on && stands) offer_stands: assert (read_valid && read_data == pop_tag);
        both: cover (second_popped);
    end
endmodule
