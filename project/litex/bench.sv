// The system of litex/sim.py against recorded frames and the pictures that they must become, its serial line behind a pseudo-terminal.
// Compiled and run by sim.py.
//
// The camera starts when a host has initialised the DRAM (`dram_ready`). Camera, screen and what counts as right are those of
// sim/core_bench.sv: every frame on the screen must be black or one of the pictures, in order and none left out. With +serve the bench runs on
// after the last picture.
`default_nettype none
`timescale 1ps / 1ps

module edof_litex_bench;
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

    // Periods in picoseconds: 125 MHz for LiteDRAM and the bus; the core's and the calculator's are the board's.
    localparam integer SYS = 8000;
    localparam integer CORE = 1000 * @core_period@;
    localparam integer CALCULATOR = 1000 * @calculator_period@;
    localparam integer SLOWER = CORE > CALCULATOR ? CORE : CALCULATOR;
    localparam integer CAMERA = SLOWER * CYCLES / (COLUMNS * ROWS);
    localparam integer CYCLES_PER_BIT = 8;
    reg sys_clock = 1'b0;
    reg core_clock = 1'b0;
    reg calculator_clock = 1'b0;
    reg input_clock = 1'b0;
    reg screen_clock = 1'b0;
    always #(SYS / 2) sys_clock = !sys_clock;
    always #(CORE / 2) core_clock = !core_clock;
    always #(CALCULATOR / 2) calculator_clock = !calculator_clock;
    always #(CAMERA / 2) input_clock = !input_clock;
    always #(CAMERA * 49 / 100) screen_clock = !screen_clock;

    reg [15:0] frames [0:FRAMES*PIXELS-1];
    reg [15:0] pictures [0:FRAMES*PIXELS-1];
    initial $readmemh("sim/frames.hex", frames);
    initial $readmemh("sim/pictures.hex", pictures);

    wire serves = $test$plusargs("serve") != 0;
    reg reset = 1'b0;
    wire dram_ready;
    // Cycles of the core since the start, and since the DRAM is ready.
    integer cycle = 0;
    integer running = 0;
    // Pictures on the screen so far.
    integer shown = 0;
    always @(posedge core_clock) begin
        cycle <= cycle + 1;
        reset <= cycle >= 4 && cycle < 200;
        if (dram_ready) running <= running + 1;
        if (running == (FRAMES + 6) * CYCLES * SLOWER / CORE && shown < FRAMES) begin
            $display("FAIL: %0d of %0d pictures after %0d cycles", shown, FRAMES, running);
            $fatal(1, "FAIL");
        end
    end

    // The host's line: a byte is ten bits, the lowest first.
    import "DPI-C" function void line_open();
    import "DPI-C" function int line_get();
    import "DPI-C" function void line_put(input int value);
    initial line_open();
    reg serial_rx = 1'b1;
    wire serial_tx;
    integer taken = 0;
    integer to_board = 0;
    integer to_board_wait = 0;
    always @(posedge sys_clock) if (cycle > 400) begin
        if (to_board_wait != 0) begin
            to_board_wait <= to_board_wait - 1;
        end else begin
            to_board_wait <= CYCLES_PER_BIT - 1;
            if (to_board == 0) begin
                taken = line_get();
                if (taken >= 0) begin
                    serial_rx <= 1'b0;
                    to_board <= 1;
                end
            end else begin
                serial_rx <= to_board == 9 || taken[to_board-1];
                to_board <= to_board == 9 ? 0 : to_board + 1;
            end
        end
    end
    reg [7:0] given = 8'd0;
    integer from_board = 0;
    integer from_board_wait = 0;
    always @(posedge sys_clock) if (cycle > 400) begin
        if (from_board_wait != 0) begin
            from_board_wait <= from_board_wait - 1;
        end else if (from_board == 0) begin
            if (!serial_tx) begin
                from_board <= 1;
                from_board_wait <= CYCLES_PER_BIT + CYCLES_PER_BIT / 2 - 1;
            end
        end else if (from_board == 9) begin
            line_put({24'd0, given});
            from_board <= 0;
        end else begin
            given[from_board-1] <= serial_tx;
            from_board <= from_board + 1;
            from_board_wait <= CYCLES_PER_BIT - 1;
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
    always @(posedge input_clock) if (running > 400) begin
        column <= ends ? 0 : column + 1;
        if (ends) row <= row == ROWS - 1 ? 0 : row + 1;
        if (ends && row == ROWS - 1 && frame < FRAMES - 1) frame <= frame + 1;
        input_hs <= column >= HS_ON && column < HS_OFF;
        // A frame's sync begins and ends with that of a line.
        if (column == HS_ON) input_vs <= row >= VS_ON && row < VS_OFF;
        input_de <= row < HEIGHT && column < WIDTH;
        input_data <= row < HEIGHT && column < WIDTH ? frames[frame*PIXELS + row*WIDTH + column] : 16'h5a5a;
    end

    wire screen_hs, screen_vs, screen_de;
    wire [15:0] screen_data;

    edof_litex dut (
        .sys_clk(sys_clock),
        .core_clk(core_clock),
        .calculator_clk(calculator_clock),
        .screen_clk(screen_clock),
        .reset(reset),
        .serial_rx(serial_rx),
        .serial_tx(serial_tx),
        .dram_ready(dram_ready),
        .input_clock(input_clock),
        .input_hs(input_hs),
        .input_vs(input_vs),
        .input_de(input_de),
        .input_data(input_data),
        .screen_hs(screen_hs),
        .screen_vs(screen_vs),
        .screen_de(screen_de),
        .screen_data(screen_data),
        .sim_trace(1'b0)
    );

    // The screen: which of the pictures each frame still may be.
    integer at = 0;
    integer k;
    reg vs_before = 1'b0;
    reg is_black = 1'b1;
    reg [FRAMES-1:0] may_be = {FRAMES{1'b1}};
    always @(posedge screen_clock) if (cycle > 400 && shown < FRAMES) begin
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
            if (at == PIXELS && may_be[shown % FRAMES]) begin
                shown <= shown + 1;
                if (shown == FRAMES - 1) begin
                    $display("PASS: %0d pictures from bus to bus in %0d cycles", FRAMES, running);
                    if (!serves) $finish;
                end
            end else if (at != 0 && !(shown > 0 && at == PIXELS && may_be[shown-1]) && !(shown == 0 && is_black)) begin
                $display("FAIL: a frame of %0d pixels after %0d pictures is none that was sent", at, shown);
                $fatal(1, "FAIL");
            end
        end
    end
endmodule

`default_nettype wire
