// The calculator against recorded windows and the patches that they must become. Needs nothing but this directory: start it there.
//
// Windows come and patches are taken with random pauses. It ends with PASS, or with the first word that is wrong.
`default_nettype none

module edof_bench;
    localparam WINDOWS = @windows@;
    localparam WINDOW_BEATS = @window_beats@;
    localparam PATCH_BEATS = @patch_beats@;
    localparam LIMIT = @limit@;

    reg clock = 1'b0;
    always #1 clock = !clock;

    reg [31:0] windows [0:WINDOWS*WINDOW_BEATS-1];
    reg [31:0] patches [0:WINDOWS*PATCH_BEATS-1];
    initial $readmemh("sim/windows.hex", windows);
    initial $readmemh("sim/patches.hex", patches);

    // Reset rises after the start: a block that waits for a change of its inputs must see one.
    reg reset = 1'b0;
    reg window_valid = 1'b0;
    wire window_ready;
    integer sent = 0;
    wire patch_valid, patch_last;
    wire [31:0] patch_data;
    reg patch_ready = 1'b0;
    integer taken = 0;
    integer cycle = 0;
    // A shift register with feedback: the pauses are the same in every simulator.
    reg [31:0] lot = 32'h1234_5678;

    chain dut (
        @ports@
    );

    always @(posedge clock) begin
        cycle <= cycle + 1;
        lot <= {lot[30:0], lot[31] ^ lot[21] ^ lot[1] ^ lot[0]};
        reset <= cycle >= 4 && cycle < 64;
        patch_ready <= lot[3:0] != 4'd0;
        if (cycle > 64) begin
            if (!window_valid || window_ready) window_valid <= (sent + (window_valid ? 1 : 0) < WINDOWS * WINDOW_BEATS) && (lot[6:4] != 3'd0);
            if (window_valid && window_ready) sent <= sent + 1;
            if (patch_valid && patch_ready) begin
                if (patch_data !== patches[taken] || patch_last !== (taken % PATCH_BEATS == PATCH_BEATS - 1))
                    $fatal(1, "FAIL: patch %0d, beat %0d: expected %h, got %h", taken / PATCH_BEATS, taken % PATCH_BEATS,
                        patches[taken], patch_data);
                taken <= taken + 1;
                if (taken + 1 == WINDOWS * PATCH_BEATS) begin
                    $display("PASS: %0d patches in %0d cycles", WINDOWS, cycle);
                    $finish;
                end
            end
        end
        if (cycle == LIMIT) $fatal(1, "FAIL: %0d of %0d words after %0d cycles", taken, WINDOWS * PATCH_BEATS, cycle);
    end
endmodule

`default_nettype wire
