//! Constants that follow from others: Rust and the printed formulas give the same numbers.

use edof_verilog::describe::{Circuit, kernel};
use edof_verilog::{EmitError, Fault, emit};
use edof_verilog_diff::{Check, check, harness};
use rust_hdl::prelude::*;

/// What is added to its input: numbers that follow from others.
#[derive(Circuit)]
#[circuit(registers(clock))]
struct Derived {
    pub clock: Signal<In, Clock>,
    pub x: Signal<In, Bits<16>>,
    pub select: Signal<In, Bits<3>>,
    pub y: Signal<Out, Bits<16>>,
    lanes: Constant<Bits<16>>,
    codes: Constant<Bits<16>>,
    shrinks: Constant<Bit>,
    #[is(lanes / 2 - 1)]
    half: Constant<Bits<9>>,
    #[is(if codes > lanes { codes % lanes } else { 3 * codes })]
    rest: Constant<Bits<16>>,
    #[is(2 * (codes / lanes) * (half + rest))]
    rows: Constant<Bits<24>>,
    #[is(if shrinks { codes + 3 * lanes } else { 0 })]
    kept: Constant<Bits<13>>,
    #[is(codes == lanes)]
    is_whole: Constant<Bit>,
    y_q: DFF<Bits<16>>,
}

impl Derived {
    fn new(lanes: u64, codes: u64, shrinks: bool) -> Self {
        let [lanes, codes] = [lanes, codes].map(|number| Constant::new(number.into()));
        Self::from_parts(DerivedParts { lanes, codes, shrinks: Constant::new(shrinks) })
    }
}

impl Logic for Derived {
    #[kernel]
    fn update(&mut self) {
        self.y_q.d.next = self.x.val() + bit_cast::<16, 9>(self.half.val());
        if self.select.val() == 1 {
            self.y_q.d.next = self.x.val() + self.rest.val();
        }
        if self.select.val() == 2 {
            self.y_q.d.next = self.x.val() + self.rows.val().get_bits::<16>(0);
        }
        if self.select.val() == 3 {
            self.y_q.d.next = self.x.val() + self.rows.val().get_bits::<16>(8);
        }
        if self.select.val() == 4 {
            self.y_q.d.next = self.x.val() + bit_cast::<16, 13>(self.kept.val());
        }
        if self.select.val() == 5 && self.is_whole.val() {
            self.y_q.d.next = self.x.val();
        }
        if self.select.val() == 6 && self.shrinks.val() {
            self.y_q.d.next = self.x.val();
        }
        self.y.next = self.y_q.q.val();
    }
}

/// Three of them, with one module.
#[derive(Circuit)]
struct Three {
    pub clock: Signal<In, Clock>,
    pub x: Signal<In, Bits<16>>,
    pub select: Signal<In, Bits<3>>,
    pub first: Signal<Out, Bits<16>>,
    pub second: Signal<Out, Bits<16>>,
    pub third: Signal<Out, Bits<16>>,
    parts: [Derived; 3],
}

impl Logic for Three {
    #[kernel]
    fn update(&mut self) {
        for i in 0..3 {
            self.parts[i].clock.next = self.clock.val();
            self.parts[i].x.next = self.x.val();
            self.parts[i].select.next = self.select.val();
        }
        self.first.next = self.parts[0].y.val();
        self.second.next = self.parts[1].y.val();
        self.third.next = self.parts[2].y.val();
    }
}

/// Random numbers, from a small generator.
fn numbers(seed: u64) -> impl FnMut(u64) -> u64 {
    let mut state = seed + 1;
    move |below| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state % below
    }
}

fn three(seed: u64) -> Three {
    let mut next = numbers(seed);
    let mut part = || {
        let lanes = 2 + next(700);
        let codes = if next(4) == 0 { lanes } else { 1 + next(1000) };
        Derived::new(lanes, codes, next(2) == 1)
    };
    Three::from_parts(ThreeParts { parts: [part(), part(), part()] })
}

#[test]
fn formulas_of_random_constants_agree_in_rust_verilator_and_icarus() {
    let harness = harness!(Three, clock; x, select);
    for seed in 0..4 {
        check(&|| three(seed), &harness, &Check { cycles: 200, ..Check::default() }).unwrap();
    }
}

