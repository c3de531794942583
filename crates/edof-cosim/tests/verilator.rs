//! Small designs through Verilator.

use crate::support::{build, build_traced, fresh_cache, images, machine, options, ticks, wide};
use edof_cosim::verilator::{Library, Model, Start, Waveform};
use edof_cosim::{Direction, Error, Rows, Source};
use std::collections::BTreeSet;
use std::path::Path;

fn start(library: &Library, seed: u64) -> Model {
    library.start(&Start { seed, ..Start::default() }).unwrap()
}

/// Row of the inputs of `ticks`: reset for a cycle, then enabled.
fn counting(library: &Library, cycles: usize) -> Rows {
    let mut rows = Rows::new(library.inputs().words());
    for cycle in 0..cycles {
        rows.push_zeros()[usize::from(cycle > 0)] = 1;
    }
    rows
}

#[test]
fn a_counter_counts_and_its_outputs_follow_its_inputs_before_the_edge() {
    let source = ticks();
    let port = |name| source.port(name).unwrap();
    let mut model = start(&build(&source), 1);
    model.poke(port("reset_i"), 1).unwrap();
    model.tick().unwrap();
    model.poke(port("reset_i"), 0).unwrap();
    model.poke(port("enable_i"), 1).unwrap();
    for count in 0..300 {
        assert_eq!(model.peek(port("count_o")).unwrap(), count % 256);
        assert_eq!(model.peek(port("last_o")).unwrap(), u64::from(count % 256 == 255));
        model.tick().unwrap();
    }
    model.poke(port("enable_i"), 0).unwrap();
    assert_eq!(model.peek(port("last_o")).unwrap(), 0);
    assert_eq!(model.cycle(), 301);
}

#[test]
fn a_batch_gives_what_single_steps_give() {
    let library = build(&ticks());
    let stimulus = library.inputs().random(200, 5);
    let batch = start(&library, 1).run(&stimulus).unwrap();
    let mut model = start(&library, 1);
    let mut single = Rows::new(library.outputs().words());
    for row in stimulus.iter() {
        model.apply(row).unwrap();
        model.sample(single.push_zeros()).unwrap();
        model.tick().unwrap();
    }
    assert_eq!(batch, single);
}

#[test]
fn every_width_passes_unharmed() {
    let mut model = start(&build(&wide()), 1);
    model.poke(1, 1).unwrap();
    model.poke(2, 0x1_2345_6789).unwrap();
    model.poke(3, u64::MAX - 5).unwrap();
    model.poke_words(4, &[1, 2, 3, 0xffff_fff4]).unwrap();
    model.tick().unwrap();
    assert_eq!(model.peek(5).unwrap(), 0);
    assert_eq!(model.peek(6).unwrap(), 0xdcba_9876);
    assert_eq!(model.peek(7).unwrap(), 5);
    let mut words = [0; 4];
    model.peek_words(8, &mut words).unwrap();
    assert_eq!(words, [!1, !2, !3, 0xb]);
    assert_eq!(model.peek(8).unwrap(), 0xffff_fffd_ffff_fffe);
}

#[test]
fn start_up_values_are_the_seeds() {
    let library = build(&ticks());
    let free = |seed| start(&library, seed).peek(5).unwrap();
    assert_eq!(free(3), free(3));
    let distinct: BTreeSet<u64> = (0..50).map(free).collect();
    assert!(distinct.len() > 45, "{distinct:?}");
    let ones: u32 = distinct.iter().map(|value| value.count_ones()).sum();
    assert!((13..19).contains(&(ones as usize / distinct.len())), "{ones}");
}

#[test]
fn a_memory_image_is_found_wherever_the_process_is() {
    let library = build(&machine());
    for first in [0x100, 0x200] {
        let (_guard, dir) = images(first);
        let mut model = library.start(&Start { memory_dir: Some(dir), ..Start::default() }).unwrap();
        model.poke(1, 1).unwrap();
        model.tick().unwrap();
        model.tick().unwrap();
        assert_eq!(model.peek(5).unwrap(), u64::from(first));
    }
}

#[test]
fn a_missing_memory_image_is_named() {
    let error = build(&machine()).start(&Start::default()).unwrap_err();
    assert_eq!(error.to_string(), "simulation stopped: images/machine.hex: $readmem file not found");
}

#[test]
fn a_window_of_cycles_is_written_as_a_waveform() {
    let dir = tempfile::tempdir().unwrap();
    let library = build_traced(&ticks(), Waveform::Vcd);
    let mut model = start(&library, 1);
    let path = dir.path().join("window.vcd");
    model.trace_window(&path, 20, 22).unwrap();
    model.run(&counting(&library, 50)).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let times: Vec<&str> = text.lines().filter(|line| line.starts_with('#')).collect();
    assert_eq!(times, ["#200", "#205", "#210", "#215", "#220", "#225"]);
    assert!(text.contains("count_q"), "{text}");
    assert!(text.contains("b00010011 "), "cycle 20 shows a count of 19: {text}");
}

