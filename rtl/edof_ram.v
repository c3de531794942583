// Memory with one write port and one read port, one clock; a read returns the word before a write in the same cycle.
//
// With DEPTH 0 there is no memory, and read_data_o is 0. BLOCK = 1 asks for block RAM, 2 for block RAM and its output register, without which its output is slow, 0 for LUT RAM. read_data_o is
// valid one cycle after its address, with the output register two. INIT names a $readmemh image, ""
// leaves the start-up contents open. Addresses are 12 bits wide whatever the depth, so that one port fits all; the memory uses as
// many bits as it has rows. Images are in mem/ below `EDOF_DIR, which ends in a slash: the working directory, unless it is
// defined. With EDOF_IMAGES_BY_NAME defined the tool finds them by their names, as Vivado does among the files of its project.
`ifndef EDOF_DIR
`define EDOF_DIR "./"
`endif
`default_nettype none
module edof_ram #(
    parameter WIDTH = 32,
    parameter DEPTH = 64,
    parameter BLOCK = 0,
    parameter INIT = ""
) (
    input  wire             clock_i,
    input  wire [11:0]      read_address_i,
    output wire [WIDTH-1:0] read_data_o,
    input  wire             write_enable_i,
    input  wire [11:0]      write_address_i,
    input  wire [WIDTH-1:0] write_data_i
);
    localparam BITS = $clog2(DEPTH);
`ifdef EDOF_IMAGES_BY_NAME
    localparam IMAGE = INIT;
`else
    // Yosys 0.70 stops at a concatenation with an empty text.
    localparam IMAGE = {`EDOF_DIR, "mem/", (INIT == "") ? "-" : INIT};
`endif

`ifndef SYNTHESIS
    // Icarus would continue with unknown words; Verilator stops by itself.
    integer image;
    initial if (INIT != "") begin
        image = $fopen(IMAGE, "r");
        if (image == 0) $fatal(1, "%m: memory image %0s cannot be read", IMAGE);
        $fclose(image);
    end
`endif

    generate
        if (DEPTH == 0) begin : none
            wire unused = ^{clock_i, read_address_i, write_enable_i, write_address_i, write_data_i};
            assign read_data_o = {WIDTH{1'b0}};
        end else begin : some
            reg [WIDTH-1:0] read_q;
            if (BLOCK != 0) begin : in_block
                (* ram_style = "block" *) reg [WIDTH-1:0] words [0:DEPTH-1];
                initial if (INIT != "") $readmemh(IMAGE, words);
                always @(posedge clock_i) begin
                    if (write_enable_i) words[write_address_i[BITS-1:0]] <= write_data_i;
                    read_q <= words[read_address_i[BITS-1:0]];
                end
            end else begin : in_luts
                (* ram_style = "distributed" *) reg [WIDTH-1:0] words [0:DEPTH-1];
                initial if (INIT != "") $readmemh(IMAGE, words);
                always @(posedge clock_i) begin
                    if (write_enable_i) words[write_address_i[BITS-1:0]] <= write_data_i;
                    read_q <= words[read_address_i[BITS-1:0]];
                end
            end
            if (BLOCK == 2) begin : in_its_register
                reg [WIDTH-1:0] read_q2;
                always @(posedge clock_i) read_q2 <= read_q;
                assign read_data_o = read_q2;
            end else begin : at_once
                assign read_data_o = read_q;
            end
        end
    endgenerate
endmodule
`default_nettype wire
