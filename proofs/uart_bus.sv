// uart_bus, whatever bytes come and however the bus answers: the rules of AXI4-Lite, one transfer at a time, no write without a command to
// write, with the four bytes that came last; a frame that pauses is given up in time, and a frame that is done ends.
module prove #(
    parameter TIME_OUT = 6
) (
    input wire        clock_i,
    input wire        reset_i,
    input wire        aw_ready_i,
    input wire        w_ready_i,
    input wire        b_valid_i,
    input wire        ar_ready_i,
    input wire [31:0] r_data_i,
    input wire        r_valid_i
);
    wire aw_valid, w_valid, b_ready, ar_valid, r_ready;
    wire [31:0] aw_addr, w_data, ar_addr;
    wire [3:0] w_strb;
    uart_bus dut (
        .clock_i(clock_i), .reset_i(reset_i), .receive_i(1'b1), .bus_aw_addr_o(aw_addr), .bus_aw_valid_o(aw_valid),
        .bus_aw_ready_i(aw_ready_i), .bus_w_data_o(w_data), .bus_w_strb_o(w_strb), .bus_w_valid_o(w_valid), .bus_w_ready_i(w_ready_i),
        .bus_b_valid_i(b_valid_i), .bus_b_ready_o(b_ready), .bus_ar_addr_o(ar_addr), .bus_ar_valid_o(ar_valid),
        .bus_ar_ready_i(ar_ready_i), .bus_r_data_i(r_data_i), .bus_r_valid_i(r_valid_i), .bus_r_ready_o(r_ready)
    );
    (* hierconn *) wire \dut.receiver_valid ;
    (* hierconn *) wire [7:0] \dut.receiver_byte ;
    (* hierconn *) wire [3:0] \dut.phase_q ;
    localparam COMMAND = 0, WRITE = 4, SEND = 7;

    reg started = 0;
    // What the bus owes: both halves of a write, then an answer; an answer to a read.
    reg address_taken = 0, word_taken = 0, asked = 0;
    reg writing = 0, reading = 0;
    reg [31:0] last_four = 0;
    reg [3:0] quiet = 0;
    wire receives = \dut.receiver_valid ;
    wire resting = \dut.phase_q == COMMAND;
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || reset_i);
        assume (!b_valid_i || (address_taken && word_taken));
        assume (!r_valid_i || asked);
        address_taken <= !reset_i && (aw_valid && aw_ready_i || address_taken) && !(b_valid_i && b_ready);
        word_taken <= !reset_i && (w_valid && w_ready_i || word_taken) && !(b_valid_i && b_ready);
        asked <= !reset_i && (ar_valid && ar_ready_i || asked) && !(r_valid_i && r_ready);

        if (receives && !(\dut.phase_q == WRITE)) last_four <= {last_four[23:0], \dut.receiver_byte };
        if (reset_i || (resting && receives)) begin
            writing <= !reset_i && (\dut.receiver_byte == 1 || \dut.receiver_byte == 3);
            reading <= !reset_i && (\dut.receiver_byte == 2 || \dut.receiver_byte == 4);
        end
        // While the bus is at work nobody waits for a byte.
        quiet <= (reset_i || receives || (\dut.phase_q >= WRITE && \dut.phase_q <= SEND)) ? 0 : quiet + (quiet != 15);

        if (started && !reset_i) begin
            one_at_a_time: assert (!(aw_valid || w_valid || address_taken || word_taken) || !(ar_valid || asked));
            address_once: assert (!aw_valid || !address_taken);
            word_once: assert (!w_valid || !word_taken);
            request_once: assert (!ar_valid || !asked);
            writes_if_told: assert (!(aw_valid || w_valid) || writing);
            reads_if_told: assert (!ar_valid || reading);
            whole_words: assert (!w_valid || (w_strb == 15 && w_data == last_four));
            aligned: assert ((!aw_valid || aw_addr[1:0] == 0) && (!ar_valid || ar_addr[1:0] == 0));
            given_up: assert (quiet < TIME_OUT + 2 || resting);
            if ($past(started && !reset_i)) begin
                if ($past(aw_valid && !aw_ready_i)) address_stands: assert (aw_valid && aw_addr == $past(aw_addr));
                if ($past(w_valid && !w_ready_i)) word_stands: assert (w_valid && w_data == $past(w_data));
                if ($past(ar_valid && !ar_ready_i)) request_stands: assert (ar_valid && ar_addr == $past(ar_addr));
            end
        end
        wrote: cover (b_valid_i && b_ready);
        read: cover (r_valid_i && r_ready);
    end
endmodule
