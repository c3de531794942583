// Words of ten bits per lane into a clock five times as fast, which has the same source: two bits per lane and cycle, the lowest first.
//
// The phase of the clocks may be any and may wander: a word is taken two to three cycles after it came, when it has stood for one at least and
// will stand for one more. Cycles are counted in fives. Where the count is more than one off what a change says (edof_sync: a change is
// seen a cycle late at random), as at the start, it waits for a cycle or leaves one out, so that three neighbouring moments of a change end in the middle; one word is cut.
`default_nettype none
module edof_serialiser #(
    parameter LANES = 1
) (
    input  wire                word_clock_i,
    input  wire [10*LANES-1:0] word_i,
    input  wire                bit_clock_i,
    output wire [LANES-1:0]    first_o,
    output wire [LANES-1:0]    second_o
);
    reg toggle_q = 1'b0;
    reg [10*LANES-1:0] word_q;
    always @(posedge word_clock_i) begin
        toggle_q <= !toggle_q;
        word_q <= word_i;
    end

    wire toggle_seen;
    edof_sync #(.WIDTH(1)) to_bits (.clock_i(bit_clock_i), .from_i(toggle_q), .to_o(toggle_seen));
    reg toggle_before_q;
    reg [2:0] count_q = 3'd0;
    wire is_off = toggle_seen != toggle_before_q && (count_q == 3'd2 || count_q == 3'd3);
    // The count is 0.
    reg is_first_q = 1'b1;
    reg [10*LANES-1:0] bits_q;
    integer lane;
    always @(posedge bit_clock_i) begin
        toggle_before_q <= toggle_seen;
        if (is_off) count_q <= count_q == 3'd2 ? 3'd2 : 3'd0;
        else count_q <= count_q >= 3'd4 ? 3'd0 : count_q + 3'd1;
        is_first_q <= is_off ? count_q == 3'd3 : count_q >= 3'd4;
        for (lane = 0; lane < LANES; lane = lane + 1)
            bits_q[10*lane +: 10] <= is_first_q ? word_q[10*lane +: 10] : {2'b00, bits_q[10*lane+2 +: 8]};
    end

    genvar i;
    generate
        for (i = 0; i < LANES; i = i + 1) begin : lanes
            assign first_o[i] = bits_q[10*i];
            assign second_o[i] = bits_q[10*i+1];
        end
    endgenerate
endmodule
`default_nettype wire
