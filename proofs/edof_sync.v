// edof_sync for proofs: a bit that changes near a clock's edge is seen at this edge or at the next, as the prover likes, each bit by itself.
module edof_sync #(
    parameter WIDTH = 1
) (
    input  wire             clock_i,
    input  wire [WIDTH-1:0] from_i,
    output wire [WIDTH-1:0] to_o
);
    (* anyseq *) wire [WIDTH-1:0] late;
`ifdef COVER
    always @* assume (late == 0);
`endif
    reg [WIDTH-1:0] before_q;
    reg [WIDTH-1:0] first_q;
    reg [WIDTH-1:0] second_q;
    always @(posedge clock_i) begin
        before_q <= from_i;
        first_q <= (late & before_q) | (~late & from_i);
        second_q <= first_q;
    end
    assign to_o = second_q;
endmodule
