// uart_receiver for proofs: any byte at any moment.
module uart_receiver (
    input  wire       clock_i,
    input  wire       reset_i,
    input  wire       line_i,
    output wire       valid_o,
    output wire [7:0] byte_o
);
    (* anyseq *) wire valid;
    (* anyseq *) wire [7:0] value;
    assign valid_o = valid;
    assign byte_o = value;
endmodule
