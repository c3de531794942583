// Windows that wait for F's linear path: a ring of whole windows in block RAM, each from a power of two of rows on.
// Ready while there is room for one more. Two pixels are read two cycles after read_pair, from the oldest window.
//
// From crates/edof-hdl/src/blocks/window_ring.rs (WindowRing).
`default_nettype none

module window_ring (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        valid_i,
    output wire        ready_o,
    input  wire [31:0] pixels_i,
    input  wire        last_i,
    input  wire [6:0]  read_pair_i,
    output wire [31:0] read_pixels_o,
    input  wire        finished_i
);

    localparam LARGE = 1'h0;
    localparam [4:0] LAST_WINDOW = 5'h1f;
    localparam [5:0] MOST = 6'h20;

    wire accept;
    wire arrived;
    reg  [5:0] held_next;
    reg  [11:0] ram_read_address;
    reg  [11:0] ram_write_address;
    reg  write_q_q;
    reg  write_q_d;
    reg  [31:0] pixels_q_q;
    reg  last_q_q;
    reg  [6:0] write_beat_q;
    reg  [6:0] write_beat_d;
    reg  [4:0] write_window_q;
    reg  [4:0] write_window_d;
    reg  [4:0] oldest_q;
    reg  [4:0] oldest_d;
    reg  [5:0] held_q;
    reg  [5:0] held_d;
    reg  ready_q_q;
    reg  ready_q_d;

    edof_ram #(
        .WIDTH(32),
        .DEPTH(1024),
        .BLOCK(2),
        .INIT("")
    ) ram (
        .clock_i(clock_i),
        .read_address_i(ram_read_address),
        .read_data_o(read_pixels_o),
        .write_enable_i(write_q_q),
        .write_address_i(ram_write_address),
        .write_data_i(pixels_q_q)
    );

    assign ready_o = ready_q_q;
    assign accept = valid_i && ready_q_q;
    assign arrived = accept && last_i;

    always @* begin
        held_next = held_q;
        if (arrived && (!finished_i)) begin
            held_next = held_q + 6'd1;
        end else if (finished_i && (!arrived)) begin
            held_next = held_q - 6'd1;
        end
    end

    always @* begin
        write_beat_d = write_beat_q;
        write_window_d = write_window_q;
        oldest_d = oldest_q;
        held_d = held_next;
        ready_q_d = held_next != MOST;
        write_q_d = accept;
        if (write_q_q) begin
            write_beat_d = write_beat_q + 7'd1;
            if (last_q_q) begin
                write_beat_d = 7'd0;
                write_window_d = (write_window_q + 5'd1) & LAST_WINDOW;
            end
        end
        if (finished_i) begin
            oldest_d = (oldest_q + 5'd1) & LAST_WINDOW;
        end
        if (reset_i) begin
            write_q_d = 1'b0;
            write_beat_d = 7'd0;
            write_window_d = 5'd0;
            oldest_d = 5'd0;
            held_d = 6'd0;
            ready_q_d = 1'b0;
        end
    end

    always @* begin
        ram_write_address = ({7'd0, write_window_q} << 5) | {5'd0, write_beat_q};
        ram_read_address = ({7'd0, oldest_q} << 5) | {5'd0, read_pair_i};
        if (LARGE) begin
            ram_write_address = ({7'd0, write_window_q} << 7) | {5'd0, write_beat_q};
            ram_read_address = ({7'd0, oldest_q} << 7) | {5'd0, read_pair_i};
        end
    end

    always @(posedge clock_i) begin
        write_q_q <= write_q_d;
        pixels_q_q <= pixels_i;
        last_q_q <= last_i;
        write_beat_q <= write_beat_d;
        write_window_q <= write_window_d;
        oldest_q <= oldest_d;
        held_q <= held_d;
        ready_q_q <= ready_q_d;
    end
endmodule

`default_nettype wire
