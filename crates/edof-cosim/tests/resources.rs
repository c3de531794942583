//! What Yosys makes of the stages of the committed designs, each mapped flat from the files as they are emitted, against what was estimated
//! before it ran. It is the mapping that their timing is told from, made once for both.

use crate::common::committed;
use crate::timing::of_stages;
use edof_cosim::yosys::Cells;
use edof_hdl::resources::{Resources, stages};
use edof_spec::Design;
use edof_spec::design::{FrameSize, StageSize};
use edof_spec::network::{Form, Recurrence};

/// What of a stage is not as estimated: exactly, or within 15 %.
fn differences(name: &str, estimated: &Resources, measured: &Cells) -> Vec<String> {
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
    wrong
        .map(|(what, estimated, measured)| {
            format!("{what} of {name}: {estimated} estimated, {measured} measured\n")
        })
        .collect()
}

/// Holds every stage to the estimate.
fn assert_as_estimated(design: &Design) {
    let mut wrong = vec![];
    let estimated = stages(design);
    for ((plan, estimated), measured) in design.stages().zip(&estimated).zip(of_stages(design)) {
        let name = format!("{} stage {}", design.name, plan.index);
        assert_eq!((measured.dsps, measured.accumulating_dsps), (plan.dsps(), plan.dsps()), "{name}");
        wrong.extend(differences(&name, estimated, &measured.cells));
    }
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
