//! Real kernels, one for each thing that a kernel can say: rust-hdl's own simulation, Icarus and Verilator agree, and
//! Verilator has nothing to say against the text.

use std::process::Command;

use crate::testbench::{BOTH, Random, emit, run};
use edof_hdl::verilog::Emitted;
use edof_verilog::describe::Circuit;
use rust_hdl::core::simulate::simulate;
use rust_hdl::prelude::*;

/// A signed number of `bits` bits from its pattern.
fn signed_value(pattern: u128, bits: usize) -> i64 {
    ((pattern << (128 - bits)) as i128 >> (128 - bits)) as i64
}

/// What `verilator --lint-only -Wall` says.
fn lint(emitted: &Emitted) -> String {
    let folder = tempfile::tempdir().unwrap();
    for module in &emitted.modules {
        std::fs::write(folder.path().join(module.name.clone() + ".v"), &module.text).unwrap();
    }
    let top = emitted.top.clone();
    let mut command = Command::new("verilator");
    command.current_dir(folder.path()).args([
        "--lint-only",
        "-Wall",
        "--top-module",
        &top,
        &(top.clone() + ".v"),
    ]);
    String::from_utf8_lossy(&command.output().unwrap().stderr).into_owned()
}

/// Compares all three from the second row on; the first resets.
pub fn agree(emitted: &Emitted, rows: &[Vec<u128>], want: &[Vec<u128>]) {
    for simulator in BOTH {
        let found = run(emitted, simulator, rows);
        for (n, (found, want)) in found.iter().zip(want).enumerate().skip(1) {
            assert_eq!(
                found,
                want,
                "{simulator:?}, row {n}: {:x?}\n{}",
                rows[n],
                emitted.modules.last().unwrap().text
            );
        }
    }
    let said = lint(emitted);
    assert!(said.is_empty(), "{said}");
}

#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Mode {
    Add,
    Swap,
    Clear,
}

#[derive(Copy, Clone, Debug, Default, PartialEq, LogicStruct)]
struct Pixel {
    level: Bits<8>,
    offset: Bits<4>,
    last: Bit,
}

/// Everything that a kernel can compute.
#[derive(Circuit)]
struct Operators {
    pub a: Signal<In, Bits<8>>,
    pub b: Signal<In, Bits<8>>,
    pub n: Signal<In, Bits<3>>,
    pub wide: Signal<In, Bits<48>>,
    pub p: Signal<In, Bits<16>>,
    pub q: Signal<In, Bits<16>>,
    pub x: Signal<In, Signed<16>>,
    pub y: Signal<In, Signed<16>>,
    pub flag: Signal<In, Bit>,
    pub array: [Signal<In, Bits<4>>; 6],
    pub mode: Signal<In, Bits<2>>,
    pub sums: Signal<Out, Bits<8>>,
    pub logic: Signal<Out, Bits<8>>,
    pub shifts: Signal<Out, Bits<48>>,
    pub one_hot: Signal<Out, Bits<64>>,
    pub product: Signal<Out, Bits<32>>,
    pub signed_product: Signal<Out, Signed<48>>,
    pub signed_sums: Signal<Out, Signed<16>>,
    pub narrow: Signal<Out, Signed<8>>,
    pub compares: Signal<Out, Bits<8>>,
    pub truth: Signal<Out, Bit>,
    pub reduced: Signal<Out, Bits<3>>,
    pub window: Signal<Out, Bits<8>>,
    pub fixed_window: Signal<Out, Bits<12>>,
    pub replaced: Signal<Out, Bits<8>>,
    pub field: Signal<Out, Bits<12>>,
    pub total: Signal<Out, Bits<8>>,
    pub chosen: Signal<Out, Bits<8>>,
    pub steps: Signal<Out, Bits<8>>,
    state: Signal<Local, Mode>,
    bits: Signal<Local, Bits<8>>,
    some: Signal<Local, Bits<3>>,
    pixel: Signal<Local, Pixel>,
    step: Signal<Local, Bits<8>>,
    limit: Constant<Bits<8>>,
    below: Constant<Signed<16>>,
}

impl Default for Operators {
    fn default() -> Self {
        Self::from_parts(OperatorsParts {
            limit: Constant::new(100.into()),
            below: Constant::new((-300).into()),
        })
    }
}

