// Reads rows of a memory of the stage one after the other, each in 256 cycles, and makes a CRC-32 (of IEEE
// 802.3) of them: a row is 64
// bits, the lowest first. The last row stays to be looked at. A row of weights is asked for until it is
// `taken`, which costs the
// multipliers a step; thresholds until there is a pause in which they are not used; a register is there at
// once. A command ends the
// one before, and begins 64 cycles later, when nothing of that is on its way any more.
//
// Within the cycle: select_i -> value_o
//
// From crates/edof-hdl/src/blocks/reader.rs (Reader).
`default_nettype none

module reader (
  input wire clock_i,             // Clock.
  input wire reset_i,             // Stops and forgets.

  input wire starts_i,            // A command comes (`edof_device::design::reading::read_command`).
  input wire [31:0] command_i,    // It: space (2 bits), bank (6), first row (12), rows after it (12).
  output wire wants_weights_o,    // A row of weights is asked for.
  input wire taken_i,             // It will be read.
  output wire [5:0] bank_o,       // Its bank.
  output wire [11:0] row_o,       // Row of weights or thresholds, or register.
  input wire [63:0] weights_i,    // A row of weights is back; 0 where none is.
  output wire wants_thresholds_o, // Two thresholds are asked for.
  input wire thresholds_valid_i,  // They are here.
  input wire [31:0] thresholds_i, // They.
  input wire [31:0] previous_i,   // Those of the stage before.
  input wire [19:0] register_i,   // The register of that row.
  // What to show: 0 CRC-32 of all rows, 1 and 2 the halves of the row that was read last, 3 whether it still
  // reads.
  input wire [1:0] select_i,
  output wire [31:0] value_o      // It.
);

  localparam [31:0] POLYNOMIAL = 32'hedb88320;
  localparam [31:0] ONES = 32'hffffffff;
  localparam [63:0] TOP = 64'h8000000000000000;

  reg [31:0] shown, came_q, crc_q;
  reg on_q, fresh_q, request_q, at_end_q, clears_word_q, clears_crc_q;
  reg [1:0] space_q;
  reg [5:0] bank_q;
  reg [11:0] row_q, remaining_q;
  reg [7:0] cycle_q;
  wire [1:0] shifts_later;
  reg [63:0] word_q;

  // reader.rs:115: A row is asked for in cycle 0, as long as it takes; it is here before the 192nd, and goes
  // through the CRC in the last 64.
  wire advance = request_q && (taken_i || (thresholds_valid_i && (|space_q)) || (space_q == 2'd3));
  wire [1:0] shifts_now = (on_q && (cycle_q[7:6] == 2'd3)) ? 2'd3 : 2'd0;
  wire again = at_end_q && (fresh_q || (|remaining_q));

  // reader.rs:165: What comes is gathered by or; 64 turns later the row is as it was.
  wire [63:0] turned = word_q[0] ? ((word_q >> 1) | TOP) : (word_q >> 1);
  assign wants_weights_o = request_q && (space_q == 2'd0);
  assign wants_thresholds_o = request_q && ((space_q == 2'd1) || (space_q == 2'd2));
  assign bank_o = bank_q;
  assign row_o = row_q;

  // reader.rs:192
  always @* begin
    case (select_i)
      2'd1: shown = word_q[31:0];
      2'd2: shown = word_q[63:32];
      2'd3: begin
        shown = 32'd0;
        if (on_q) shown = 32'd1;
      end
      default: shown = ~crc_q;
    endcase
  end

  // reader.rs:202
  assign value_o = shown;

  edof_delay #(.WIDTH(2), .CYCLES(1)) shifts (.clock_i(clock_i), .now_i(shifts_now), .later_o(shifts_later));

  always @(posedge clock_i) begin
    // reader.rs:119: A row is asked for in cycle 0, as long as it takes; it is here before the 192nd, and goes
    // through the CRC in the last 64.
    if (on_q && (!request_q || advance)) cycle_q <= cycle_q + 8'd1;
    at_end_q <= on_q && (cycle_q == 8'd254);
    if (advance) request_q <= 1'b0;
    if (again) request_q <= 1'b1;
    if (at_end_q && !fresh_q) begin
      row_q <= row_q + 12'd1;
      remaining_q <= remaining_q - 12'd1;
    end
    if (at_end_q) begin
      fresh_q <= 1'b0;
      on_q <= again;
    end
    if (starts_i) begin
      on_q <= 1'b1;
      fresh_q <= 1'b1;
      request_q <= 1'b0;
      at_end_q <= 1'b0;
      cycle_q <= 8'd192;
      space_q <= command_i[31:30];
      bank_q <= command_i[29:24];
      row_q <= command_i[23:12];
      remaining_q <= command_i[11:0];
    end
    clears_word_q <= again || reset_i;
    clears_crc_q <= (at_end_q && fresh_q) || reset_i;
    // reader.rs:157: What comes is gathered by or; 64 turns later the row is as it was.
    came_q <= 32'd0;
    if (advance && (space_q == 2'd1)) came_q <= thresholds_i;
    else if (advance && (space_q == 2'd2)) came_q <= previous_i;
    else if (advance && (space_q == 2'd3)) came_q <= {12'd0, register_i};
    word_q <= word_q | weights_i | {32'd0, came_q};
    if (shifts_later[0]) word_q <= turned;
    if (clears_word_q) word_q <= 64'd0;
    if (shifts_later[1]) begin
      crc_q <= crc_q >> 1;
      if (crc_q[0] != word_q[0]) crc_q <= (crc_q >> 1) ^ POLYNOMIAL;
    end
    if (clears_crc_q) crc_q <= ONES;
    if (reset_i) begin
      on_q <= 1'b0;
      request_q <= 1'b0;
      at_end_q <= 1'b0;
      cycle_q <= 8'd0;
    end
  end
endmodule

`default_nettype wire
