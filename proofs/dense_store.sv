// dense_store, whenever vectors come and are freed: a vector's descriptor comes three cycles after its last beat; each beat is read at its place
// in its part, from the descriptor on until its slot is freed; ready is as docs/calculator.md says.
//
// Vectors have two parts of two beats, and are whole (window_guard). The prover chooses one place, slot and beat, that is looked at in a run
// (one_row.v).
module prove (
    input wire        clock_i,
    input wire        reset_i,
    input wire        valid_i,
    input wire [31:0] data_i,
    input wire        last_i,
    input wire        set_i,
    input wire [8:0]  read_row_i,
    input wire        finished_i
);
    (* anyconst *) wire [1:0] slot, number;
    wire [8:0] place = {slot, 6'd0, number[0]};
    wire ready, arrived;
    wire [11:0] descriptor;
    wire [31:0] pair_a, pair_b;
    dense_store #(.DENSE(1)) dut (
        .clock_i(clock_i), .reset_i(reset_i), .valid_i(valid_i), .ready_o(ready), .data_i(data_i), .last_i(last_i), .set_i(set_i),
        .arrived_o(arrived), .descriptor_o(descriptor), .read_row_i(read_row_i), .pair_a_o(pair_a), .pair_b_o(pair_b), .finished_i(finished_i)
    );
    (* hierconn *) wire [8:0] \dut.parts_0.row , \dut.parts_1.row ;
    (* hierconn *) wire [31:0] \dut.parts_0.word , \dut.parts_1.word ;
    (* hierconn *) wire [2:0] \dut.full_q ;
    (* hierconn *) wire [6:0] \dut.row_q ;
    (* hierconn *) wire [1:0] \dut.part_q , \dut.write_slot_q ;

    reg started = 0, was_reset = 1;
    // What came, a cycle later; beats of the vector that comes.
    reg valid_1 = 0, last_1, ended_2 = 0, ended_3 = 0, set_1, set_2, set_3;
    reg [31:0] data_1;
    reg [1:0] came = 0;
    wire comes = valid_i && ready;
    // The vector that is stored.
    reg [1:0] slot_in = 0, beat = 0;
    // What lies at the place that is looked at.
    reg there = 0;
    reg [31:0] pair, pair_1, pair_2;
    // Whole vectors: how many are inside and how many of them have arrived, the slot of the oldest. A read of the place, by age.
    reg [2:0] held = 0, whole = 0;
    reg [1:0] oldest = 0, reads = 0;
    wire [1:0] age = slot - oldest;
    wire readable = age < whole;
    wire [2:0] stored = whole + ended_3 + ended_2;
    always @(posedge clock_i) begin
        started <= 1;
        was_reset <= reset_i;
        assume (started || reset_i);
        assume (\dut.parts_0.row == place && \dut.parts_1.row == place);
        assume (!valid_i || last_i == (came == 3));
        // A vector is freed after it has arrived.
        assume (!finished_i || whole != 0);

        if (reset_i) {valid_1, ended_2, ended_3, came, slot_in, beat, there, held, whole, oldest, reads} <= 0;
        else begin
            valid_1 <= comes;
            came <= came + comes;
            if (valid_1) begin
                beat <= beat + 1;
                slot_in <= slot_in + last_1;
                if (slot_in == slot && beat == number) begin
                    there <= 1;
                    pair <= data_1;
                end
            end
            {ended_3, ended_2} <= {ended_2, valid_1 && last_1};
            held <= held + (comes && last_i) - finished_i;
            whole <= whole + ended_3 - finished_i;
            oldest <= oldest + finished_i;
            reads <= {reads[0], readable && there && read_row_i == place};
        end
        {last_1, data_1} <= {last_i, data_i};
        {set_3, set_2, set_1} <= {set_2, set_1, set_i};
        {pair_2, pair_1} <= {pair_1, pair};

        if (started && !was_reset && !reset_i) begin
            room: assert ($past(was_reset) || ready == (held < 4));
            in_time: assert (arrived == ended_3);
            what: assert (!arrived || descriptor == {8'd31, 3'd0, set_3});
            if (reads[1]) found: assert ((number[1] ? pair_b : pair_a) == pair_2);
        end
        if (started) begin
            // What the circuit's registers hold; from these the rest follows in a few cycles.
            counts: assert (\dut.full_q == held && \dut.part_q == beat[1] && \dut.row_q == beat[0] && \dut.write_slot_q == slot_in);
            inside: assert (held <= 4 && whole <= held && !(ready && held == 4) && held == stored + (valid_1 && last_1));
            in_turn: assert (slot_in == oldest + stored[1:0]);
            so_far: assert (came == beat + valid_1 && (!valid_1 || last_1 == (beat == 3)));
            holds: assert (!there || (number[1] ? \dut.parts_1.word : \dut.parts_0.word ) == pair);
        end
        full: cover (!was_reset && held == 4 && reads[1] && number == 3 && pair_2 == 1);
    end
endmodule
