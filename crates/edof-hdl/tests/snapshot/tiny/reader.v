// Reads rows of a memory of the stage one after the other, each in 256 cycles, and makes a CRC-32 (of IEEE 802.3) of them: a row is 64
// bits, the lowest first. The last row stays to be looked at. A row of weights is asked for until it is `taken`, which costs the
// multipliers a step; thresholds until there is a pause in which they are not used; a register is there at once. A command ends the
// one before, and begins 64 cycles later, when nothing of that is on its way any more.
//
// From crates/edof-hdl/src/blocks/reader.rs (Reader).
`default_nettype none

module reader (
    input  wire        clock_i,            // Clock.
    input  wire        reset_i,            // Stops and forgets.
    input  wire        starts_i,           // A command comes (`edof_device::design::reading::read_command`).
    input  wire [31:0] command_i,          // It: space (2 bits), bank (6), first row (12), rows after it (12).
    output wire        wants_weights_o,    // A row of weights is asked for.
    input  wire        taken_i,            // It will be read.
    output wire [5:0]  bank_o,             // Its bank.
    output wire [11:0] row_o,              // Row of weights or thresholds, or register.
    input  wire [63:0] weights_i,          // A row of weights is back; 0 where none is.
    output wire        wants_thresholds_o, // Two thresholds are asked for.
    input  wire        thresholds_valid_i, // They are here.
    input  wire [31:0] thresholds_i,       // They.
    input  wire [31:0] previous_i,         // Those of the stage before.
    input  wire [31:0] register_i,         // The register of that row.
    input  wire [1:0]  select_i,           // What to show: 0 CRC-32 of all rows, 1 and 2 the halves of the row that was read last, 3 whether it still reads.
    output wire [31:0] value_o             // It.
);

    localparam [31:0] POLYNOMIAL = 32'hedb88320;
    localparam [31:0] ONES = 32'hffffffff;
    localparam [63:0] TOP = 64'h8000000000000000;

    wire goes_on, again;
    wire [63:0] turned;
    reg  [31:0] shown;
    reg  on_q, on_d, fresh_q, asks_q, asks_d;
    reg  [1:0] space_q;
    reg  [5:0] bank_q;
    reg  [11:0] row_q, left_q;
    reg  [7:0] cycle_q, cycle_d;
    reg  at_end_q, clears_word_q, clears_crc_q;
    wire [1:0] shifts_now, shifts_later;
    reg  [31:0] came_q, came_d;
    reg  [63:0] word_q, word_d;
    reg  [31:0] crc_q, crc_d;

    edof_delay #(.WIDTH(2), .CYCLES(1)) shifts (
        .clock_i(clock_i), .now_i(shifts_now), .later_o(shifts_later)
    );

    assign goes_on = asks_q && (taken_i || (thresholds_valid_i && (|space_q)) || (space_q == 2'd3));

    always @* begin
        on_d = on_q;
        if (at_end_q) begin
            on_d = again;
        end
        if (starts_i) begin
            on_d = 1'b1;
        end
        if (reset_i) begin
            on_d = 1'b0;
        end
    end

    always @* begin
        asks_d = asks_q;
        if (goes_on) begin
            asks_d = 1'b0;
        end
        if (again) begin
            asks_d = 1'b1;
        end
        if (starts_i) begin
            asks_d = 1'b0;
        end
        if (reset_i) begin
            asks_d = 1'b0;
        end
    end

    always @* begin
        cycle_d = cycle_q;
        if (on_q && (!asks_q || goes_on)) begin
            cycle_d = cycle_q + 8'd1;
        end
        if (starts_i) begin
            cycle_d = 8'hc0;
        end
        if (reset_i) begin
            cycle_d = 8'd0;
        end
    end

    assign shifts_now = (on_q && (cycle_q[7:6] == 2'd3)) ? 2'd3 : 2'd0;
    assign again = at_end_q && (fresh_q || (|left_q));

    always @* begin
        came_d = 32'd0;
        if (goes_on && (space_q == 2'd1)) begin
            came_d = thresholds_i;
        end else if (goes_on && (space_q == 2'd2)) begin
            came_d = previous_i;
        end else if (goes_on && (space_q == 2'd3)) begin
            came_d = register_i;
        end
    end

    assign turned = word_q[0] ? ((word_q >> 1) | TOP) : (word_q >> 1);

    always @* begin
        word_d = word_q | weights_i | {32'd0, came_q};
        if (shifts_later[0]) begin
            word_d = turned;
        end
        if (clears_word_q) begin
            word_d = 64'd0;
        end
    end

    always @* begin
        crc_d = crc_q;
        if (shifts_later[1]) begin
            crc_d = crc_q >> 1;
            if (crc_q[0] != word_q[0]) begin
                crc_d = (crc_q >> 1) ^ POLYNOMIAL;
            end
        end
        if (clears_crc_q) begin
            crc_d = ONES;
        end
    end

    assign wants_weights_o = asks_q && (space_q == 2'd0);
    assign wants_thresholds_o = asks_q && ((space_q == 2'd1) || (space_q == 2'd2));
    assign bank_o = bank_q;
    assign row_o = row_q;

    always @* begin
        shown = ~crc_q;
        if (select_i == 2'd1) begin
            shown = word_q[31:0];
        end else if (select_i == 2'd2) begin
            shown = word_q[63:32];
        end else if (select_i == 2'd3) begin
            shown = 32'd0;
            if (on_q) begin
                shown = 32'd1;
            end
        end
    end

    assign value_o = shown;

    always @(posedge clock_i) begin
        on_q <= on_d;
        fresh_q <= starts_i ? 1'b1 : (at_end_q ? 1'b0 : fresh_q);
        asks_q <= asks_d;
        space_q <= starts_i ? command_i[31:30] : space_q;
        bank_q <= starts_i ? command_i[29:24] : bank_q;
        row_q <= starts_i ? command_i[23:12] : ((at_end_q && !fresh_q) ? (row_q + 12'd1) : row_q);
        left_q <= starts_i ? command_i[11:0] : ((at_end_q && !fresh_q) ? (left_q - 12'd1) : left_q);
        cycle_q <= cycle_d;
        at_end_q <= reset_i ? 1'b0 : (starts_i ? 1'b0 : (on_q && (cycle_q == 8'hfe)));
        clears_word_q <= again || reset_i;
        clears_crc_q <= (at_end_q && fresh_q) || reset_i;
        came_q <= came_d;
        word_q <= word_d;
        crc_q <= crc_d;
    end
endmodule

`default_nettype wire
