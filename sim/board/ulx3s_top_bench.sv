// The ULX3S' top between models of its PLL, its pins' cells and the core: periods of the clocks, the order of the resets, which pin is which.
`timescale 1ps / 1ps
`default_nettype none

// A PLL whose feedback is its output (FPGA-TN-02200): CLKOP is CLKI / CLKI_DIV x CLKFB_DIV, the oscillator CLKOP_DIV times as fast and between
// 400 and 800 MHz (FPGA-DS-02012). It locks after some cycles of its input.
module EHXPLLL (
    input  wire CLKI, CLKFB, RST, STDBY, PHASESEL0, PHASESEL1, PHASEDIR, PHASESTEP, PHASELOADREG, PLLWAKESYNC, ENCLKOP,
    output reg  CLKOP,
    output reg  LOCK
);
    parameter CLKI_DIV = 1, CLKFB_DIV = 1, CLKOP_DIV = 8, CLKOP_CPHASE = 0, CLKOP_FPHASE = 0;
    parameter CLKOP_ENABLE = "ENABLED", FEEDBK_PATH = "CLKOP", OUTDIVIDER_MUXA = "DIVA", PLLRST_ENA = "DISABLED", INTFB_WAKE = "DISABLED",
        STDBY_ENABLE = "DISABLED", DPHASE_SOURCE = "DISABLED";
    realtime last = 0, period = 0, half = 0;
    integer seen = 0;
    initial {CLKOP, LOCK} = 2'b00;
    always @(posedge CLKI) begin
        period = $realtime - last;
        last = $realtime;
        seen = seen + 1;
        half = period * CLKI_DIV / CLKFB_DIV / 2;
        LOCK <= seen > 40 + CLKFB_DIV;
        if (seen == 4 && (2 * half / CLKOP_DIV < 1250 || 2 * half / CLKOP_DIV > 2500)) begin
            $display("FAIL: %m: the oscillator has a period of %0.1f ps", 2 * half / CLKOP_DIV);
            $finish;
        end
    end
    initial begin
        wait (seen == 3);
        if (FEEDBK_PATH != "CLKOP" || CLKOP_CPHASE >= CLKOP_DIV || RST || STDBY) $display("FAIL: %m: no model of this use");
        forever #(half) CLKOP = !CLKOP;
    end
    wire unused = &{1'b0, CLKFB, PHASESEL0, PHASESEL1, PHASEDIR, PHASESTEP, PHASELOADREG, PLLWAKESYNC, ENCLKOP};
endmodule

// Registers at pins, a pin of both directions, and D0 then D1 of each cycle at a pin (FPGA-TN-02032).
module OFS1P3DX (input wire SCLK, CD, SP, D, output reg Q);
    always @(posedge SCLK, posedge CD) if (CD) Q <= 1'b0; else if (SP) Q <= D;
endmodule
module IFS1P3DX (input wire SCLK, CD, SP, D, output reg Q);
    always @(posedge SCLK, posedge CD) if (CD) Q <= 1'b0; else if (SP) Q <= D;
endmodule
module BB (input wire I, T, output wire O, inout wire B);
    assign B = T ? 1'bz : I, O = B;
endmodule
module ODDRX1F (input wire SCLK, RST, D0, D1, output wire Q);
    assign Q = !RST & (SCLK ? D0 : D1);
endmodule

// What the top sees of a core: its line goes back inverted, its LEDs and the pairs of its screen are alternate, and each pin of its memory has a word of its own.
module ulx3s_core (
    input  wire clock_i, calculator_clock_i, screen_clock_i, bit_clock_i, reset_i, calculator_reset_i, uart_receive_i,
    input  wire camera_clock_i, camera_vs_i, camera_href_i, camera_scl_i, camera_sda_i,
    input  wire [7:0] camera_data_i,
    output reg  [1:0] camera_on_o,
    output reg  camera_scl_low_o, camera_sda_low_o,
    output wire uart_transmit_o,
    output wire [3:0] dvi_o,
    output wire [5:0] leds_o,
    output reg  [2:0] sdram_command_o,
    output reg  [1:0] sdram_bank_o, sdram_mask_o,
    output reg  [12:0] sdram_address_o,
    output reg  [15:0] sdram_data_out_o,
    output reg  sdram_drive_o,
    input  wire [15:0] sdram_data_in_i
);
    assign uart_transmit_o = !uart_receive_i;
    assign leds_o = 6'b010101, dvi_o = 4'b0110;
    initial begin
        {camera_on_o, camera_scl_low_o, camera_sda_low_o} = 4'b0000;
        {sdram_command_o, sdram_bank_o, sdram_mask_o, sdram_drive_o} = {3'd5, 2'd2, 2'd1, 1'b0};
        {sdram_address_o, sdram_data_out_o} = {13'h1234, 16'hbeef};
    end
endmodule

module ulx3s_top_bench;
    reg clk_25mhz = 1'b0, btn_fire1 = 1'b0, ftdi_txd = 1'b1;
    wire [7:0] led;
    wire [3:0] gpdi_dp;
    reg camera_pclk = 1'b0;
    reg [9:0] camera_says = 10'd0;
    wire camera_xclk, camera_pwdn, camera_resetn, camera_sioc, camera_siod;
    pullup (camera_sioc);
    pullup (camera_siod);
    wire ftdi_rxd, wifi_gpio0, sdram_clk, sdram_cke, sdram_csn, sdram_rasn, sdram_casn, sdram_wen;
    wire [1:0] sdram_ba, sdram_dqm;
    wire [12:0] sdram_a;
    wire [15:0] sdram_d;
    reg chip_drives = 1'b1;
    assign sdram_d = chip_drives ? 16'hcafe : 16'hzzzz;
    always #20000 clk_25mhz = !clk_25mhz;
    ulx3s_top dut (
        .clk_25mhz(clk_25mhz), .btn_fire1(btn_fire1), .led(led), .ftdi_txd(ftdi_txd), .ftdi_rxd(ftdi_rxd), .gpdi_dp(gpdi_dp), .wifi_gpio0(wifi_gpio0),
        .camera_xclk(camera_xclk), .camera_pclk(camera_pclk), .camera_vsync(camera_says[9]), .camera_href(camera_says[8]), .camera_d(camera_says[7:0]),
        .camera_pwdn(camera_pwdn), .camera_resetn(camera_resetn), .camera_sioc(camera_sioc), .camera_siod(camera_siod),
        .sdram_clk(sdram_clk), .sdram_cke(sdram_cke), .sdram_csn(sdram_csn), .sdram_rasn(sdram_rasn), .sdram_casn(sdram_casn),
        .sdram_wen(sdram_wen), .sdram_ba(sdram_ba), .sdram_dqm(sdram_dqm), .sdram_a(sdram_a), .sdram_d(sdram_d)
    );
    // A press of some microseconds is enough here.
    defparam dut.fire1.LOG_CYCLES = 6;

    task fail(input [8*60-1:0] what);
        begin
            $display("FAIL: %0s", what);
            $finish;
        end
    endtask

    // The mean period of a clock over a thousand cycles against what the design says.
    realtime begun;
    task measure(input integer clock, input real expected);
        integer cycle;
        real period;
        begin
            for (cycle = 0; cycle <= 1000; cycle = cycle + 1) begin
                case (clock)
                    0: @(posedge dut.core.clock_i);
                    1: @(posedge dut.core.calculator_clock_i);
                    2: @(posedge dut.core.screen_clock_i);
                    4: @(posedge camera_xclk);
                    default: @(posedge dut.core.bit_clock_i);
                endcase
                if (cycle == 0) begun = $realtime;
            end
            period = ($realtime - begun) / 1000;
            if (period > expected * 1.001 || period < expected * 0.999) begin
                $display("FAIL: clock %0d has a period of %0.1f ps, expected %0.1f", clock, period, expected);
                $finish;
            end
        end
    endtask

    always @(posedge dut.core.clock_i) begin
        if (!dut.core_locked && !dut.core.reset_i) fail("the core's reset is over before its clock is locked");
        if (!dut.calculator_locked && !dut.core.calculator_reset_i) fail("the calculator's reset is over before its clock is locked");
    end

    initial begin
        #20000000;
        if (dut.core.reset_i || dut.core.calculator_reset_i) fail("a reset does not end");
        if (led !== 8'b10010101) fail("LEDs");
        if (wifi_gpio0 !== 1'b1) fail("the ESP32 is held");
        measure(0, @core_ps@);
        measure(1, @calculator_ps@);
        measure(2, 40000.0);
        measure(3, 8000.0);
        measure(4, 40000.0);
        // The camera is off until the core lets it on; its bus is pulled down and let go.
        if ({camera_pwdn, camera_resetn, camera_sioc, camera_siod} !== 4'b1011) fail("the camera's pins before its set-up");
        dut.core.camera_on_o = 2'b01;
        dut.core.camera_scl_low_o = 1'b1;
        #1000 if ({camera_pwdn, camera_resetn, camera_sioc, camera_siod} !== 4'b0001) fail("the camera out of power-down");
        if ({dut.core.camera_scl_i, dut.core.camera_sda_i} !== 2'b01) fail("the camera's bus");
        dut.core.camera_on_o = 2'b10;
        {dut.core.camera_scl_low_o, dut.core.camera_sda_low_o} = 2'b01;
        #1000 if ({camera_pwdn, camera_resetn, camera_sioc, camera_siod} !== 4'b1110) fail("the camera out of reset");
        if ({dut.core.camera_scl_i, dut.core.camera_sda_i} !== 2'b10) fail("the camera's bus");
        // What changes with the fall of its clock is seen from the next rise on.
        camera_says = 10'b10_1010_0110;
        #40000 camera_pclk = 1'b1;
        #1000 if ({dut.core.camera_vs_i, dut.core.camera_href_i, dut.core.camera_data_i} !== 10'b10_1010_0110) fail("the camera's pins");
        #39000 camera_pclk = 1'b0;
        camera_says = 10'b01_0101_1001;
        #45000 if ({dut.core.camera_vs_i, dut.core.camera_href_i, dut.core.camera_data_i} !== 10'b10_1010_0110) fail("a register at the camera's pins");
        if (gpdi_dp !== 4'b0110) fail("the screen");
        if ({sdram_cke, sdram_csn, sdram_rasn, sdram_casn, sdram_wen} !== 5'b10101) fail("the SDRAM's command");
        if (sdram_ba !== 2'd2 || sdram_dqm !== 2'd1 || sdram_a !== 13'h1234) fail("the SDRAM's address");
        if (dut.core.sdram_data_in_i !== 16'hcafe) fail("data from the SDRAM");
        chip_drives = 1'b0;
        dut.core.sdram_drive_o = 1'b1;
        #1000 if (sdram_d !== 16'hbeef) fail("data to the SDRAM");
        // A word is at the pins for half a cycle when the chip's clock rises.
        dut.core.sdram_data_out_o = 16'h5a5a;
        @(sdram_d) begun = $realtime;
        @(posedge sdram_clk) begun = ($realtime - begun) / @core_ps@;
        if (sdram_d !== 16'h5a5a || begun < 0.4 || begun > 0.6) fail("the SDRAM's clock is not inverted");
        ftdi_txd = 1'b0;
        #1000 if (ftdi_rxd !== 1'b1) fail("the serial line");
        btn_fire1 = 1'b1;
        #20000000 if (!dut.core.reset_i || dut.core.calculator_reset_i) fail("FIRE1 resets the core alone");
        btn_fire1 = 1'b0;
        #20000000 if (dut.core.reset_i) fail("the reset of FIRE1 does not end");
        $display("PASS: clocks, resets, pins");
        $finish;
    end
endmodule
`default_nettype wire
