// A host at the core of edof_core_bench: it carries out the steps of sim/steps.hex one after the other and ends with PASS, or with the first
// register that is not as expected. What the other bench does with the screen's pixels is off.
//
// A step is four words, the highest first: what, byte address, mask, word. 0 writes the word; 1 reads and expects it; 2 waits that number of cycles;
// 3 reads until it comes; 4 reads until it is another one than at the last step of this kind.
`default_nettype none

module edof_check_bench;
    localparam STEPS = @steps@;
    // Reads of one step after which the core hangs.
    localparam PATIENCE = 100000;

    edof_core_bench bench ();
    wire clock = bench.clock;

    reg [127:0] steps [0:STEPS-1];
    initial $readmemh("sim/steps.hex", steps);

    reg asks = 1'b0;
    reg tells = 1'b0;
    reg reads = 1'b0;
    reg [31:0] address = 32'd0;
    reg [31:0] word = 32'd0;
    initial begin
        force bench.screen_de = 1'b0;
        force bench.dut.host_aw_valid_i = asks;
        force bench.dut.host_aw_addr_i = address;
        force bench.dut.host_w_valid_i = tells;
        force bench.dut.host_w_data_i = word;
        force bench.dut.host_b_ready_i = 1'b1;
        force bench.dut.host_ar_valid_i = reads;
        force bench.dut.host_ar_addr_i = address;
        force bench.dut.host_r_ready_i = 1'b1;
    end

    reg [31:0] found = 32'd0;
    reg [31:0] last = 32'd0;
    reg [31:0] mask, expected;
    integer step, tries;

    task write;
        begin
            asks <= 1'b1;
            tells <= 1'b1;
            @(posedge clock);
            while (asks || tells) begin
                if (bench.dut.host_aw_ready_o) asks <= 1'b0;
                if (bench.dut.host_w_ready_o) tells <= 1'b0;
                @(posedge clock);
            end
            while (!bench.dut.host_b_valid_o) @(posedge clock);
            if (bench.dut.host_b_resp_o !== 2'd0) begin
                $display("FAIL: step %0d: address %h takes no word", step, address);
                $fatal(1, "FAIL");
            end
        end
    endtask

    task read;
        begin
            reads <= 1'b1;
            @(posedge clock);
            while (!bench.dut.host_ar_ready_o) @(posedge clock);
            reads <= 1'b0;
            @(posedge clock);
            while (!bench.dut.host_r_valid_o) @(posedge clock);
            found = bench.dut.host_r_data_o & mask;
            tries = tries + 1;
            if (tries == PATIENCE) begin
                $display("FAIL: step %0d: address %h stays %h", step, address, found);
                $fatal(1, "FAIL");
            end
        end
    endtask

    initial begin
        while (bench.cycle < 600) @(posedge clock);
        for (step = 0; step < STEPS; step = step + 1) begin
            address = steps[step][95:64];
            mask = steps[step][63:32];
            expected = steps[step][31:0];
            word = expected;
            tries = 0;
            case (steps[step][127:96])
                32'd0: write;
                32'd1: begin
                    read;
                    if (found !== expected) begin
                        $display("FAIL: step %0d: address %h is %h, expected %h", step, address, found, expected);
                        $fatal(1, "FAIL");
                    end
                end
                32'd2: repeat (expected) @(posedge clock);
                32'd3: begin
                    read;
                    while (found !== expected) read;
                end
                default: begin
                    read;
                    while (found === last) read;
                    last = found;
                end
            endcase
        end
        $display("PASS: %0d steps in %0d cycles", STEPS, bench.cycle);
        $finish;
    end
endmodule

`default_nettype wire
