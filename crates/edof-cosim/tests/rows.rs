//! What stands together in the text of a module: wires and the instance that reads them, short instances, names that are given to outputs, registers
//! that are cleared, the two values of a choice.

use crate::testbench::emit;
use edof_hdl::blocks::delay::Delay;
use edof_verilog::describe::Circuit;
use rust_hdl::prelude::*;

/// Waits for two sums.
#[derive(Circuit)]
#[circuit(default(Delay), registers(clock, reset))]
struct Rows {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub left: Signal<In, Bits<4>>,
    pub right: Signal<In, Bits<4>>,
    pub both: Signal<Out, Bits<4>>,
    pub newest: Signal<Out, Bits<4>>,
    pub high: Signal<Out, Bits<2>>,
    pub is_equal: Signal<Out, Bit>,
    sum: Signal<Local, Bits<4>>,
    level_of_both_sides: Delay<4, 2>,
    level_of_both_sides_before: Delay<4, 3>,
    newest_q: DFF<Bits<4>>,
    #[reset(0)]
    highest: DFF<Bits<4>>,
    #[reset(3)]
    spare: DFF<Bits<4>>,
    #[reset(false)]
    is_full: DFF<Bit>,
}

impl Logic for Rows {
    #[hdl_gen]
    fn update(&mut self) {
        self.level_of_both_sides.clock.next = self.clock.val();
        self.level_of_both_sides_before.clock.next = self.clock.val();
        self.sum.next = self.left.val() + self.right.val();
        self.level_of_both_sides.data.next = self.sum.val();
        self.level_of_both_sides_before.data.next = self.level_of_both_sides.delayed.val();
        self.newest_q.d.next = self.sum.val();
        self.both.next = self.level_of_both_sides_before.delayed.val() ^ self.left.val();
        self.newest.next = self.newest_q.q.val();
        self.high.next = self.newest_q.q.val().get_bits::<2>(2);
        self.is_equal.next = self.left.val() == self.right.val();
        self.highest.d.next = self.left.val();
        if self.left.val() < self.right.val() {
            self.highest.d.next = self.right.val();
        }
        self.is_full.d.next = self.highest.q.val() == self.spare.q.val();
        self.spare.d.next = self.spare.q.val() - 1;
        if self.is_full.q.val() {
            self.highest.d.next = 0.into();
            self.spare.d.next = 0.into();
        }
    }
}

#[test]
fn what_belongs_together_stands_together() {
    let text = &emit(&mut Rows::default()).modules[0].text;
    for words in [
        // Silence says that no path leads through; this one has one.
        "\n// Within the cycle: left_i -> both_o\n// Within the cycle: left_i, right_i -> is_equal_o\n// From ",
        "  input wire clock_i, input wire reset_i,\n  input wire [3:0] left_i,\n",
        "
  wire [3:0] sum = left_i + right_i;
  wire [3:0] level_of_both_sides_delayed;
  edof_delay #(.WIDTH(4), .CYCLES(2))
    level_of_both_sides (.clock_i(clock_i), .data_i(sum), .data_o(level_of_both_sides_delayed));
  wire [3:0] level_of_both_sides_before_delayed;
  edof_delay #(.WIDTH(4), .CYCLES(3)) level_of_both_sides_before (
    .clock_i(clock_i), .data_i(level_of_both_sides_delayed), .data_o(level_of_both_sides_before_delayed)
  );
",
        "  assign newest_o = newest_q, high_o = newest_q[3:2];\n  assign is_equal_o = left_i == right_i;\n",
        "    highest_q <= (left_i < right_i) ? right_i : left_i;\n",
        "    if (is_full_q) {highest_q, spare_q} <= 0;\n",
        "    if (reset_i) begin\n      {highest_q, is_full_q} <= 0;\n      spare_q <= 4'd3;\n    end\n",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
}
