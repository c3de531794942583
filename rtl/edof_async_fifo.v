// A FIFO from one clock domain to another: Gray-coded pointers, LUT RAM, 2^LOG_DEPTH words and one in the output register.
//
// A word can be read three to four read cycles after it was written; room is seen by the writer two to three write cycles after
// a word was read. A reset of either side empties both, in any order and with either clock standing still (edof_clear); a word that is
// offered at the output stays until it is taken or the reader is reset.
`default_nettype none
module edof_async_fifo #(
    parameter WIDTH = 18,
    parameter LOG_DEPTH = 4
) (
    input  wire             write_clock_i,
    input  wire             write_reset_i,
    input  wire             write_valid_i,
    output wire             write_ready_o,
    input  wire [WIDTH-1:0] write_data_i,
    input  wire             read_clock_i,
    input  wire             read_reset_i,
    output wire             read_valid_o,
    input  wire             read_ready_i,
    output wire [WIDTH-1:0] read_data_o
);
    localparam [LOG_DEPTH:0] ONE = 1;
    localparam [LOG_DEPTH:0] TOP_TWO = 3 << (LOG_DEPTH - 1);

    (* ram_style = "distributed" *) reg [WIDTH-1:0] words [0:(1<<LOG_DEPTH)-1];

    // Writer.
    // The top bit of a pointer is that of its Gray code: one register, so that no tool merges two and drops the name that is limited.
    reg [LOG_DEPTH-1:0] write_low_q;
    reg [LOG_DEPTH:0] write_gray_q;
    wire [LOG_DEPTH:0] write = {write_gray_q[LOG_DEPTH], write_low_q};
    wire [LOG_DEPTH:0] read_gray_seen;
    wire [LOG_DEPTH:0] write_next = write + ONE;
    wire push = write_valid_i && write_ready_o && !write_reset_i;
    wire write_open;
    wire write_clear;
    assign write_ready_o = write_open && write_gray_q != (read_gray_seen ^ TOP_TWO);

    always @(posedge write_clock_i) begin
        if (write_clear) begin
            write_low_q <= 0;
            write_gray_q <= 0;
        end else if (push) begin
            write_low_q <= write_next[LOG_DEPTH-1:0];
            write_gray_q <= write_next ^ (write_next >> 1);
        end
        if (push) words[write_low_q] <= write_data_i;
    end

    // Reader.
    reg [LOG_DEPTH-1:0] read_low_q;
    reg [LOG_DEPTH:0] read_gray_q;
    wire [LOG_DEPTH:0] read = {read_gray_q[LOG_DEPTH], read_low_q};
    reg full_q;
    reg [WIDTH-1:0] word_q;
    wire [LOG_DEPTH:0] write_gray_seen;
    wire [LOG_DEPTH:0] read_next = read + ONE;
    wire read_open;
    wire read_clear;
    wire fetch = read_open && (read_gray_q != write_gray_seen) && (!full_q || read_ready_i);

    always @(posedge read_clock_i) begin
        if (read_clear) begin
            read_low_q <= 0;
            read_gray_q <= 0;
        end else if (fetch) begin
            read_low_q <= read_next[LOG_DEPTH-1:0];
            read_gray_q <= read_next ^ (read_next >> 1);
        end
        if (read_reset_i) full_q <= 1'b0;
        else if (fetch) full_q <= 1'b1;
        else if (read_ready_i) full_q <= 1'b0;
        if (fetch) word_q <= words[read_low_q];
    end

    assign read_valid_o = full_q;
    assign read_data_o = word_q;

    edof_sync #(.WIDTH(LOG_DEPTH + 1)) to_reader (
        .clock_i(read_clock_i), .from_i(write_gray_q), .to_o(write_gray_seen)
    );
    edof_sync #(.WIDTH(LOG_DEPTH + 1)) to_writer (
        .clock_i(write_clock_i), .from_i(read_gray_q), .to_o(read_gray_seen)
    );
    edof_clear clear (
        .from_clock_i(write_clock_i), .from_reset_i(write_reset_i), .from_open_o(write_open), .from_clear_o(write_clear),
        .to_clock_i(read_clock_i), .to_reset_i(read_reset_i), .to_open_o(read_open), .to_clear_o(read_clear)
    );
endmodule
`default_nettype wire
