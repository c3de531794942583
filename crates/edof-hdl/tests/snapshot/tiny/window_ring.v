// Windows that wait for F's linear path: a ring of whole windows in block RAM, each from a power of two of rows
// on. Ready while there is room for one more. Two pixels are read two cycles after read_pair, from the oldest
// window.
// From crates/edof-hdl/src/blocks/window_ring.rs (WindowRing).
`default_nettype none
module window_ring #(
  parameter WINDOW_PIXELS = 0, // Pixels of a window.
  parameter WINDOWS = 0        // Windows that are kept.
) (
  input wire clock_i, input wire reset_i, // Empties the memory.
  input wire valid_i,                     // The input beat is valid.
  output wire ready_o,                    // The block accepts a valid input in this cycle.
  input wire [31:0] pixels_i,             // Two pixels of the beat, the left one low.
  input wire last_i,                      // The beat is the last of its window.
  input wire [6:0] read_pair_i,           // Which two pixels of the oldest window to read.
  output wire [31:0] read_pixels_o,       // Two pixels, two cycles after their address.
  input wire finished_i                   // Frees the oldest window.
);

  // Its pixels are more than those of a window of side 8: one of side 12 has 144, and takes four times as many
  // rows.
  localparam LARGE = WINDOW_PIXELS > 64;
  localparam [31:0] LAST_WINDOW = WINDOWS > 0 ? WINDOWS - 1 : 0, MAX_WINDOWS = WINDOWS, COUNT_BITS = WINDOWS > 0
      ? 2 * WINDOWS - 1 : 0;

  reg write_q, last_q, ready_q;
  reg [31:0] pixels_q;
  reg [6:0] write_beat_q, came_q, with_next_q, freed_q;
  reg [5:0] write_window_q;

  assign ready_o = ready_q;
  wire accept = valid_i && ready_q;
  wire arrived = accept && last_i;
  wire is_full = ((came_q ^ freed_q) & COUNT_BITS[6:0]) == MAX_WINDOWS[6:0];
  wire would_be_full = ((with_next_q ^ freed_q) & COUNT_BITS[6:0]) == MAX_WINDOWS[6:0];
  wire [5:0] oldest = freed_q[5:0] & LAST_WINDOW[5:0];

  reg [11:0] ram_read_address, ram_write_address;
  always @* begin
    ram_write_address = {1'b0, write_window_q, 5'd0} | {5'd0, write_beat_q};
    ram_read_address = {1'b0, oldest, 5'd0} | {5'd0, read_pair_i};
    if (LARGE) begin
      ram_write_address = ({6'd0, write_window_q} << 7) | {5'd0, write_beat_q};
      ram_read_address = ({6'd0, oldest} << 7) | {5'd0, read_pair_i};
    end
  end

  edof_ram #(.WIDTH(32), .DEPTH(WINDOWS * (LARGE ? 128 : 32)), .BLOCK(2), .INIT("")) ram (
    .clock_i(clock_i), .read_address_i(ram_read_address), .read_data_o(read_pixels_o),
    .write_enable_i(write_q), .write_address_i(ram_write_address), .write_data_i(pixels_q)
  );

  always @(posedge clock_i) begin
    ready_q <= (finished_i && !arrived) || ((arrived && !finished_i) ? !would_be_full : !is_full);
    if (arrived) begin
      came_q <= with_next_q;
      with_next_q <= with_next_q + 7'd1;
    end
    if (finished_i) freed_q <= freed_q + 7'd1;
    write_q <= accept;
    pixels_q <= pixels_i;
    last_q <= last_i;
    if (write_q) begin
      write_beat_q <= write_beat_q + 7'd1;
      if (last_q) begin
        write_beat_q <= 7'd0;
        write_window_q <= (write_window_q + 6'd1) & LAST_WINDOW[5:0];
      end
    end
    if (reset_i) begin
      {write_q, write_beat_q, write_window_q, came_q, freed_q, ready_q} <= 0;
      with_next_q <= 7'd1;
    end
  end
endmodule
`default_nettype wire
