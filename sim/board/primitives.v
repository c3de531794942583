// What kc705_top stands on, as far as its clocks, resets and pads show it (UG472, UG471, UG586): models to be simulated, not the vendor's.
`timescale 1ps / 1ps
`default_nettype none

module IBUFDS (input wire I, input wire IB, output wire O);
    assign O = I;
    always @(I) #1 if (I === IB) begin
        $display("FAIL: both halves of a differential pair are %b", I);
        $fatal(1, "FAIL");
    end
endmodule

module BUFG (input wire I, output wire O);
    assign O = I;
endmodule

module IOBUF (input wire I, output wire O, input wire T, inout wire IO);
    assign IO = T ? 1'bz : I;
    assign O = IO;
endmodule

// SAME_EDGE: both data are taken at the rising edge; D1 leaves with it, D2 with the falling one.
module ODDR #(parameter DDR_CLK_EDGE = "OPPOSITE_EDGE") (
    input wire C, input wire CE, input wire D1, input wire D2, input wire R, input wire S, output reg Q
);
    reg later_q;
    initial if (DDR_CLK_EDGE != "SAME_EDGE") $fatal(1, "FAIL: an ODDR of mode %0s", DDR_CLK_EDGE);
    always @(posedge C) if (CE) begin
        Q <= R ? 1'b0 : S ? 1'b1 : D1;
        later_q <= R ? 1'b0 : S ? 1'b1 : D2;
    end
    always @(negedge C) if (CE) Q <= later_q;
endmodule

// Locks some cycles after its reset; before that its clock runs wild. It rejects what the FPGA cannot do: an input of another period than its parameter states, and an oscillator outside of 600 to 1440 MHz or a phase detector outside of 10 to 500 MHz (DS182, speed grade -2).
module MMCME2_BASE #(
    parameter real CLKIN1_PERIOD = 0.0,
    parameter integer DIVCLK_DIVIDE = 1,
    parameter real CLKFBOUT_MULT_F = 5.0,
    parameter real CLKOUT0_DIVIDE_F = 1.0
) (
    input wire CLKIN1,
    input wire CLKFBIN,
    output wire CLKFBOUT,
    output wire CLKOUT0,
    output wire LOCKED,
    input wire PWRDWN,
    input wire RST
);
    localparam integer LOCK_CYCLES = 100;
    real detector, oscillator, period, now;
    initial begin
        detector = 1000.0 / CLKIN1_PERIOD / DIVCLK_DIVIDE;
        oscillator = detector * CLKFBOUT_MULT_F;
        period = 1000000.0 / oscillator * CLKOUT0_DIVIDE_F;
        if (detector < 10.0 || detector > 500.0 || oscillator < 600.0 || oscillator > 1440.0) begin
            $display("FAIL: %m: phase detector at %0f MHz, oscillator at %0f MHz", detector, oscillator);
            $fatal(1, "FAIL");
        end
    end

    integer cycles = 0;
    real last = 0.0;
    always @(posedge CLKIN1 or posedge RST) begin
        now = $realtime;
        if (RST) cycles <= 0;
        else begin
            if (cycles > 2 && ((now - last) / 1000.0 > 1.01 * CLKIN1_PERIOD || (now - last) / 1000.0 < 0.99 * CLKIN1_PERIOD)) begin
                $display("FAIL: %m: an input period of %0f ps, stated are %0f ns", now - last, CLKIN1_PERIOD);
                $fatal(1, "FAIL");
            end
            if (cycles < LOCK_CYCLES && CLKFBIN === CLKFBOUT) cycles <= cycles + 1;
        end
        last = now;
    end
    assign LOCKED = cycles == LOCK_CYCLES && !RST && !PWRDWN;
    assign CLKFBOUT = CLKIN1;

    reg made = 1'b0;
    integer wild = 7;
    always begin
        if (RST || PWRDWN) begin
            made = 1'b0;
            #1000;
        end else begin
            // Before it locks: any period from a half to twice of what is asked for.
            wild = (wild * 75 + 74) % 65537;
            #(LOCKED ? period / 2.0 : period * (0.25 + wild / 87000.0)) made = !made;
        end
    end
    assign CLKOUT0 = made;
