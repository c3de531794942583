// In place of edof_ram, for the prover: one row that the prover chooses, once for a run. What other rows give is anything, so whatever is
// proven holds for each row, and the state is that of one.
module edof_ram #(
    parameter WIDTH = 32,
    parameter DEPTH = 64,
    parameter BLOCK = 0,
    parameter INIT = ""
) (
    input  wire             clock_i,
    input  wire [11:0]      read_address_i,
    output wire [WIDTH-1:0] read_data_o,
    input  wire             write_enable_i,
    input  wire [11:0]      write_address_i,
    input  wire [WIDTH-1:0] write_data_i
);
    localparam BITS = $clog2(DEPTH);
    (* anyconst *) wire [BITS-1:0] row;
    (* anyseq *) wire [WIDTH-1:0] other;
    reg [WIDTH-1:0] word, read_q, read_q2;
    assign read_data_o = BLOCK == 2 ? read_q2 : read_q;
    always @(posedge clock_i) begin
        if (write_enable_i && write_address_i[BITS-1:0] == row) word <= write_data_i;
        read_q <= read_address_i[BITS-1:0] == row ? word : other;
        read_q2 <= read_q;
    end
endmodule

// The same in place of edof_memory, which has the output register always.
module edof_memory #(
    parameter WIDTH = 16,
    parameter DEPTH = 1024,
    parameter INIT = ""
) (
    input  wire             clock_i,
    input  wire [15:0]      read_address_i,
    output reg  [WIDTH-1:0] read_data_o,
    input  wire             write_enable_i,
    input  wire [15:0]      write_address_i,
    input  wire [WIDTH-1:0] write_data_i
);
    localparam BITS = $clog2(DEPTH);
    (* anyconst *) wire [BITS-1:0] row;
    (* anyseq *) wire [WIDTH-1:0] other;
    reg [WIDTH-1:0] word, read_q;
    always @(posedge clock_i) begin
        if (write_enable_i && write_address_i[BITS-1:0] == row) word <= write_data_i;
        read_q <= read_address_i[BITS-1:0] == row ? word : other;
        read_data_o <= read_q;
    end
endmodule