#[test]
fn a_module_has_the_primary_constants_as_parameters_and_derives_the_others() {
    let parts = [Derived::new(64, 192, true), Derived::new(96, 192, true), Derived::new(64, 128, false)];
    let mut circuit = Three::from_parts(ThreeParts { parts });
    circuit.connect_all();
    let emitted = emit(&circuit).unwrap();
    assert_eq!(emitted.modules.len(), 2);
    let text = &emitted.modules[0].text;
    assert_eq!(text.matches("parameter ").count(), 3, "{text}");
    for line in [
        " HALF = LANES / 2 - 1",
        " REST = CODES > LANES ? CODES % LANES : 3 * CODES",
        " ROWS = 2 * (CODES / LANES) * (HALF + REST)",
        " KEPT = SHRINKS ? CODES + 3 * LANES : 0",
        " IS_WHOLE = CODES == LANES",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
}

/// A memory of as many words as it says.
#[derive(Circuit)]
struct Memory {
    pub clock: Signal<In, Clock>,
    pub y: Signal<Out, Bits<8>>,
    _words: usize,
}

impl Logic for Memory {
    fn update(&mut self) {}

    fn connect(&mut self) {
        self.y.connect();
    }

    fn hdl(&self) -> Verilog {
        let text = "module words #(parameter DEPTH = 1) (input wire clock_i, output reg [7:0] y_o);\n  \
            always @(posedge clock_i) y_o <= DEPTH;\nendmodule\n";
        let leaf = edof_verilog::leaf::Leaf::new("words", text).parameter("DEPTH", self._words);
        leaf.port("clock_i", "clock").port("y_o", "y").verilog()
    }
}

/// A memory for twice as many codes.
#[derive(Circuit)]
struct Holder {
    pub clock: Signal<In, Clock>,
    pub y: Signal<Out, Bits<8>>,
    codes: Constant<Bits<16>>,
    #[is(DEPTH = 2 * codes)]
    memory: Memory,
}

impl Logic for Holder {
    #[kernel]
    fn update(&mut self) {
        self.memory.clock.next = self.clock.val();
        self.y.next = self.memory.y.val();
    }
}

fn holder(codes: u64, words: usize) -> Result<String, EmitError> {
    let memory = Memory::from_parts(MemoryParts { _words: words });
    let mut holder = Holder::from_parts(HolderParts { codes: Constant::new(codes.into()), memory });
    holder.connect_all();
    emit(&holder).map(|emitted| emitted.modules[0].text.clone())
}

#[test]
fn a_parameter_of_a_leaf_follows_from_a_constant_and_another_value_is_rejected() {
    let text = holder(24, 48).unwrap();
    assert!(text.contains(" CODES = 24") && text.contains(".DEPTH(2 * CODES)"), "{text}");
    let error = holder(24, 47).unwrap_err();
    assert!(matches!(error.fault, Fault::Formula { value: 48, .. }), "{error}");
    assert!(error.to_string().contains("the leaf has DEPTH(47), and `2 * codes` is 48"), "{error}");
}

/// Two constants of eight bits that the kernel reads, and a memory of as many words as their product.
#[derive(Circuit)]
struct Narrow {
    pub clock: Signal<In, Clock>,
    pub x: Signal<In, Bits<8>>,
    pub y: Signal<Out, Bits<8>>,
    a: Constant<Bits<8>>,
    b: Constant<Bits<8>>,
    #[is(DEPTH = a * b)]
    memory: Memory,
}

impl Logic for Narrow {
    #[kernel]
    fn update(&mut self) {
        self.memory.clock.next = self.clock.val();
        self.y.next = self.memory.y.val() + (self.x.val() ^ self.a.val() ^ self.b.val());
    }
}

#[test]
fn a_parameter_that_verilog_computes_in_too_few_bits_is_rejected() {
    let [a, b] = [200_u64, 100].map(|number| Constant::new(number.into()));
    let memory = Memory::from_parts(MemoryParts { _words: 20_000 });
    let mut narrow = Narrow::from_parts(NarrowParts { a, b, memory });
    narrow.connect_all();
    assert!(matches!(emit(&narrow).unwrap_err().fault, Fault::NarrowFormula(text) if text == "a * b"));
}

#[test]
#[should_panic(expected = "below 0")]
fn a_step_below_zero_is_no_number() {
    let _ = Derived::new(1, 1, false);
}
