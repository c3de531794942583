// Windows that wait for F's linear path: a ring of whole windows in block RAM.
// Ready while there is room for one more. Two pixels are read a cycle after read_pair, from the oldest window.
//
// From crates/edof-hdl/src/blocks/window_ring.rs (WindowRing).
`default_nettype none

module window_ring (
    input  wire        clock_i,       // Clock.
    input  wire        reset_i,       // Empties it.
    input  wire        valid_i,       // A beat stands on the input.
    output wire        ready_o,       // It is taken in this cycle, if there is one.
    input  wire [31:0] pixels_i,      // Its two pixels.
    input  wire        last_i,        // Whether it is its window's last.
    input  wire [7:0]  read_pair_i,   // Which two pixels of the oldest window to read.
    output wire [31:0] read_pixels_o, // They, a cycle later.
    input  wire        finished_i     // Frees the oldest window.
);

    localparam [11:0] WINDOW_ROWS = 12'd32;
    localparam [11:0] LAST_ROW = 12'd319;
    localparam [11:0] LAST_WINDOW = 12'd288;
    localparam [5:0] MOST = 6'd10;

    wire accept;
    wire arrived;
    wire [11:0] ram_read_address;
    reg  [11:0] write_row_q;
    reg  [11:0] write_row_d;
    reg  [11:0] oldest_row_q;
    reg  [11:0] oldest_row_d;
    reg  [5:0] held_q;
    reg  [5:0] held_d;

    edof_ram #(
        .WIDTH(32),
        .DEPTH(320),
        .BLOCK(1),
        .INIT("")
    ) ram (
        .clock_i(clock_i),
        .read_address_i(ram_read_address),
        .read_data_o(read_pixels_o),
        .write_enable_i(accept),
        .write_address_i(write_row_q),
        .write_data_i(pixels_i)
    );

    assign ready_o = held_q != MOST;
    assign accept = valid_i && (held_q != MOST);
    assign arrived = accept && last_i;
    assign ram_read_address = oldest_row_q + {4'd0, read_pair_i};

    always @* begin
        write_row_d = write_row_q;
        if (accept) begin
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
        oldest_row_d = oldest_row_q;
        if (finished_i) begin
            oldest_row_d = oldest_row_q + WINDOW_ROWS;
            if (oldest_row_q == LAST_WINDOW) begin
                oldest_row_d = 12'd0;
            end
        end
        if (reset_i) begin
            oldest_row_d = 12'd0;
        end
    end

    always @* begin
        held_d = held_q;
        if (arrived && !finished_i) begin
            held_d = held_q + 6'd1;
        end else if (finished_i && !arrived) begin
            held_d = held_q - 6'd1;
        end
        if (reset_i) begin
            held_d = 6'd0;
        end
    end

    always @(posedge clock_i) begin
        write_row_q <= write_row_d;
        oldest_row_q <= oldest_row_d;
        held_q <= held_d;
    end
endmodule

`default_nettype wire
