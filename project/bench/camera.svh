    // The camera begins behind a picture, so that the first frame has its sync before it.
    integer frame = -1;
    integer column = 0;
    integer row = HEIGHT;
    reg input_hs = 1'b0;
    reg input_vs = 1'b0;
    reg input_de = 1'b0;
    reg [15:0] input_data = 16'd0;
    wire ends = column == COLUMNS - 1;
    always @(posedge input_clock) if (running > 400) begin
        column <= ends ? 0 : column + 1;
        if (ends) row <= row == ROWS - 1 ? 0 : row + 1;
        if (ends && row == ROWS - 1 && frame < FRAMES - 1) frame <= frame + 1;
        input_hs <= column >= HS_ON && column < HS_OFF;
        // A frame's sync begins and ends with that of a line.
        if (column == HS_ON) input_vs <= row >= VS_ON && row < VS_OFF;
        input_de <= row < HEIGHT && column < WIDTH;
        input_data <= row < HEIGHT && column < WIDTH ? frames[frame*PIXELS + row*WIDTH + column] : 16'h5a5a;
    end