impl Logic for Operators {
    #[hdl_gen]
    fn update(&mut self) {
        self.sums.next = self.a.val() + self.b.val() - 3 + (1 + self.a.val());
        self.logic.next = (self.a.val() & self.b.val()) | (self.a.val() ^ 0x5a) & !self.b.val();
        self.shifts.next =
            (self.wide.val() << self.n.val()) ^ (self.wide.val() >> self.a.val()) ^ (self.wide.val() >> 5);
        self.one_hot.next = 1 << self.a.val();
        self.product.next = self.p.val() * self.q.val() + bit_cast::<32, 16>(self.p.val());
        self.signed_product.next =
            signed_bit_cast::<48, 32>(self.x.val() * self.y.val()) - signed_bit_cast::<48, 16>(self.x.val());
        self.signed_sums.next = -self.x.val() + (self.y.val() - (-7).into());
        self.narrow.next = signed_cast(self.p.val().get_bits::<8>(4)) - 1.into();
        // Comparisons of either sign, and a mask before one.
        self.bits.next = 0.into();
        self.bits.next = self.bits.val().replace_bit(0, self.x.val() > self.below.val());
        self.bits.next = self.bits.val().replace_bit(1, self.x.val() <= self.y.val());
        self.bits.next = self.bits.val().replace_bit(2, self.a.val() < self.limit.val());
        self.bits.next = self.bits.val().replace_bit(3, self.a.val() >= self.b.val());
        self.bits.next = self.bits.val().replace_bit(4, unsigned_cast(self.x.val()) != self.p.val());
        self.bits.next = self.bits.val().replace_bit(7, self.a.val() & 3 == 2);
        self.compares.next = self.bits.val();
        self.truth.next =
            self.flag.val() && !self.a.val().get_bit(3) || self.wide.val().get_bit(self.n.val().index());
        self.some.next = 0.into();
        self.some.next = self.some.val().replace_bit(0, self.a.val().all());
        self.some.next = self.some.val().replace_bit(1, self.b.val().any());
        self.some.next = self.some.val().replace_bit(2, (self.a.val() + self.b.val()).xor());
        self.reduced.next = self.some.val();
        self.window.next = self.a.val().get_bits::<8>(self.n.val().index());
        self.fixed_window.next = (self.wide.val() + 1).get_bits::<12>(40);
        self.replaced.next = self.b.val().replace_bit(self.n.val().index(), self.flag.val());
        self.pixel.next.level = self.a.val();
        self.pixel.next.offset = self.b.val().get_bits::<4>(2);
        self.pixel.next.last = self.flag.val();
        self.field.next = bit_cast::<12, 8>(self.pixel.val().level);
        if self.pixel.val().offset < 7 {
            self.field.next = bit_cast::<12, 1>(self.pixel.val().last.into()) << 9;
        }
        self.step.next = 0.into();
        for i in 0..3 {
            self.step.next = self.step.val() + self.array[2 * i + 1].val().get_bits::<8>(0);
        }
        self.total.next = self.step.val()
            + bit_cast::<8, 4>(self.array[0].val() ^ self.array[2].val() ^ self.array[4].val());
        self.state.next = Mode::Add;
        if self.mode.val() == 1 {
            self.state.next = Mode::Swap;
        } else if self.mode.val() == 2 {
            self.state.next = Mode::Clear;
        }
        match self.state.val() {
            Mode::Add => self.chosen.next = self.a.val() + self.b.val(),
            Mode::Swap => {
                self.chosen.next = (self.a.val() << 4) | (self.a.val() >> 4);
            }
            Mode::Clear => {
                self.chosen.next = 0.into();
            }
        }
        self.step.next = self.a.val() + 1;
        if (self.step.val() + self.b.val()).get_bit(7) {
            self.step.next = bit_cast::<8, 9>(bit_cast::<9, 8>(self.step.val() + self.b.val()) >> 1);
        }
        self.steps.next = self.step.val() - 1;
    }
}

impl Operators {
    /// Sets the inputs from a row.
    fn set(&mut self, row: &[u128]) {
        self.a.next = (row[0] as u64).into();
        self.b.next = (row[1] as u64).into();
        self.n.next = (row[2] as u64).into();
        self.wide.next = (row[3] as u64).into();
        self.p.next = (row[4] as u64).into();
        self.q.next = (row[5] as u64).into();
        self.x.next = signed_value(row[6], 16).into();
        self.y.next = signed_value(row[7], 16).into();
        self.flag.next = row[8] == 1;
        self.array.iter_mut().zip(&row[9..]).for_each(|(signal, value)| signal.next = (*value as u64).into());
        self.mode.next = (row[15] as u64).into();
    }

