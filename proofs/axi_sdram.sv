// axi_sdram at 50 MHz, whatever the master does, resets apart: what the chip's pins see keeps the chip's rules (Micron MT48LC16M16A2-75), in cycles of 20 ns: tRCD,
// tRP 2, tRAS 3, tRC, tRFC 4, tWR and tMRD 2 or more; no burst is cut; nobody drives the data lines while the chip does. A column is of the row that its word lies in. A refresh
// waits for at most 14 cycles. Of the words nothing is seen here. The power-up time is 3 cycles, two
// refreshes follow, and then one every 16 cycles.
module prove (
    input wire        clock_i,
    input wire [31:0] aw_addr_i,
    input wire        aw_valid_i,
    input wire        w_last_i,
    input wire        w_valid_i,
    input wire        b_ready_i,
    input wire [31:0] ar_addr_i,
    input wire [7:0]  ar_len_i,
    input wire        ar_valid_i,
    input wire        r_ready_i
);
    wire aw_ready, w_ready, b_valid, ar_ready, r_last, r_valid, ready, drive;
    wire [2:0] command;
    wire [1:0] bank;
    wire [12:0] address;
    reg started = 0;
    axi_sdram dut (
        .clock_i(clock_i), .reset_i(!started), .write_aw_id_i(1'b0), .write_aw_addr_i(aw_addr_i), .write_aw_valid_i(aw_valid_i),
        .write_aw_ready_o(aw_ready), .write_w_data_i(128'd0), .write_w_strb_i(16'd0), .write_w_last_i(w_last_i),
        .write_w_valid_i(w_valid_i), .write_w_ready_o(w_ready), .write_b_valid_o(b_valid), .write_b_ready_i(b_ready_i),
        .read_ar_id_i(1'b0), .read_ar_addr_i(ar_addr_i), .read_ar_len_i(ar_len_i), .read_ar_valid_i(ar_valid_i),
        .read_ar_ready_o(ar_ready), .read_r_last_o(r_last), .read_r_valid_o(r_valid), .read_r_ready_i(r_ready_i),
        .ready_o(ready), .command_o(command), .bank_o(bank), .address_o(address), .drive_o(drive), .data_in_i(16'd0)
    );
    localparam MODE = 3'd0, REFRESH = 3'd1, PRECHARGE = 3'd2, ACTIVE = 3'd3, WRITE = 3'd4, READ = 3'd5, NOP = 3'd7;
    (* hierconn *) wire \dut.due_q , \dut.open_q , \dut.compared_q , \dut.is_hit_q , \dut.last_is_write_q , \dut.is_driven_q ;
    (* hierconn *) wire [2:0] \dut.phase_q , \dut.refreshes_q , \dut.columns_left_q ;
    (* hierconn *) wire [4:0] \dut.gap_q , \dut.quiet_q ;
    (* hierconn *) wire [14:0] \dut.open_row_q ;
    (* hierconn *) wire [20:0] \dut.chosen_place_q ;

    // Before the command that is on the pins: cycles since the last one of each kind, 31 for more; what is open, set up, refreshed.
    reg [4:0] active = 31, precharge = 31, refresh = 31, mode = 31, write = 31, read = 31, waits = 0;
    reg [1:0] refreshes = 0;
    reg open = 0, closed_once = 0, set = 0;
    reg [14:0] row = 0;
    // The word of the column that is on the pins.
    reg [20:0] place = 0;
    wire column = command == READ || command == WRITE;
    // The same after it.
    function [4:0] since(input [4:0] before, input now);
        since = now ? 5'd1 : &before ? before : before + 5'd1;
    endfunction
    wire [4:0] next_active = since(active, command == ACTIVE), next_precharge = since(precharge, command == PRECHARGE);
    wire [4:0] next_refresh = since(refresh, command == REFRESH), next_mode = since(mode, command == MODE);
    wire [4:0] next_write = since(write, command == WRITE), next_read = since(read, command == READ);
    wire [1:0] next_refreshes = refreshes + (command == REFRESH && !refreshes[1]);
    wire next_open = command == ACTIVE || (open && command != PRECHARGE);
    wire next_closed_once = closed_once || command == PRECHARGE, next_set = set || command == MODE;
    wire [14:0] next_row = command == ACTIVE ? {address, bank} : row;
    // A master keeps its offer.
    reg w_held = 0;
    always @(posedge clock_i) begin
        started <= 1;
        w_held <= started && w_valid_i && !w_ready;
        waits <= \dut.due_q && ready ? waits + 1 : 0;
        place <= \dut.chosen_place_q ;
        if (started) begin
            {active, precharge, refresh, mode} <= {next_active, next_precharge, next_refresh, next_mode};
            {write, read, refreshes} <= {next_write, next_read, next_refreshes};
            {open, closed_once, set, row} <= {next_open, next_closed_once, next_set, next_row};
        end
        if (w_held) assume (w_valid_i);
    end
    always @* if (started) begin
        busy: assert (command == NOP || (refresh >= 4 && mode >= 2));
        activated: assert (command != ACTIVE || (set && !open && precharge >= 2 && active >= 4));
        precharged: assert (command != PRECHARGE || !open || (active >= 3 && write >= 9 && read >= 8));
        refreshed: assert (command != REFRESH || (closed_once && !open && precharge >= 2));
        loaded: assert (command != MODE || (refreshes[1] && !open && address == 13'h33 && bank == 0));
        accessed: assert (!column || (set && open && active >= 2 && write >= 8 && read >= 8 && address[12:9] == 0 && address[2:0] == 0));
        whose: assert (!column || (bank == row[1:0] && place[20:6] == row && address[8:3] == place[5:0]));
        // The chip drives from two cycles after its command on, for eight cycles. The board begins one and a half cycles before the chip takes the column.
        lines: assert (command != WRITE || read >= 12);
        driven: assert (!drive || write <= 8 || command == WRITE);
        in_time: assert (waits <= 14);
        not_used: assert (command != 3'd6);

        // What holds inside.
        phases: assert ( \dut.phase_q <= 4);
        setting_up: assert ( \dut.phase_q == 4 || (!next_open && ! \dut.open_q && !next_set && next_write == 31 && next_read == 31 && next_active == 31));
        first: assert ( \dut.phase_q > 1 || (!next_closed_once && next_refreshes == 0 && command == NOP));
        refreshing: assert ( \dut.phase_q != 2 || (next_closed_once && \dut.refreshes_q <= 1 && next_refreshes == 1 - \dut.refreshes_q ));
        refreshed_twice: assert ( \dut.phase_q < 3 || (next_closed_once && next_refreshes[1]));
        running: assert ( \dut.phase_q != 4 || next_set);
        after_refresh: assert (next_refresh + {1'b0, \dut.quiet_q } >= 4);
        after_mode: assert (next_mode + {1'b0, \dut.quiet_q } >= 3);
        after_precharge: assert (next_precharge + {1'b0, \dut.quiet_q } >= 2);
        after_active: assert (next_active + {1'b0, \dut.quiet_q } >= 3 && next_active + {1'b0, \dut.gap_q } >= 3);
        after_write: assert (next_write + {1'b0, \dut.quiet_q } >= 9 && next_write + {1'b0, \dut.gap_q } >= 8);
        after_read: assert (next_read + {1'b0, \dut.gap_q } >= 8);
        before_write: assert ( \dut.last_is_write_q ? next_read >= 12 || next_write == 31 : 1);
        turn: assert (next_read + {1'b0, \dut.quiet_q } >= 12);
        is_open: assert (next_open == \dut.open_q && (! \dut.open_q || next_row == \dut.open_row_q ));
        cycle: assert (next_active + {1'b0, \dut.quiet_q } >= 5 || \dut.open_q );
        hit: assert (! \dut.compared_q || ! \dut.is_hit_q || \dut.due_q || ( \dut.open_q && \dut.chosen_place_q [20:6] == \dut.open_row_q ));
        left: assert (next_write <= 8 ? \dut.columns_left_q == 8 - next_write : \dut.columns_left_q == 0);
        drives: assert ( \dut.is_driven_q == (next_write <= 8) && (!drive || next_write <= 9));
        waiting: assert (! \dut.due_q || ! ready || waits + {1'b0, \dut.quiet_q } <= ( \dut.open_q ? 11 : 13));

        both: cover (w_ready && read < 31);
        again: cover (set && refresh == 1 && write < 31);
    end
endmodule
