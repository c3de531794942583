//! A circuit that runs a plan, and says it as Verilog.

use super::plan::{Expr, Plan, Statement, Target, Test};
use super::source::{assign, name};
use crate::drive::{Harness, Input, Word};
use edof_verilog::describe;
use edof_verilog::leaf::Leaf;
use rust_hdl::prelude::ast::{
    VerilogBlockOrConditional as Otherwise, VerilogConditional, VerilogExpression as Source, VerilogStatement,
};
use rust_hdl::prelude::*;
use std::sync::Arc;

type Byte = Bits<8>;

/// The Verilog of a memory of 16 words: written at the edge, read within the cycle after it.
const MEMORY: &str = "module random_memory (\n  input wire clock_i, input wire [7:0] at_i, input wire [7:0] data_i,\n  \
    input wire [7:0] enable_i, output reg [7:0] data_o\n);\n  reg [7:0] words [0:15];\n  integer n;\n  initial begin\n    \
    for (n = 0; n < 16; n = n + 1) words[n] = 8'd0;\n    data_o = 8'd0;\n  end\n  always @(posedge clock_i) begin\n    \
    data_o <= words[at_i[3:0]];\n    if (enable_i[0]) words[at_i[3:0]] <= data_i;\n  end\nendmodule\n";

/// A memory of 16 words.
#[derive(describe::Circuit)]
struct Memory {
    pub clock: Signal<In, Clock>,
    pub at: Signal<In, Byte>,
    pub data: Signal<In, Byte>,
    pub enable: Signal<In, Byte>,
    pub read: Signal<Out, Byte>,
    _words: [u64; 16],
    _was_high: bool,
}

impl Logic for Memory {
    fn update(&mut self) {
        let is_high = self.clock.val().clk;
        if is_high && !self._was_high {
            let at = (number(self.at.val()) & 15) as usize;
            self.read.next = self._words[at].into();
            if number(self.enable.val()) & 1 == 1 {
                self._words[at] = number(self.data.val());
            }
        }
        self._was_high = is_high;
    }

    fn connect(&mut self) {
        self.read.connect();
    }

    fn hdl(&self) -> Verilog {
        let leaf = Leaf::new("random_memory", MEMORY).port("clock_i", "clock").port("at_i", "at");
        leaf.port("data_i", "data").port("enable_i", "enable").port("data_o", "read").verilog()
    }
}

fn number(word: Byte) -> u64 {
    (0..8).fold(0, |all, at| all | u64::from(word.get_bit(at)) << at)
}

/// A circuit that runs a plan.
#[derive(describe::Circuit)]
#[circuit(role(_name))]
pub struct Circuit {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// All registers become 0.
    pub reset: Signal<In, Bit>,
    /// First input.
    pub a: Signal<In, Byte>,
    /// Second input.
    pub b: Signal<In, Byte>,
    /// First output; it may follow inputs within the cycle.
    pub x: Signal<Out, Byte>,
    /// Second output.
    pub y: Signal<Out, Byte>,
    registers: Vec<DFF<Byte>>,
    locals: Vec<Signal<Local, Byte>>,
    parts: Vec<Circuit>,
    memories: Vec<Memory>,
    _plan: Arc<Plan>,
    _name: String,
}

impl Circuit {
    /// The circuit of a plan.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        let memory = |_: &_| Memory::from_parts(MemoryParts { _words: [0; 16], _was_high: false });
        Self::from_parts(CircuitParts {
            registers: (0..plan.registers).map(|_| DFF::default()).collect(),
            locals: (0..plan.locals).map(|_| Signal::default()).collect(),
            parts: plan.parts.iter().map(Self::new).collect(),
            memories: plan.memories.iter().map(memory).collect(),
            _plan: Arc::new(plan.clone()),
            _name: plan.name.clone(),
        })
    }

    /// What drives it.
    #[must_use]
    pub fn harness() -> Harness<Self> {
        let input = |field: &str, set: fn(&mut Self, u128)| Input { field: field.into(), set: Box::new(set) };
        Harness {
            clock: Some(|circuit| &mut circuit.clock),
            inputs: vec![
                input("reset", |circuit, bits| circuit.reset.next = Word::word(bits)),
                input("a", |circuit, bits| circuit.a.next = Word::word(bits)),
                input("b", |circuit, bits| circuit.b.next = Word::word(bits)),
            ],
        }
    }

    fn value(&self, expr: &Expr) -> Byte {
        match expr {
            Expr::Input(0) => self.a.val(),
            Expr::Input(_) => self.b.val(),
            Expr::Register(n) => self.registers[*n].q.val(),
            Expr::Local(n) => self.locals[*n].val(),
            Expr::Part(n) if n % 2 == 0 => self.parts[n / 2].x.val(),
            Expr::Part(n) => self.parts[n / 2].y.val(),
            Expr::Memory(n) => self.memories[*n].read.val(),
            Expr::Number(number) => (*number).into(),
            Expr::Not(x) => !self.value(x),
            Expr::Shifted(x, by) => self.value(x) >> *by,
            Expr::Binary(op, x, y) => {
                let (x, y) = (self.value(x), self.value(y));
                match *op {
                    "+" => x + y,
                    "-" => x - y,
                    "&" => x & y,
                    "|" => x | y,
                    _ => x ^ y,
                }
            }
        }
    }

    fn holds(&self, test: &Test) -> bool {
        match test {
            Test::Compare(op, x, y) => {
                let (x, y) = (number(self.value(x)), number(self.value(y)));
                match *op {
                    "==" => x == y,
                    "!=" => x != y,
                    "<" => x < y,
                    "<=" => x <= y,
                    ">" => x > y,
                    _ => x >= y,
                }
            }
            Test::Bit(x, at) => number(self.value(x)) >> at & 1 == 1,
            Test::Any(x) => number(self.value(x)) != 0,
            Test::Not(test) => !self.holds(test),
            Test::Both("&&", one, other) => self.holds(one) && self.holds(other),
            Test::Both(_, one, other) => self.holds(one) || self.holds(other),
        }
    }

    fn run(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                Statement::Assign(Target::Register(n), value) => {
                    self.registers[*n].d.next = self.value(value)
                }
                Statement::Assign(Target::Local(n), value) => self.locals[*n].next = self.value(value),
                Statement::If(test, then, otherwise) => {
                    let body = if self.holds(test) { then } else { otherwise };
                    self.run(body);
                }
                Statement::Match(subject, arms, default) => {
                    let subject = number(self.value(subject));
                    let arm = arms.iter().find(|(number, _)| *number == subject);
                    self.run(arm.map_or(default, |(_, body)| body));
                }
            }
        }
    }
}