    fn get(&self) -> Vec<u128> {
        vec![
            self.sums.val().to_u128(),
            self.logic.val().to_u128(),
            self.shifts.val().to_u128(),
            self.one_hot.val().to_u128(),
            self.product.val().to_u128(),
            self.signed_product.val().inner().to_u128(),
            self.signed_sums.val().inner().to_u128(),
            self.narrow.val().inner().to_u128(),
            self.compares.val().to_u128(),
            self.truth.val().into(),
            self.reduced.val().to_u128(),
            self.window.val().to_u128(),
            self.fixed_window.val().to_u128(),
            self.replaced.val().to_u128(),
            self.field.val().to_u128(),
            self.total.val().to_u128(),
            self.chosen.val().to_u128(),
            self.steps.val().to_u128(),
        ]
    }
}

#[test]
fn every_operator_agrees_with_rust_hdl_itself() {
    let emitted = emit(&mut Operators::default());
    let mut rows = Random(11).rows(&emitted, 400);
    // rust-hdl's cast of the most negative number does not end.
    rows.retain(|row| row[6] != 0x8000 && row[7] != 0x8000);
    let mut circuit = Operators::default();
    circuit.connect_all();
    let mut expected = |row: &Vec<u128>| {
        circuit.set(row);
        assert!(simulate(&mut circuit, 20));
        circuit.get()
    };
    let want: Vec<_> = rows.iter().map(&mut expected).collect();
    agree(&emitted, &rows, &want);
}

/// Adds, and hands back whether it may.
#[derive(Circuit)]
struct Adder {
    pub a: Signal<In, Bits<8>>,
    pub b: Signal<In, Bits<8>>,
    pub sum: Signal<Out, Bits<8>>,
    pub ready: Signal<Out, Bit>,
    pub hold: Signal<In, Bit>,
}

impl Logic for Adder {
    #[hdl_gen]
    fn update(&mut self) {
        self.sum.next = self.a.val() + self.b.val();
        self.ready.next = !self.hold.val();
    }
}

/// Takes data where it may.
///
/// A block whose only match drives a part by what another output of the part says.
#[derive(Circuit)]
#[circuit(default)]
struct Machine {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub valid: Signal<In, Bit>,
    pub data: Signal<In, Bits<8>>,
    pub ready: Signal<Out, Bit>,
    pub total: Signal<Out, Bits<8>>,
    pub top: Signal<Out, Signed<8>>,
    mode: DFF<Mode>,
    sum: DFF<Bits<8>>,
    peak: DFF<Signed<8>>,
    adders: [Adder; 2],
}

impl Logic for Machine {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, mode, sum, peak);
        self.adders[0].b.next = self.sum.q.val();
        self.adders[1].a.next = self.adders[0].sum.val();
        self.adders[1].b.next = 1.into();
        self.adders[1].hold.next = self.reset.val();
        self.adders[0].a.next = 0.into();
        self.adders[0].hold.next = true;
        self.ready.next = false;
        match self.mode.q.val() {
            Mode::Add => {
                self.adders[0].hold.next = !self.valid.val();
                if self.adders[0].ready.val() {
                    self.adders[0].a.next = self.data.val();
                    self.ready.next = true;
                    self.mode.d.next = Mode::Swap;
                }
                self.sum.d.next = self.adders[0].sum.val();
            }
            Mode::Swap => {
                self.sum.d.next = self.adders[1].sum.val();
                self.mode.d.next = Mode::Clear;
            }
            _ => {
                self.mode.d.next = Mode::Add;
            }
        }
        if self.peak.q.val() < signed_cast(self.sum.q.val()) {
            self.peak.d.next = signed_cast(self.sum.q.val());
        }
        if self.reset.val() {
            self.mode.d.next = Mode::Add;
            self.sum.d.next = 0.into();
            self.peak.d.next = (-128).into();
        }
        self.total.next = self.sum.q.val();
        self.top.next = self.peak.q.val();
    }
}

#[test]
fn a_machine_with_parts_agrees_cycle_by_cycle() {
    let emitted = emit(&mut Machine::default());
    let mut rows = Random(5).rows(&emitted, 600);
    rows.iter_mut().enumerate().for_each(|(n, row)| row[0] = u128::from(n == 0 || n % 97 == 50));
    let mut circuit = Machine::default();
    circuit.connect_all();
    let mut cycle = |row: &Vec<u128>| {
        circuit.reset.next = row[0] == 1;
        circuit.valid.next = row[1] == 1;
        circuit.data.next = (row[2] as u64).into();
        assert!(simulate(&mut circuit, 20));
        let outputs = vec![
            circuit.ready.val().into(),
            circuit.total.val().to_u128(),
            circuit.top.val().inner().to_u128(),
        ];
        for edge in [true, false] {
            circuit.clock.next = edge.into();
            assert!(simulate(&mut circuit, 20));
        }
        outputs
    };
    let want: Vec<_> = rows.iter().map(&mut cycle).collect();
    agree(&emitted, &rows, &want);
}

