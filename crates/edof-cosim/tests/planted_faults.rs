//! Faults injected into the generated files, each found at its place.

use crate::common::{Setup, committed, moderate, patches};
use edof_cosim::chain::{Difference, Drive, Fault};
use edof_device::design::memory::{self, Shifts};
use edof_golden::cycle::Stalls;
use edof_hdl::project::{self, Project};

/// `tiny` after `plant`: the first difference in 60 patches, if there is one.
fn first_difference(plant: impl FnOnce(Project) -> Project) -> Option<Difference> {
    let design = committed("tiny");
    let networks = [5, 6].map(|seed| moderate(&design, seed));
    let setup = Setup::altered(design, networks, plant);
    let drive = Drive { stalls: Some(Stalls::drawn(1, 40)), ..Drive::default() };
    setup.run(&drive, patches(&setup.design, 60, 1), 1).difference
}

fn found(plant: impl FnOnce(Project) -> Project) -> Difference {
    let difference = first_difference(plant).expect("the fault is found");
    println!("{difference}");
    difference
}

/// Replaces text that is there exactly once in the module of a part, which is named by its instances from the top on. The other instances
/// of that module stay as they are.
pub fn replaced(mut project: Project, part: &str, from: &str, to: &str) -> Project {
    let top = project.top.clone();
    let module = part.split('.').fold(top, |module, instance| own_module(&mut project, &module, instance));
    let text = text(&mut project, &module);
    assert_eq!(text.matches(from).count(), 1, "{from} in {module}");
    *text = text.replace(from, to);
    project
}

/// Gives an instance a copy of its module, and names that.
fn own_module(project: &mut Project, parent: &str, instance: &str) -> String {
    let copy = format!("{parent}_{instance}");
    let text_of_parent = text(project, parent);
    // Pins stand behind it or below it, and words in a comment.
    let heads = ["\n", "."].map(|pins| format!(" {instance} ({pins}"));
    let end = heads.iter().find_map(|head| text_of_parent.find(head)).unwrap();
    let line = |end: usize| text_of_parent[..end].rfind('\n').unwrap() + 1;
    let mut start = line(end);
    if text_of_parent[start..end].trim().is_empty() {
        start = line(start - 1);
    }
    if text_of_parent[start..].trim_start().starts_with(')') {
        start = line(text_of_parent[..start].rfind("#(\n").unwrap());
    }
    let module: String = text_of_parent[start..].split_whitespace().next().unwrap().into();
    text_of_parent.replace_range(start..end, &text_of_parent[start..end].replacen(&module, &copy, 1));
    let own = text(project, &module).replacen(&format!("module {module} "), &format!("module {copy} "), 1);
    project.verilog.push((format!("{copy}.v"), own));
    copy
}

fn text<'a>(project: &'a mut Project, module: &str) -> &'a mut String {
    let file = format!("{module}.v");
    &mut project.verilog.iter_mut().find(|(name, _)| *name == file).unwrap().1
}

#[test]
fn without_a_fault_there_is_no_difference() {
    assert_eq!(first_difference(|project| project), None);
}

#[test]
fn a_wrong_shift() {
    let design = committed("tiny");
    let shifts = Shifts::of(&moderate(&design, 5), &design.stage(3));
    let wrong = Shifts { result: shifts.result + 1, ..shifts };
    let image = memory::shift_image(&design.stage(3));
    let first = patches(&design, 60, 1).iter().position(|patch| patch.set == memory::Set::First).unwrap();

    let difference = found(|mut project| {
        let (_, words) = project.memory.iter_mut().find(|(name, _)| *name == image).unwrap();
        let word = |shifts: Shifts| format!("{:05x}\n", shifts.word());
        assert!(words.starts_with(&word(shifts)));
        *words = words.replacen(&word(shifts), &word(wrong), 1);
        project
    });

    assert_eq!((difference.fault, difference.stage.as_str()), (Fault::Word, "F"));
    assert_eq!((difference.patch, difference.element), (first as u64, 0));
    assert!((difference.got.unwrap() - difference.expected / 2).abs() <= 1, "half the word: {difference}");
}

#[test]
fn a_wrong_direction_of_rounding() {
    let round = "half_1_q <= (ONE << result_shift_i) >> 1;";
    let difference = found(|p| replaced(p, "stages_0.results.requantize_even", round, "half_1_q <= 48'd0;"));
    assert_eq!((difference.fault, difference.boundary.as_str()), (Fault::Base, "I to M1"));
    assert_eq!(difference.element % 2, 0);
    assert_eq!(difference.got.unwrap(), difference.expected - 1);
}

