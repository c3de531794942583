// TmdsEncoder: what the decoder of DVI 1.0 (section 3) makes of each symbol is what came four cycles before; ones exceed zeros by at most 8 since the
// last symbol of control, and by what is counted.
module prove (
    input wire       clock_i,
    input wire       de_i,
    input wire [7:0] byte_i,
    input wire [1:0] control_i
);
    wire [9:0] symbol_o;
    wire signed [3:0] disparity_o;
    tmds_encoder dut (
        .clock_i(clock_i), .de_i(de_i), .byte_i(byte_i), .control_i(control_i), .symbol_o(symbol_o), .disparity_o(disparity_o)
    );

    // What came, and how many cycles there were.
    reg [10:0] came_1, came_2, came_3, came_4;
    reg [2:0] steps = 0;
    always @(posedge clock_i) begin
        came_1 <= {de_i, control_i, byte_i};
        came_2 <= came_1;
        came_3 <= came_2;
        came_4 <= came_3;
        if (steps != 5) steps <= steps + 1;
    end
    wire de = came_4[10];
    wire [1:0] control = came_4[9:8];

    wire [7:0] bits = symbol_o[9] ? ~symbol_o[7:0] : symbol_o[7:0];
    wire [7:0] decoded = bits ^ {bits[6:0], 1'b0} ^ (symbol_o[8] ? 8'h00 : 8'hfe);
    wire is_control = symbol_o == 10'h354 || symbol_o == 10'h0ab || symbol_o == 10'h154 || symbol_o == 10'h2ab;
    wire [3:0] ones = symbol_o[0] + symbol_o[1] + symbol_o[2] + symbol_o[3] + symbol_o[4]
        + symbol_o[5] + symbol_o[6] + symbol_o[7] + symbol_o[8] + symbol_o[9];
    wire signed [4:0] excess = $signed({1'b0, ones}) - 5'sd5;

    always @(posedge clock_i) begin
        // The disparity of the start is any, and a control makes it 0.
        if (steps == 0) assume (!de_i);
        if (steps >= 4) begin
            is_pixel: assert (is_control == !de);
            byte_back: assert (!de || decoded == came_4[7:0]);
            control_back: assert (de || symbol_o == (control == 0 ? 10'h354 : control == 1 ? 10'h0ab : control == 2 ? 10'h154 : 10'h2ab));
            bounded: assert (disparity_o >= -4 && disparity_o <= 4);
        end
        if (steps == 5) counted: assert (disparity_o == (de ? $past(disparity_o) + excess : 0));
        most: cover (steps == 5 && disparity_o == 4);
        least: cover (steps == 5 && disparity_o == -4);
    end
endmodule
