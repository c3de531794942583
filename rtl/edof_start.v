// Two constant words from the $readmemh image INIT: start values of registers. The values are not part of the Verilog text, so one text
// serves every network. A ROM with one port is read alternately: both words are valid from the fourth cycle after power-up on, before any
// reset ends. For the location of images see edof_ram.v.
`ifndef EDOF_DIR
`define EDOF_DIR "./"
`endif
`default_nettype none
module edof_start #(
    parameter WIDTH = 20,
    parameter INIT = ""
) (
    input  wire             clock_i,
    output wire [WIDTH-1:0] first_o,
    output wire [WIDTH-1:0] second_o
);
`ifdef EDOF_IMAGES_BY_NAME
    localparam IMAGE = INIT;
`else
    // Yosys 0.70 stops at a concatenation with an empty text.
    localparam IMAGE = {`EDOF_DIR, "mem/", (INIT == "") ? "-" : INIT};
`endif

    (* rom_style = "distributed" *) reg [WIDTH-1:0] words [0:1];
    reg turn_q = 1'b0;
    reg turn_later_q = 1'b0;
    reg [WIDTH-1:0] word_q;
    reg [WIDTH-1:0] first_q;
    reg [WIDTH-1:0] second_q;
    initial $readmemh(IMAGE, words);

`ifndef SYNTHESIS
    // Icarus would continue with unknown words; Verilator stops by itself.
    integer image;
    initial begin
        image = $fopen(IMAGE, "r");
        if (image == 0) $fatal(1, "%m: memory image %0s cannot be read", IMAGE);
        $fclose(image);
    end
`endif

    always @(posedge clock_i) begin
        turn_q <= !turn_q;
        turn_later_q <= turn_q;
        word_q <= words[turn_q];
        if (turn_later_q) second_q <= word_q;
        else first_q <= word_q;
    end

    assign first_o = first_q;
    assign second_o = second_q;
endmodule
`default_nettype wire