#[test]
fn a_waveform_ends_and_another_begins_within_one_run() {
    let dir = tempfile::tempdir().unwrap();
    let format = Waveform::best();
    let library = build_traced(&ticks(), format);
    let mut model = start(&library, 1);
    for name in ["first", "second"] {
        let path = dir.path().join(name).with_extension(format.extension());
        model.start_trace(&path).unwrap();
        model.run(&counting(&library, 50)).unwrap();
        model.stop_trace();
        assert!(path.metadata().unwrap().len() > 100);
    }
    let error = model.start_trace(&dir.path().join("no/such/place.fst")).unwrap_err();
    assert!(error.to_string().ends_with("place.fst: cannot be written"), "{error}");
}

#[test]
fn tracing_changes_nothing() {
    let plain = build(&ticks());
    let stimulus = plain.inputs().random(100, 9);
    let traced = build_traced(&ticks(), Waveform::Vcd);
    assert_eq!(start(&plain, 4).run(&stimulus).unwrap(), start(&traced, 4).run(&stimulus).unwrap());
    let error = start(&plain, 4).start_trace(Path::new("x.vcd")).unwrap_err();
    assert_eq!(error.to_string(), "simulation stopped: this model was built without waveforms");
}

#[test]
fn models_run_on_many_threads_at_once() {
    let (_guard, dir) = images(7);
    let (ticks, machine) = (build(&ticks()), build(&machine()));
    let run = |library: &Library, seed| {
        let memory_dir = Some(dir.clone());
        let mut model = library.start(&Start { seed, memory_dir }).unwrap();
        model.run(&library.inputs().random(2000, seed)).unwrap()
    };
    let expected: Vec<_> = (0..4).map(|seed| (run(&ticks, seed), run(&machine, seed))).collect();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for (seed, expected) in expected.iter().enumerate() {
                    assert_eq!(*expected, (run(&ticks, seed as u64), run(&machine, seed as u64)));
                }
            });
        }
    });
}

#[test]
fn ports_that_do_not_fit_are_rejected() {
    let library = build(&ticks());
    let mut model = start(&library, 1);
    let text = |result: Result<(), Error>| result.unwrap_err().to_string();
    assert_eq!(text(model.poke(0, 1)), "clock_i: is a clock, which tick moves");
    assert_eq!(text(model.poke(3, 1)), "count_o: is an output");
    assert_eq!(text(model.peek(6).map(drop)), "there is no port 6: there are 6");
    assert_eq!(text(model.poke_words(1, &[0, 0])), "reset_i: 2 words given, where the port has 1");
    assert_eq!(text(model.apply(&[0])), "a row of 1 words, where the design has 2");
    assert_eq!(text(model.run(&Rows::zeros(3, 1)).map(drop)), "a row of 3 words, where the design has 2");
    assert_eq!(text(library.source().port("x").map(drop)), "ticks has no port x");
}

#[test]
fn broken_verilog_is_reported_with_file_and_line() {
    let mut source = ticks();
    source.files[0].1 = "module ticks (input wire a);\n  assign b = ;\nendmodule\n".into();
    let error = Library::build(&source, &options()).unwrap_err().to_string();
    assert!(error.starts_with("verilator failed: %Error: ticks.v:2:14: syntax error"), "{error}");
}

#[test]
fn ports_other_than_those_of_the_verilog_are_rejected() {
    let refusal = |change: fn(&mut Source)| {
        let mut source = ticks();
        change(&mut source);
        Library::build(&source, &options()).unwrap_err().to_string()
    };
    assert_eq!(
        refusal(|source| source.ports[1].name = "other_i".into()),
        "design ticks: port other_i is not in the Verilog"
    );
    assert_eq!(
        refusal(|source| source.ports[3].bits = 9),
        "design ticks: port count_o has 8 bits in the Verilog, not 9"
    );
    assert_eq!(
        refusal(|source| source.ports[2].direction = Direction::Out),
        "design ticks: port enable_i has the other direction in the Verilog"
    );
    assert_eq!(
        refusal(|source| drop(source.ports.pop())),
        "design ticks: port free_o of the Verilog is not in the list of ports"
    );
}

#[test]
fn a_corrupted_file_in_the_cache_is_named() {
    let (cache, options) = fresh_cache();
    drop(Library::build(&ticks(), &options).unwrap());
    let names = std::fs::read_dir(cache.path()).unwrap().map(|entry| entry.unwrap().path());
    let model = names.into_iter().find(|path| path.extension().is_some_and(|end| end == "so")).unwrap();
    std::fs::write(&model, "spoilt").unwrap();
    let error = Library::build(&ticks(), &options).unwrap_err().to_string();
    assert!(error.starts_with(&format!("{}: ", model.display())), "{error}");
}

#[test]
fn only_a_change_compiles_again() {
    let (cache, options) = fresh_cache();
    let models = || {
        let names = std::fs::read_dir(cache.path()).unwrap().map(|entry| entry.unwrap().file_name());
        names.filter(|name| name.to_str().unwrap().ends_with(".so")).count()
    };
    for _ in 0..2 {
        Library::build(&ticks(), &options).unwrap();
        assert_eq!(models(), 1);
    }
    let mut changed = ticks();
    changed.files[0].1 += "\n";
    Library::build(&changed, &options).unwrap();
    assert_eq!(models(), 2);
}
