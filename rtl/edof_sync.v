// Brings bits into the clock domain of clock_i, each by itself, through two flip-flops.
//
// A change arrives in the second or third cycle; bits that change together may arrive one cycle apart. So the bits are
// independent levels or a Gray code; each comes straight from a register. There is no reset: to_o follows the level of from_i.
// With EDOF_METASTABLE (simulation) a bit that changes is seen in this cycle or in the next, at random. Where from_i changed more than once
// in a cycle, the last change alone is in doubt: bits of a Gray code arrive less than a cycle of their own clock apart (set_bus_skew).
`default_nettype none
module edof_sync #(
    parameter WIDTH = 1
) (
    input  wire             clock_i,
    input  wire [WIDTH-1:0] from_i,
    output wire [WIDTH-1:0] to_o
);
    (* ASYNC_REG = "TRUE" *) reg [WIDTH-1:0] first_q;
    (* ASYNC_REG = "TRUE" *) reg [WIDTH-1:0] second_q;

`ifdef EDOF_METASTABLE
    reg [WIDTH-1:0] before_q;
    reg [WIDTH-1:0] newest;
    reg [WIDTH-1:0] older;
    integer bit_at;
    initial newest = from_i;
    always @(from_i) begin
        older <= newest;
        newest <= from_i;
    end
    wire [WIDTH-1:0] old = newest != from_i ? newest : older;
    always @(posedge clock_i) begin
        before_q <= from_i;
        for (bit_at = 0; bit_at < WIDTH; bit_at = bit_at + 1)
            first_q[bit_at] <= (from_i != before_q && ($random & 1) != 0) ? old[bit_at] : from_i[bit_at];
    end
`else
    always @(posedge clock_i) first_q <= from_i;
`endif
    always @(posedge clock_i) second_q <= first_q;

    assign to_o = second_q;
endmodule
`default_nettype wire
