// From dense vectors to (index, value) pairs: four slots, one fills while others wait and one is read, as often as there are passes.
// Ready while fewer than four are full. With skip_zeros only non-zero elements are kept. Pair 2r of slot s lies at row 128 s + r of
// the even memory, pair 2r + 1 likewise in the odd one; both are read two cycles after read_row. A vector's descriptor comes three
// cycles after its last beat.
//
// From crates/edof-hdl/src/blocks/pair_store.rs (PairStore).
`default_nettype none

module pair_store_2 (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        skip_zeros_i,
    input  wire        valid_i,
    output wire        ready_o,
    input  wire [15:0] even_i,
    input  wire [15:0] odd_i,
    input  wire        last_i,
    input  wire        set_i,
    output wire        arrived_o,
    output wire [11:0] descriptor_o,
    input  wire [8:0]  read_row_i,
    output wire [24:0] even_pair_o,
    output wire [24:0] odd_pair_o,
    input  wire        finished_i
);

    localparam TWO_ROWS = 1'h1;
    localparam [2:0] ALL_SLOTS = 3'h4;

    reg  [2:0] full_next;
    wire accept;
    wire keep_one;
    wire keep_both;
    wire [24:0] arrived_even;
    wire [24:0] arrived_odd;
    reg  [24:0] arrived_first;
    reg  [8:0] stored_next;
    wire [11:0] row;
    wire [8:0] before_last;
    reg  [7:0] steps;
    reg  [3:0] flags;
    wire [11:0] even_pairs_read_address;
    wire [11:0] odd_pairs_read_address;
    reg  [2:0] full_q;
    reg  [2:0] full_d;
    reg  ready_q_q;
    reg  ready_q_d;
    reg  valid_1_q;
    reg  valid_1_d;
    reg  [15:0] even_1_q;
    reg  [15:0] odd_1_q;
    reg  last_1_q;
    reg  set_1_q;
    reg  valid_2_q;
    reg  valid_2_d;
    reg  keep_even_2_q;
    reg  keep_even_2_d;
    reg  keep_odd_2_q;
    reg  keep_odd_2_d;
    reg  [15:0] even_2_q;
    reg  [15:0] odd_2_q;
    reg  last_2_q;
    reg  set_2_q;
    reg  [7:0] beat_q;
    reg  [7:0] beat_d;
    reg  [8:0] stored_q;
    reg  [8:0] stored_d;
    reg  [1:0] write_slot_q;
    reg  [1:0] write_slot_d;
    reg  even_write_3_q;
    reg  even_write_3_d;
    reg  odd_write_3_q;
    reg  odd_write_3_d;
    reg  [11:0] even_row_3_q;
    reg  [11:0] even_row_3_d;
    reg  [11:0] odd_row_3_q;
    reg  [24:0] even_data_3_q;
    reg  [24:0] even_data_3_d;
    reg  [24:0] odd_data_3_q;
    reg  [24:0] odd_data_3_d;
    reg  arrived_3_q;
    reg  arrived_3_d;
    reg  [8:0] count_3_q;
    reg  set_3_q;

    // Only a part of what follows is used.
    /* verilator lint_off UNUSED */
    wire [8:0] steps_shifted = before_last >> 1;
    /* verilator lint_on UNUSED */

    edof_ram #(
        .WIDTH(25),
        .DEPTH(512),
        .BLOCK(2),
        .INIT("")
    ) even_pairs (
        .clock_i(clock_i),
        .read_address_i(even_pairs_read_address),
        .read_data_o(even_pair_o),
        .write_enable_i(even_write_3_q),
        .write_address_i(even_row_3_q),
        .write_data_i(even_data_3_q)
    );

    edof_ram #(
        .WIDTH(25),
        .DEPTH(512),
        .BLOCK(2),
        .INIT("")
    ) odd_pairs (
        .clock_i(clock_i),
        .read_address_i(odd_pairs_read_address),
        .read_data_o(odd_pair_o),
        .write_enable_i(odd_write_3_q),
        .write_address_i(odd_row_3_q),
        .write_data_i(odd_data_3_q)
    );

    assign ready_o = ready_q_q;
    assign accept = valid_i && ready_q_q;

    always @* begin
        full_next = full_q;
        if ((accept && last_i) && (!finished_i)) begin
            full_next = full_q + 3'd1;
        end else if (finished_i && (!(accept && last_i))) begin
            full_next = full_q - 3'd1;
        end
    end

    always @* begin
        beat_d = beat_q;
        stored_d = stored_q;
        write_slot_d = write_slot_q;
        full_d = full_next;
        ready_q_d = full_next != ALL_SLOTS;
        valid_1_d = accept;
        valid_2_d = valid_1_q;
        keep_even_2_d = valid_1_q && ((!skip_zeros_i) || (|even_1_q));
        keep_odd_2_d = valid_1_q && ((!skip_zeros_i) || (|odd_1_q));
        even_write_3_d = keep_one;
        even_row_3_d = row;
        even_data_3_d = arrived_first;
        odd_write_3_d = keep_both;
        odd_data_3_d = arrived_odd;
        if (stored_q[0]) begin
            even_write_3_d = keep_both;
            even_row_3_d = row + 12'd1;
            even_data_3_d = arrived_odd;
            odd_write_3_d = keep_one;
            odd_data_3_d = arrived_first;
        end
        if (valid_2_q) begin
            beat_d = beat_q + 8'd1;
            stored_d = stored_next;
            if (last_2_q) begin
                beat_d = 8'd0;
                stored_d = 9'd0;
                write_slot_d = write_slot_q + 2'd1;
            end
        end
        arrived_3_d = valid_2_q && last_2_q;
        if (reset_i) begin
            full_d = 3'd0;
            ready_q_d = 1'b0;
            valid_1_d = 1'b0;
            valid_2_d = 1'b0;
            keep_even_2_d = 1'b0;
            keep_odd_2_d = 1'b0;
            beat_d = 8'd0;
            stored_d = 9'd0;
            write_slot_d = 2'd0;
            even_write_3_d = 1'b0;
            odd_write_3_d = 1'b0;
            arrived_3_d = 1'b0;
        end
    end

    assign keep_one = keep_even_2_q || keep_odd_2_q;
    assign keep_both = keep_even_2_q && keep_odd_2_q;
    assign arrived_even = ({17'd0, beat_q} << 17) | {9'd0, even_2_q};
    assign arrived_odd = (({17'd0, beat_q} << 17) | {9'd0, odd_2_q}) | 25'h10000;

    always @* begin
        arrived_first = arrived_odd;
        if (keep_even_2_q) begin
            arrived_first = arrived_even;
        end
    end

    assign row = ({10'd0, write_slot_q} << 7) | {4'd0, stored_q[8:1]};

    always @* begin
        stored_next = stored_q;
        if (keep_both) begin
            stored_next = stored_q + 9'd2;
        end else if (keep_one) begin
            stored_next = stored_q + 9'd1;
        end
    end

    assign before_last = count_3_q - 9'd1;

    always @* begin
        steps = before_last[7:0];
        flags = 4'd0;
        if (set_3_q) begin
            flags = 4'd1;
        end
        if (count_3_q[0]) begin
            flags = flags | 4'd2;
        end
        if (count_3_q == 9'd1) begin
            flags = flags | 4'd8;
        end
        if (TWO_ROWS) begin
            steps = steps_shifted[7:0];
            if (count_3_q == 9'd2) begin
                flags = flags | 4'd8;
            end
        end
        if (!(|count_3_q)) begin
            steps = 8'd0;
            flags = flags | 4'he;
        end
    end

    assign arrived_o = arrived_3_q;
    assign descriptor_o = ({4'd0, steps} << 4) | {8'd0, flags};
    assign even_pairs_read_address = {3'd0, read_row_i};
    assign odd_pairs_read_address = {3'd0, read_row_i};

    always @(posedge clock_i) begin
        full_q <= full_d;
        ready_q_q <= ready_q_d;
        valid_1_q <= valid_1_d;
        even_1_q <= even_i;
        odd_1_q <= odd_i;
        last_1_q <= last_i;
        set_1_q <= set_i;
        valid_2_q <= valid_2_d;
        keep_even_2_q <= keep_even_2_d;
        keep_odd_2_q <= keep_odd_2_d;
        even_2_q <= even_1_q;
        odd_2_q <= odd_1_q;
        last_2_q <= last_1_q;
        set_2_q <= set_1_q;
        beat_q <= beat_d;
        stored_q <= stored_d;
        write_slot_q <= write_slot_d;
        even_write_3_q <= even_write_3_d;
        odd_write_3_q <= odd_write_3_d;
        even_row_3_q <= even_row_3_d;
        odd_row_3_q <= row;
        even_data_3_q <= even_data_3_d;
        odd_data_3_q <= odd_data_3_d;
        arrived_3_q <= arrived_3_d;
        count_3_q <= stored_next;
        set_3_q <= set_2_q;
    end
endmodule

`default_nettype wire
