//! What Yosys makes of the committed designs, against what was estimated before it ran.

use edof_cosim::Source;
use edof_cosim::yosys::{Options, Report, synthesize};
use edof_hdl::project;
use edof_hdl::resources::{Resources, stages, whole};
use edof_spec::Design;
use edof_spec::design::{FrameSize, StageSize};
use edof_spec::network::{Form, Recurrence};

fn committed(name: &str) -> Design {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    Design::load(&root.join(format!("designs/{name}.json"))).unwrap()
}

/// Maps a chain. Without the names of their images all banks of a stage are one module, which is mapped once.
fn mapped(design: &Design) -> Report {
    let network = edof_random::for_design(design, 1);
    let mut source = Source::from(&project::calculator(design, [&network, &network]).unwrap());
    for (_, text) in &mut source.files {
        *text = without_images(text);
    }
    synthesize(&source, &Options { keep_hierarchy: true, ..Options::default() }).unwrap()
}

fn without_images(text: &str) -> String {
    let line = |line: &str| match line.split_once(".INIT(\"") {
        Some((before, after)) => {
            let (_, rest) = after.split_once('"').unwrap();
            format!("{before}.INIT(\"\"{rest}")
        }
        None => line.to_string(),
    };
    text.lines().map(|l| line(l) + "\n").collect()
}

/// What of a stage is not as estimated: exactly, or within 15 %.
fn differences(name: &str, estimated: &Resources, measured: &Report) -> Vec<String> {
    let exact = [
        ("DSP48E1", estimated.dsp48e1, measured.dsp48e1()),
        ("RAMB36E1", estimated.ramb36e1, measured.ramb36e1()),
        ("RAMB18E1", estimated.ramb18e1, measured.ramb18e1()),
    ];
    let about = [("LUT", estimated.lut, measured.luts()), ("FF", estimated.ff, measured.flip_flops())];
    let differs = |percent: usize| {
        move |(_, estimated, measured): &(&str, usize, usize)| {
            estimated.abs_diff(*measured) * 100 > percent * measured
        }
    };
    let wrong = exact.into_iter().filter(differs(0)).chain(about.into_iter().filter(differs(15)));
    let part =
        |(part, report): (&String, &Report)| format!("{part} {} {}", report.luts(), report.flip_flops());
    let parts: Vec<String> = measured.parts.iter().map(part).collect();
    let parts = parts.join(", ");
    wrong
        .map(|(what, estimated, measured)| {
            format!(
                "{what} of {name}: {estimated} estimated, {measured} measured; LUT and FF of parts: {parts}\n"
            )
        })
        .collect()
}

/// Holds every stage and the whole to the estimate.
fn assert_as_estimated(design: &Design) {
    let report = mapped(design);
    let mut wrong = vec![];
    for (index, (plan, estimated)) in design.stages().zip(stages(design)).enumerate() {
        let part = &report.parts[&format!("stages_{index}")];
        let name = format!("{} stage {index}", design.name);
        assert_eq!(part.dsp48e1(), plan.lanes * plan.rows, "{name}");
        assert_eq!(part.accumulators_inside(), plan.lanes * plan.rows, "{name}");
        wrong.extend(differences(&name, &estimated, part));
    }
    wrong.extend(differences("the whole calculator", &whole(design), &report));
    assert!(wrong.is_empty(), "{}", wrong.concat());
}

#[test]
fn tiny_takes_what_was_estimated() {
    assert_as_estimated(&committed("tiny"));
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn paper_takes_what_was_estimated() {
    assert_as_estimated(&committed("paper"));
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn kc705_takes_what_was_estimated() {
    assert_as_estimated(&committed("kc705"));
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn the_difference_form_takes_what_was_estimated() {
    let tiny = committed("tiny");
    let form = Form { recurrence: Recurrence::Difference, linear_path: false, ..tiny.form };
    let size = |lanes, rows| StageSize { lanes, rows };
    let design = Design {
        name: "difference".into(),
        form,
        stages: vec![size(8, 1), size(16, 2), size(16, 1), size(64, 1)],
        frame: FrameSize { width: 64, ..tiny.frame },
        ..tiny
    };
    design.check().unwrap();
    assert_as_estimated(&design);
}
