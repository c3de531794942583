// Reads rows of a memory of the stage one after the other, each in 256 cycles, and makes a CRC-32 (of IEEE
// 802.3) of them: a row is 64 bits, the lowest first. The last row stays to be looked at. A row of weights is
// asked for until it is `taken`, which costs the multipliers a step; thresholds until there is a pause in which
// they are not used; a register is there at once. A command ends the one before, and begins 64 cycles later,
// when nothing of that is on its way any more.
//
// Within the cycle: select_i -> value_o
// From crates/edof-hdl/src/blocks/reader.rs (Reader).
`default_nettype none
module reader (
  input wire clock_i, input wire reset_i, // Stops and forgets.
  input wire starts_i,                    // A command comes (`edof_device::design::reading::read_command`).
  // The command: space (2 bits), bank (6), first row (12), rows after it (12).
  input wire [31:0] command_i,
  output wire request_weights_o,          // A row of weights is requested.
  input wire grant_i,                     // The requested row of weights will be read.
  output wire [5:0] bank_o,               // Bank of the requested row.
  output wire [11:0] row_o,               // Row of weights or thresholds, or register.
  input wire [63:0] weights_i,            // The requested row of weights; 0 in other cycles.
  output wire request_thresholds_o,       // Two thresholds are requested.
  input wire thresholds_valid_i,          // The two thresholds are valid.
  input wire [31:0] thresholds_i,         // The two thresholds.
  input wire [31:0] previous_i,           // Thresholds of the stage before.
  input wire [31:0] register_i,           // The register of that row.
  // What to show: 0 CRC-32 of all rows, 1 and 2 the halves of the row that was read last, 3 whether it still
  // reads.
  input wire [1:0] select_i,
  output wire [31:0] value_o              // Word that `select` selects.
);

  localparam [31:0] POLYNOMIAL = 32'hedb88320, ONES = 32'hffffffff;
  localparam [63:0] TOP = 64'h8000000000000000;

  reg is_active_q, fresh_q, request_q, at_end_q, clear_word_q, clear_crc_q;
  reg [1:0] space_q;
  reg [5:0] bank_q;
  reg [11:0] row_q, remaining_q;
  reg [7:0] cycle_q;
  reg [31:0] read_word_q, crc_q;
  reg [63:0] word_q;

  // A row is asked for in cycle 0, as long as it takes; it is here before the 192nd, and goes through the CRC
  // in the last 64.
  wire advance = request_q && (grant_i || (thresholds_valid_i && (|space_q)) || (space_q == 2'd3));
  wire restart = at_end_q && (fresh_q || (|remaining_q));
  wire [63:0] rotated = word_q[0] ? ((word_q >> 1) | TOP) : (word_q >> 1);
  assign request_weights_o = request_q && (space_q == 2'd0);
  assign request_thresholds_o = request_q && ((space_q == 2'd1) || (space_q == 2'd2));
  assign bank_o = bank_q, row_o = row_q;

  reg [31:0] status_word;
  always @* begin
    case (select_i)
      2'd1: status_word = word_q[31:0];
      2'd2: status_word = word_q[63:32];
      2'd3: status_word = {31'd0, is_active_q};
      default: status_word = ~crc_q;
    endcase
  end

  assign value_o = status_word;
  wire [1:0] shifts_data = (is_active_q && (cycle_q[7:6] == 2'd3)) ? 2'd3 : 2'd0;

  wire [1:0] delayed;
  edof_delay #(.WIDTH(2), .CYCLES(1)) shifts (.clock_i(clock_i), .data_i(shifts_data), .data_o(delayed));

  always @(posedge clock_i) begin
    if (is_active_q && (!request_q || advance)) cycle_q <= cycle_q + 8'd1;
    at_end_q <= is_active_q && (cycle_q == 8'd254);
    if (advance) request_q <= 1'b0;
    if (restart) request_q <= 1'b1;
    if (at_end_q && !fresh_q) begin
      row_q <= row_q + 12'd1;
      remaining_q <= remaining_q - 12'd1;
    end
    if (at_end_q) begin
      fresh_q <= 1'b0;
      is_active_q <= restart;
    end
    if (starts_i) begin
      is_active_q <= 1'b1;
      fresh_q <= 1'b1;
      {request_q, at_end_q} <= 0;
      cycle_q <= 8'd192;
      space_q <= command_i[31:30];
      bank_q <= command_i[29:24];
      row_q <= command_i[23:12];
      remaining_q <= command_i[11:0];
    end
    clear_word_q <= restart || reset_i;
    clear_crc_q <= (at_end_q && fresh_q) || reset_i;
    // What comes is gathered by or; 64 turns later the row is as it was.
    read_word_q <= 32'd0;
    if (advance && (space_q == 2'd1)) read_word_q <= thresholds_i;
    else if (advance && (space_q == 2'd2)) read_word_q <= previous_i;
    else if (advance && (space_q == 2'd3)) read_word_q <= register_i;
    word_q <= delayed[0] ? rotated : (word_q | weights_i | {32'd0, read_word_q});
    if (clear_word_q) word_q <= 64'd0;
    if (delayed[1]) crc_q <= (crc_q[0] != word_q[0]) ? ((crc_q >> 1) ^ POLYNOMIAL) : (crc_q >> 1);
    if (clear_crc_q) crc_q <= ONES;
    if (reset_i) {is_active_q, request_q, cycle_q, at_end_q} <= 0;
  end
endmodule
`default_nettype wire
