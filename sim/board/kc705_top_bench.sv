// The top of the board between models of its primitives: clocks at their periods, resets in their order, pixels in the middle of the
// transmitter's clock, and `id` over the UART's pins; then the memory controller loses its clock, and all begins anew. It ends with PASS, or
// with the first thing that is wrong.
`timescale 1ps / 1ps
`default_nettype none

module kc705_top_bench;
    // Periods in picoseconds, and a bit on the line.
    localparam real CORE = @core_ps@;
    localparam real CALCULATOR = @calculator_ps@;
    localparam real SCREEN = @screen_ps@;
    localparam real BIT = 1000000000000.0 / @baud@;

    reg oscillator = 1'b0;
    always #2500 oscillator = !oscillator;
    reg pixel_clock = 1'b0;
    always #6734 pixel_clock = !pixel_clock;

    reg button = 1'b0;
    reg to_board = 1'b1;
    wire from_board;
    wire [7:0] leds;
    wire tx_clock, hsync, vsync, de;
    wire [15:0] pixels;
    wire scl, sda, card_scl, card_sda;
    pullup (scl);
    pullup (sda);
    pullup (card_scl);
    pullup (card_sda);

    kc705_top top (
        .sysclk_p(oscillator),
        .sysclk_n(!oscillator),
        .cpu_reset(button),
        .leds(leds),
        .uart_rx(to_board),
        .uart_tx(from_board),
        .iic_scl(scl),
        .iic_sda(sda),
        .fmc_iic_scl(card_scl),
        .fmc_iic_sda(card_sda),
        .hdmi_rx_clk(pixel_clock),
        .hdmi_rx_data(16'd0),
        .hdmi_tx_clk(tx_clock),
        .hdmi_tx_hsync(hsync),
        .hdmi_tx_vsync(vsync),
        .hdmi_tx_de(de),
        .hdmi_tx_data(pixels)
    );

    task fail(input [8*60-1:0] what);
        begin
            $display("FAIL: %0s at %0t ps", what, $time);
            $fatal(1, "FAIL");
        end
    endtask

    // A reset is over only while its clock is locked; that of the calculator and the screen, after that of their MMCM.
    always @(top.reset_q) if (top.reset_q === 1'b0 && (!top.dram_locked || top.core_clock_reset)) fail("the core's reset is over before its clock is locked");
    always @(top.calculator_reset_q) if (top.calculator_reset_q === 1'b0 && (!top.calculator_locked)) fail("the calculator's reset is over before its clock is locked");
    always @(top.screen_reset_q) if (top.screen_reset_q === 1'b0 && (!top.screen_locked)) fail("the screen's reset is over before its clock is locked");
    always @(posedge top.core_clock_reset) begin
        repeat (6) @(posedge top.core_clock);
        if (!top.reset_q || !top.calculator_reset_q || !top.screen_reset_q) fail("a reset does not follow the memory controller's");
    end

    // The transmitter takes pixels with the rising edge of its clock: they are half a period old and stay for another half.
    real changed = 0.0;
    real taken = 0.0;
    always @(pixels or hsync or vsync or de) if (leds[7]) begin
        changed = $realtime;
        if (changed - taken < 0.4 * SCREEN) fail("pixels change less than 0.4 periods after the transmitter took them");
    end
    always @(posedge tx_clock) if (leds[7]) begin
        taken = $realtime;
        if (taken - changed < 0.4 * SCREEN) fail("pixels are less than 0.4 periods old when the transmitter takes them");
    end

    real since;
    task period_is(input real measured, input real expected, input [8*20-1:0] clock);
        if (measured < 0.9999 * expected || measured > 1.0001 * expected) begin
            $display("FAIL: %0s has a period of %0f ps, expected %0f", clock, measured, expected);
            $fatal(1, "FAIL");
        end
    endtask

    task clocks_are_right;
        begin
            @(posedge top.core_clock) since = $realtime;
            repeat (200) @(posedge top.core_clock);
            period_is(($realtime - since) / 200.0, CORE, "the core's clock");
            @(posedge top.calculator_clock) since = $realtime;
            repeat (200) @(posedge top.calculator_clock);
            period_is(($realtime - since) / 200.0, CALCULATOR, "the calculator's clock");
            @(posedge tx_clock) since = $realtime;
            repeat (200) @(posedge tx_clock);
            period_is(($realtime - since) / 200.0, SCREEN, "the screen's clock");
        end
    endtask

    integer i, k;
    task send(input [7:0] byte_);
        begin
            to_board = 1'b0;
            #(BIT);
            for (i = 0; i < 8; i = i + 1) begin
                to_board = byte_[i];
                #(BIT);
            end
            to_board = 1'b1;
            #(BIT);
        end
    endtask

    reg [31:0] answer;
    task id_is_read;
        begin
            fork
                begin
                    send(8'h02);
                    send(8'h01);
                    repeat (4) send(8'h00);
                end
                for (k = 0; k < 4; k = k + 1) begin : of_answer
                    integer n;
                    @(negedge from_board);
                    #(1.5 * BIT);
                    for (n = 0; n < 8; n = n + 1) begin
                        answer[8 * (3 - k) + n] = from_board;
                        #(BIT);
                    end
                    if (from_board !== 1'b1) fail("a byte from the board has no stop bit");
                end
            join
            if (answer !== 32'h45444f46) begin
                $display("FAIL: id is %h", answer);
                $fatal(1, "FAIL");
            end
        end
    endtask

    initial begin
        #(200 * CORE);
        wait (leds[7] === 1'b1);
        if (leds[0] !== 1'b0) fail("the memory is ready before it is calibrated");
        clocks_are_right;
        wait (leds[0] === 1'b1);
        id_is_read;
        // The controller loses its clock for a while.
        force top.dram.sys_rst = 1'b1;
        #(400 * CORE);
        if (leds[7] !== 1'b0 || !top.reset_q) fail("without the controller's clock the core is not held in reset");
        release top.dram.sys_rst;
        wait (leds[7] === 1'b1 && leds[0] === 1'b1);
        clocks_are_right;
        id_is_read;
        $display("PASS: clocks, resets, pixels and id, twice, in %0d us", $time / 1000000);
        $finish;
    end

    initial begin
        #(6000000000.0);
        fail("it hangs");
    end
endmodule

`default_nettype wire
