// The CRC (`edof_device::crc`) of every frame of beats that passes a boundary, and how many frames there were. It only looks: nothing waits for it.
// A snapshot copies the last whole frame's CRC and number to where they are shown, so that those of several boundaries belong together.
//
// From crates/edof-hdl/src/blocks/frame_check.rs (FrameCheck).
`default_nettype none

module frame_check_w32 #(
    parameter [27:0] LAST_BEAT = 28'd383
) (
    input  wire        clock_i,    // Clock.
    input  wire        reset_i,    // The next beat is a frame's first, and the first frame's.
    input  wire        valid_i,    // A beat passes in this cycle.
    input  wire [31:0] data_i,     // It.
    input  wire        snapshot_i, // Copies CRC and number.
    output wire [31:0] crc_o,      // CRC of the last frame that was whole when the snapshot was taken; 0 before.
    output wire [7:0]  frames_o    // Frames that were whole by then, modulo 256.
);

    wire [31:0] made_crc;
    reg  valid_q, fresh_q;
    reg  [27:0] left_q, left_d;
    reg  at_end_q, ends_q;
    reg  [31:0] whole_q;
    reg  [7:0] frames_q;
    reg  [31:0] shown_q;
    reg  [7:0] shown_frames_q;

    edof_crc #(.WIDTH(32)) made (
        .clock_i(clock_i), .valid_i(valid_q), .first_i(fresh_q), .data_i(data_i), .crc_o(made_crc)
    );

    always @* begin
        left_d = left_q;
        if (valid_q) begin
            left_d = left_q - 28'd1;
            if (at_end_q) begin
                left_d = LAST_BEAT;
            end
        end
        if (reset_i) begin
            left_d = LAST_BEAT;
        end
    end

    assign crc_o = shown_q;
    assign frames_o = shown_frames_q;

    always @(posedge clock_i) begin
        valid_q <= reset_i ? 1'b0 : valid_i;
        fresh_q <= reset_i ? 1'b1 : (valid_q ? at_end_q : fresh_q);
        left_q <= left_d;
        at_end_q <= reset_i ? 1'b0 : (valid_q ? (left_q == 28'd1) : at_end_q);
        ends_q <= reset_i ? 1'b0 : (valid_q && at_end_q);
        whole_q <= reset_i ? 32'd0 : (ends_q ? made_crc : whole_q);
        frames_q <= reset_i ? 8'd0 : (ends_q ? (frames_q + 8'd1) : frames_q);
        shown_q <= reset_i ? 32'd0 : (snapshot_i ? whole_q : shown_q);
        shown_frames_q <= reset_i ? 8'd0 : (snapshot_i ? frames_q : shown_frames_q);
    end
endmodule

`default_nettype wire
