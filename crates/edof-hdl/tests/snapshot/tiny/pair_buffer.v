// From dense vectors to (index, value) pairs: two slots, one fills while the other is read, as often as there are passes.
// Ready while fewer than two slots are full. With skip_zeros only non-zero elements are kept. A pair is read a cycle
// after read_pair; pair 2r lies at row r of the even memory, pair 2r + 1 at row r of the odd one.
//
// From crates/edof-hdl/src/blocks/pair_buffer.rs (PairBuffer).
`default_nettype none

module pair_buffer #(
    parameter [11:0] SLOT_ROWS = 12'd32,
    parameter DEPTH = 64
) (
    input  wire        clock_i,      // Clock.
    input  wire        reset_i,      // Empties both slots.
    input  wire        skip_zeros_i, // Whether zeros are left out.
    input  wire        valid_i,      // A beat stands on the input.
    output wire        ready_o,      // It is taken in this cycle, if there is one.
    input  wire [15:0] even_i,       // Element of even index.
    input  wire [15:0] odd_i,        // Element of odd index.
    input  wire        last_i,       // Whether the beat is its vector's last.
    input  wire        set_i,        // The vector's set.
    output wire        available_o,  // A vector waits to be read.
    output wire [8:0]  count_o,      // Its pairs.
    output wire        front_set_o,  // Its set.
    input  wire [7:0]  read_pair_i,  // Which pair to read, divided by two.
    output wire [24:0] even_pair_o,  // The even one of the two read, a cycle later.
    output wire [24:0] odd_pair_o,   // The odd one.
    input  wire        finished_i    // Frees the slot that is read.
);

    wire accept;
    wire arrived;
    wire keep_even;
    wire keep_odd;
    wire keep_one;
    wire keep_both;
    wire [24:0] arrived_even;
    wire [24:0] arrived_odd;
    wire [24:0] arrived_first;
    wire [8:0] stored_next;
    reg  [11:0] write_row;
    wire [11:0] read_row;
    wire even_pairs_write_enable;
    wire [11:0] even_pairs_write_address;
    wire [24:0] even_pairs_write_data;
    wire odd_pairs_write_enable;
    wire [24:0] odd_pairs_write_data;
    reg  [7:0] beat_q;
    reg  [7:0] beat_d;
    reg  [8:0] stored_q;
    reg  [8:0] stored_d;
    reg  write_slot_q;
    wire write_slot_d;
    reg  read_slot_q;
    wire read_slot_d;
    reg  [1:0] full_q;
    reg  [1:0] full_d;
    reg  [8:0] count_0_q;
    wire [8:0] count_0_d;
    reg  [8:0] count_1_q;
    wire [8:0] count_1_d;
    reg  set_0_q;
    wire set_0_d;
    reg  set_1_q;
    wire set_1_d;

    edof_ram #(
        .WIDTH(25),
        .DEPTH(DEPTH),
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
        .DEPTH(DEPTH),
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
    assign keep_even = accept && (!skip_zeros_i || (|even_i));
    assign keep_odd = accept && (!skip_zeros_i || (|odd_i));
    assign keep_one = keep_even || keep_odd;
    assign keep_both = keep_even && keep_odd;
    assign arrived_even = ({17'd0, beat_q} << 17) | {9'd0, even_i};
    assign arrived_odd = ({17'd0, beat_q} << 17) | {9'd0, odd_i} | 25'h10000;
    assign arrived_first = keep_even ? arrived_even : arrived_odd;

    always @* begin
        write_row = {3'd0, stored_q} >> 1;
        if (write_slot_q) begin
            write_row = ({3'd0, stored_q} >> 1) + SLOT_ROWS;
        end
    end

    assign even_pairs_write_enable = stored_q[0] ? keep_both : keep_one;
    assign even_pairs_write_address = stored_q[0] ? (write_row + 12'd1) : write_row;
    assign even_pairs_write_data = stored_q[0] ? arrived_odd : arrived_first;
    assign odd_pairs_write_enable = stored_q[0] ? keep_one : keep_both;
    assign odd_pairs_write_data = stored_q[0] ? arrived_first : arrived_odd;
    assign stored_next = keep_both ? (stored_q + 9'd2) : (keep_one ? (stored_q + 9'd1) : stored_q);

    always @* begin
        beat_d = beat_q;
        if (accept) begin
            beat_d = beat_q + 8'd1;
        end
        if (arrived) begin
            beat_d = 8'd0;
        end
        if (reset_i) begin
            beat_d = 8'd0;
        end
    end

    always @* begin
        stored_d = stored_q;
        if (accept) begin
            stored_d = stored_next;
        end
        if (arrived) begin
            stored_d = 9'd0;
        end
        if (reset_i) begin
            stored_d = 9'd0;
        end
    end

    assign write_slot_d = reset_i ? 1'b0 : (arrived ? !write_slot_q : write_slot_q);
    assign read_slot_d = reset_i ? 1'b0 : (finished_i ? !read_slot_q : read_slot_q);

    always @* begin
        full_d = full_q;
        if (arrived && !finished_i) begin
            full_d = full_q + 2'd1;
        end else if (finished_i && !arrived) begin
            full_d = full_q - 2'd1;
        end
        if (reset_i) begin
            full_d = 2'd0;
        end
    end

    assign count_0_d = (arrived && !write_slot_q) ? stored_next : count_0_q;
    assign count_1_d = (arrived && write_slot_q) ? stored_next : count_1_q;
    assign set_0_d = (arrived && !write_slot_q) ? set_i : set_0_q;
    assign set_1_d = (arrived && write_slot_q) ? set_i : set_1_q;
    assign available_o = |full_q;
    assign count_o = read_slot_q ? count_1_q : count_0_q;
    assign front_set_o = read_slot_q ? set_1_q : set_0_q;
    assign read_row = read_slot_q ? ({4'd0, read_pair_i} + SLOT_ROWS) : {4'd0, read_pair_i};

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
