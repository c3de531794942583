// A FIFO from one clock domain to another: Gray-coded pointers, LUT RAM, 2^LOG_DEPTH words and one in the output register.
//
// A word can be read three to four read cycles after it was written; room is seen by the writer two to three write cycles after
// a word was read. Both resets come from the same request and overlap; what was inside is lost.
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
    reg [LOG_DEPTH:0] write_q;
    reg [LOG_DEPTH:0] write_gray_q;
    wire [LOG_DEPTH:0] read_gray_seen;
    wire [LOG_DEPTH:0] write_next = write_q + ONE;
    wire push = write_valid_i && write_ready_o;
    assign write_ready_o = write_gray_q != (read_gray_seen ^ TOP_TWO);

    always @(posedge write_clock_i) begin
        if (write_reset_i) begin
            write_q <= 0;
            write_gray_q <= 0;
        end else if (push) begin
            write_q <= write_next;
            write_gray_q <= write_next ^ (write_next >> 1);
        end
        if (push) words[write_q[LOG_DEPTH-1:0]] <= write_data_i;
    end

    // Reader.
    reg [LOG_DEPTH:0] read_q;
    reg [LOG_DEPTH:0] read_gray_q;
    reg full_q;
    reg [WIDTH-1:0] word_q;
    wire [LOG_DEPTH:0] write_gray_seen;
    wire [LOG_DEPTH:0] read_next = read_q + ONE;
    wire fetch = (read_gray_q != write_gray_seen) && (!full_q || read_ready_i);

    always @(posedge read_clock_i) begin
        if (read_reset_i) begin
            read_q <= 0;
            read_gray_q <= 0;
            full_q <= 1'b0;
        end else if (fetch) begin
            read_q <= read_next;
            read_gray_q <= read_next ^ (read_next >> 1);
            full_q <= 1'b1;
        end else if (read_ready_i) begin
            full_q <= 1'b0;
        end
        if (fetch) word_q <= words[read_q[LOG_DEPTH-1:0]];
    end

    assign read_valid_o = full_q;
    assign read_data_o = word_q;

    edof_sync #(.WIDTH(LOG_DEPTH + 1)) to_reader (
        .clock_i(read_clock_i), .from_i(write_gray_q), .to_o(write_gray_seen)
    );
    edof_sync #(.WIDTH(LOG_DEPTH + 1)) to_writer (
        .clock_i(write_clock_i), .from_i(read_gray_q), .to_o(read_gray_seen)
    );
endmodule

`default_nettype wire
