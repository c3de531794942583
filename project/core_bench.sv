// The whole core against recorded frames and the pictures that they must become, from the receiver's bus to the screen's, by way of a memory
// that is late. Needs nothing but this directory: start it there.
//
// Frames of @width@x@height@: what knows the size of a frame is in sim/rtl, in place of the modules of that name in rtl. The camera sends each
// frame once and then repeats the last one. Every frame on the screen must be black or one of the pictures, these in order and none
// left out. It ends with PASS, or with the first frame that is wrong.
`default_nettype none

module edof_core_bench;
    localparam FRAMES = @frames@;
    localparam WIDTH = @width@;
    localparam HEIGHT = @height@;
    localparam PIXELS = WIDTH * HEIGHT;
    localparam HS_ON = WIDTH + @line_front@;
    localparam HS_OFF = HS_ON + @line_sync@;
    localparam COLUMNS = HS_OFF + @line_back@;
    localparam VS_ON = HEIGHT + @frame_front@;
    localparam VS_OFF = VS_ON + @frame_sync@;
    localparam ROWS = VS_OFF + @frame_back@;
    // Cycles of the slower of memory and calculator in a frame of the camera.
    localparam CYCLES = @cycles@;
    localparam [15:0] BLACK = 16'h@black@;
    localparam [31:0] CONTROL_ADDRESS = 32'h@control_address@;
    localparam [31:0] CONTROL = 32'h@control@;
    localparam WORDS = 1 << $clog2(PIXELS / 32);

    // The clocks of memory and calculator; the camera's is so slow that both keep up, the screen's a little faster than the camera's.
    // A cycle of the slower of the first two is SLOWER units of time, whatever a simulator takes a unit for.
    localparam integer CORE = @core_units@;
    localparam integer CALCULATOR = @calculator_units@;
    localparam integer SLOWER = CORE > CALCULATOR ? CORE : CALCULATOR;
    localparam integer CAMERA = SLOWER * CYCLES / (COLUMNS * ROWS);
    reg clock = 1'b0;
    reg calculator_clock = 1'b0;
    reg input_clock = 1'b0;
    reg screen_clock = 1'b0;
    always #(CORE / 2) clock = !clock;
    always #(CALCULATOR / 2) calculator_clock = !calculator_clock;
    always #(CAMERA / 2) input_clock = !input_clock;
    always #(CAMERA * 49 / 100) screen_clock = !screen_clock;

    reg [15:0] frames [0:FRAMES*PIXELS-1];
    reg [15:0] pictures [0:FRAMES*PIXELS-1];
    initial $readmemh("sim/frames.hex", frames);
    initial $readmemh("sim/pictures.hex", pictures);

    // Reset rises after the start: a block that waits for a change of its inputs must see one.
    reg reset = 1'b0;
    integer cycle = 0;
    // A shift register with feedback: the memory's pauses are the same in every simulator.
    reg [31:0] lot = 32'h1234_5678;
    // Pictures on the screen so far.
    integer shown = 0;
    always @(posedge clock) begin
        cycle <= cycle + 1;
        lot <= {lot[30:0], lot[31] ^ lot[21] ^ lot[1] ^ lot[0]};
        reset <= cycle >= 4 && cycle < 200;
        if (cycle == (FRAMES + 6) * CYCLES * SLOWER / CORE) begin
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

    // The camera begins behind a picture, so that the first frame has its sync before it.
    integer frame = -1;
    integer column = 0;
    integer row = HEIGHT;
    reg input_hs = 1'b0;
    reg input_vs = 1'b0;
    reg input_de = 1'b0;
    reg [15:0] input_data = 16'd0;
    wire ends = column == COLUMNS - 1;
    always @(posedge input_clock) if (cycle > 400) begin
        column <= ends ? 0 : column + 1;
        if (ends) row <= row == ROWS - 1 ? 0 : row + 1;
        if (ends && row == ROWS - 1 && frame < FRAMES - 1) frame <= frame + 1;
        input_hs <= column >= HS_ON && column < HS_OFF;
        // A frame's sync begins and ends with that of a line.
        if (column == HS_ON) input_vs <= row >= VS_ON && row < VS_OFF;
        input_de <= row < HEIGHT && column < WIDTH;
        input_data <= row < HEIGHT && column < WIDTH ? frames[frame*PIXELS + row*WIDTH + column] : 16'h5a5a;
    end

    // Memory, writes: one burst at a time.
    reg [511:0] memory [0:8*WORDS-1];
    wire aw_id, aw_valid, w_last, w_valid, b_ready;
    wire [31:0] aw_addr;
    wire [511:0] w_data;
    reg writes = 1'b0;
    reg w_open = 1'b0;
    reg b_valid = 1'b0;
    reg b_id = 1'b0;
    reg [15:0] write_at = 16'd0;
    wire aw_ready = !writes;
    wire w_ready = writes && w_open && !b_valid;
    always @(posedge clock) begin
        w_open <= lot[2:0] != 3'd0;
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
            late <= lot[9:4];
            read_at <= place(ar_addr);
        end else if (reads && late != 6'd0) begin
            late <= late - 6'd1;
        end else if (reads && !(r_valid && !r_ready)) begin
            // A word was taken, or none is offered.
            r_valid <= lot[12:10] != 3'd0;
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

    // The row of a byte address: buffers of 4 MiB; a frame uses the first WORDS words of its buffer.
    function [15:0] place(input [31:0] address);
        place = address[24:22] * WORDS + address[21:6];
    endfunction

    wire screen_hs, screen_vs, screen_de;
    wire [15:0] screen_data;

    edof_core dut (
        @ports@
    );

    // The screen: which of the pictures each frame still may be.
    integer at = 0;
    integer k;
    reg vs_before = 1'b0;
    reg is_black = 1'b1;
    reg [FRAMES-1:0] may_be = {FRAMES{1'b1}};
    always @(posedge screen_clock) if (cycle > 400) begin
        vs_before <= screen_vs;
        if (screen_de) begin
            at <= at + 1;
            if (screen_data !== BLACK) is_black <= 1'b0;
            for (k = 0; k < FRAMES; k = k + 1)
                if (at >= PIXELS || screen_data !== pictures[(k*PIXELS + at) % (FRAMES*PIXELS)]) may_be[k] <= 1'b0;
        end
        if (screen_vs && !vs_before) begin
            at <= 0;
            is_black <= 1'b1;
            may_be <= {FRAMES{1'b1}};
            // The last picture shown again, the next one, or black before the first.
            if (at == PIXELS && shown < FRAMES && may_be[shown % FRAMES]) begin
                shown <= shown + 1;
                if (shown == FRAMES - 1) begin
                    $display("PASS: %0d pictures from bus to bus in %0d cycles", FRAMES, cycle);
                    $finish;
                end
            end else if (at != 0 && !(shown > 0 && at == PIXELS && may_be[shown-1]) && !(shown == 0 && is_black)) begin
                $display("FAIL: a frame of %0d pixels after %0d pictures is none that was sent", at, shown);
                $fatal(1, "FAIL");
            end
        end
    end
endmodule

`default_nettype wire
