// From dense vectors to (index, value) pairs: two slots, one fills while the other is read, as often as there are passes.
// Ready while fewer than two slots are full. With skip_zeros only non-zero elements are kept. A pair is read a cycle
// after read_pair; pair 2r lies at row r of the even memory, pair 2r + 1 at row r of the odd one.
//
// From crates/edof-hdl/src/blocks/pair_buffer.rs (PairBuffer).
`default_nettype none

module pair_buffer_2 (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        skip_zeros_i,
    input  wire        valid_i,
    output wire        ready_o,
    input  wire [15:0] even_i,
    input  wire [15:0] odd_i,
    input  wire        last_i,
    input  wire        set_i,
    output wire        available_o,
    output reg  [8:0]  count_o,
    output reg         front_set_o,
    input  wire [7:0]  read_pair_i,
    output wire [24:0] even_pair_o,
    output wire [24:0] odd_pair_o,
    input  wire        finished_i
);

    localparam [11:0] SLOT_ROWS = 12'h8;

    wire accept;
    wire arrived;
    wire keep_even;
    wire keep_odd;
    wire keep_one;
    wire keep_both;
    wire [24:0] arrived_even;
    wire [24:0] arrived_odd;
    reg  [24:0] arrived_first;
    reg  [8:0] stored_next;
    reg  [11:0] write_row;
    reg  [11:0] read_row;
    reg  even_pairs_write_enable;
    reg  [11:0] even_pairs_write_address;
    reg  [24:0] even_pairs_write_data;
    reg  odd_pairs_write_enable;
    reg  [24:0] odd_pairs_write_data;
    reg  [7:0] beat_q;
    reg  [7:0] beat_d;
    reg  [8:0] stored_q;
    reg  [8:0] stored_d;
    reg  write_slot_q;
    reg  write_slot_d;
    reg  read_slot_q;
    reg  read_slot_d;
    reg  [1:0] full_q;
    reg  [1:0] full_d;
    reg  [8:0] count_0_q;
    reg  [8:0] count_0_d;
    reg  [8:0] count_1_q;
    reg  [8:0] count_1_d;
    reg  set_0_q;
    reg  set_0_d;
    reg  set_1_q;
    reg  set_1_d;

    edof_ram #(
        .WIDTH(25),
        .DEPTH(16),
        .BLOCK(0),
        .INIT("")
    ) even_pairs (
        .clock_i(clock_i),
        .read_address_i(read_row),
        .read_data_o(even_pair_o),
        .write_enable_i(even_pairs_write_enable),
        .write_address_i(even_pairs_write_address),
        .write_data_i(even_pairs_write_data)
    );

    edof_ram #(
        .WIDTH(25),
        .DEPTH(16),
        .BLOCK(0),
        .INIT("")
    ) odd_pairs (
        .clock_i(clock_i),
        .read_address_i(read_row),
        .read_data_o(odd_pair_o),
        .write_enable_i(odd_pairs_write_enable),
        .write_address_i(write_row),
        .write_data_i(odd_pairs_write_data)
    );

    assign ready_o = full_q != 2'd2;
    assign accept = valid_i && (full_q != 2'd2);
    assign arrived = accept && last_i;
    assign keep_even = accept && ((!skip_zeros_i) || (|even_i));
    assign keep_odd = accept && ((!skip_zeros_i) || (|odd_i));
    assign keep_one = keep_even || keep_odd;
    assign keep_both = keep_even && keep_odd;
    assign arrived_even = ({17'd0, beat_q} << 17) | {9'd0, even_i};
    assign arrived_odd = (({17'd0, beat_q} << 17) | {9'd0, odd_i}) | 25'h10000;

    always @* begin
        arrived_first = arrived_odd;
        if (keep_even) begin
            arrived_first = arrived_even;
        end
    end

    always @* begin
        write_row = {3'd0, stored_q} >> 1;
        if (write_slot_q) begin
            write_row = ({3'd0, stored_q} >> 1) + SLOT_ROWS;
        end
    end

    always @* begin
        even_pairs_write_enable = keep_one;
        even_pairs_write_address = write_row;
        even_pairs_write_data = arrived_first;
        odd_pairs_write_enable = keep_both;
        odd_pairs_write_data = arrived_odd;
        if (stored_q[0]) begin
            even_pairs_write_enable = keep_both;
            even_pairs_write_address = write_row + 12'd1;
            even_pairs_write_data = arrived_odd;
            odd_pairs_write_enable = keep_one;
            odd_pairs_write_data = arrived_first;
        end
    end

    always @* begin
        stored_next = stored_q;
        if (keep_both) begin
            stored_next = stored_q + 9'd2;
        end else if (keep_one) begin
            stored_next = stored_q + 9'd1;
        end
    end

    always @* begin
        beat_d = beat_q;
        stored_d = stored_q;
        write_slot_d = write_slot_q;
        read_slot_d = read_slot_q;
        full_d = full_q;
        count_0_d = count_0_q;
        count_1_d = count_1_q;
        set_0_d = set_0_q;
        set_1_d = set_1_q;
        if (accept) begin
            beat_d = beat_q + 8'd1;
            stored_d = stored_next;
        end
        if (arrived) begin
            beat_d = 8'd0;
            stored_d = 9'd0;
            write_slot_d = !write_slot_q;
            if (write_slot_q) begin
                count_1_d = stored_next;
                set_1_d = set_i;
            end else begin
                count_0_d = stored_next;
                set_0_d = set_i;
            end
        end
        if (finished_i) begin
            read_slot_d = !read_slot_q;
        end
        if (arrived && (!finished_i)) begin
            full_d = full_q + 2'd1;
        end else if (finished_i && (!arrived)) begin
            full_d = full_q - 2'd1;
        end
        if (reset_i) begin
            beat_d = 8'd0;
            stored_d = 9'd0;
            write_slot_d = 1'b0;
            read_slot_d = 1'b0;
            full_d = 2'd0;
        end
    end

    assign available_o = |full_q;

    always @* begin
        count_o = count_0_q;
        front_set_o = set_0_q;
        if (read_slot_q) begin
            count_o = count_1_q;
            front_set_o = set_1_q;
        end
    end

    always @* begin
        read_row = {4'd0, read_pair_i};
        if (read_slot_q) begin
            read_row = {4'd0, read_pair_i} + SLOT_ROWS;
        end
    end

    always @(posedge clock_i) begin
        beat_q <= beat_d;
        stored_q <= stored_d;
        write_slot_q <= write_slot_d;
        read_slot_q <= read_slot_d;
        full_q <= full_d;
        count_0_q <= count_0_d;
        count_1_q <= count_1_d;
        set_0_q <= set_0_d;
        set_1_q <= set_1_d;
    end
endmodule

`default_nettype wire
