// board_registers with its bank_guard, whatever the host does: the rules of AXI4-Lite, one access at a time, each answered; what `protection`
// keeps out never reaches the calculator, the tables, or a register, is answered with an error and is counted; `control` and `protection`
// change by nothing but a write to them, and a reset leaves the bank in use.
//
// The bank that a word belongs to is worked out here again, from the sizes of `tiny` (edof_device::design::memory::set_of).
module prove (
    input wire        clock_i,
    input wire        reset_i,
    input wire        keeps_i,
    input wire [31:0] aw_addr_i,
    input wire        aw_valid_i,
    input wire [31:0] w_data_i,
    input wire [3:0]  w_strb_i,
    input wire        w_valid_i,
    input wire        b_ready_i,
    input wire [31:0] ar_addr_i,
    input wire        ar_valid_i,
    input wire        r_ready_i,
    input wire        stage_ready_i,
    input wire        unreached_i,
    input wire        table_ready_i,
    input wire        weight_ready_i
);
    wire aw_ready, w_ready, b_valid, ar_ready, r_valid, tile_write, frame_write, stage_valid, table_valid, weight_valid;
    wire [1:0] b_resp, r_resp;
    wire [31:0] r_data, weights_hash, control, scratch, weight_data;
    wire [24:0] weight_address;
    wire [16:0] table_address;
    wire [11:0] table_data;
    board_registers dut (
        .clock_i(clock_i), .reset_i(reset_i), .preserve_i(keeps_i), .bus_aw_addr_i(aw_addr_i), .bus_aw_valid_i(aw_valid_i), .bus_aw_ready_o(aw_ready),
        .bus_w_data_i(w_data_i), .bus_w_strb_i(w_strb_i), .bus_w_valid_i(w_valid_i), .bus_w_ready_o(w_ready), .bus_b_resp_o(b_resp),
        .bus_b_valid_o(b_valid), .bus_b_ready_i(b_ready_i), .bus_ar_addr_i(ar_addr_i), .bus_ar_valid_i(ar_valid_i), .bus_ar_ready_o(ar_ready),
        .bus_r_data_o(r_data), .bus_r_resp_o(r_resp), .bus_r_valid_o(r_valid), .bus_r_ready_i(r_ready_i), .tile_write_o(tile_write), .frame_write_o(frame_write),
        .weights_hash_o(weights_hash), .control_o(control), .scratch_o(scratch), .stage_valid_o(stage_valid), .stage_ready_i(stage_ready_i),
        .unreached_i(unreached_i), .table_valid_o(table_valid), .table_ready_i(table_ready_i), .table_address_o(table_address),
        .table_data_o(table_data), .weight_valid_o(weight_valid), .weight_ready_i(weight_ready_i), .weight_address_o(weight_address),
        .weight_data_o(weight_data)
    );
    (* hierconn *) wire [31:0] \dut.host_protection_q , \dut.rejected_words_q , \dut.address_q , \dut.word_q ;
    (* hierconn *) wire [2:0] \dut.phase_q ;
    (* hierconn *) wire \dut.is_waiting_q ;
    wire [31:0] protection = \dut.host_protection_q ;

    reg started = 0;
    // The access in flight, and its cycles so far without those in which a window waits.
    reg writes = 0, reads = 0, whole;
    reg [31:0] address, word;
    reg [2:0] age = 0;
    wire takes_write = aw_valid_i && aw_ready;
    wire takes_read = ar_valid_i && ar_ready;
    wire waits = (weight_valid && !weight_ready_i) || (table_valid && !table_ready_i) || (stage_valid && !stage_ready_i);

    // Where it goes.
    wire area = address[31:8] == 0;
    wire tables = address[31:19] == 2;
    wire weights = address[31:27] == 1;
    wire tile = address[31:14] == 4;
    wire frame = address[31:14] == 6;
    wire [3:0] stage = address[26:23];
    wire [1:0] space = address[22:21];
    wire [11:0] row = address[14:3];
    // Rows of the first bank: weights, thresholds, registers.
    wire [11:0] rows = space == 3 ? 1 : space != 0 ? (stage == 3 ? 64 : 8) : stage == 0 ? 64 : stage == 3 ? 320 : 32;
    wire shut = stage < 4 && (space != 3 || row < 2) && (protection[2] || (row >= rows) == control[2]);
    wire checked = word[31:16] == ~word[15:0];
    wire barred = protection[0] && ((weights && shut) || (tables && control[0]));
    wire unchecked = area && ((address[7:2] == 5 && protection[1]) || address[7:2] == 7) && !checked;
    wire kept_out = whole && (barred || unchecked);
    wire known = address[7:2] == 4 || address[7:2] == 5 || address[7:2] == 6 || address[7:2] == 7 || address[7:2] == 40 || address[7:2] == 41
        || address[7:2] == 44 || address[7:2] == 53;
    wire is_written = whole && !kept_out && (tables || weights || tile || frame || (area && known));
    // The access writes a register in this cycle.
    wire now = writes && age == 3 && whole && area && !unchecked;

    // What the host decided.
    reg [31:0] control_then = 3, protection_then = 1, hash_then = 32'hffffffff, refused = 0;
    reg hash_known = 0, error = 0, answered = 0;
    always @(posedge clock_i) begin
        started <= 1;
        assume (started || (reset_i && !keeps_i));
        if (reset_i) {writes, reads, age, answered} <= 0;
        else begin
            if (takes_write || takes_read) begin
                {writes, reads} <= {takes_write, takes_read};
                address <= takes_write ? aw_addr_i : ar_addr_i;
                word <= w_data_i;
                whole <= takes_write ? w_strb_i == 15 && aw_addr_i[1:0] == 0 : ar_addr_i[1:0] == 0;
                age <= 1;
            end else if ((b_valid && b_ready_i) || (r_valid && r_ready_i)) {writes, reads, age} <= 0;
            else if (age != 0 && !waits && !b_valid && !r_valid) age <= age + 1;
        end
        // Registers.
        if (reset_i) begin
            control_then <= 3 | (keeps_i ? control_then & 4 : 0);
            protection_then <= 1;
            refused <= 0;
            if (!keeps_i) hash_known <= 0;
        end else begin
            if (now && address[7:2] == 4) {hash_known, hash_then} <= {1'b1, word};
            if (now && address[7:2] == 5) control_then <= word & 31;
            if (now && address[7:2] == 7) protection_then <= word & 7;
            if (b_valid && age == 4 && !$past(b_valid) && kept_out) refused <= refused + 1;
        end
        if (waits || stage_valid || weight_valid || table_valid) error <= unreached_i;
        else if (age == 3) error <= 0;

        if (started) begin
            // What the circuit's registers hold; from these the rest follows.
            idle: assert ((\dut.phase_q == 0) == (age == 0) && (age != 0) == (writes || reads) && !(writes && reads));
            held: assert (age == 0 || (\dut.address_q == address && (!writes || \dut.word_q == word)));
            stands: assert (control == control_then && protection == protection_then && (!hash_known || weights_hash == hash_then));
            phases: assert (!writes || (age == 1 ? \dut.phase_q == 1 : age == 2 ? \dut.phase_q == 2 : age == 3 ? \dut.phase_q == 3 : \dut.phase_q == 4));
            counted: assert (refused == \dut.rejected_words_q );
            of_reads: assert (!reads || (\dut.phase_q == 5 ? age == 1 + \dut.is_waiting_q : \dut.phase_q == 6 ? age == 2 || age == 3 : \dut.phase_q == 7));
            waited: assert (!\dut.is_waiting_q || (\dut.phase_q == 5 && age == 2));
        end
        if (started && !reset_i) begin
            // AXI4-Lite.
            together: assert (aw_ready == w_ready && (!aw_ready || (aw_valid_i && w_valid_i)));
            one_at_a_time: assert (!(aw_ready || ar_ready) || age == 0);
            not_both: assert (!(aw_ready && ar_ready));
            answers: assert ((!b_valid || writes) && (!r_valid || reads));
            in_time: assert (age < 5 && (age != 4 || b_valid || reads));
            if ($past(started && !reset_i)) begin
                if ($past(b_valid && !b_ready_i)) answer_stands: assert (b_valid && $stable(b_resp));
                if ($past(r_valid && !r_ready_i)) word_stands: assert (r_valid && $stable(r_data) && $stable(r_resp));
                if ($past(weight_valid && !weight_ready_i)) offer_stands: assert (weight_valid && $stable(weight_address) && $stable(weight_data));
                if ($past(table_valid && !table_ready_i)) entry_stands: assert (table_valid && $stable(table_address) && $stable(table_data));
            end
            // Protection.
            bank_kept: assert (!weight_valid || (writes && whole && weights && !(protection[0] && shut)));
            its_word: assert (!weight_valid || (weight_address == address[26:2] && weight_data == word));
            tables_kept: assert (!table_valid || (writes && whole && tables && !(protection[0] && control[0])));
            its_entry: assert (!table_valid || (table_address == address[18:2] && table_data == word[11:0]));
            tile_alone: assert (!tile_write || (writes && whole && tile));
            frame_alone: assert (!frame_write || (writes && whole && frame));
            told: assert (!b_valid || (b_resp == (is_written && !((weights || tables) && error) ? 0 : 2)));
        end
        writes_bank: cover (started && weight_valid && weight_ready_i && control[2] && row < 8 && space == 1);
        keeps_out: cover (b_valid && refused == 1 && kept_out && weights);
        shows: cover (r_valid && r_resp == 0 && r_data == 32'h45444f46);
    end
endmodule
