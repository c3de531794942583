// pair_store, whatever vectors come and whenever they are freed: a vector's descriptor comes three cycles after its last beat and says how many
// of its elements are kept; each kept element is read with its index at the place of its number, from the descriptor on until its slot is
// freed; ready is as docs/calculator.md says.
//
// Vectors have at most MOST beats. The prover chooses one place, slot and number, that is looked at in a run (one_row.v). What is kept is worked
// out two cycles after a beat came, as the circuit does it, so that its registers can be compared.
module prove #(
    parameter TWO_ROWS = 0,
    parameter MOST = 128
) (
    input wire        clock_i,
    input wire        reset_i,
    input wire        valid_i,
    input wire [15:0] even_i,
    input wire [15:0] odd_i,
    input wire        last_i,
    input wire        set_i,
    input wire [8:0]  read_row_i,
    input wire        finished_i
);
    (* anyconst *) wire skip;
    (* anyconst *) wire [1:0] slot;
    (* anyconst *) wire [7:0] number;
    wire [8:0] place = {slot, number[7:1]};
    wire ready, arrived;
    wire [11:0] descriptor;
    wire [24:0] even_pair, odd_pair;
    pair_store #(.DENSE(0), .TWO_ROWS(TWO_ROWS)) dut (
        .clock_i(clock_i), .reset_i(reset_i), .skip_zeros_i(skip), .valid_i(valid_i), .ready_o(ready), .even_i(even_i), .odd_i(odd_i),
        .last_i(last_i), .set_i(set_i), .arrived_o(arrived), .descriptor_o(descriptor), .read_row_i(read_row_i),
        .even_pair_o(even_pair), .odd_pair_o(odd_pair), .finished_i(finished_i)
    );
    (* hierconn *) wire [8:0] \dut.even_pairs.row , \dut.odd_pairs.row ;
    (* hierconn *) wire [24:0] \dut.even_pairs.word , \dut.odd_pairs.word , \dut.even_data_3_q , \dut.odd_data_3_q ;
    (* hierconn *) wire [11:0] \dut.even_row_3_q , \dut.odd_row_3_q ;
    (* hierconn *) wire \dut.even_write_3_q , \dut.odd_write_3_q ;
    (* hierconn *) wire [2:0] \dut.full_q ;
    (* hierconn *) wire [7:0] \dut.beat_q ;
    (* hierconn *) wire [8:0] \dut.stored_q ;
    (* hierconn *) wire [1:0] \dut.write_slot_q ;

    reg started = 0, was_reset = 1;
    // What came, by age; the beats of a vector that have come.
    reg valid_1 = 0, valid_2 = 0, last_1, last_2, set_1, set_2, set_3, ended_3 = 0;
    reg [15:0] even_1, even_2, odd_1, odd_2;
    reg [7:0] came = 0;
    wire comes = valid_i && ready;
    // The vector that is stored: its slot, its beats and its kept elements so far.
    reg [1:0] slot_in = 0;
    reg [7:0] beat = 0;
    reg [8:0] kept = 0, count_3;
    wire keep_even = !skip || even_2 != 0;
    wire keep_odd = !skip || odd_2 != 0;
    wire [8:0] kept_then = kept + keep_even + keep_odd;
    // What lies at the place that is looked at, and in the circuit.
    reg there = 0;
    reg [24:0] pair;
    wire write = number[0] ? \dut.odd_write_3_q && \dut.odd_row_3_q == place : \dut.even_write_3_q && \dut.even_row_3_q == place;
    wire [24:0] written = number[0] ? \dut.odd_data_3_q : \dut.even_data_3_q ;
    wire [24:0] word = write ? written : number[0] ? \dut.odd_pairs.word : \dut.even_pairs.word ;
    // Whole vectors: how many are inside and how many of them have arrived, the slot of the oldest.
    reg [2:0] held = 0, whole = 0;
    reg [1:0] oldest = 0;
    wire [1:0] age = slot - oldest;
    wire readable = age < whole;
    wire [2:0] stored = whole + ended_3;
    // A read of the place, by age.
    reg [1:0] reads = 0;
    reg [24:0] pair_1, pair_2;

    wire none = count_3 == 0;
    wire one_step = count_3 == 1 || (TWO_ROWS && count_3 == 2);
    wire [7:0] steps = none ? 0 : TWO_ROWS ? (count_3 + 1) / 2 - 1 : count_3 - 1;
    always @(posedge clock_i) begin
        started <= 1;
        was_reset <= reset_i;
        assume (started || reset_i);
        assume (\dut.even_pairs.row == place && \dut.odd_pairs.row == place);
        assume (!valid_i || came != MOST - 1 || last_i);
        // A vector is freed after it has arrived.
        assume (!finished_i || whole != 0);

        if (reset_i) {valid_1, valid_2, ended_3, came, slot_in, beat, kept, there, held, whole, oldest, reads} <= 0;
        else begin
            {valid_2, valid_1} <= {valid_1, comes};
            if (comes) came <= last_i ? 0 : came + 1;
            if (valid_2) begin
                beat <= last_2 ? 0 : beat + 1;
                kept <= last_2 ? 0 : kept_then;
                slot_in <= slot_in + last_2;
                if (slot_in == slot) begin
                    there <= (there && beat != 0) || (kept <= number && number < kept_then);
                    if (keep_even && kept == number) pair <= {beat, 1'b0, even_2};
                    else if (keep_odd && kept + keep_even == number) pair <= {beat, 1'b1, odd_2};
                end
            end
            ended_3 <= valid_2 && last_2;
            held <= held + (comes && last_i) - finished_i;
            whole <= stored - finished_i;
            oldest <= oldest + finished_i;
            reads <= {reads[0], readable && there && read_row_i == place};
        end
        {last_2, last_1, even_2, even_1, odd_2, odd_1} <= {last_1, last_i, even_1, even_i, odd_1, odd_i};
        {set_3, set_2, set_1} <= {set_2, set_1, set_i};
        {pair_2, pair_1} <= {pair_1, pair};
        count_3 <= kept_then;

        if (started && !was_reset && !reset_i) begin
            room: assert ($past(was_reset) || ready == (held < 4));
            in_time: assert (arrived == ended_3);
            what: assert (!arrived || descriptor == {steps, none || one_step, none, none || count_3[0], set_3});
            if (reads[1]) found: assert ((number[0] ? odd_pair : even_pair) == pair_2);
        end
        if (started) begin
            // What the circuit's registers hold; from these the rest follows in a few cycles.
            counts: assert (\dut.full_q == held && \dut.beat_q == beat && \dut.stored_q == kept && \dut.write_slot_q == slot_in);
            inside: assert (held <= 4 && whole <= held && !(ready && held == 4) && held == stored + (valid_2 && last_2) + (valid_1 && last_1));
            in_turn: assert (slot_in == oldest + stored[1:0]);
            beats: assert (kept <= 2 * beat && beat < MOST && came < MOST);
            so_far: assert (came == (valid_1 && last_1 ? 0 : valid_2 && last_2 ? valid_1 : beat + valid_2 + valid_1));
            holds: assert (!there || word == pair);
        end
        full: cover (!was_reset && held == 4 && reads[1] && number == 3 && pair_2[16:0] == 17'h10001);
        empty: cover (arrived && none);
    end
endmodule
