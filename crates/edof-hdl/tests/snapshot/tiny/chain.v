// The stages of a design, I, each M, F: windows in, patches out. Where F has a linear path it takes the window with I.
// The outputs `between_*` show what stands between the stages, for observation; they cost nothing where they are left open.
//
// From crates/edof-hdl/src/blocks/chain.rs (Chain).
`default_nettype none

module chain (
    input  wire        clock_i,           // Clock.
    input  wire        reset_i,           // Forgets every vector; held for 48 cycles or more, and two more pass until something can be taken.
    input  wire        window_valid_i,    // Two pixels of a window stand on the input.
    output wire        window_ready_o,    // They are taken in this cycle, if there are any.
    input  wire [31:0] window_data_i,     // They, the even one low.
    input  wire        window_last_i,     // Whether they are their window's last.
    input  wire        window_set_i,      // The set of weights for this window.
    output wire        patch_valid_o,     // Two words of a patch stand on the output.
    input  wire        patch_ready_i,     // The receiver takes them.
    output wire [31:0] patch_data_o,      // They.
    output wire        patch_last_o,      // Whether they are their patch's last.
    output wire        patch_set_o,       // The set that it was made with.
    input  wire        write_valid_i,     // A word is to be written (`edof_spec::design::memory::address`).
    input  wire [24:0] write_address_i,   // Where.
    input  wire [31:0] write_data_i,      // What.
    input  wire [5:0]  status_address_i,  // Stage (4 bits) and counter (2 bits) to show.
    output wire [31:0] status_o,          // The counter, a cycle later.
    output wire        between_valid_0_o, // This stage offers a beat to the next (observation only).
    output wire        between_valid_1_o,
    output wire        between_valid_2_o,
    output wire        between_ready_0_o, // The next takes it.
    output wire        between_ready_1_o,
    output wire        between_ready_2_o,
    output wire [31:0] between_data_0_o,  // Its two words.
    output wire [31:0] between_data_1_o,
    output wire [31:0] between_data_2_o,
    output wire [31:0] between_base_0_o,  // Their base words.
    output wire [31:0] between_base_1_o,
    output wire [31:0] between_base_2_o,
    output wire        between_last_0_o,  // Whether it is its vector's last.
    output wire        between_last_1_o,
    output wire        between_last_2_o,
    output wire        between_set_0_o,   // The vector's set.
    output wire        between_set_1_o,
    output wire        between_set_2_o
);

    wire [31:0] shown;
    wire stages_0_valid, stages_0_ready, stages_0_window_ready_unused;
    wire [31:0] stages_0_status;
    wire stages_1_window_ready_unused;
    wire [31:0] stages_1_status;
    wire stages_2_window_ready_unused;
    wire [31:0] stages_2_status;
    wire stages_3_window_valid, stages_3_window_ready;
    wire [31:0] stages_3_out_base_unused, stages_3_status;

    stage_i stages_0 (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .valid_i(stages_0_valid),
        .ready_o(stages_0_ready),
        .data_i(window_data_i),
        .last_i(window_last_i),
        .set_i(window_set_i),
        .window_ready_o(stages_0_window_ready_unused),
        .out_valid_o(between_valid_0_o),
        .out_ready_i(between_ready_0_o),
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

    stage_m stages_1 (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .valid_i(between_valid_0_o),
        .ready_o(between_ready_0_o),
        .data_i(between_data_0_o),
        .base_i(between_base_0_o),
        .last_i(between_last_0_o),
        .set_i(between_set_0_o),
        .window_ready_o(stages_1_window_ready_unused),
        .out_valid_o(between_valid_1_o),
        .out_ready_i(between_ready_1_o),
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

    stage_m_last stages_2 (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .valid_i(between_valid_1_o),
        .ready_o(between_ready_1_o),
        .data_i(between_data_1_o),
        .base_i(between_base_1_o),
        .last_i(between_last_1_o),
        .set_i(between_set_1_o),
        .window_ready_o(stages_2_window_ready_unused),
        .out_valid_o(between_valid_2_o),
        .out_ready_i(between_ready_2_o),
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

    stage_f stages_3 (
        .clock_i(clock_i),
        .reset_i(reset_i),
        .valid_i(between_valid_2_o),
        .ready_o(between_ready_2_o),
        .data_i(between_data_2_o),
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
    assign shown = stages_0_status | stages_1_status | stages_2_status | stages_3_status;
    assign status_o = shown;
endmodule

`default_nettype wire
