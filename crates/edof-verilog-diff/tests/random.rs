//! The kit finds what it is made for, and random circuits agree.

use edof_verilog::{Direction, Fault, emit};
use edof_verilog_diff::random::{Circuit, Plan};
use edof_verilog_diff::{Bench, Check, Failure, Random, Simulator, check, harness};
use rust_hdl::prelude::*;

/// Counts enabled cycles, and says when three are reached.
#[derive(edof_verilog::describe::Circuit)]
struct Counter {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub enable: Signal<In, Bit>,
    pub count: Signal<Out, Bits<8>>,
    pub full: Signal<Out, Bit>,
    count_q: DFF<Bits<8>>,
    _wrong_from: u64,
}

impl Logic for Counter {
    fn update(&mut self) {
        // The plan of the kernel below, with the injected fault.
        self.count_q.clock.next = self.clock.val();
        self.count_q.d.next = self.count_q.q.val();
        if self.enable.val() {
            self.count_q.d.next = self.count_q.q.val() + 1;
        }
        if self.reset.val() {
            self.count_q.d.next = 0.into();
        }
        self.count.next = self.count_q.q.val();
        let is_wrong = self._wrong_from < 256 && self.count_q.q.val() >= self._wrong_from;
        self.full.next = self.count_q.q.val() >= 3 && !is_wrong;
    }

    fn connect(&mut self) {
        Kernel::connect_ports(&mut self.count, &mut self.full, &mut self.count_q);
    }

    fn hdl(&self) -> Verilog {
        Kernel::default().hdl()
    }
}

/// The counter's kernel.
#[derive(edof_verilog::describe::Circuit)]
struct Kernel {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub enable: Signal<In, Bit>,
    pub count: Signal<Out, Bits<8>>,
    pub full: Signal<Out, Bit>,
    count_q: DFF<Bits<8>>,
}

impl Kernel {
    fn connect_ports(
        count: &mut Signal<Out, Bits<8>>,
        full: &mut Signal<Out, Bit>,
        register: &mut DFF<Bits<8>>,
    ) {
        count.connect();
        full.connect();
        register.clock.connect();
        register.d.connect();
    }
}

impl Logic for Kernel {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, count_q);
        if self.enable.val() {
            self.count_q.d.next = self.count_q.q.val() + 1;
        }
        if self.reset.val() {
            self.count_q.d.next = 0.into();
        }
        self.count.next = self.count_q.q.val();
        self.full.next = self.count_q.q.val() >= 3;
    }
}

fn counter(wrong_from: u64) -> Counter {
    Counter::from_parts(CounterParts { _wrong_from: wrong_from })
}

fn with_reset(cycles: usize) -> Check {
    Check { reset: Some("reset"), cycles, ..Check::default() }
}

#[test]
fn a_circuit_agrees_with_itself() {
    let harness = harness!(Counter, clock; reset, enable);
    let agreement = check(&|| counter(1_000), &harness, &with_reset(300)).unwrap();
    assert_eq!((agreement.cycles, agreement.outputs), (296, 2));
}

#[test]
fn a_difference_is_shrunk_to_what_it_takes() {
    let harness = harness!(Counter, clock; reset, enable);
    let only_icarus = Check { simulators: vec![Simulator::Icarus], ..with_reset(300) };
    let Err(Failure::Difference(difference)) = check(&|| counter(5), &harness, &only_icarus) else {
        panic!("the planted difference was not found");
    };
    // Five enabled cycles bring the count to five, where Rust says that it is not full.
    assert_eq!((difference.port.as_str(), difference.rust, difference.verilog), ("full", 0, Some(1)));
    assert_eq!(difference.stimulus.len(), 4 + 5 + 1, "{difference}");
    let enabled = difference.stimulus.iter().skip(4).filter(|row| row[1] == 1).count();
    assert_eq!(enabled, 5, "{difference}");
}

#[test]
fn an_input_that_the_harness_does_not_have_is_named() {
    let harness = harness!(Counter, clock; reset);
    let error = check(&|| counter(1_000), &harness, &with_reset(10)).unwrap_err();
    assert!(error.to_string().contains("`enable`"), "{error}");
}

/// Many circuits side by side, on the same inputs.
#[derive(edof_verilog::describe::Circuit)]
struct Batch {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub a: Signal<In, Bits<8>>,
    pub b: Signal<In, Bits<8>>,
    pub x: [Signal<Out, Bits<8>>; 24],
    pub y: [Signal<Out, Bits<8>>; 24],
    circuits: Vec<Circuit>,
    _count: usize,
}

impl Logic for Batch {
    #[hdl_gen]
    fn update(&mut self) {
        for i in 0..24 {
            self.circuits[i].clock.next = self.clock.val();
            self.circuits[i].reset.next = self.reset.val();
            self.circuits[i].a.next = self.a.val();
            self.circuits[i].b.next = self.b.val();
            self.x[i].next = self.circuits[i].x.val();
            self.y[i].next = self.circuits[i].y.val();
        }
    }
}

