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
