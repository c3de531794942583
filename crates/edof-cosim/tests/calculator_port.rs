//! The host's way into the calculator's clock: an access is carried out once and answered with what it asked for, or fails.

use crate::board_blocks::{model, source};
use edof_core::draw::Draw;
use edof_cosim::bench::{Actor, Bench, ClockId};
use edof_cosim::verilator::Model;
use edof_cosim::{Error, Source};
use edof_hdl::board::CalculatorPort;
use std::collections::VecDeque;

/// The host: offers one access after the other until it is answered.
struct Host {
    clock: ClockId,
    source: Source,
    draw: Draw,
    /// Kind (0 a weight, 1 a table's word, 2 a status word), address, word.
    offered: Option<[u64; 3]>,
    accesses: Vec<[u64; 3]>,
    answers: Vec<u64>,
    errors: usize,
}

/// What a stage shows at an address.
const fn shown(address: u64) -> u64 {
    (address.wrapping_mul(0x9e37_79b1) ^ 0x1234_5678) & 0xffff_ffff
}

impl Host {
    fn poke(&self, model: &mut Model, name: &str, value: u64) -> Result<(), Error> {
        model.poke(self.source.port(name)?, value)
    }
}

impl Actor for Host {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        if model.peek(self.source.port("ready_o")?)? == 1 {
            let access = self.offered.take().expect("an answer to an access");
            if model.peek(self.source.port("error_o")?)? == 1 {
                self.errors += 1;
            } else {
                self.accesses.push(access);
                if access[0] == 2 {
                    self.answers.push(model.peek(self.source.port("read_value_o")?)?);
                }
            }
        }
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        if self.offered.is_none() && self.draw.whole(0, 3) == 0 {
            let (kind, word) = (self.draw.whole(0, 2) as u64, self.draw.bits());
            self.offered = Some([kind, word >> 39, word & 0xffff_ffff]);
        }
        for (kind, name) in ["weight_valid_i", "table_valid_i", "stage_valid_i"].into_iter().enumerate() {
            self.poke(model, name, self.offered.is_some_and(|access| access[0] == kind as u64).into())?;
        }
        let [_, address, word] = self.offered.unwrap_or_else(|| [0, 1, 2].map(|_| self.draw.bits() >> 40));
        self.poke(model, "address_i", address)?;
        self.poke(model, "data_i", word)
    }
}

/// The calculator: notes what is written, and shows a word as late after its address as the port allows.
struct Calculator {
    clock: ClockId,
    source: Source,
    written: Vec<[u64; 3]>,
    addresses: VecDeque<u64>,
}

impl Actor for Calculator {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        let address = model.peek(self.source.port("to_address_o")?)?;
        for (kind, name) in [(0, "write_weight_o"), (1, "write_table_o")] {
            if model.peek(self.source.port(name)?)? == 1 {
                self.written.push([kind, address, model.peek(self.source.port("to_data_o")?)?]);
            }
        }
        self.addresses.push_back(address);
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let address = if self.addresses.len() > 3 { self.addresses.pop_front() } else { None };
        model.poke(self.source.port("status_i")?, address.map_or(0, shown))
    }
}

#[test]
fn an_access_of_the_calculator_is_carried_out_once_or_fails_where_its_clock_stands() {
    let source = source(CalculatorPort::default()).metastable();
    for (seed, (host, calculator)) in (1..).zip(crate::crossing::PERIODS) {
        let mut bench = Bench::new(model(&source, seed), seed);
        let clock = bench.clock("clock_i", host).unwrap();
        let to_clock = bench.clock("to_clock_i", calculator).unwrap();
        let empty = (vec![], vec![]);
        let mut host = Host {
            clock,
            source: source.clone(),
            draw: Draw::new(seed),
            offered: None,
            accesses: empty.0,
            answers: empty.1,
            errors: 0,
        };
        let mut calculator = Calculator {
            clock: to_clock,
            source: source.clone(),
            written: vec![],
            addresses: VecDeque::new(),
        };
        bench.set("is_down_i", 0).unwrap();
        // The first access is offered before the crossing is open.
        for (reset, steps) in [(1, 200), (0, 0)] {
            bench.set("reset_i", reset).unwrap();
            bench.set("to_reset_i", reset).unwrap();
            bench.steps(steps, &mut []).unwrap();
        }
        bench.steps(30_000, &mut [&mut host, &mut calculator]).unwrap();
        let writes =
            |host: &Host| host.accesses.iter().copied().filter(|access| access[0] < 2).collect::<Vec<_>>();
        assert!(host.accesses.len() > 50, "only {} accesses", host.accesses.len());
        let asked = host.accesses.iter().filter(|access| access[0] == 2).map(|access| shown(access[1]));
        assert!(host.answers.iter().copied().eq(asked));
        // The last one may have been written and not yet be answered.
        assert!(
            calculator.written.starts_with(&writes(&host))
                && calculator.written.len() <= writes(&host).len() + 1
        );
        assert_eq!(host.errors, 0);
        // The calculator is reset in the middle of accesses: these fail, and no earlier answer is taken for one of the next.
        for _ in 0..20 {
            bench.steps(host.draw.whole(1, 300) as usize, &mut [&mut host, &mut calculator]).unwrap();
            for level in [1, 0] {
                for port in ["is_down_i", "reset_i", "to_reset_i"] {
                    bench.set(port, level).unwrap();
                }
                bench.steps(80, &mut [&mut host, &mut calculator]).unwrap();
            }
        }
        let asked = host.accesses.iter().filter(|access| access[0] == 2).map(|access| shown(access[1]));
        assert!(host.errors > 0 && host.answers.iter().copied().eq(asked));
        host.errors = 0;
        // The calculator's clock stands: all that is offered fails, and nothing is written.
        bench.run_clock(to_clock, false);
        bench.set("is_down_i", 1).unwrap();
        // An answer may be in flight.
        bench.steps(3, &mut [&mut host, &mut calculator]).unwrap();
        let (accesses, written) = (host.accesses.len(), calculator.written.len());
        bench.steps(1_000, &mut [&mut host, &mut calculator]).unwrap();
        assert!(host.errors > 50 && host.accesses.len() == accesses && calculator.written.len() == written);
    }
}