/// Random circuits that the backend accepts. What it rejects has a loop. A circuit with a loop may be accepted where a number breaks the loop, as
/// in `x | 255`: it is compared like all others, and with a loop in its Verilog it would be unknown in Icarus.
fn plans(random: &mut Random) -> Vec<Plan> {
    let mut plans = vec![];
    while plans.len() < 24 {
        let plan = Plan::drawn(random, 2, &format!("n{}", plans.len()));
        let mut circuit = Circuit::new(&plan);
        circuit.connect_all();
        match emit(&circuit) {
            Ok(_) => plans.push(plan),
            // A choice that hangs on numbers alone.
            Err(error) if error.fault == Fault::Constant => {}
            Err(error) => {
                assert!(plan.loops() && matches!(error.fault, Fault::Cycle(_)), "{error}: {plan:?}")
            }
        }
    }
    plans
}

fn compare(seed: u64, cycles: usize, simulators: &[Simulator]) {
    let plans = plans(&mut Random::new(seed));
    let make = || {
        let circuits = plans.iter().map(Circuit::new).collect();
        Batch::from_parts(BatchParts { circuits, _count: 24 })
    };
    let harness = harness!(Batch, clock; reset, a, b);
    let how = Check { seed, simulators: simulators.to_vec(), ..with_reset(cycles) };
    if let Err(failure) = check(&make, &harness, &how) {
        if let Failure::Difference(difference) = &failure {
            let number: usize = difference.port[2..difference.port.len() - 1].parse().unwrap();
            panic!("seed {seed}: {failure}\n{:?}", plans[number]);
        }
        panic!("seed {seed}: {failure}");
    }
}

/// `y` reads `limit` before its last assignment, and `other`, which follows `limit`. One block for `limit` and `y` would wake itself by way of
/// `other`, for ever in Icarus.
#[derive(edof_verilog::describe::Circuit)]
#[circuit(registers(clock))]
struct Knot {
    pub clock: Signal<In, Clock>,
    pub a: Signal<In, Bits<8>>,
    pub b: Signal<In, Bits<8>>,
    pub y: Signal<Out, Bits<8>>,
    limit: Signal<Local, Bits<8>>,
    other: Signal<Local, Bits<8>>,
    kept: DFF<Bits<8>>,
}

impl Logic for Knot {
    #[edof_verilog::describe::kernel]
    fn update(&mut self) {
        self.kept.d.next = self.b.val();
        self.y.next = 0.into();
        self.limit.next = self.a.val();
        if self.limit.val().get_bits::<2>(0) == 3 {
            self.y.next = self.a.val();
            self.limit.next = 1.into();
        }
        self.other.next = self.kept.q.val();
        if self.limit.val().get_bits::<1>(0) == 1 {
            self.other.next = 7.into();
            if self.b.val() == 9 {
                self.other.next = self.a.val();
            }
        } else if self.limit.val().get_bits::<2>(1) == 2 {
            self.other.next = self.b.val();
        }
        if self.b.val().get_bits::<1>(0) == 1 {
            self.y.next = self.other.val();
        }
    }
}

#[test]
fn a_block_that_would_wake_itself_comes_to_rest() {
    let harness = harness!(Knot, clock; a, b);
    check(&Knot::default, &harness, &Check { cycles: 300, ..Check::default() }).unwrap();
}

#[test]
fn random_circuits_mean_what_rust_means() {
    compare(1, 300, &[Simulator::Icarus, Simulator::Verilator]);
}

#[test]
#[ignore = "ten minutes: scripts/soak.sh"]
fn ten_thousand_random_circuits_mean_what_rust_means() {
    // Verilator's compiler takes most of the time: every tenth batch of 24 circuits.
    let batch = |seed| {
        let verilator = Some(Simulator::Verilator).filter(|_| seed % 10 == 0);
        let simulators: Vec<Simulator> = [Simulator::Icarus].into_iter().chain(verilator).collect();
        compare(seed, 500, &simulators);
    };
    // Two at a time.
    std::thread::scope(|scope| {
        for first in [2, 3] {
            scope.spawn(move || (first..420).step_by(2).for_each(batch));
        }
    });
}

#[test]
fn a_bench_that_a_simulator_does_not_take_is_reported() {
    let mut counter = counter(1_000);
    counter.connect_all();
    let mut emitted = emit(&counter).unwrap();
    assert_eq!(emitted.ports.iter().filter(|port| port.direction == Direction::Output).count(), 2);
    emitted.modules[0].text.push_str("nonsense\n");
    let Err(error) = Bench::new(&emitted, Simulator::Icarus) else { panic!("taken") };
    assert!(error.to_string().contains("nonsense") || error.to_string().contains("syntax"), "{error}");
}
