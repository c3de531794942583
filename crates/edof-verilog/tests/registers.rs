//! `#[circuit(registers(…))]` says once what a kernel says three times.

use edof_verilog::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Counts enabled cycles down from a start.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
struct Short {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub enable: Signal<In, Bit>,
    pub left: Signal<Out, Bits<4>>,
    pub seen: Signal<Out, Bits<4>>,
    start: Constant<Bits<4>>,
    #[reset(start)]
    count: DFF<Bits<4>>,
    #[reset(false)]
    enable_q: DFF<Bit>,
    last: DFF<Bits<4>>,
}

impl Logic for Short {
    #[kernel]
    fn update(&mut self) {
        self.enable_q.d.next = self.enable.val();
        if self.enable_q.q.val() {
            self.count.d.next = self.count.q.val() - 1;
            self.last.d.next = self.count.q.val();
        }
        self.left.next = self.count.q.val();
        self.seen.next = self.last.q.val();
    }
}

/// Counts enabled cycles down from a start.
#[derive(Circuit)]
struct Long {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub enable: Signal<In, Bit>,
    pub left: Signal<Out, Bits<4>>,
    pub seen: Signal<Out, Bits<4>>,
    start: Constant<Bits<4>>,
    count: DFF<Bits<4>>,
    enable_q: DFF<Bit>,
    last: DFF<Bits<4>>,
}

impl Logic for Long {
    #[kernel]
    fn update(&mut self) {
        dff_setup!(self, clock, count, enable_q, last);
        self.enable_q.d.next = self.enable.val();
        if self.enable_q.q.val() {
            self.count.d.next = self.count.q.val() - 1;
            self.last.d.next = self.count.q.val();
        }
        self.left.next = self.count.q.val();
        self.seen.next = self.last.q.val();
        if self.reset.val() {
            self.count.d.next = self.start.val();
            self.enable_q.d.next = false;
        }
    }
}

fn short() -> Short {
    Short::from_parts(ShortParts { start: Constant::new(9.into()) })
}

/// The Verilog without comments.
fn text(circuit: &mut dyn Circuit) -> Vec<String> {
    circuit.connect_all();
    let text = edof_verilog::emit(circuit).unwrap().modules[0].text.clone();
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim_end());
    code.filter(|line| !line.is_empty()).map(|line| line.replace("short", "long")).collect()
}

#[test]
fn derived_registers_are_the_verilog_that_a_kernel_writes_by_hand() {
    let long = Long::from_parts(LongParts { start: Constant::new(9.into()) });
    let (short, long) = (text(&mut { short() }), text(&mut { long }));
    assert!(short.iter().any(|line| line.contains("count_q <= START")), "{short:#?}");
    assert_eq!(short, long);
}

#[test]
fn derived_registers_hold_and_are_reset_in_simulation() {
    let mut circuit = short();
    circuit.connect_all();
    let mut seen = vec![];
    for (reset, enable) in
        [(true, true), (true, true), (false, true), (false, true), (false, false), (false, false)]
    {
        for level in [false, true] {
            circuit.clock.next = level.into();
            circuit.reset.next = reset;
            circuit.enable.next = enable;
            for _ in 0..8 {
                circuit.update_all();
            }
        }
        seen.push(circuit.left.val().to_u64());
    }
    assert_eq!(seen, [9, 9, 9, 8, 7, 7]);
}
