// Counts enabled cycles; `free_o` is never reset.
module ticks (
    input  wire       clock_i,
    input  wire       reset_i,
    input  wire       enable_i,
    output wire [7:0] count_o,
    output wire       last_o,
    output wire [31:0] free_o
);
    reg [7:0] count_q;
    reg [31:0] free_q;
    always @(posedge clock_i) begin
        free_q <= free_q + 32'd1;
        if (reset_i) count_q <= 8'd0;
        else if (enable_i) count_q <= count_q + 8'd1;
    end
    assign count_o = count_q;
    assign last_o = enable_i & (count_q == 8'hff);
    assign free_o = free_q;
endmodule
