// The stages of a design, I, each M, F: windows in, patches out. Where F has a linear path it takes the window with I.
// The outputs `between_*` show what passes between the stages, for observation; they cost nothing where they are left open.
//
// From crates/edof-hdl/src/blocks/chain.rs (Chain).
`default_nettype none

module chain (
    input  wire        clock_i,
    input  wire        reset_i,
    input  wire        window_valid_i,
    output wire        window_ready_o,
    input  wire [31:0] window_data_i,
    input  wire        window_last_i,
    input  wire        window_set_i,
    output wire        patch_valid_o,
    input  wire        patch_ready_i,
    output wire [31:0] patch_data_o,
    output wire        patch_last_o,
    output wire        patch_set_o,
    input  wire        write_valid_i,
    input  wire [24:0] write_address_i,
    input  wire [31:0] write_data_i,
    input  wire [5:0]  status_address_i,
    output wire [31:0] status_o,
    output wire        between_transfer_0_o,
    output wire        between_transfer_1_o,
    output wire        between_transfer_2_o,
    output wire [31:0] between_data_0_o,
    output wire [31:0] between_data_1_o,
    output wire [31:0] between_data_2_o,
    output wire [31:0] between_base_0_o,
    output wire [31:0] between_base_1_o,
    output wire [31:0] between_base_2_o,
    output wire        between_last_0_o,
    output wire        between_last_1_o,
    output wire        between_last_2_o,
    output wire        between_set_0_o,
    output wire        between_set_1_o,
    output wire        between_set_2_o
);

    reg  [31:0] shown;
    wire stages_0_valid;
    wire stages_0_ready;
    wire stages_0_window_ready_unused;
    wire stages_0_out_valid;
    wire [31:0] stages_0_status;
    wire stages_1_ready;
    wire stages_1_window_ready_unused;
    wire stages_1_out_valid;
    wire [31:0] stages_1_status;
    wire stages_2_ready;
    wire stages_2_window_ready_unused;
    wire stages_2_out_valid;
    wire [31:0] stages_2_status;
    wire stages_3_ready;
    wire stages_3_window_valid;
    wire stages_3_window_ready;
    wire [31:0] stages_3_out_base_unused;
    wire [31:0] stages_3_status;

    stage stages_0 (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .valid_i(stages_0_valid),
        .ready_o(stages_0_ready),
        .data_i(window_data_i),
        .base_i(32'd0),
        .last_i(window_last_i),
        .set_i(window_set_i),
        .window_valid_i(1'b0),
        .window_ready_o(stages_0_window_ready_unused),
        .window_data_i(32'd0),
        .window_last_i(1'b0),
        .out_valid_o(stages_0_out_valid),
        .out_ready_i(stages_1_ready),
        .out_data_o(between_data_0_o),
        .out_base_o(between_base_0_o),
        .out_last_o(between_last_0_o),
        .out_set_o(between_set_0_o),
        .write_valid_i(write_valid_i),
        .write_address_i(write_address_i),
        .write_data_i(write_data_i),
        .status_address_i(status_address_i),
        .status_o(stages_0_status)
    );

    stage_2 stages_1 (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .valid_i(stages_0_out_valid),
        .ready_o(stages_1_ready),
        .data_i(between_data_0_o),
        .base_i(between_base_0_o),
        .last_i(between_last_0_o),
        .set_i(between_set_0_o),
        .window_valid_i(1'b0),
        .window_ready_o(stages_1_window_ready_unused),
        .window_data_i(32'd0),
        .window_last_i(1'b0),
        .out_valid_o(stages_1_out_valid),
        .out_ready_i(stages_2_ready),
        .out_data_o(between_data_1_o),
        .out_base_o(between_base_1_o),
        .out_last_o(between_last_1_o),
        .out_set_o(between_set_1_o),
        .write_valid_i(write_valid_i),
        .write_address_i(write_address_i),
        .write_data_i(write_data_i),
        .status_address_i(status_address_i),
        .status_o(stages_1_status)
    );

    stage_3 stages_2 (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .valid_i(stages_1_out_valid),
        .ready_o(stages_2_ready),
        .data_i(between_data_1_o),
        .base_i(between_base_1_o),
        .last_i(between_last_1_o),
        .set_i(between_set_1_o),
        .window_valid_i(1'b0),
        .window_ready_o(stages_2_window_ready_unused),
        .window_data_i(32'd0),
        .window_last_i(1'b0),
        .out_valid_o(stages_2_out_valid),
        .out_ready_i(stages_3_ready),
        .out_data_o(between_data_2_o),
        .out_base_o(between_base_2_o),
        .out_last_o(between_last_2_o),
        .out_set_o(between_set_2_o),
        .write_valid_i(write_valid_i),
        .write_address_i(write_address_i),
        .write_data_i(write_data_i),
        .status_address_i(status_address_i),
        .status_o(stages_2_status)
    );

    stage_4 stages_3 (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .valid_i(stages_2_out_valid),
        .ready_o(stages_3_ready),
        .data_i(between_data_2_o),
        .base_i(between_base_2_o),
        .last_i(between_last_2_o),
        .set_i(between_set_2_o),
        .window_valid_i(stages_3_window_valid),
        .window_ready_o(stages_3_window_ready),
        .window_data_i(window_data_i),
        .window_last_i(window_last_i),
        .out_valid_o(patch_valid_o),
        .out_ready_i(patch_ready_i),
        .out_data_o(patch_data_o),
        .out_base_o(stages_3_out_base_unused),
        .out_last_o(patch_last_o),
        .out_set_o(patch_set_o),
        .write_valid_i(write_valid_i),
        .write_address_i(write_address_i),
        .write_data_i(write_data_i),
        .status_address_i(status_address_i),
        .status_o(stages_3_status)
    );

    assign stages_0_valid = window_valid_i && stages_3_window_ready;
    assign stages_3_window_valid = window_valid_i && stages_0_ready;
    assign window_ready_o = stages_0_ready && stages_3_window_ready;
    assign between_transfer_0_o = stages_0_out_valid && stages_1_ready;
    assign between_transfer_1_o = stages_1_out_valid && stages_2_ready;
    assign between_transfer_2_o = stages_2_out_valid && stages_3_ready;

    always @* begin
        shown = 32'd0;
        shown = shown | stages_0_status;
        shown = shown | stages_1_status;
        shown = shown | stages_2_status;
        shown = shown | stages_3_status;
    end

    assign status_o = shown;
endmodule

`default_nettype wire
