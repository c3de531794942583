// Two words that nobody writes, from the $readmemh image INIT: what registers begin with. They are constants to synthesis, and no part of
// the text, so that one text serves every network. Images lie below `EDOF_DIR (edof_ram.v).
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
    localparam IMAGE = {`EDOF_DIR, INIT};

    reg [WIDTH-1:0] words [0:1];
    reg [WIDTH-1:0] first_q;
    reg [WIDTH-1:0] second_q;
    initial $readmemh(IMAGE, words);

`ifndef SYNTHESIS
    // Icarus would go on with unknown words; Verilator stops by itself.
    integer image;
    initial begin
        image = $fopen(IMAGE, "r");
        if (image == 0) $fatal(1, "%m: memory image %0s cannot be read", IMAGE);
        $fclose(image);
    end
`endif

    always @(posedge clock_i) begin
        first_q <= words[0];
        second_q <= words[1];
    end

    assign first_o = first_q;
    assign second_o = second_q;
endmodule

`default_nettype wire
