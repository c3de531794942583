//! Random typed expressions, computed by Rust, Icarus and Verilator.

use crate::testbench::{BOTH, Random, emit, run};
use crate::trees::{Table, Tree, expressions};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Expressions in one module, and modules.
const BATCH: usize = 1_000;
const ROWS: usize = 40;

#[test]
fn random_expressions_mean_what_rust_means() {
    compare_batches(0..1);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn more_random_expressions_mean_what_rust_means() {
    compare_batches(1..16);
}

/// Compares these batches out of one sequence that is the same each time.
fn compare_batches(wanted: std::ops::Range<usize>) {
    let mut runner = TestRunner::deterministic();
    let strategy = expressions();
    let drawn = (0..wanted.end).map(|_| {
        (0..BATCH).map(|_| strategy.new_tree(&mut runner).unwrap().current()).collect::<Vec<Tree>>()
    });
    let first = wanted.start;
    let batches: Vec<Vec<Tree>> = drawn.skip(first).collect();
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let batch = next.fetch_add(1, Ordering::Relaxed);
                    let Some(trees) = batches.get(batch) else { return };
                    compare(trees, (first + batch) as u64 + 1);
                }
            });
        }
    });
}

/// Fails with the first expression on which a simulator differs from Rust.
fn compare(trees: &[Tree], seed: u64) {
    let emitted = emit(&mut Table::new(trees));
    let rows = Random(seed * 0x9e37_79b9).rows(&emitted, ROWS);
    for simulator in BOTH {
        for (row, found) in rows.iter().zip(run(&emitted, simulator, &rows)) {
            let wrong = |n: &usize| found[*n] != trees[*n].value(row);
            if let Some(n) = (0..trees.len()).find(wrong) {
                let want = trees[n].value(row);
                let lines = emitted.modules[0].text.lines().filter(|line| line.contains(&format!(" y{n}_")));
                let lines = lines.collect::<Vec<_>>().join("\n");
                panic!(
                    "{simulator:?}: {:x}, Rust: {want:x}, inputs {row:x?}\n{:?}\n{lines}",
                    found[n], trees[n]
                );
            }
        }
    }
}
