// The system of litex/sim.py against recorded frames and the pictures that they must become, its serial line behind a pseudo-terminal.
// Compiled and run by sim.py.
//
// The camera starts when a host has initialised the DRAM (`dram_ready`). Camera, screen and what counts as right are those of
// sim/core_bench.sv: every frame on the screen must be black or one of the pictures, in order and none left out. With +serve the bench runs on
// after the last picture.
`default_nettype none
`timescale 1ps / 1ps

module edof_litex_bench;
@frames_svh@
    // Periods in picoseconds: 125 MHz for LiteDRAM and the bus; the core's and the calculator's are the board's.
    localparam integer SYS = 8000;
    localparam integer CORE = 1000 * @core_period@;
    localparam integer CALCULATOR = 1000 * @calculator_period@;
    localparam integer SLOWER = CORE > CALCULATOR ? CORE : CALCULATOR;
    // Products of many cycles need more than 32 bits.
    localparam integer CAMERA = 64'd1 * SLOWER * CYCLES / (COLUMNS * ROWS);
    localparam integer SCREEN = CAMERA * 64'd49 / 100;
    localparam [63:0] LIMIT = 64'd1 * (FRAMES + 6) * CYCLES * SLOWER / CORE;
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
    always #(SCREEN) screen_clock = !screen_clock;

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
        if (running == LIMIT && shown < FRAMES) begin
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

@camera_svh@
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

@screen_svh@
endmodule

`default_nettype wire
