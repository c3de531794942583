// HostFrame, whatever the host writes and whenever it chooses, however the source and the receiver pause: what is offered stands until it is
// taken; pixels of a frame of the host are marked at its begin and at the ends of its lines; between blocks there are as many as the shown
// blocks have, so that no block is cut or comes twice; back at the source the first pixel is a frame's first; a block takes at most
// LONGEST cycles while its receiver never pauses. What the CRC says is anything.
//
// The frame is made small for the proof: two blocks of two lines of two pixels.
module edof_crc #(
    parameter WIDTH = 32
) (
    input  wire        clock_i,
    input  wire [31:0] data_i,
    input  wire        valid_i,
    input  wire        first_i,
    output wire [31:0] crc_o
);
    (* anyseq *) wire [31:0] any;
    assign crc_o = any;
endmodule

module prove (
    input wire        clock_i,
    input wire        reset_i,
    input wire        select_i,
    input wire        write_i,
    input wire [11:0] address_i,
    input wire [31:0] data_i,
    input wire        valid_i,
    input wire [15:0] pixel_i,
    input wire        user_i,
    input wire        last_i,
    input wire        ready_i
);
    localparam LONGEST = 28;
    wire source_ready, valid, user, last;
    wire [15:0] pixel;
    wire [31:0] blocks, check;
    host_frame dut (
        .clock_i(clock_i), .reset_i(reset_i), .select_i(select_i), .write_i(write_i), .address_i(address_i), .data_i(data_i),
        .source_valid_i(valid_i), .source_data_i(pixel_i), .source_user_i(user_i), .source_last_i(last_i), .source_ready_o(source_ready),
        .pixels_valid_o(valid), .pixels_data_o(pixel), .pixels_user_o(user), .pixels_last_o(last), .pixels_ready_i(ready_i),
        .blocks_o(blocks), .check_o(check)
    );
    (* hierconn *) wire \dut.on_q , \dut.is_second_q , \dut.is_first_q ;
    (* hierconn *) wire [1:0] \dut.phase_q ;
    (* hierconn *) wire [11:0] \dut.word_q , \dut.column_q ;
    localparam SEND = 3;
    wire on = \dut.on_q ;
    wire busy = blocks[16];

    reg started = 0;
    // Pixels of the host's frame that left, modulo 16; the source's first pixel is still to come.
    reg [3:0] place = 0;
    reg fresh = 1;
    // A receiver that never pauses, if the prover likes; cycles of the block.
    (* anyconst *) reg fair;
    reg [5:0] cycles = 0;
    wire restart = write_i && address_i[11] && address_i[0] && on && !busy;
    // The pixel that is offered, or that comes next, and the one after those that were made.
    wire [3:0] made = place + (on && valid);
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || reset_i);
        if (fair) assume (ready_i);
        if (started && $past(started && !reset_i && valid_i && !source_ready))
            assume (valid_i && $stable(pixel_i) && $stable(user_i) && $stable(last_i));
        cycles <= reset_i || !busy ? 0 : cycles + 1;
        if (on) fresh <= 1;
        else if (valid && ready_i) fresh <= 0;
        if (reset_i) fresh <= 1;
        if (reset_i || !on) place <= 0;
        else if (restart) place <= valid && !ready_i ? 15 : 0;
        else if (valid && ready_i) place <= place + 1;

        if (started && !reset_i) begin
            if ($past(started && !reset_i && valid && !ready_i)) stands: assert (valid && $stable(pixel) && $stable(user) && $stable(last));
            if (on && valid && place != 15) marks: assert (user == (place == 0) && last == place[0]);
            if (on && !busy) whole_blocks: assert (made == {blocks[1:0], 2'd0});
            at_most_two: assert (blocks[15:0] <= 2);
            from_the_first: assert (on || !valid || !fresh || user);
            in_time: assert (!fair || cycles < LONGEST);
            drops: assert (!on || source_ready);
            passes: assert (on || !valid || (valid_i && pixel == pixel_i && source_ready == ready_i));
            // How the states of the block belong together.
            if (on) next_pixel: assert (\dut.column_q == made[0] && \dut.is_first_q == (made == 0));
            if (on && place == 15) offered: assert (valid);
            if (on && \dut.phase_q == SEND) inside: assert (made == {blocks[1:0], \dut.word_q [0], \dut.is_second_q });
        end
        takes_two_blocks: cover (started && blocks == 2 && !valid);
        comes_back: cover (started && !on && valid && user && ready_i && $past(on));
    end
endmodule
