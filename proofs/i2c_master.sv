// i2c_master: a line that is stuck and a chip that does not answer are never success, whatever happens on the lines; a transfer ends
// after at most 204 steps; lines are let go when it ends.
//
// A step takes QUARTER + 2 cycles and the cycles in which a chip holds the clock line, of which there are HOLD + 1 in a transfer at most.
// That the number of steps is bounded is shown by a number that falls with each. QUARTER and HOLD are made small for the proof.
module prove #(
    parameter QUARTER = 3,
    parameter HOLD = 12
) (
    input wire       clock_i,
    input wire       reset_i,
    input wire       start_i,
    input wire       read_i,
    input wire       bare_i,
    input wire [6:0] device_i,
    input wire [7:0] register_i,
    input wire [7:0] write_value_i,
    input wire       scl_held_i,
    input wire       sda_held_i
);
    wire scl_low, sda_low, busy, done;
    wire [2:0] cause;
    wire scl = !scl_low && !scl_held_i;
    wire sda = !sda_low && !sda_held_i;
    i2c_master dut (
        .clock_i(clock_i), .reset_i(reset_i), .start_i(start_i), .read_i(read_i), .bare_i(bare_i), .device_i(device_i),
        .register_i(register_i), .write_value_i(write_value_i), .scl_i(scl), .sda_i(sda),
        .scl_low_o(scl_low), .sda_low_o(sda_low), .busy_o(busy), .done_o(done), .cause_o(cause)
    );
    (* hierconn *) wire [2:0] \dut.phase_q ;
    (* hierconn *) wire [2:0] \dut.byte_q ;
    (* hierconn *) wire \dut.steps_q ;
    (* hierconn *) wire [1:0] \dut.part_q ;
    (* hierconn *) wire [3:0] \dut.bit_number_q ;
    (* hierconn *) wire \dut.cleared_q ;
    (* hierconn *) wire \dut.is_clearing_q ;
    (* hierconn *) wire [15:0] \dut.cycle_q ;
    (* hierconn *) wire [23:0] \dut.held_cycles_q ;

    localparam FREE = 1, CLEAR = 2, START = 3, BIT = 4, STOP = 5;
    localparam TO_WRITE = 0, REGISTER = 1, VALUE = 2, TO_READ = 3, ANSWER = 4;
    // Steps that are left at most.
    reg [7:0] left;
    always @* begin
        left = 0;
        case (\dut.phase_q )
            FREE: left = \dut.cleared_q ? 156 : 200;
            CLEAR: left = 164;
            START: left = \dut.byte_q == TO_READ ? 76 : 152;
            BIT: case (\dut.byte_q )
                TO_WRITE: left = 116;
                REGISTER: left = 80;
                ANSWER: left = 4;
                default: left = 40;
            endcase
            STOP: left = \dut.is_clearing_q ? 160 : 0;
            default: left = 0;
        endcase
        left = left + 4 - \dut.part_q + (8 - \dut.bit_number_q ) * ((\dut.phase_q == BIT || \dut.phase_q == CLEAR) ? 4 : 0);
    end

    // A chip that never acknowledges: it never pulls the data line.
    (* anyconst *) wire silent;
    reg started = 0;
    reg [3:0] sda_low_for = 0;
    reg scl_always_low = 1;
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || reset_i);
        // What the transfer is must stand while it lasts.
        if (started && $past(busy) && !$past(reset_i)) begin
            assume ($stable(read_i) && $stable(bare_i) && $stable(device_i) && $stable(register_i) && $stable(write_value_i));
        end
        if (silent) assume (!sda_held_i);
        sda_low_for <= sda ? 0 : sda_low_for + (sda_low_for != 15);
        scl_always_low <= started && busy ? scl_always_low && !scl : !scl;

        if (started && !reset_i) begin
            released: assert (!done || $past(reset_i) || \dut.phase_q != STOP);
            if (done) begin
                stuck_data: assert (sda_low_for < 2 * QUARTER || cause != 0);
                stuck_clock: assert (!scl_always_low || cause != 0);
                no_answer: assert (!silent || cause != 0);
            end
            if ($past(done && !reset_i)) lines_go: assert (!busy && !scl_low && !sda_low);
            bounded: assert (!busy || left <= 204);
            if ($past(started && busy && !reset_i && \dut.steps_q ) && busy && !done) falls: assert (left < $past(left));
            if ($past(started && busy && !reset_i && !\dut.steps_q ) && busy && !done) never_rises: assert (left == $past(left));
            step_is_short: assert (!busy || \dut.cycle_q <= QUARTER + 1);
            hold_is_short: assert (!busy || \dut.held_cycles_q <= HOLD + 1);
        end
        begins: cover (busy && \dut.phase_q == BIT && \dut.bit_number_q == 1);
    end
endmodule
