    localparam FRAMES = @frames@;
    localparam WIDTH = @width@;
    localparam HEIGHT = @height@;
    localparam PIXELS = WIDTH * HEIGHT;
    localparam HS_ON = WIDTH + @line_front@;
    localparam HS_OFF = HS_ON + @line_sync@;
    localparam COLUMNS = HS_OFF + @line_back@;
    localparam VS_ON = HEIGHT + @frame_front@;
    localparam VS_OFF = VS_ON + @frame_sync@;
    localparam ROWS = VS_OFF + @frame_back@;
    // Cycles of the slower of memory and calculator in a frame of the camera.
    localparam CYCLES = @cycles@;
    localparam [15:0] BLACK = 16'h@black@;

    reg [15:0] frames [0:FRAMES*PIXELS-1];
    reg [15:0] pictures [0:FRAMES*PIXELS-1];
    initial $readmemh("sim/frames.hex", frames);
    initial $readmemh("sim/pictures.hex", pictures);