endmodule

// The memory controller as far as its clock and its resets: the user clock runs from the start, is locked later, and the memory is
// ready later still. Nothing is stored.
module mig_kc705 (
    input wire sys_clk_i,
    input wire sys_rst,
    output wire ui_clk,
    output reg ui_clk_sync_rst,
    output reg mmcm_locked,
    input wire aresetn,
    output reg init_calib_complete,
    input wire app_sr_req,
    input wire app_ref_req,
    input wire app_zq_req,
    output wire app_sr_active,
    output wire app_ref_ack,
    output wire app_zq_ack,
    output wire [11:0] device_temp,
    input wire [0:0] s_axi_awid, input wire [29:0] s_axi_awaddr, input wire [7:0] s_axi_awlen, input wire [2:0] s_axi_awsize,
    input wire [1:0] s_axi_awburst, input wire [0:0] s_axi_awlock, input wire [3:0] s_axi_awcache, input wire [2:0] s_axi_awprot,
    input wire [3:0] s_axi_awqos, input wire s_axi_awvalid, output wire s_axi_awready,
    input wire [511:0] s_axi_wdata, input wire [63:0] s_axi_wstrb, input wire s_axi_wlast, input wire s_axi_wvalid, output wire s_axi_wready,
    output wire [0:0] s_axi_bid, output wire [1:0] s_axi_bresp, output wire s_axi_bvalid, input wire s_axi_bready,
    input wire [0:0] s_axi_arid, input wire [29:0] s_axi_araddr, input wire [7:0] s_axi_arlen, input wire [2:0] s_axi_arsize,
    input wire [1:0] s_axi_arburst, input wire [0:0] s_axi_arlock, input wire [3:0] s_axi_arcache, input wire [2:0] s_axi_arprot,
    input wire [3:0] s_axi_arqos, input wire s_axi_arvalid, output wire s_axi_arready,
    output wire [0:0] s_axi_rid, output wire [511:0] s_axi_rdata, output wire [1:0] s_axi_rresp, output wire s_axi_rlast,
    output wire s_axi_rvalid, input wire s_axi_rready,
    output wire [13:0] ddr3_addr, output wire [2:0] ddr3_ba, output wire ddr3_ras_n, output wire ddr3_cas_n, output wire ddr3_we_n,
    output wire [0:0] ddr3_ck_p, output wire [0:0] ddr3_ck_n, output wire [0:0] ddr3_cke, output wire [0:0] ddr3_cs_n,
    output wire [7:0] ddr3_dm, output wire [0:0] ddr3_odt, output wire ddr3_reset_n,
    inout wire [63:0] ddr3_dq, inout wire [7:0] ddr3_dqs_p, inout wire [7:0] ddr3_dqs_n
);
    assign ui_clk = sys_clk_i;
    integer cycle = 0;
    initial {ui_clk_sync_rst, mmcm_locked, init_calib_complete} = 3'b100;
    always @(posedge ui_clk) begin
        cycle <= sys_rst ? 0 : cycle + 1;
        mmcm_locked <= cycle > 40;
        ui_clk_sync_rst <= cycle < 60;
        init_calib_complete <= cycle > 2000 && aresetn;
    end
    assign {app_sr_active, app_ref_ack, app_zq_ack, device_temp} = 0;
    assign {s_axi_awready, s_axi_wready, s_axi_bid, s_axi_bresp, s_axi_bvalid} = 0;
    assign {s_axi_arready, s_axi_rid, s_axi_rdata, s_axi_rresp, s_axi_rlast, s_axi_rvalid} = 0;
    assign {ddr3_addr, ddr3_ba, ddr3_ras_n, ddr3_cas_n, ddr3_we_n, ddr3_ck_p, ddr3_ck_n, ddr3_cke, ddr3_cs_n, ddr3_dm, ddr3_odt} = 0;
    assign ddr3_reset_n = 1'b0;
endmodule

`default_nettype wire
