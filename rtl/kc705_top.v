// The KC705: pins, clocks, the DRAM controller, and kc705_core between them.
//
// sysclk (200 MHz) feeds the DRAM controller (MIG, made by build.tcl from mig.prj) and nothing else. The controller's user clock of
// @core_mhz@ MHz is that of memory and host, and feeds two MMCMs: one makes the calculator's clock of @calculator_mhz@ MHz, one the screen's of
// @screen_mhz@ MHz. The HDMI receiver brings its own clock. The figures of the MMCMs follow from the design.
//
// Resets: the controller's ui_clk_sync_rst resets both MMCMs and the core; an MMCM that is not locked resets the domain of its clock alone.
// cpu_reset, debounced, resets the core. Nothing resets the controller but the configuration of the FPGA.
//
// LEDs: 0 the DRAM is calibrated; 1 video comes in, blinking where a cable is in and nothing comes; 2 it has the design's size; 3 pictures
// leave; 4 all video chips are set up; 5 a set-up failed; 6 a screen is plugged in; 7 the clocks of calculator and
// screen are locked.
`default_nettype none
module kc705_top (
    input wire sysclk_p, input wire sysclk_n, input wire cpu_reset,
    output wire [7:0] leds, output wire fan_pwm,
    input wire uart_rx, output wire uart_tx,
    inout wire iic_scl, inout wire iic_sda, output wire iic_mux_reset_n,
    inout wire fmc_iic_scl, inout wire fmc_iic_sda, output wire fmc_iic_reset_n,
    input wire hdmi_rx_clk, input wire [15:0] hdmi_rx_data,
    output wire hdmi_tx_clk, output wire hdmi_tx_hsync, output wire hdmi_tx_vsync, output wire hdmi_tx_de,
    output wire [15:0] hdmi_tx_data,
    output wire [13:0] ddr3_addr, output wire [2:0] ddr3_ba, output wire ddr3_ras_n, output wire ddr3_cas_n,
    output wire ddr3_we_n, output wire [0:0] ddr3_ck_p, output wire [0:0] ddr3_ck_n, output wire [0:0] ddr3_cke,
    output wire [0:0] ddr3_cs_n, output wire [7:0] ddr3_dm, output wire [0:0] ddr3_odt, output wire ddr3_reset_n,
    inout wire [63:0] ddr3_dq, inout wire [7:0] ddr3_dqs_p, inout wire [7:0] ddr3_dqs_n
);
    // Clocks. The controller's user clock feeds all that are made here: a second load on the oscillator's buffer may not be placed.
    wire sysclk;
    IBUFDS sysclk_in (.I(sysclk_p), .IB(sysclk_n), .O(sysclk));

    wire input_clock;
    BUFG input_clock_buffer (.I(hdmi_rx_clk), .O(input_clock));

    wire core_clock, core_clock_reset, dram_locked, dram_ready;

    // @core_mhz@ MHz / @calculator_divide@ * @calculator_multiply@ / @calculator_output@ = @calculator_mhz@ MHz.
    wire calculator_feedback, calculator_unbuffered, calculator_clock, calculator_locked;
    MMCME2_BASE #(
        .CLKIN1_PERIOD(@core_period@), .DIVCLK_DIVIDE(@calculator_divide@), .CLKFBOUT_MULT_F(@calculator_multiply@),
        .CLKOUT0_DIVIDE_F(@calculator_output@)
    ) calculator_mmcm (
        .CLKIN1(core_clock), .CLKFBIN(calculator_feedback), .CLKFBOUT(calculator_feedback), .CLKOUT0(calculator_unbuffered),
        .LOCKED(calculator_locked), .PWRDWN(1'b0), .RST(core_clock_reset)
    );
    BUFG calculator_clock_buffer (.I(calculator_unbuffered), .O(calculator_clock));

    // @core_mhz@ MHz / @screen_divide@ * @screen_multiply@ / @screen_output@ = @screen_mhz@ MHz.
    wire screen_feedback, screen_unbuffered, screen_clock, screen_locked;
    MMCME2_BASE #(
        .CLKIN1_PERIOD(@core_period@), .DIVCLK_DIVIDE(@screen_divide@), .CLKFBOUT_MULT_F(@screen_multiply@),
        .CLKOUT0_DIVIDE_F(@screen_output@)
    ) screen_mmcm (
        .CLKIN1(core_clock), .CLKFBIN(screen_feedback), .CLKFBOUT(screen_feedback), .CLKOUT0(screen_unbuffered),
        .LOCKED(screen_locked), .PWRDWN(1'b0), .RST(core_clock_reset)
    );
    BUFG screen_clock_buffer (.I(screen_unbuffered), .O(screen_clock));

    // Resets. Those of the MMCMs are not made of their locks. Those of the core are registered: no logic stands before an asynchronous set.
    wire button;
    edof_debounce cpu_reset_button (.clock_i(core_clock), .line_i(cpu_reset), .level_o(button));
    wire dram_locked_seen, calculator_locked_seen, screen_locked_seen;
    edof_sync #(.WIDTH(3)) locks (
        .clock_i(core_clock), .from_i({dram_locked, calculator_locked, screen_locked}),
        .to_o({dram_locked_seen, calculator_locked_seen, screen_locked_seen})
    );
    reg reset_q = 1'b1, calculator_reset_q = 1'b1, screen_reset_q = 1'b1;
    always @(posedge core_clock) begin
        reset_q <= core_clock_reset | button | !dram_locked_seen;
        calculator_reset_q <= !calculator_locked_seen;
        screen_reset_q <= !screen_locked_seen;
    end

    // Pixels: registered in the pads, the transmitter's clock half a period later.
    (* IOB = "TRUE" *) reg [15:0] input_data_q;
    always @(posedge input_clock) input_data_q <= hdmi_rx_data;

    wire screen_hs, screen_vs, screen_de;
    wire [15:0] screen_data;
    (* IOB = "TRUE" *) reg hsync_q, vsync_q, de_q;
    (* IOB = "TRUE" *) reg [15:0] data_q;
    always @(posedge screen_clock) begin
        hsync_q <= screen_hs;
        vsync_q <= screen_vs;
        de_q <= screen_de;
        data_q <= screen_data;
    end
    assign hdmi_tx_hsync = hsync_q, hdmi_tx_vsync = vsync_q, hdmi_tx_de = de_q, hdmi_tx_data = data_q;
    ODDR #(.DDR_CLK_EDGE("SAME_EDGE")) screen_clock_out (
        .C(screen_clock), .CE(1'b1), .D1(1'b0), .D2(1'b1), .R(1'b0), .S(1'b0), .Q(hdmi_tx_clk)
    );

    // I2C: lines are driven low or left alone.
    wire [1:0] scl, sda, scl_low, sda_low;
    IOBUF iic_scl_pad (.I(1'b0), .O(scl[0]), .T(!scl_low[0]), .IO(iic_scl));
    IOBUF iic_sda_pad (.I(1'b0), .O(sda[0]), .T(!sda_low[0]), .IO(iic_sda));
    IOBUF fmc_iic_scl_pad (.I(1'b0), .O(scl[1]), .T(!scl_low[1]), .IO(fmc_iic_scl));
    IOBUF fmc_iic_sda_pad (.I(1'b0), .O(sda[1]), .T(!sda_low[1]), .IO(fmc_iic_sda));
    assign iic_mux_reset_n = !button, fmc_iic_reset_n = !button;

    wire [6:0] states;
    assign leds = {calculator_locked_seen & screen_locked_seen, states};
    assign fan_pwm = 1'b1;

    // Memory.
    wire        aw_id, aw_valid, aw_ready, w_last, w_valid, w_ready, b_id, b_valid, b_ready;
    wire        ar_id, ar_valid, ar_ready, r_id, r_last, r_valid, r_ready;
    wire [31:0] aw_addr, ar_addr;
    wire [7:0]  aw_len, ar_len;
    wire [2:0]  aw_size, ar_size;
    wire [1:0]  aw_burst, b_resp, ar_burst, r_resp;
    wire [511:0] w_data, r_data;
    wire [63:0] w_strb;

    // The controller's reset of its AXI side follows its user clock.
    reg axi_reset_n_q = 1'b0;
    always @(posedge core_clock) axi_reset_n_q <= !core_clock_reset;

    mig_kc705 dram (
        .sys_clk_i(sysclk), .sys_rst(1'b0), .ui_clk(core_clock), .ui_clk_sync_rst(core_clock_reset),
        .mmcm_locked(dram_locked), .aresetn(axi_reset_n_q), .init_calib_complete(dram_ready),
        .app_sr_req(1'b0), .app_ref_req(1'b0), .app_zq_req(1'b0), .app_sr_active(), .app_ref_ack(), .app_zq_ack(),
        .device_temp(),
        .s_axi_awid(aw_id), .s_axi_awaddr(aw_addr[29:0]), .s_axi_awlen(aw_len), .s_axi_awsize(aw_size),
        .s_axi_awburst(aw_burst), .s_axi_awlock(1'b0), .s_axi_awcache(4'd0), .s_axi_awprot(3'd0), .s_axi_awqos(4'd0),
        .s_axi_awvalid(aw_valid), .s_axi_awready(aw_ready),
        .s_axi_wdata(w_data), .s_axi_wstrb(w_strb), .s_axi_wlast(w_last), .s_axi_wvalid(w_valid),
        .s_axi_wready(w_ready),
        .s_axi_bid(b_id), .s_axi_bresp(b_resp), .s_axi_bvalid(b_valid), .s_axi_bready(b_ready),
        .s_axi_arid(ar_id), .s_axi_araddr(ar_addr[29:0]), .s_axi_arlen(ar_len), .s_axi_arsize(ar_size),
        .s_axi_arburst(ar_burst), .s_axi_arlock(1'b0), .s_axi_arcache(4'd0), .s_axi_arprot(3'd0), .s_axi_arqos(4'd0),
        .s_axi_arvalid(ar_valid), .s_axi_arready(ar_ready),
        .s_axi_rid(r_id), .s_axi_rdata(r_data), .s_axi_rresp(r_resp), .s_axi_rlast(r_last), .s_axi_rvalid(r_valid),
        .s_axi_rready(r_ready),
        .ddr3_addr(ddr3_addr), .ddr3_ba(ddr3_ba), .ddr3_ras_n(ddr3_ras_n), .ddr3_cas_n(ddr3_cas_n),
        .ddr3_we_n(ddr3_we_n), .ddr3_ck_p(ddr3_ck_p), .ddr3_ck_n(ddr3_ck_n), .ddr3_cke(ddr3_cke),
        .ddr3_cs_n(ddr3_cs_n), .ddr3_dm(ddr3_dm), .ddr3_odt(ddr3_odt), .ddr3_reset_n(ddr3_reset_n), .ddr3_dq(ddr3_dq),
        .ddr3_dqs_p(ddr3_dqs_p), .ddr3_dqs_n(ddr3_dqs_n)
    );

    kc705_core core (
        .clock_i(core_clock), .calculator_clock_i(calculator_clock), .input_clock_i(input_clock),
        .screen_clock_i(screen_clock), .reset_i(reset_q), .calculator_reset_i(calculator_reset_q),
        .screen_reset_i(screen_reset_q),
        .input_data_i(input_data_q), .screen_hs_o(screen_hs), .screen_vs_o(screen_vs), .screen_de_o(screen_de),
        .screen_data_o(screen_data),
        .dram_ready_i(dram_ready), .uart_receive_i(uart_rx), .uart_transmit_o(uart_tx),
        .scl_0_i(scl[0]), .scl_1_i(scl[1]), .sda_0_i(sda[0]), .sda_1_i(sda[1]), .scl_low_0_o(scl_low[0]),
        .scl_low_1_o(scl_low[1]), .sda_low_0_o(sda_low[0]), .sda_low_1_o(sda_low[1]),
        .leds_o(states),
        .dram_write_aw_id_o(aw_id), .dram_write_aw_addr_o(aw_addr), .dram_write_aw_len_o(aw_len),
        .dram_write_aw_size_o(aw_size), .dram_write_aw_burst_o(aw_burst), .dram_write_aw_valid_o(aw_valid),
        .dram_write_aw_ready_i(aw_ready),
        .dram_write_w_data_o(w_data), .dram_write_w_strb_o(w_strb), .dram_write_w_last_o(w_last),
        .dram_write_w_valid_o(w_valid), .dram_write_w_ready_i(w_ready),
        .dram_write_b_id_i(b_id), .dram_write_b_resp_i(b_resp), .dram_write_b_valid_i(b_valid),
        .dram_write_b_ready_o(b_ready),
        .dram_read_ar_id_o(ar_id), .dram_read_ar_addr_o(ar_addr), .dram_read_ar_len_o(ar_len),
        .dram_read_ar_size_o(ar_size), .dram_read_ar_burst_o(ar_burst), .dram_read_ar_valid_o(ar_valid),
        .dram_read_ar_ready_i(ar_ready),
        .dram_read_r_id_i(r_id), .dram_read_r_data_i(r_data), .dram_read_r_resp_i(r_resp),
        .dram_read_r_last_i(r_last), .dram_read_r_valid_i(r_valid), .dram_read_r_ready_o(r_ready)
    );
endmodule
`default_nettype wire