/// One of a row: passes words both ways, each a cycle later, and changes those of one direction.
#[derive(Circuit)]
struct Link {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub number: Signal<In, Bits<3>>,
    pub from_next: Signal<In, Bits<8>>,
    pub to_before: Signal<Out, Bits<8>>,
    pub from_before: Signal<In, Bits<8>>,
    pub to_next: Signal<Out, Bits<8>>,
    pub unread: Signal<In, Bits<8>>,
    step: Constant<Bits<8>>,
    down: DFF<Bits<8>>,
    up: DFF<Bits<8>>,
}

impl Logic for Link {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, down, up);
        self.down.d.next = 0.into();
        self.down.d.next = self.from_next.val() + self.step.val();
        if (self.number.val() == 2) && self.from_before.val().get_bit(7) {
            self.down.d.next = self.from_before.val();
        }
        self.up.d.next = self.from_before.val() ^ bit_cast::<8, 3>(self.number.val());
        if self.reset.val() {
            self.down.d.next = 0.into();
            self.up.d.next = 0.into();
        }
        self.to_before.next = self.down.q.val();
        self.to_next.next = self.up.q.val();
    }
}

/// Two rows of links, which differ in a constant and in their length.
#[derive(Circuit)]
struct Links {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub top: Signal<In, Bits<8>>,
    pub bottom: Signal<In, Bits<8>>,
    pub down: Signal<Out, Bits<8>>,
    pub up: Signal<Out, Bits<8>>,
    long: Vec<Link>,
    short: Vec<Link>,
    numbers: Vec<Constant<Bits<3>>>,
}

impl Default for Links {
    fn default() -> Self {
        let row = |count: usize, step: u64| {
            let link = |_| Link::from_parts(LinkParts { step: Constant::new(step.into()) });
            (0..count).map(link).collect()
        };
        Self::from_parts(LinksParts {
            long: row(4, 3),
            short: row(2, 91),
            numbers: (0..4_u64).map(|number| Constant::new(number.into())).collect(),
        })
    }
}

impl Logic for Links {
    #[hdl_gen]
    fn update(&mut self) {
        for i in 0..4 {
            self.long[i].clock.next = self.clock.val();
            self.long[i].reset.next = self.reset.val();
            self.long[i].number.next = self.numbers[i].val();
            self.long[i].unread.next = self.top.val();
        }
        for i in 0..3 {
            self.long[i].from_next.next = self.long[i + 1].to_before.val();
            self.long[i + 1].from_before.next = self.long[i].to_next.val();
        }
        for i in 0..2 {
            self.short[i].clock.next = self.clock.val();
            self.short[i].reset.next = self.reset.val();
            self.short[i].number.next = self.numbers[i].val();
            self.short[i].unread.next = self.top.val();
        }
        self.long[3].from_next.next = self.top.val();
        self.long[0].from_before.next = self.short[1].to_next.val();
        self.short[1].from_next.next = self.long[0].to_before.val();
        self.short[0].from_next.next = self.short[1].to_before.val();
        self.short[1].from_before.next = self.short[0].to_next.val();
        self.short[0].from_before.next = self.bottom.val();
        self.down.next = self.short[0].to_before.val();
        self.up.next = self.long[3].to_next.val();
    }
}

#[test]
fn rows_of_parts_agree_cycle_by_cycle() {
    let emitted = emit(&mut Links::default());
    let top = &emitted.modules.last().unwrap().text;
    assert_eq!((emitted.modules.len(), top.matches("endgenerate").count()), (2, 2), "{top}");
    let mut rows = Random(6).rows(&emitted, 600);
    rows.iter_mut().enumerate().for_each(|(n, row)| row[0] = u128::from(n == 0 || n % 97 == 50));
    let mut circuit = Links::default();
    circuit.connect_all();
    let mut cycle = |row: &Vec<u128>| {
        circuit.reset.next = row[0] == 1;
        circuit.top.next = (row[1] as u64).into();
        circuit.bottom.next = (row[2] as u64).into();
        assert!(simulate(&mut circuit, 20));
        let outputs = vec![circuit.down.val().to_u128(), circuit.up.val().to_u128()];
        for edge in [true, false] {
            circuit.clock.next = edge.into();
            assert!(simulate(&mut circuit, 20));
        }
        outputs
    };
    let want: Vec<_> = rows.iter().map(&mut cycle).collect();
    agree(&emitted, &rows, &want);
}
