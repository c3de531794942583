// uart_sender for proofs: takes a byte when it likes.
module uart_sender (
    input  wire       clock_i,
    input  wire       reset_i,
    input  wire       valid_i,
    output wire       ready_o,
    input  wire [7:0] byte_i,
    output wire       line_o
);
    (* anyseq *) wire ready;
    assign ready_o = ready;
    assign line_o = 1'b1;
endmodule
