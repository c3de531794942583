// Functional model of an ECP5's carry cell (FPGA-TN-02200's slice in arithmetic mode), for simulators that have no model of Yosys': two LUTs of four inputs,
// the carry of each from the lower half of its lower table.
// verilator lint_off DECLFILENAME
// verilator lint_off WIDTH
module CCU2C (
    input CIN, A0, B0, C0, D0, A1, B1, C1, D1,
    output S0, S1, COUT
);
    parameter [15:0] INIT0 = 16'h0000, INIT1 = 16'h0000;
    parameter INJECT1_0 = "YES", INJECT1_1 = "YES";

    wire propagate_0 = INIT0[{D0, C0, B0, A0}];
    wire propagate_1 = INIT1[{D1, C1, B1, A1}];
    wire starts_0 = INJECT1_0 == "YES";
    wire starts_1 = INJECT1_1 == "YES";
    wire generate_0 = !starts_0 && INIT0[{2'b00, B0, A0}];
    wire generate_1 = !starts_1 && INIT1[{2'b00, B1, A1}];
    wire carry = propagate_0 ? CIN : generate_0;
    assign S0 = propagate_0 ^ (!starts_0 && CIN);
    assign S1 = propagate_1 ^ (!starts_1 && carry);
    assign COUT = propagate_1 ? carry : generate_1;
endmodule