impl Logic for Circuit {
    fn update(&mut self) {
        let plan = Arc::clone(&self._plan);
        for register in &mut self.registers {
            register.clock.next = self.clock.val();
            register.d.next = register.q.val();
        }
        self.run(&plan.statements);
        for (n, [a, b]) in plan.feeds.iter().enumerate() {
            let (a, b) = (self.value(a), self.value(b));
            let (clock, reset) = (self.clock.val(), self.reset.val());
            let part = &mut self.parts[n];
            (part.clock.next, part.reset.next, part.a.next, part.b.next) = (clock, reset, a, b);
        }
        for (n, [at, data, enable]) in plan.memories.iter().enumerate() {
            let (at, data, enable) = (self.value(at), self.value(data), self.value(enable));
            let clock = self.clock.val();
            let memory = &mut self.memories[n];
            (memory.clock.next, memory.at.next, memory.data.next, memory.enable.next) =
                (clock, at, data, enable);
        }
        self.x.next = self.value(&plan.outputs[0]);
        self.y.next = self.value(&plan.outputs[1]);
        if self.reset.val() {
            self.registers.iter_mut().for_each(|register| register.d.next = 0.into());
            for memory in &mut self.memories {
                (memory.at.next, memory.enable.next) = (0.into(), 0.into());
            }
        }
    }

    fn connect(&mut self) {
        self.x.connect();
        self.y.connect();
        self.locals.iter_mut().for_each(Signal::connect);
        for register in &mut self.registers {
            register.clock.connect();
            register.d.connect();
        }
        for part in &mut self.parts {
            part.clock.connect();
            part.reset.connect();
            part.a.connect();
            part.b.connect();
        }
        for memory in &mut self.memories {
            memory.clock.connect();
            memory.at.connect();
            memory.data.connect();
            memory.enable.connect();
        }
    }

    fn hdl(&self) -> Verilog {
        let plan = &self._plan;
        let mut block = vec![];
        let mut held = vec![];
        for n in 0..plan.registers {
            held.push(assign(format!("registers${n}$clock"), name("clock")));
            held.push(assign(format!("registers${n}$d"), name(&format!("registers${n}$q"))));
        }
        block.push(VerilogStatement::Macro(held));
        block.extend(plan.statements.iter().map(Statement::source));
        for (n, [a, b]) in plan.feeds.iter().enumerate() {
            block.push(assign(format!("parts${n}$clock"), name("clock")));
            block.push(assign(format!("parts${n}$reset"), name("reset")));
            block.push(assign(format!("parts${n}$a"), a.source()));
            block.push(assign(format!("parts${n}$b"), b.source()));
        }
        for (n, [at, data, enable]) in plan.memories.iter().enumerate() {
            block.push(assign(format!("memories${n}$clock"), name("clock")));
            block.push(assign(format!("memories${n}$at"), at.source()));
            block.push(assign(format!("memories${n}$data"), data.source()));
            block.push(assign(format!("memories${n}$enable"), enable.source()));
        }
        block.push(assign("x".into(), plan.outputs[0].source()));
        block.push(assign("y".into(), plan.outputs[1].source()));
        let zero = || Source::Literal(0_u64.into());
        let registers = (0..plan.registers).map(|n| format!("registers${n}$d"));
        // What registers hold before the reset must come neither into a memory nor, as an address that follows from what was read, out of it.
        let memories =
            (0..plan.memories.len()).flat_map(|n| ["at", "enable"].map(|pin| format!("memories${n}${pin}")));
        let then = registers.chain(memories).map(|target| assign(target, zero())).collect();
        block.push(VerilogStatement::If(VerilogConditional {
            test: name("reset"),
            then,
            otherwise: Otherwise::None,
        }));
        Verilog::Combinatorial(block)
    }
}
