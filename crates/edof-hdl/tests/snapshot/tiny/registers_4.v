// What the host sets in a stage: shifts of both sets (result 6 bits, base 6, code 4, linear path 4), and control.
//
// From crates/edof-hdl/src/blocks/registers.rs (Registers).
`default_nettype none

module registers_4 (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        write_enable_i,
    input  wire [11:0] write_row_i,
    input  wire [31:0] write_data_i,
    output wire [19:0] shifts_0_o,
    output wire [19:0] shifts_1_o,
    output wire        skip_zeros_o
);

    localparam [19:0] START_0 = 20'h10002;
    localparam [19:0] START_1 = 20'h10002;
    localparam START_SKIP = 1'h1;

    reg  [19:0] shifts_0_q_q;
    reg  [19:0] shifts_0_q_d;
    reg  [19:0] shifts_1_q_q;
    reg  [19:0] shifts_1_q_d;
    reg  skip_q_q;
    reg  skip_q_d;

    always @* begin
        shifts_0_q_d = shifts_0_q_q;
        shifts_1_q_d = shifts_1_q_q;
        skip_q_d = skip_q_q;
        if (write_enable_i) begin
            if (write_row_i == 12'd0) begin
                shifts_0_q_d = write_data_i[19:0];
            end else if (write_row_i == 12'd1) begin
                shifts_1_q_d = write_data_i[19:0];
            end else if (write_row_i == 12'd2) begin
                skip_q_d = write_data_i[0];
            end
        end
        if (reset_i) begin
            shifts_0_q_d = START_0;
            shifts_1_q_d = START_1;
            skip_q_d = START_SKIP;
        end
    end

    assign shifts_0_o = shifts_0_q_q;
    assign shifts_1_o = shifts_1_q_q;
    assign skip_zeros_o = skip_q_q;

    always @(posedge clock_i) begin
        shifts_0_q_q <= shifts_0_q_d;
        shifts_1_q_q <= shifts_1_q_d;
        skip_q_q <= skip_q_d;
    end
endmodule

`default_nettype wire
