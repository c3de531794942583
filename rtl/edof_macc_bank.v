// Four lanes of the calculator and the weight memory that they share.
//
// DENSE = 1: a row is ROWS words of four weights, and the lanes add word k x value k of all of them. DENSE = 0: a row is one word;
// with ROWS = 2 both ports of the memory read, and the lanes add word a x value 0 and word b x value 1. first_i starts the sums anew
// with this product. A cycle without work has values 0. Counted from address_*_i, value_i and first_i follow two cycles later;
// six cycles later the product is in its sum. copy_i copies the sums to the holding registers two cycles later. shift_i, with the same
// latency, shifts two lanes out of the holding registers to drain_*_o, and two in from drain_*_i. Each multiplier has one holding register,
// so this bank adds nothing. write_i writes half a word. With two ports a write needs a cycle whose values are 0; read_i, which reads a row
// for the host, always does. The words that back_i selects (word a, or each) are valid on back_o one cycle later, in a register of this
// bank; else back_o is 0.
//
// The register behind a memory is the block RAM's own output register to Vivado, which is left free to take it. Yosys has none, and
// would make it a second input register of the multiplier, to which the way from the memory is too long: `EDOF_KEEP_IN_YOSYS stops it,
// and stands before processes, too, whose registers Yosys would merge: Vivado is told so at the registers, and sees nothing at a process.
// Write enables power up as 0, so that no write corrupts the memory image before reset arrives. Control signals have registers in this
// bank; first, copy and shift have one per multiplier. `keep` and similar attributes stop Yosys and Vivado from merging them. For the
// location of images see edof_ram.v.
`ifndef EDOF_DIR
`define EDOF_DIR "./"
`endif
`ifndef EDOF_KEEP_IN_YOSYS
`ifdef YOSYS
`define EDOF_KEEP_IN_YOSYS (* keep *)
`else
`define EDOF_KEEP_IN_YOSYS
`endif
`endif
`default_nettype none
module edof_macc_bank #(
    parameter BANK = 0,
    parameter DEPTH = 384,
    parameter ROWS = 1,
    parameter DENSE = 0,
    parameter SUM = 48,
    parameter INIT = ""
) (
    input  wire                clock_i,
    input  wire                first_i,
    input  wire [$clog2(DEPTH)-1:0] address_a_i,
    input  wire [$clog2(DEPTH)-1:0] address_b_i,
    input  wire [25*ROWS-1:0]  value_i,
    input  wire                copy_i,
    input  wire                shift_i,
    input  wire [ROWS*SUM-1:0] drain_even_i,
    input  wire [ROWS*SUM-1:0] drain_odd_i,
    output wire [ROWS*SUM-1:0] drain_even_o,
    output wire [ROWS*SUM-1:0] drain_odd_o,
    input  wire [((DENSE != 0) ? ROWS : 1)-1:0] back_i,
    output wire [63:0]         back_o,
    input  wire                read_i,
    input  wire                write_i,
    input  wire [5:0]          write_bank_i,
    input  wire                write_half_i,
    input  wire [11:0]         write_address_i,
    input  wire [31:0]         write_data_q_i
);
    localparam BITS = $clog2(DEPTH);
    localparam WORDS = (DENSE != 0) ? ROWS : 1;
    localparam PART_BITS = $clog2(WORDS);
`ifdef EDOF_IMAGES_BY_NAME
    localparam IMAGES = INIT;
`else
    // Yosys 0.70 stops at a concatenation with an empty text.
    localparam IMAGES = {`EDOF_DIR, "mem/", (INIT == "") ? "-" : INIT};
