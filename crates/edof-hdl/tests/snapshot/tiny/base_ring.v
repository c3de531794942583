// Base words that wait for their sums: a ring of whole vectors, written as they arrive, read as their sums are taken.
// It never overflows: a stage holds at most two vectors in its pair buffer and one in its multipliers and drain.
//
// From crates/edof-hdl/src/blocks/base_ring.rs (BaseRing).
`default_nettype none

module base_ring (
    input  wire        clock_i, // Clock.
    input  wire        reset_i, // Empties it.
    input  wire        write_i, // A beat arrives.
    input  wire [31:0] words_i, // Its two base words.
    input  wire        read_i,  // Moves on to the next two.
    output wire [31:0] front_o  // The two that stood first a cycle ago.
);

    localparam [11:0] LAST_ROW = 12'd31;

    reg  [11:0] write_row_q;
    reg  [11:0] write_row_d;
    reg  [11:0] read_row_q;
    reg  [11:0] read_row_d;

    edof_ram #(
        .WIDTH(32),
        .DEPTH(32),
        .BLOCK(0),
        .INIT("")
    ) ram (
        .clock_i(clock_i),
        .read_address_i(read_row_q),
        .read_data_o(front_o),
        .write_enable_i(write_i),
        .write_address_i(write_row_q),
        .write_data_i(words_i)
    );

    always @* begin
        write_row_d = write_row_q;
        if (write_i) begin
            write_row_d = write_row_q + 12'd1;
            if (write_row_q == LAST_ROW) begin
                write_row_d = 12'd0;
            end
        end
        if (reset_i) begin
            write_row_d = 12'd0;
        end
    end

    always @* begin
        read_row_d = read_row_q;
        if (read_i) begin
            read_row_d = read_row_q + 12'd1;
            if (read_row_q == LAST_ROW) begin
                read_row_d = 12'd0;
            end
        end
        if (reset_i) begin
            read_row_d = 12'd0;
        end
    end

    always @(posedge clock_i) begin
        write_row_q <= write_row_d;
        read_row_q <= read_row_d;
    end
endmodule

`default_nettype wire
