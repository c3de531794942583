//! The button's debouncing against its law: the level follows the line once that has been different for 2^n cycles.

use crate::support;
use edof_core::draw::Draw;
use edof_cosim::verilator::{Library, Start};
use edof_cosim::{Port, Source};

const LOG_CYCLES: usize = 3;

fn source() -> Source {
    let top = format!(
        "module debounce (input wire clock_i, input wire line_i, output wire level_o);\n    \
         edof_debounce #(.LOG_CYCLES({LOG_CYCLES})) under_test (.clock_i(clock_i), .line_i(line_i), .level_o(level_o));\n\
         endmodule\n"
    );
    let files = [
        ("debounce.v", top.as_str()),
        ("edof_debounce.v", include_str!("../../../rtl/edof_debounce.v")),
        ("edof_sync.v", include_str!("../../../rtl/edof_sync.v")),
    ];
    Source {
        top: "debounce".into(),
        files: files.map(|(name, text)| (name.into(), text.into())).into(),
        ports: vec![Port::clock("clock_i"), Port::input("line_i", 1), Port::output("level_o", 1)],
    }
}

/// A line that bounces: levels that stand for one to twice as many cycles as it takes.
fn line(cycles: usize, seed: u64) -> Vec<bool> {
    let draw = &mut Draw::new(seed);
    let mut levels = Vec::new();
    while levels.len() < cycles {
        let longest = if draw.whole(0, 2) == 0 { 2 << LOG_CYCLES } else { 3 };
        let level = levels.last().is_none_or(|last: &bool| !last);
        levels.extend(vec![level; draw.whole(1, longest) as usize]);
    }
    levels
}

/// The level before each edge, by the law alone: the line arrives two edges later, and is low before the first.
fn expected(line: &[bool]) -> Vec<bool> {
    let seen = |cycle: usize| cycle.checked_sub(2).is_some_and(|sent| line[sent]);
    let (mut level, mut different) = (false, 0);
    (0..line.len())
        .map(|cycle| {
            let before = level;
            different = if seen(cycle) == level { 0 } else { different + 1 };
            if different == 1 << LOG_CYCLES {
                (level, different) = (!level, 0);
            }
            before
        })
        .collect()
}

#[test]
fn the_level_follows_a_line_that_has_been_still_and_no_other() {
    let library = Library::build(&source(), &support::options()).unwrap();
    for seed in 0..4 {
        let line = line(5_000, seed);
        let mut model = library.start(&Start { seed, ..Start::default() }).unwrap();
        let mut poke = |level| model.poke(1, u64::from(level)).and_then(|()| model.tick());
        // Until the line has passed its two registers, they hold what they started with.
        (0..2).for_each(|_| poke(false).unwrap());
        let mut levels = Vec::new();
        for level in &line {
            model.poke(1, u64::from(*level)).unwrap();
            levels.push(model.peek(2).unwrap() == 1);
            model.tick().unwrap();
        }
        assert_eq!(levels, expected(&line), "seed {seed}");
        assert!(levels.windows(2).filter(|pair| pair[0] != pair[1]).count() > 100, "seed {seed}");
    }
}
