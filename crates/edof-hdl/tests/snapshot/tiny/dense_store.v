// Dense vectors that wait for their multipliers: four slots, in as many memories as the stage takes values at once. Each holds a
// part of every vector, two elements a row, slot s from row 128 s on. Ready while fewer than four slots are full. Row read_row of
// all parts is read two cycles later. A vector's descriptor comes three cycles after its last beat.
//
// From crates/edof-hdl/src/blocks/dense_store.rs (DenseStore).
`default_nettype none

module dense_store (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        valid_i,
    output wire        ready_o,
    input  wire [31:0] data_i,
    input  wire        last_i,
    input  wire        set_i,
    output wire        arrived_o,
    output reg  [11:0] descriptor_o,
    input  wire [8:0]  read_row_i,
    output wire [31:0] pair_a_o,
    output reg  [31:0] pair_b_o,
    output wire [31:0] pair_c_o,
    output wire [31:0] pair_d_o,
    input  wire        finished_i
);

    localparam [1:0] PART_IDS_0 = 2'h0;
    localparam [1:0] PART_IDS_1 = 2'h1;
    localparam [6:0] LAST_ROW = 7'hf;
    localparam [11:0] DESCRIPTOR_OF_SET_0 = 12'h1f0;
    localparam [2:0] ALL_SLOTS = 3'h4;

    wire accept;
    reg  [2:0] full_next;
    wire [11:0] write_row;
    wire [11:0] parts_0_read_address;
    wire parts_0_write_enable;
    wire [11:0] parts_1_read_address;
    wire [31:0] parts_1_read_data;
    wire parts_1_write_enable;
    reg  [2:0] full_q;
    reg  [2:0] full_d;
    reg  ready_q_q;
    reg  ready_q_d;
    reg  valid_1_q;
    reg  valid_1_d;
    reg  [31:0] data_1_q;
    reg  last_1_q;
    reg  set_1_q;
    reg  arrived_2_q;
    reg  arrived_2_d;
    reg  set_2_q;
    reg  arrived_3_q;
    reg  arrived_3_d;
    reg  set_3_q;
    reg  [1:0] part_q;
    reg  [1:0] part_d;
    reg  [6:0] row_q;
    reg  [6:0] row_d;
    reg  [1:0] write_slot_q;
    reg  [1:0] write_slot_d;

    edof_ram #(
        .WIDTH(32),
        .DEPTH(512),
        .BLOCK(2),
        .INIT("")
    ) parts_0 (
        .clock_i(clock_i),
        .read_address_i(parts_0_read_address),
        .read_data_o(pair_a_o),
        .write_enable_i(parts_0_write_enable),
        .write_address_i(write_row),
        .write_data_i(data_1_q)
    );

    edof_ram #(
        .WIDTH(32),
        .DEPTH(512),
        .BLOCK(2),
        .INIT("")
    ) parts_1 (
        .clock_i(clock_i),
        .read_address_i(parts_1_read_address),
        .read_data_o(parts_1_read_data),
        .write_enable_i(parts_1_write_enable),
        .write_address_i(write_row),
        .write_data_i(data_1_q)
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
        part_d = part_q;
        row_d = row_q;
        write_slot_d = write_slot_q;
        full_d = full_next;
        ready_q_d = full_next != ALL_SLOTS;
        valid_1_d = accept;
        if (valid_1_q) begin
            row_d = row_q + 7'd1;
            if (row_q == LAST_ROW) begin
                row_d = 7'd0;
                part_d = part_q + 2'd1;
            end
            if (last_1_q) begin
                row_d = 7'd0;
                part_d = 2'd0;
                write_slot_d = write_slot_q + 2'd1;
            end
        end
        arrived_2_d = valid_1_q && last_1_q;
        arrived_3_d = arrived_2_q;
        if (reset_i) begin
            full_d = 3'd0;
            ready_q_d = 1'b0;
            valid_1_d = 1'b0;
            arrived_2_d = 1'b0;
            arrived_3_d = 1'b0;
            part_d = 2'd0;
            row_d = 7'd0;
            write_slot_d = 2'd0;
        end
    end

    assign write_row = ({10'd0, write_slot_q} << 7) | {5'd0, row_q};
    assign parts_0_write_enable = valid_1_q && (part_q == PART_IDS_0);
    assign parts_0_read_address = {3'd0, read_row_i};
    assign parts_1_write_enable = valid_1_q && (part_q == PART_IDS_1);
    assign parts_1_read_address = {3'd0, read_row_i};
    assign arrived_o = arrived_3_q;

    always @* begin
        descriptor_o = DESCRIPTOR_OF_SET_0;
        if (set_3_q) begin
            descriptor_o = DESCRIPTOR_OF_SET_0 | 12'd1;
        end
    end

    always @* begin
        pair_b_o = 32'd0;
        pair_b_o = parts_1_read_data;
    end

    assign pair_c_o = 32'd0;
    assign pair_d_o = 32'd0;

    always @(posedge clock_i) begin
        full_q <= full_d;
        ready_q_q <= ready_q_d;
        valid_1_q <= valid_1_d;
        data_1_q <= data_i;
        last_1_q <= last_i;
        set_1_q <= set_i;
        arrived_2_q <= arrived_2_d;
        set_2_q <= set_1_q;
        arrived_3_q <= arrived_3_d;
        set_3_q <= set_2_q;
        part_q <= part_d;
        row_q <= row_d;
        write_slot_q <= write_slot_d;
    end
endmodule

`default_nettype wire