`endif
    localparam [7:0] TENS = 8'd48 + BANK / 10;
    localparam [7:0] ONES = 8'd48 + BANK % 10;

    wire mine = write_i && (write_bank_i == BANK[5:0]);
    wire mine_back = read_i && (write_bank_i == BANK[5:0]);
    wire [BITS-1:0] write_row = write_address_i[PART_BITS +: BITS];

    // Rows and values on their way to the multipliers: word k of DENSE, else word a, and word b.
    wire [64*ROWS-1:0] rows;
    // Bit 0 is stored above the others. Otherwise the bits of a sign are at the register's top, where Yosys makes one of them; the
    // multiplier is narrower then, and its sum is not packed into the DSP.
    (* keep = "true" *) reg [25*ROWS-1:0] rotated_q;
    `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) rotated_q <= {value_i[0], value_i[25*ROWS-1:1]};
    wire [25*ROWS-1:0] value_q = {rotated_q[25*ROWS-2:0], rotated_q[25*ROWS-1]};
    (* keep = "true", shreg_extract = "no" *) reg first_q;
    `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) first_q <= first_i;

    // Two of each, of 32 loads.
    (* keep = "true" *) reg [WORDS-1:0] back_low_q, back_high_q;
    `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) begin
        back_low_q <= back_i;
        back_high_q <= back_i;
    end

    genvar part;
    generate
        if (DENSE == 0 && ROWS == 2) begin : two_ports
            // The write shares port A, so that both ports of the block RAM can read.
            (* ram_style = "block" *) reg [63:0] weights [0:DEPTH-1];
            localparam IMAGE = {IMAGES, TENS, ONES, "_0.mem"};
            initial if (INIT != "") $readmemh(IMAGE, weights);
            (* keep = "true" *) reg [BITS-1:0] address_a_q;
            (* keep = "true" *) reg [BITS-1:0] address_b_q;
            (* keep = "true" *) reg write_low_q = 1'b0, write_high_q = 1'b0;
            `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) begin
                address_a_q <= (mine || mine_back) ? write_row : address_a_i;
                address_b_q <= address_b_i;
                write_low_q <= mine && !write_half_i;
                write_high_q <= mine && write_half_i;
            end
            reg [63:0] read_a_q, read_b_q;
            `EDOF_KEEP_IN_YOSYS reg [63:0] row_a_q, row_b_q;
            always @(posedge clock_i) begin
                if (write_low_q) weights[address_a_q][31:0] <= write_data_q_i;
                if (write_high_q) weights[address_a_q][63:32] <= write_data_q_i;
                read_a_q <= weights[address_a_q];
            end
            always @(posedge clock_i) read_b_q <= weights[address_b_q];
            always @(posedge clock_i) begin
                row_a_q <= read_a_q;
                row_b_q <= read_b_q;
            end
            assign rows = {row_b_q, row_a_q};
        end else begin : one_port
            (* keep = "true" *) reg [BITS-1:0] address_q;
            (* keep = "true" *) reg [BITS-1:0] write_row_q;
            `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) begin
                address_q <= mine_back ? write_row : address_a_i;
                write_row_q <= write_row;
            end
            for (part = 0; part < WORDS; part = part + 1) begin : parts
                localparam [7:0] PART = 8'd48 + part;
                wire this_part = mine && (WORDS == 1 || (write_address_i & (12'd1 << PART_BITS) - 12'd1) == part);
                (* ram_style = "block" *) reg [63:0] weights [0:DEPTH-1];
                localparam IMAGE = {IMAGES, TENS, ONES, "_", PART, ".mem"};
                initial if (INIT != "") $readmemh(IMAGE, weights);
                (* keep = "true" *) reg write_low_q = 1'b0, write_high_q = 1'b0;
                `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) begin
                    write_low_q <= this_part && !write_half_i;
                    write_high_q <= this_part && write_half_i;
                end
                reg [63:0] read_q;
                `EDOF_KEEP_IN_YOSYS reg [63:0] row_q;
                always @(posedge clock_i) begin
                    if (write_low_q) weights[write_row_q][31:0] <= write_data_q_i;
                    if (write_high_q) weights[write_row_q][63:32] <= write_data_q_i;
                    read_q <= weights[address_q];
                end
                always @(posedge clock_i) row_q <= read_q;
                assign rows[64*part +: 64] = row_q;
            end
        end
    endgenerate

    // What is read for the host: a register before anything wide, so that nothing far away hangs on the rows.
    wire [64*4-1:0] back;
    genvar word;
    generate
        for (word = 0; word < 4; word = word + 1) begin : words
            if (word < WORDS) begin : some
                assign back[64*word +: 64] = rows[64*word +: 64] & {{32{back_high_q[word]}}, {32{back_low_q[word]}}};
            end else begin : none
                assign back[64*word +: 64] = 64'd0;
            end
        end
    endgenerate
    reg [63:0] back_q;
    always @(posedge clock_i) back_q <= back[0 +: 64] | back[64 +: 64] | back[128 +: 64] | back[192 +: 64];
    assign back_o = back_q;

    (* keep = "true", shreg_extract = "no" *) reg copy_q, shift_q;
    `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) begin
        copy_q <= copy_i;
        shift_q <= shift_i;
    end

    // Lane 0 and 1 stand first; what they take comes from lanes 2 and 3, and these take from the next bank.
    wire [ROWS*SUM-1:0] held [0:3];
    wire [ROWS*SUM-1:0] next [0:3];
    assign next[0] = held[2];
    assign next[1] = held[3];
    assign next[2] = drain_even_i;
    assign next[3] = drain_odd_i;
    assign drain_even_o = held[0];
    assign drain_odd_o = held[1];

    genvar lane;
    genvar row;
    generate
        for (lane = 0; lane < 4; lane = lane + 1) begin : lanes
            for (row = 0; row < ROWS; row = row + 1) begin : macc
                wire [47:0] sum;
                (* keep = "true", shreg_extract = "no" *) reg starts_q;
                `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) starts_q <= first_q;
                edof_macc multiplier (
                    .clock_i(clock_i),
                    .first_i(starts_q),
                    .weight_i(rows[64*row + 16*lane +: 16]),
                    .value_i(value_q[25*row +: 25]),
                    .sum_o(sum)
                );
                (* keep = "true", shreg_extract = "no" *) reg take_sum_q, move_q;
                `EDOF_KEEP_IN_YOSYS always @(posedge clock_i) begin
                    take_sum_q <= copy_q;
                    move_q <= copy_q || shift_q;
                end
                reg [SUM-1:0] hold_q;
                always @(posedge clock_i) if (move_q) hold_q <= take_sum_q ? sum[SUM-1:0] : next[lane][SUM*row +: SUM];
                assign held[lane][SUM*row +: SUM] = hold_q;
            end
        end
    endgenerate
endmodule
`default_nettype wire