#[test]
#[ignore = "others have wrong words: scripts/soak.sh"]
fn a_drain_that_ends_one_beat_early() {
    // M1 has eight lanes: its drain ends with beat 3, here with beat 2.
    let (whole, early) = ("BEFORE_LAST_TAKE = LANES / 2 - 1", "BEFORE_LAST_TAKE = LANES / 2 - 2");
    let difference = found(|p| replaced(p, "stages_1.drain", whole, early));
    assert_eq!((difference.stage.as_str(), difference.boundary.as_str()), ("M1", "M1 to M2"));
    assert_eq!((difference.patch, difference.element), (0, 6));
}

#[test]
fn two_banks_that_changed_places() {
    let design = committed("tiny");
    let [two, three] = [2, 3].map(|bank| memory::weight_image(&design.stage(3), bank, 0));
    let difference = found(|mut project| {
        let place = |name: &str| project.memory.iter().position(|(path, _)| path == name).unwrap();
        let (two, three) = (place(&two), place(&three));
        let swapped = [two, three].map(|bank| project.memory[bank].1.clone());
        [project.memory[three].1, project.memory[two].1] = swapped;
        project
    });
    assert_eq!((difference.fault, difference.stage.as_str()), (Fault::Word, "F"));
    assert_eq!((difference.patch, difference.element), (0, 8), "the first lane of bank 2");
}

#[test]
#[ignore = "others have wrong words: scripts/soak.sh"]
fn two_sets_that_changed_places() {
    let (of_set, other) = ("if (next[0]) job_row_q", "if (!next[0]) job_row_q");
    let difference = found(|p| replaced(p, "stages_1.sequencer", of_set, other));
    assert_eq!((difference.fault, difference.boundary.as_str()), (Fault::Word, "M1 to M2"));
    assert_eq!(difference.patch, 0);
}

#[test]
fn a_receiver_that_is_not_waited_for() {
    let difference = found(|p| replaced(p, "stages_2", ".ready_i(out_ready_i)", ".ready_i(1'b1)"));
    assert_eq!((difference.stage.as_str(), difference.boundary.as_str()), ("M2", "M2 to F"));
    assert_eq!(difference.fault, Fault::Held, "{difference}");
}

#[test]
fn a_receiver_that_never_says_wait() {
    // F is the slowest stage, and the first whose store is full.
    let difference =
        found(|p| replaced(p, "stages_3.pairs", "assign ready_o = ready_q;", "assign ready_o = 1'b1;"));
    assert_eq!((difference.fault, difference.boundary.as_str()), (Fault::Early, "M2 to F"));
}

#[test]
fn a_difference_names_what_drives_it_in_verilog_and_in_rust() {
    let design = committed("tiny");
    let networks = [5, 6].map(|seed| moderate(&design, seed));
    let project = project::calculator(&design, [&networks[0], &networks[1]]).unwrap();
    let difference = |fault| Difference {
        fault,
        boundary: "M1 to M2".into(),
        stage: "M1".into(),
        patch: 0,
        element: 0,
        cycle: 0,
        expected: 0,
        got: None,
    };
    for (fault, port) in
        [(Fault::Word, "out_data_o"), (Fault::Set, "out_set_o"), (Fault::Late, "out_valid_o")]
    {
        let place = difference(fault).driver(&project, design.stages.len()).unwrap();
        let (file, line) = place.verilog.split_once(':').unwrap();
        let text = &project.verilog.iter().find(|(name, _)| name == file).unwrap().1;
        let line = text.lines().nth(line.parse::<usize>().unwrap() - 1).unwrap();
        assert!(file == "stage.v" && line.contains(port), "{place}: {line}");
        assert!(place.rust.starts_with("crates/edof-hdl/src/blocks/stage.rs"), "{place}");
        if fault != Fault::Late {
            let (_, line) = place.rust.split_once(':').unwrap();
            let rust = include_str!("../../edof-hdl/src/blocks/stage.rs");
            let rust = rust.lines().nth(line.parse::<usize>().unwrap() - 1).unwrap();
            assert!(rust.contains("self.out"), "{place}: {rust}");
        }
    }
}
