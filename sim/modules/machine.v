// A state machine that walks a memory, writes sums back, and rests at zero data.
module machine (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        go_i,
    input  wire [15:0] data_i,
    output wire        busy_o,
    output wire [15:0] data_o,
    output wire [71:0] trail_o
);
    reg [15:0] memory [0:15];
    reg [3:0] address_q;
    reg [15:0] data_q;
    reg [71:0] trail_q;
    reg busy_q;
    initial $readmemh("images/machine.hex", memory);
    always @(posedge clock_i) begin
        data_q <= memory[address_q];
        if (reset_i) begin
            busy_q <= 1'b0;
            address_q <= 4'd0;
            trail_q <= 72'd0;
        end else if (!busy_q) begin
            busy_q <= go_i;
        end else begin
            memory[address_q] <= memory[address_q] + data_i;
            address_q <= address_q + data_i[3:0];
            trail_q <= {trail_q[55:0], data_q};
            busy_q <= data_i != 16'd0;
        end
    end
    assign busy_o = busy_q;
    assign data_o = data_q ^ {16{go_i}};
    assign trail_o = trail_q;
endmodule
