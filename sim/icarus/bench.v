`timescale 1ns / 1ns
// Reads a row of inputs, lets the outputs settle, writes them, and lets the clocks rise.
module edof_bench;
    reg clock;
    reg [@input_high@:0] inputs;
    wire [@output_high@:0] outputs;
    integer from, to, found;

    @top@ dut (
        @connections@
    );

    initial begin
        from = $fopen("@stimulus@", "r");
        to = $fopen("@outputs@", "w");
        clock = 1'b0;
        found = $fscanf(from, "%h\n", inputs);
        while (found == 1) begin
            #5 $fdisplay(to, "%b", outputs);
            clock = 1'b1;
            #5 clock = 1'b0;
            found = $fscanf(from, "%h\n", inputs);
        end
        $fclose(to);
        $finish(0);
    end
endmodule
