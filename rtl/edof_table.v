// Block RAM with one read port and one port that writes or reads, one clock. Both outputs are valid two cycles after an address and
// show the word before a write in the cycle of the address: the second register is the one that a block RAM has inside.
//
// INIT names a $readmemh image. Addresses are 16 bits wide whatever the depth, so that one port fits all; the memory uses as many bits as
// it has rows. For the location of images see edof_ram.v.
`ifndef EDOF_DIR
`define EDOF_DIR "./"
`endif
`default_nettype none
module edof_table #(
    parameter WIDTH = 8,
    parameter DEPTH = 1024,
    parameter INIT = ""
) (
    input  wire             clock_i,
    input  wire [15:0]      read_address_i,
    output reg  [WIDTH-1:0] read_data_o,
    input  wire             write_enable_i,
    input  wire [15:0]      address_i,
    input  wire [WIDTH-1:0] write_data_i,
    output reg  [WIDTH-1:0] data_o
);
    localparam BITS = $clog2(DEPTH);
`ifdef EDOF_IMAGES_BY_NAME
    localparam IMAGE = INIT;
`else
    // Yosys 0.70 stops at a concatenation with an empty text.
    localparam IMAGE = {`EDOF_DIR, "mem/", (INIT == "") ? "-" : INIT};
`endif

    (* ram_style = "block" *) reg [WIDTH-1:0] words [0:DEPTH-1];
    initial if (INIT != "") $readmemh(IMAGE, words);

`ifndef SYNTHESIS
    // Icarus would continue with unknown words; Verilator stops by itself.
    integer image;
    initial if (INIT != "") begin
        image = $fopen(IMAGE, "r");
        if (image == 0) $fatal(1, "%m: memory image %0s cannot be read", IMAGE);
        $fclose(image);
    end
`endif

    reg [WIDTH-1:0] read_q;
    always @(posedge clock_i) read_q <= words[read_address_i[BITS-1:0]];
    always @(posedge clock_i) read_data_o <= read_q;

    reg [WIDTH-1:0] data_q;
    always @(posedge clock_i) begin
        if (write_enable_i) words[address_i[BITS-1:0]] <= write_data_i;
        data_q <= words[address_i[BITS-1:0]];
    end
    always @(posedge clock_i) data_o <= data_q;
endmodule
`default_nettype wire
