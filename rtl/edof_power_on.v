// Distinguishes the first reset of a domain from later ones: first_o is high from configuration until reset_i falls for the first time.
`default_nettype none
module edof_power_on (
    input  wire clock_i,
    input  wire reset_i,
    output wire first_o
);
    reg was_q = 1'b0;
    reg first_q = 1'b1;

    always @(posedge clock_i) begin
        was_q <= reset_i;
        if (was_q && !reset_i) first_q <= 1'b0;
    end

    assign first_o = first_q;
endmodule
`default_nettype wire
