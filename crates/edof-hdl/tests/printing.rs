//! What the backend prints, shown on small circuits.

use edof_hdl::leaf::Leaf;
use edof_hdl::{described, verilog};
use rust_hdl::prelude::*;

/// The text between the ports and `endmodule` of the last module.
fn body(top: &mut dyn Block) -> String {
    top.connect_all();
    let emitted = verilog::emit(top).unwrap_or_else(|error| panic!("{error}"));
    let text = &emitted.modules.last().unwrap().text;
    let (_, rest) = text.split_once(");\n").unwrap();
    rest.split_once("endmodule").unwrap().0.trim_matches('\n').to_string()
}

#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Phase {
    Idle,
    Fill,
    Drain,
}

#[derive(LogicBlock, Default)]
struct Sequencer {
    pub clock: Signal<In, Clock>,
    pub start: Signal<In, Bit>,
    pub busy: Signal<Out, Bit>,
    phase: DFF<Phase>,
    count: DFF<Bits<4>>,
    last: Signal<Local, Bit>,
}

impl Logic for Sequencer {
    described!("Fills for 16 cycles, drains for one.\n\nStarts when it is told to.");
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, phase, count);
        self.last.next = self.count.q.val() + 1 == 0;
        self.busy.next = self.phase.q.val() != Phase::Idle;
        match self.phase.q.val() {
            Phase::Idle => {
                if self.start.val() {
                    self.phase.d.next = Phase::Fill;
                    self.count.d.next = 0.into();
                }
            }
            Phase::Fill => {
                self.count.d.next = self.count.q.val() + 1;
                if self.last.val() {
                    self.phase.d.next = Phase::Drain;
                }
            }
            Phase::Drain => {
                self.phase.d.next = Phase::Idle;
            }
        }
    }
}

#[test]
fn a_whole_module_reads_like_this() {
    let mut top = Sequencer::default();
    top.connect_all();
    let emitted = verilog::emit(&top).unwrap();
    println!("{}", emitted.modules[0].text);
}

#[derive(LogicBlock, Default)]
struct Accumulator {
    pub clock: Signal<In, Clock>,
    pub clear: Signal<In, Bit>,
    pub a: Signal<In, Signed<16>>,
    pub b: Signal<In, Signed<16>>,
    pub sum: Signal<Out, Signed<48>>,
    acc: DFF<Signed<48>>,
}

impl Logic for Accumulator {
    described!("Sums products.");
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, acc);
        if self.clear.val() {
            self.acc.d.next = signed_bit_cast::<48, 32>(self.a.val() * self.b.val());
        } else {
            self.acc.d.next = self.acc.q.val() + signed_bit_cast::<48, 32>(self.a.val() * self.b.val());
        }
        self.sum.next = self.acc.q.val();
    }
}

#[derive(LogicBlock)]
struct Pair {
    pub clock: Signal<In, Clock>,
    pub a: Signal<In, Signed<16>>,
    pub b: [Signal<In, Signed<16>>; 2],
    pub sum: [Signal<Out, Signed<48>>; 2],
    lanes: [Accumulator; 2],
}

impl Default for Pair {
    fn default() -> Self {
        Self {
            clock: Default::default(),
            a: Default::default(),
            b: Default::default(),
            sum: Default::default(),
            lanes: Default::default(),
        }
    }
}

impl Logic for Pair {
    described!("Two accumulators.");
    #[hdl_gen]
    fn update(&mut self) {
        for i in 0..2 {
            self.lanes[i].clock.next = self.clock.val();
            self.lanes[i].clear.next = false;
            self.lanes[i].a.next = self.a.val();
            self.lanes[i].b.next = self.b[1 - i].val();
            self.sum[i].next = self.lanes[i].sum.val();
        }
    }
}

#[test]
fn equal_parts_share_a_module() {
    let mut top = Pair::default();
    top.connect_all();
    let emitted = verilog::emit(&top).unwrap();
    for m in &emitted.modules {
        println!("{}", m.text);
    }
    assert_eq!(emitted.modules.len(), 2);
}

#[derive(LogicBlock, Default)]
struct Memory {
    pub clock: Signal<In, Clock>,
    pub at: Signal<In, Bits<4>>,
    pub data: Signal<Out, Bits<16>>,
}

impl Logic for Memory {
    fn update(&mut self) {}
    fn connect(&mut self) {
        self.data.connect();
    }
    fn hdl(&self) -> Verilog {
        let leaf = Leaf::new("edof_ram").parameter("DEPTH", 16).text("INIT", "mem/a.hex");
        leaf.port("clock_i", "clock").port("at_i", "at").port("data_o", "data").verilog()
    }
}

#[derive(LogicBlock, Default)]
struct Reader {
    pub clock: Signal<In, Clock>,
    pub data: Signal<Out, Bits<8>>,
    memory: Memory,
    at: DFF<Bits<4>>,
}

impl Logic for Reader {
    described!("Reads a memory in turn.");
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, at);
        clock!(self, clock, memory);
        self.at.d.next = self.at.q.val() + 1;
        self.memory.at.next = self.at.q.val();
        self.data.next = self.memory.data.val().get_bits::<8>(4);
    }
}

#[test]
fn leaves_are_instances() {
    println!("{}", body(&mut Reader::default()));
}
