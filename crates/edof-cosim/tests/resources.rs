//! What Yosys makes of the stages of the committed designs and of what is around them, each mapped flat from the files as they are emitted, against the estimate. Their timing is computed from the same mapping, which is made once for both.

use crate::common::committed;
use crate::timing::{of_core, of_stages};
use edof_core::Stride;
use edof_cosim::Source;
use edof_cosim::system;
use edof_cosim::yosys::{Cells, Options, synthesize};
use edof_device::Design;
use edof_device::board::{KC705, Resources};
use edof_device::design::{FrameSize, StageSize};
use edof_golden::Display;
use edof_hdl::blocks::frame_check::FrameCheck;
use edof_hdl::board::{BoardRegisters, CycleCount, Identity, PatternSource, PictureWindow};
use edof_hdl::resources::{around_the_chain, stages};
use edof_network::network::{Form, Recurrence};
use edof_verilog::describe::Circuit;
use std::collections::BTreeMap;

/// What of a stage is not as estimated: exactly, or within 15 %.
fn differences(name: &str, estimated: &Resources, measured: &Cells) -> Vec<String> {
    let cells = KC705.part.named(estimated).0;
    let exact = cells[..3].iter().map(|(name, count)| (*name, *count, measured.count(name)));
    let about =
        [("LUT", estimated.luts, measured.luts()), ("FF", estimated.registers, measured.flip_flops())];
    let differs = |percent: usize| {
        move |(_, estimated, measured): &(&str, usize, usize)| {
            estimated.abs_diff(*measured) * 100 > percent * measured
        }
    };
    let wrong = exact.filter(differs(0)).chain(about.into_iter().filter(differs(15)));
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
    for (plan, measured) in of_stages(design) {
        let name = format!("{} stage {}", design.name, plan.index);
        assert_eq!((measured.dsps, measured.accumulating_dsps), (plan.dsps(), plan.dsps()), "{name}");
        wrong.extend(differences(&name, &estimated[plan.index], &measured.cells));
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

/// The instances in `stream_core` that its modules around the chain are, or consist of.
const AROUND: [(&str, &str); 7] = [
    ("window_reorder", "core/windows"),
    ("lines", "core/lines/pairs"),
    ("lines", "core/lines/raster"),
    ("display", "core/display"),
    ("table_reader", "core/tables"),
    ("frame_check", "core/check"),
    ("lines", "core/lines/overlap"),
];

/// Holds the modules around the chain to the estimate, all but the registers of `stream_core` itself.
fn assert_around_as_estimated(design: &Design) {
    let overlaps = design.frame.stride != Stride::PATCH;
    let instances = &AROUND[..AROUND.len() - usize::from(!overlaps)];
    let paths: Vec<String> = instances.iter().map(|(_, path)| (*path).to_owned()).collect();
    let mut measured = BTreeMap::<&str, Cells>::new();
    for ((module, _), part) in instances.iter().zip(of_core(design, &paths)) {
        let all = &mut measured.entry(module).or_default().0;
        part.cells.0.into_iter().for_each(|(cell, count)| *all.entry(cell).or_default() += count);
    }
    let modules = around_the_chain(design).into_iter().filter(|(module, _)| *module != "others");
    let wrong: String = modules
        .flat_map(|(module, estimated)| {
            differences(&format!("{module} of {}", design.name), &estimated, &measured[module])
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong}");
}

/// The smallest lines whose patches overlap.
#[test]
fn what_is_around_the_chain_takes_what_was_estimated() {
    let tiny = committed("tiny");
    let frame = FrameSize { stride: Stride::new(4).unwrap(), ..tiny.frame };
    assert_around_as_estimated(&Design { frame, ..tiny });
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn what_is_around_the_chain_of_kc705_takes_what_was_estimated() {
    assert_around_as_estimated(&committed("kc705"));
}

/// Elaborated, checked and mapped module by module: a whole core laid flat takes hours.
const WHOLE: &str = "
read_verilog -defer *.v
hierarchy -check -top edof_core
proc
check -assert
select -assert-none t:$dlatch t:$adlatch t:$dlatchsr
synth_xilinx -family xc7 -noiopad -noclkbuf
check -assert
tee -q -o cells.json stat -json
";

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn the_whole_core_of_kc705_has_neither_latch_nor_loop_nor_two_drivers_and_fits_the_board() {
    let design = committed("kc705");
    let network = edof_device::random::for_design(&design, 1);
    let project = system::project(&design, [&network, &network], &Display::default()).unwrap();
    let work = tempfile::tempdir().unwrap();
    for (name, text) in project.verilog.iter().chain(&project.memory) {
        let file = work.path().join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
    }
    std::fs::write(work.path().join("whole.ys"), WHOLE).unwrap();
    let mut yosys = std::process::Command::new("yosys");
    let run = yosys.args(["-q", "-s", "whole.ys"]).current_dir(work.path()).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = std::fs::read_to_string(work.path().join("cells.json")).unwrap();
    let stat: serde_json::Value = serde_json::from_str(&text).unwrap();
    let cells = serde_json::from_value(stat["design"]["num_cells_by_type"].clone()).unwrap();
    let cells = Cells(cells);
    println!("{cells:?}");
    assert!(
        (design.stages().map(|plan| plan.dsps()).sum::<usize>()..=KC705.part.cells.multipliers)
            .contains(&cells.count("DSP48E1"))
    );
    assert!(2 * cells.count("RAMB36E1") + cells.count("RAMB18E1") <= 2 * KC705.part.cells.memories);
    assert!(cells.luts() * 100 <= KC705.part.cells.luts * 60);
}

/// 3 % of the 61,000 LUTs and of the 725 halves of block RAMs that `edof_core` of `kc705` takes (docs/hardware.md).
const OF_SELF_CHECK: [usize; 2] = [1_830, 21];

#[test]
#[ignore = "a minute: scripts/soak.sh"]
fn what_only_checks_pictures_takes_less_than_three_percent_of_the_core() {
    let found = self_check(&committed("kc705"));
    println!("{} LUTs and {} halves of block RAMs", found[0], found[1]);
    assert!(found[0] <= OF_SELF_CHECK[0] && found[1] <= OF_SELF_CHECK[1], "{found:?}");
}

/// LUTs and halves of block RAMs of all that only shows whether pictures are right: CRCs of frames, patterns, the window to pictures, counters
/// of cycles, and what shows them to the host.
fn self_check(design: &Design) -> [usize; 2] {
    let cells = |source: &Source| synthesize(source, &Options::default()).unwrap().cells;
    let of = |circuit: &mut dyn Circuit| cells(&Source::circuit(circuit).unwrap());
    let checks = 1 + design.stages.len();
    let pixels = design.frame.width * design.frame.height;
    let registers = |remove: &[&str]| {
        let identity = Identity { design_hash: 1, weights_hash: 2, frame: (1920, 1080) };
        let mut source = Source::circuit(&mut BoardRegisters::new(design, &identity)).unwrap();
        let (_, text) = source.files.iter_mut().find(|(name, _)| name == "board_registers.v").unwrap();
        for word in remove {
            assert!(text.contains(word), "{word}");
            let kept = text.lines().filter(|line| !(line.contains("found_") && line.contains(word)));
            *text = kept.map(|line| format!("{line}\n")).collect();
        }
        cells(&source)
    };
    let shown = ["<= check_", "<= core_cycles_i", "<= input_cycles_i", "<= screen_cycles_i"];
    let parts = [
        (3, of(&mut FrameCheck::new(16, pixels))),
        (checks, of(&mut FrameCheck::new(32, pixels / 2))),
        (1, of(&mut PatternSource::new(design.frame))),
        (1, of(&mut PictureWindow::new())),
        (3, of(&mut CycleCount::default())),
        (1, registers(&[])),
    ];
    let sum =
        |count: fn(&Cells) -> usize| parts.iter().map(|(times, cells)| times * count(cells)).sum::<usize>();
    let halves = |cells: &Cells| 2 * cells.count("RAMB36E1") + cells.count("RAMB18E1");
    [sum(Cells::luts) - registers(&shown).luts(), sum(halves)]
}
