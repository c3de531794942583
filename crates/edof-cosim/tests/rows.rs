//! What stands together in the text of a module: wires and the instance that reads them, short instances, names that are given to outputs.

use crate::testbench::emit;
use edof_hdl::blocks::delay::Delay;
use edof_verilog::describe::Circuit;
use rust_hdl::prelude::*;

/// Waits for two sums.
#[derive(Circuit)]
#[circuit(default(Delay), registers(clock))]
struct Rows {
    pub clock: Signal<In, Clock>,
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
    }
}

#[test]
fn what_belongs_together_stands_together() {
    let text = &emit(&mut Rows::default()).modules[0].text;
    for words in [
        // Silence says that no path leads through; this one has one.
        "\n// Within the cycle: left_i -> both_o\n// Within the cycle: left_i, right_i -> is_equal_o\n// From ",
        "  input wire clock_i,\n  input wire [3:0] left_i,\n",
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
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
}
