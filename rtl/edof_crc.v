// CRC of 32 bits of a frame of beats (docs/contract.md, 9), the lowest bit of a beat first. A beat is the low WIDTH bits of data_i; valid_i and
// first_i say a cycle later that it counts, and that it is its frame's first. crc_o is that of all beats from the first one on, valid a cycle
// after valid_i. The CRC is linear: what a beat adds is made in the cycle before, and each bit is the parity of some bits of the old value.
`default_nettype none
module edof_crc #(
    parameter WIDTH = 32
) (
    input  wire        clock_i,
    input  wire [31:0] data_i,
    input  wire        valid_i,
    input  wire        first_i,
    output wire [31:0] crc_o
);
    reg [31:0] added_q;
    reg [31:0] crc_q;

    // The value after as many zeros as a beat has bits.
    function [31:0] after;
        input [31:0] value;
        integer i;
        begin
            after = value;
            for (i = 0; i < WIDTH; i = i + 1) after = {1'b0, after[31:1]} ^ (after[0] ? 32'he0000200 : 32'd0);
        end
    endfunction

    // Bits of the old value that a bit of the new one is the parity of.
    function [31:0] parity_of;
        input integer place;
        integer i;
        begin
            for (i = 0; i < 32; i = i + 1) parity_of[i] = |(after(32'd1 << i) & (32'd1 << place));
        end
    endfunction

    localparam [31:0] START = after(32'hffffffff);
    localparam [31:0] BEAT = 32'hffffffff >> (32 - WIDTH);
    wire [31:0] next;
    wire [31:0] added;
    genvar place;
    generate
        for (place = 0; place < 32; place = place + 1) begin : places
            localparam [31:0] PARITY_OF = parity_of(place);
            assign next[place] = ^(crc_q & PARITY_OF);
            assign added[place] = ^(data_i & BEAT & PARITY_OF);
        end
    endgenerate

    always @(posedge clock_i) begin
        added_q <= added;
        if (valid_i) crc_q <= (first_i ? START : next) ^ added_q;
    end

    assign crc_o = ~crc_q;
endmodule
`default_nettype wire
