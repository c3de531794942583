// The ULX3S: pins, clocks, and ulx3s_core between them.
//
// clk_25mhz is the clock of the screen's pixels and feeds three PLLs: one makes the clock of memory and host of @core_mhz@ MHz, one the calculator's
// of @calculator_mhz@ MHz, one that of the screen's bits of @bits_mhz@ MHz, two of which leave in a cycle. The figures of the PLLs follow from the design.
//
// Resets: the core is in reset until the PLL of its clock is locked, and while FIRE1 is pressed; the calculator's domain alone while the PLL of its
// clock is not locked.
//
// LEDs: 0 the memory is ready; 1 video comes in; 2 it has the design's size; 3 pictures leave the memory; 4 the camera is set up; 5 its set-up failed;
// 7 the clocks of core, calculator and screen are locked.
`default_nettype none
module ulx3s_top (
    input  wire       clk_25mhz,
    input  wire       btn_fire1,
    output wire [7:0] led,
    // Named from the FT231X: it transmits on ftdi_txd.
    input  wire       ftdi_txd,
    output wire       ftdi_rxd,
    // DVI: blue, green, red, clock. The pads drive the other half of each pair.
    output wire [3:0] gpdi_dp,
    // High: the ESP32 keeps running its program.
    output wire       wifi_gpio0,
    // The camera, an OV7670: its clocks, frames, pins and bus.
    output wire       camera_xclk,
    input  wire       camera_pclk, camera_vsync, camera_href,
    input  wire [7:0] camera_d,
    output wire       camera_pwdn, camera_resetn,
    inout  wire       camera_sioc, camera_siod,
    // The memory of frames.
    output wire       sdram_clk, sdram_cke, sdram_csn, sdram_rasn, sdram_casn, sdram_wen,
    output wire [1:0] sdram_ba, sdram_dqm,
    output wire [12:0] sdram_a,
    inout  wire [15:0] sdram_d
);
    // 25 MHz / @core_divide@ * @core_feedback@ = @core_mhz@ MHz; the oscillator runs @core_output@ times as fast.
    wire core_clock, core_locked;
    (* FREQUENCY_PIN_CLKI = "25", FREQUENCY_PIN_CLKOP = "@core_mhz@" *)
    (* ICP_CURRENT = "12", LPF_RESISTOR = "8", MFG_ENABLE_FILTEROPAMP = "1", MFG_GMCREF_SEL = "2" *)
    EHXPLLL #(
        .CLKI_DIV(@core_divide@), .CLKFB_DIV(@core_feedback@), .CLKOP_DIV(@core_output@), .CLKOP_CPHASE(@core_output@ / 2),
        .CLKOP_FPHASE(0), .CLKOP_ENABLE("ENABLED"), .FEEDBK_PATH("CLKOP"), .OUTDIVIDER_MUXA("DIVA"),
        .PLLRST_ENA("DISABLED"), .INTFB_WAKE("DISABLED"), .STDBY_ENABLE("DISABLED"), .DPHASE_SOURCE("DISABLED")
    ) core_pll (
        .CLKI(clk_25mhz), .CLKFB(core_clock), .CLKOP(core_clock), .LOCK(core_locked),
        .RST(1'b0), .STDBY(1'b0), .PHASESEL0(1'b0), .PHASESEL1(1'b0), .PHASEDIR(1'b1), .PHASESTEP(1'b1), .PHASELOADREG(1'b1),
        .PLLWAKESYNC(1'b0), .ENCLKOP(1'b0)
    );

    // 25 MHz / @calculator_divide@ * @calculator_feedback@ = @calculator_mhz@ MHz; the oscillator runs @calculator_output@ times as fast.
    wire calculator_clock, calculator_locked;
    (* FREQUENCY_PIN_CLKI = "25", FREQUENCY_PIN_CLKOP = "@calculator_mhz@" *)
    (* ICP_CURRENT = "12", LPF_RESISTOR = "8", MFG_ENABLE_FILTEROPAMP = "1", MFG_GMCREF_SEL = "2" *)
    EHXPLLL #(
        .CLKI_DIV(@calculator_divide@), .CLKFB_DIV(@calculator_feedback@), .CLKOP_DIV(@calculator_output@),
        .CLKOP_CPHASE(@calculator_output@ / 2), .CLKOP_FPHASE(0), .CLKOP_ENABLE("ENABLED"), .FEEDBK_PATH("CLKOP"), .OUTDIVIDER_MUXA("DIVA"),
        .PLLRST_ENA("DISABLED"), .INTFB_WAKE("DISABLED"), .STDBY_ENABLE("DISABLED"), .DPHASE_SOURCE("DISABLED")
    ) calculator_pll (
        .CLKI(clk_25mhz), .CLKFB(calculator_clock), .CLKOP(calculator_clock), .LOCK(calculator_locked),
        .RST(1'b0), .STDBY(1'b0), .PHASESEL0(1'b0), .PHASESEL1(1'b0), .PHASEDIR(1'b1), .PHASESTEP(1'b1), .PHASELOADREG(1'b1),
        .PLLWAKESYNC(1'b0), .ENCLKOP(1'b0)
    );

    // 25 MHz / @bits_divide@ * @bits_feedback@ = @bits_mhz@ MHz; the oscillator runs @bits_output@ times as fast.
    wire bit_clock, bits_locked;
    (* FREQUENCY_PIN_CLKI = "25", FREQUENCY_PIN_CLKOP = "@bits_mhz@" *)
    (* ICP_CURRENT = "12", LPF_RESISTOR = "8", MFG_ENABLE_FILTEROPAMP = "1", MFG_GMCREF_SEL = "2" *)
    EHXPLLL #(
        .CLKI_DIV(@bits_divide@), .CLKFB_DIV(@bits_feedback@), .CLKOP_DIV(@bits_output@), .CLKOP_CPHASE(@bits_output@ / 2),
        .CLKOP_FPHASE(0), .CLKOP_ENABLE("ENABLED"), .FEEDBK_PATH("CLKOP"), .OUTDIVIDER_MUXA("DIVA"),
        .PLLRST_ENA("DISABLED"), .INTFB_WAKE("DISABLED"), .STDBY_ENABLE("DISABLED"), .DPHASE_SOURCE("DISABLED")
    ) bits_pll (
        .CLKI(clk_25mhz), .CLKFB(bit_clock), .CLKOP(bit_clock), .LOCK(bits_locked),
        .RST(1'b0), .STDBY(1'b0), .PHASESEL0(1'b0), .PHASESEL1(1'b0), .PHASEDIR(1'b1), .PHASESTEP(1'b1), .PHASELOADREG(1'b1),
        .PLLWAKESYNC(1'b0), .ENCLKOP(1'b0)
    );

    // Resets are registered: no logic stands before an asynchronous set.
    wire button;
    edof_debounce fire1 (.clock_i(core_clock), .line_i(btn_fire1), .level_o(button));
    wire core_locked_seen, calculator_locked_seen, bits_locked_seen;
    edof_sync #(.WIDTH(3)) locks (
        .clock_i(core_clock),
        .from_i({core_locked, calculator_locked, bits_locked}),
        .to_o({core_locked_seen, calculator_locked_seen, bits_locked_seen})
    );
    reg reset_q = 1'b1;
    reg calculator_reset_q = 1'b1;
    always @(posedge core_clock) begin
        reset_q <= button | !core_locked_seen;
        calculator_reset_q <= !calculator_locked_seen;
    end

    wire [5:0] states;
    assign led = {core_locked_seen & calculator_locked_seen & bits_locked_seen, 1'b0, states};
    assign wifi_gpio0 = 1'b1;

    // The SDRAM's clock is the core's inverted, by the same cell at the pin as the data: its edges are in the middle of what the pins say.
    ODDRX1F sdram_clock (.SCLK(core_clock), .RST(1'b0), .D0(1'b0), .D1(1'b1), .Q(sdram_clk));
    assign sdram_cke = 1'b1, sdram_csn = 1'b0;

    // A register at each of its pins.
    wire [19:0] to_sdram, at_sdram;
    wire [15:0] data_to, data_at, data_of, data_from;
    wire drive;
    assign {sdram_rasn, sdram_casn, sdram_wen, sdram_ba, sdram_a, sdram_dqm} = at_sdram;
    genvar i;
    generate
        for (i = 0; i < 20; i = i + 1) begin : control
            OFS1P3DX register (.SCLK(core_clock), .CD(1'b0), .SP(1'b1), .D(to_sdram[i]), .Q(at_sdram[i]));
        end
        for (i = 0; i < 16; i = i + 1) begin : data
            OFS1P3DX out (.SCLK(core_clock), .CD(1'b0), .SP(1'b1), .D(data_to[i]), .Q(data_at[i]));
            BB pad (.I(data_at[i]), .T(!drive), .O(data_of[i]), .B(sdram_d[i]));
            IFS1P3DX in (.SCLK(core_clock), .CD(1'b0), .SP(1'b1), .D(data_of[i]), .Q(data_from[i]));
        end
    endgenerate

    // The camera's clock is the board's. Its bytes change with the fall of its pixel clock, and the registers at their pins see them at its rise.
    ODDRX1F camera_clock (.SCLK(clk_25mhz), .RST(1'b0), .D0(1'b1), .D1(1'b0), .Q(camera_xclk));
    wire [9:0] from_camera;
    wire [9:0] of_camera = {camera_vsync, camera_href, camera_d};
    wire [1:0] camera_on, bus_low, bus_level;
    generate
        for (i = 0; i < 10; i = i + 1) begin : camera
            IFS1P3DX in (.SCLK(camera_pclk), .CD(1'b0), .SP(1'b1), .D(of_camera[i]), .Q(from_camera[i]));
        end
    endgenerate
    assign camera_pwdn = !camera_on[0], camera_resetn = camera_on[1];
    BB sioc_pad (.I(1'b0), .T(!bus_low[0]), .O(bus_level[0]), .B(camera_sioc));
    BB siod_pad (.I(1'b0), .T(!bus_low[1]), .O(bus_level[1]), .B(camera_siod));

    ulx3s_core core (
        .clock_i(core_clock), .calculator_clock_i(calculator_clock), .screen_clock_i(clk_25mhz), .bit_clock_i(bit_clock),
        .reset_i(reset_q), .calculator_reset_i(calculator_reset_q),
        .uart_receive_i(ftdi_txd), .uart_transmit_o(ftdi_rxd), .dvi_o(gpdi_dp), .leds_o(states),
        .camera_clock_i(camera_pclk), .camera_vs_i(from_camera[9]), .camera_href_i(from_camera[8]), .camera_data_i(from_camera[7:0]),
        .camera_on_o(camera_on), .camera_scl_i(bus_level[0]), .camera_sda_i(bus_level[1]), .camera_scl_low_o(bus_low[0]), .camera_sda_low_o(bus_low[1]),
        .sdram_command_o(to_sdram[19:17]), .sdram_bank_o(to_sdram[16:15]), .sdram_address_o(to_sdram[14:2]),
        .sdram_mask_o(to_sdram[1:0]), .sdram_data_out_o(data_to), .sdram_drive_o(drive), .sdram_data_in_i(data_from)
    );
endmodule
`default_nettype wire
