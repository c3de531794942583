// Dense vectors that wait for their multipliers: four slots, in as many memories as the stage takes values at
// once. Each holds a part of every vector, two elements a row, slot s from row 128 s on. Ready while fewer than
// four slots are full. Row read_row of all parts is read two cycles later. A vector's descriptor comes three
// cycles after its last beat.
// From crates/edof-hdl/src/blocks/dense_store.rs (DenseStore).
`default_nettype none
module dense_store #(
  parameter DENSE = 1 // 1 in the stage that is dense (I); in others the memories are absent.
) (
  input wire clock_i, input wire reset_i, // Empties all slots.
  input wire valid_i,                     // The input beat is valid.
  output wire ready_o,                    // The block accepts a valid input in this cycle.
  input wire [31:0] data_i,               // Two elements of the beat, the even one low.
  input wire last_i,                      // Whether the beat is its vector's last.
  input wire set_i,                       // The vector's set.
  output wire arrived_o,                  // A vector is whole.
  output wire [11:0] descriptor_o,        // What the sequencer must know of it.
  input wire [8:0] read_row_i,            // Which two elements of each part to read.
  output wire [31:0] pair_a_o,            // Two elements of the first part, two cycles after their address.
  output wire [31:0] pair_b_o,            // Of the second.
  output wire [31:0] pair_c_o,            // Of the third.
  output wire [31:0] pair_d_o,            // Of the fourth.
  input wire finished_i                   // Frees the slot that is read.
);

  localparam [1:0] PART_IDS_0 = 2'd0, PART_IDS_1 = 2'd1;
  localparam [6:0] LAST_ROW = 7'd15;
  localparam [11:0] DESCRIPTOR_OF_SET_0 = 12'h1f0;
  localparam [2:0] ALL_SLOTS = 3'd4;

  reg [2:0] full_q;
  reg ready_q, valid_1_q, last_1_q, set_1_q, arrived_2_q, set_2_q, arrived_3_q, set_3_q;
  reg [31:0] data_1_q;
  reg [1:0] part_q, write_slot_q;
  reg [6:0] row_q;

  // Room for a vector.
  assign ready_o = ready_q;
  wire accept = valid_i && ready_q;

  reg [2:0] full_next;
  always @* begin
    full_next = full_q;
    if (accept && last_i && !finished_i) full_next = full_q + 3'd1;
    else if (finished_i && (!(accept && last_i))) full_next = full_q - 3'd1;
  end

  wire [11:0] write_row = {3'd0, write_slot_q, row_q};
  assign arrived_o = arrived_3_q;
  assign descriptor_o = set_3_q ? (DESCRIPTOR_OF_SET_0 | 12'd1) : DESCRIPTOR_OF_SET_0;
  assign pair_c_o = 32'd0, pair_d_o = 32'd0;
  wire [11:0] parts_0_read_address = {3'd0, read_row_i};
  wire parts_0_write_enable = valid_1_q && (part_q == PART_IDS_0);

  edof_ram #(.WIDTH(32), .DEPTH(DENSE ? 512 : 0), .BLOCK(2), .INIT("")) parts_0 (
    .clock_i(clock_i), .read_address_i(parts_0_read_address), .read_data_o(pair_a_o),
    .write_enable_i(parts_0_write_enable), .write_address_i(write_row), .write_data_i(data_1_q)
  );

  wire [11:0] parts_1_read_address = {3'd0, read_row_i};
  wire parts_1_write_enable = valid_1_q && (part_q == PART_IDS_1);
  edof_ram #(.WIDTH(32), .DEPTH(DENSE ? 512 : 0), .BLOCK(2), .INIT("")) parts_1 (
    .clock_i(clock_i), .read_address_i(parts_1_read_address), .read_data_o(pair_b_o),
    .write_enable_i(parts_1_write_enable), .write_address_i(write_row), .write_data_i(data_1_q)
  );

  always @(posedge clock_i) begin
    full_q <= full_next;
    ready_q <= full_next != ALL_SLOTS;
    // Where a beat goes: one part after the other.
    valid_1_q <= accept;
    data_1_q <= data_i;
    last_1_q <= last_i;
    set_1_q <= set_i;
    if (valid_1_q) begin
      row_q <= row_q + 7'd1;
      if (row_q == LAST_ROW) begin
        row_q <= 7'd0;
        part_q <= part_q + 2'd1;
      end
      if (last_1_q) begin
        {row_q, part_q} <= 0;
        write_slot_q <= write_slot_q + 2'd1;
      end
    end
    arrived_2_q <= valid_1_q && last_1_q;
    set_2_q <= set_1_q;
    arrived_3_q <= arrived_2_q;
    set_3_q <= set_2_q;
    if (reset_i) {full_q, ready_q, valid_1_q, arrived_2_q, arrived_3_q, part_q, row_q, write_slot_q} <= 0;
  end
endmodule
`default_nettype wire
