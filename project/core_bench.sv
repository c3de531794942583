// The whole core against recorded frames and the pictures that they must become, from the receiver's bus to the screen's, by way of a memory
// that is late. Needs nothing but this directory: start it there.
//
// Frames of @width@x@height@: what knows the size of a frame is in sim/rtl, in place of the modules of that name in rtl. The camera sends each
// frame once and then repeats the last one. Every frame on the screen must be black or one of the pictures, these in order and none
// left out. It ends with PASS, or with the first frame that is wrong.
`default_nettype none

module edof_core_bench;
@frames_svh@
    localparam [31:0] CONTROL_ADDRESS = 32'h@control_address@;
    localparam [31:0] CONTROL = 32'h@control@;
    localparam WORD_BITS = @word_bits@;
    localparam WORDS = 1 << $clog2(PIXELS * 16 / WORD_BITS);

    // The clocks of memory and calculator; the camera's is so slow that both keep up, the screen's a little faster than the camera's.
    // A cycle of the slower of the first two is SLOWER units of time, whatever a simulator takes a unit for.
    localparam integer CORE = @core_units@;
    localparam integer CALCULATOR = @calculator_units@;
    localparam integer SLOWER = CORE > CALCULATOR ? CORE : CALCULATOR;
    // Products of many cycles need more than 32 bits.
    localparam integer CAMERA = 64'd1 * SLOWER * CYCLES / (COLUMNS * ROWS);
    localparam integer SCREEN = CAMERA * 64'd49 / 100;
    localparam [63:0] LIMIT = 64'd1 * (FRAMES + 6) * CYCLES * SLOWER / CORE;
    reg clock = 1'b0;
    reg calculator_clock = 1'b0;
    reg input_clock = 1'b0;
    reg screen_clock = 1'b0;
    always #(CORE / 2) clock = !clock;
    always #(CALCULATOR / 2) calculator_clock = !calculator_clock;
    always #(CAMERA / 2) input_clock = !input_clock;
    always #(SCREEN) screen_clock = !screen_clock;

    // Reset rises after the start: a block that waits for a change of its inputs must see one.
    reg reset = 1'b0;
    integer cycle = 0;
    // The camera waits for nothing but the core, and nothing follows the last picture.
    wire [31:0] running = cycle;
    localparam serves = 1'b0;
    // A shift register with feedback: the memory's pauses are the same in every simulator.
    reg [31:0] lfsr = 32'h1234_5678;
    // Pictures on the screen so far.
    integer shown = 0;
    always @(posedge clock) begin
        cycle <= cycle + 1;
        lfsr <= {lfsr[30:0], lfsr[31] ^ lfsr[21] ^ lfsr[1] ^ lfsr[0]};
        reset <= cycle >= 4 && cycle < 200;
        if (cycle == LIMIT) begin
            $display("FAIL: %0d of %0d pictures after %0d cycles", shown, FRAMES, cycle);
            $fatal(1, "FAIL");
        end
    end

    // The host writes how the board shall run, once.
    reg aw_request = 1'b0;
    reg w_request = 1'b0;
    wire aw_grant, w_grant;
    always @(posedge clock) begin
        if (cycle == 400) begin
            aw_request <= 1'b1;
            w_request <= 1'b1;
        end else begin
            if (aw_grant) aw_request <= 1'b0;
            if (w_grant) w_request <= 1'b0;
        end
    end

@camera_svh@
    // Memory, writes: one burst at a time.
    reg [WORD_BITS-1:0] memory [0:8*WORDS-1];
    wire aw_id, aw_valid, w_last, w_valid, b_ready;
    wire [31:0] aw_addr;
    wire [WORD_BITS-1:0] w_data;
    reg writes = 1'b0;
    reg w_open = 1'b0;
    reg b_valid = 1'b0;
    reg b_id = 1'b0;
    reg [15:0] write_at = 16'd0;
    wire aw_ready = !writes;
    wire w_ready = writes && w_open && !b_valid;
    always @(posedge clock) begin
        w_open <= lfsr[2:0] != 3'd0;
        if (aw_valid && aw_ready) begin
            writes <= 1'b1;
            b_id <= aw_id;
            write_at <= place(aw_addr);
        end
        if (w_valid && w_ready) begin
            memory[write_at] <= w_data;
            write_at <= write_at + 16'd1;
            if (w_last) b_valid <= 1'b1;
        end
        if (b_valid && b_ready) begin
            b_valid <= 1'b0;
            writes <= 1'b0;
        end
    end

    // Memory, reads: late by up to 63 cycles.
    wire ar_id, ar_valid, r_ready;
    wire [31:0] ar_addr;
    wire [7:0] ar_len;
    reg reads = 1'b0;
    reg [5:0] late = 6'd0;
    reg r_id = 1'b0;
    reg r_valid = 1'b0;
    reg [7:0] left = 8'd0;
    reg [15:0] read_at = 16'd0;
    wire ar_ready = !reads;
    always @(posedge clock) begin
        if (ar_valid && ar_ready) begin
            reads <= 1'b1;
            r_id <= ar_id;
            left <= ar_len;
            late <= lfsr[9:4];
            read_at <= place(ar_addr);
        end else if (reads && late != 6'd0) begin
            late <= late - 6'd1;
        end else if (reads && !(r_valid && !r_ready)) begin
            // A word was taken, or none is offered.
            r_valid <= lfsr[12:10] != 3'd0;
            if (r_valid) begin
                read_at <= read_at + 16'd1;
                left <= left - 8'd1;
                if (left == 8'd0) begin
                    r_valid <= 1'b0;
                    reads <= 1'b0;
                end
            end
        end
    end

    // The row of a byte address: a frame uses the first WORDS words of its buffer.
    function [15:0] place(input [31:0] address);
        place = address / @buffer_bytes@ * WORDS + address % @buffer_bytes@ / (WORD_BITS / 8);
    endfunction

    wire screen_hs, screen_vs, screen_de;
    wire [15:0] screen_data;

    edof_core dut (
        @ports@
    );

@screen_svh@
endmodule

`default_nettype wire
