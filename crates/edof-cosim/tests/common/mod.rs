//! Designs, networks and patches for runs of a whole chain, and the chain itself, compiled.
pub mod traffic;

use crate::support;
use edof_core::draw::Draw;
use edof_core::number::InputWord;
use edof_cosim::chain::verilated::{Compiled, Verilated, write_images};
use edof_cosim::chain::{Device, Drive, Inputs, Outcome, Outputs};
use edof_cosim::verilator::Options;
use edof_cosim::{Error, Source, yosys};
use edof_device::Design;
use edof_device::design::memory::{SNAPSHOT, Set};
use edof_golden::cycle::{Cycle, Patch};
use edof_golden::scalar;
use edof_hdl::project::{self, Project};
use edof_network::FixedNetwork;
use std::path::{Path, PathBuf};

/// The root of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A design of `designs/`.
pub fn committed(name: &str) -> Design {
    Design::load(&root().join(format!("designs/{name}.json"))).unwrap()
}

/// A network whose words lie at the ends of their range, and one whose results mostly fit and whose codes are half zeros: the
/// first shows every saturation, the second every wrong bit.
pub fn networks(design: &Design, seed: u64) -> [FixedNetwork; 2] {
    [edof_device::random::for_design(design, seed), moderate(design, seed + 1)]
}

/// An extreme network with thresholds near zero, codes of one format, and matrices scaled down until few results saturate.
pub fn moderate(design: &Design, seed: u64) -> FixedNetwork {
    let mut network = edof_device::random::for_design(design, seed);
    let last = network.code_fractions[network.code_fractions.len() - 1];
    network.code_fractions.fill(last);
    let draw = &mut Draw::new(seed);
    let max = 1 << (design.code_bits - 5);
    network.thresholds.iter_mut().for_each(|theta| theta.mapv_inplace(|_| draw.whole(0, max) as i16));
    let windows: Vec<Vec<InputWord>> =
        (0..8).map(|_| natural_window(draw, design.form.window.side(), 15)).collect();
    for stage in 0..design.form.layers {
        // A stage's results depend on the stages before: those are settled first.
        while saturated(&network, &windows, stage) > 16 {
            let scaled = scaled_down(&network, stage);
            if scaled.check().is_err() || design.check_network(&scaled).is_err() {
                break;
            }
            network = scaled;
        }
    }
    network
}

fn saturated(network: &FixedNetwork, windows: &[Vec<InputWord>], stage: usize) -> u64 {
    windows.iter().map(|window| scalar::run(network, window).stages[stage].saturated_results).sum()
}

/// A stage's matrices with one more fraction bit.
fn scaled_down(network: &FixedNetwork, stage: usize) -> FixedNetwork {
    let mut network = network.clone();
    let last = network.form.layers - 1;
    match stage {
        0 => network.analysis.fraction += 1,
        stage if stage == last => {
            network.dictionary.fraction += 1;
            network.linear_path.iter_mut().for_each(|r| r.fraction += 1);
        }
        stage => {
            let index = network.form.recurrent_index(stage - 1);
            network.recurrent[index].fraction += 1;
        }
    }
    network
}

/// A window as a camera sees it: a slope with noise.
pub fn natural_window(draw: &mut Draw, side: usize, bits: u32) -> Vec<InputWord> {
    let max = (1i64 << bits) - 1;
    let (level, right, down) = (draw.whole(0, max), draw.whole(-max, max), draw.whole(-max, max));
    let pixel = |draw: &mut Draw, i: usize| {
        let (column, row) = ((i % side) as i64, (i / side) as i64);
        let slope = (right * column + down * row) / (2 * side as i64);
        InputWord::from_bits((level + slope + draw.whole(-200, 200)).clamp(0, max) as i16)
    };
    (0..side * side).map(|i| pixel(draw, i)).collect()
}

/// Windows for either set: natural ones, ones at the ends of their range, black ones.
pub fn patches(design: &Design, count: usize, seed: u64) -> Vec<Patch> {
    let draw = &mut Draw::new(seed);
    let window = design.form.window;
    let patch = |_| Patch {
        set: design.sets()[draw.whole(0, design.sets as i64 - 1) as usize],
        window: match draw.whole(0, 9) {
            0 => vec![InputWord::ZERO; window.pixels()],
            1..=4 => edof_device::random::extreme_window(draw, window.pixels()),
            _ => natural_window(draw, window.side(), 15),
        },
    };
    (0..count).map(patch).collect()
}

/// The same patches, but that of a third of them the window is too short or too long.
pub fn misfits(mut patches: Vec<Patch>, seed: u64) -> Vec<Patch> {
    let draw = &mut Draw::new(seed);
    for patch in &mut patches {
        let beats = patch.window.len() / 2;
        let wrong = match draw.whole(0, 3) {
            0 => [1, beats - 1, beats + 1][draw.whole(0, 2) as usize],
            _ => draw.whole(1, 2 * beats as i64) as usize,
        };
        if draw.whole(0, 2) == 0 {
            patch.window.resize_with(2 * wrong, || InputWord::from_bits(draw.whole(0, 0x7fff) as i16));
        }
    }
    patches
}

/// The same patches, all for one set.
pub fn for_set(set: Set, patches: Vec<Patch>) -> Vec<Patch> {
    patches.into_iter().map(|patch| Patch { set, ..patch }).collect()
}

/// A design with a network in each set, generated and compiled.
pub struct Setup {
    pub design: Design,
    pub networks: [FixedNetwork; 2],
    pub compiled: Compiled,
}

impl Setup {
    /// The design with [`networks`] of that seed.
    pub fn new(design: Design, seed: u64) -> Self {
        let networks = networks(&design, seed);
        Self::new_with(design, networks)
    }

    /// The design with these networks.
    pub fn new_with(design: Design, networks: [FixedNetwork; 2]) -> Self {
        Self::altered(design, networks, |project| project)
    }

    /// The design as it is after something was done to its files.
    pub fn altered(
        design: Design,
        networks: [FixedNetwork; 2],
        alter: impl FnOnce(Project) -> Project,
    ) -> Self {
        let project = project::calculator(&design, [&networks[0], &networks[1]]).unwrap();
        let compiled = Compiled::new(&alter(project), design.stages.len(), &support::options()).unwrap();
        Self { design, networks, compiled }
    }

    /// The design as Yosys maps it to the cells of its board's FPGA.
    pub fn mapped(
        design: Design,
        networks: [FixedNetwork; 2],
        map: impl FnOnce(&Source, &yosys::Options) -> Result<Source, Error>,
    ) -> Self {
        let part = &design.board.part;
        let project = project::calculator(&design, [&networks[0], &networks[1]]).unwrap().on_part(part);
        let images = tempfile::tempdir().unwrap();
        write_images(&project, images.path()).unwrap();
        let memory_dir = Some(images.path().into());
        let options = yosys::Options { memory_dir, ..yosys::Options::default() };
        let source = map(&Source::from(&project), &options).unwrap();
        let stages = design.stages.len();
        // Verilator makes fifty megabytes of C++ of 35,000 cells, and a run is of a few thousand cycles.
        let options = Options { optimize: 0, ..support::options() };
        let compiled = Compiled::of_source(&source, &project, stages, &options).unwrap();
        Self { design, networks, compiled }
    }

    /// A fresh circuit.
    pub fn start(&self, seed: u64) -> Verilated {
        self.compiled.start(seed).unwrap()
    }

    /// The model, which holds these networks.
    pub fn model(&self) -> Cycle {
        self.model_of([&self.networks[0], &self.networks[1]])
    }

    /// The model, which holds other networks.
    pub fn model_of(&self, networks: [&FixedNetwork; 2]) -> Cycle {
        Cycle::new(&self.design, networks).unwrap()
    }

    /// Runs patches through a fresh circuit.
    pub fn run(&self, drive: &Drive, patches: Vec<Patch>, seed: u64) -> Outcome {
        drive.run(self.model(), patches, &mut self.start(seed), &mut |_| ()).unwrap()
    }
}

/// A circuit, and what passed through its ports.
pub struct Recorded<D> {
    pub device: D,
    /// Every cycle, reset included.
    pub inputs: Vec<Inputs>,
    /// Words of patches that were taken.
    pub words: Vec<i16>,
    /// Cycle of the last write, except for accesses that only read the counters.
    pub last_write: usize,
}

impl<D: Device> Recorded<D> {
    pub fn new(device: D) -> Self {
        Self { device, inputs: vec![], words: vec![], last_write: 0 }
    }

    /// The cycle in which the first beat for set 1 is offered.
    pub fn first_of_second_set(&self) -> Option<usize> {
        self.inputs.iter().position(|inputs| inputs.window.is_some_and(|beat| beat.set == Set::Second))
    }
}

impl<D: Device> Device for Recorded<D> {
    fn cycle(&mut self, inputs: &Inputs, outputs: &mut Outputs) -> Result<(), Error> {
        self.device.cycle(inputs, outputs)?;
        let taken = outputs.patch.filter(|_| inputs.patch_ready && !inputs.reset);
        self.words.extend(taken.iter().flat_map(|beat| beat.words));
        if inputs.write.is_some_and(|(address, _)| address != SNAPSHOT) {
            self.last_write = self.inputs.len();
        }
        self.inputs.push(*inputs);
        Ok(())
    }
}

/// Fails with the report of the first difference, if there is one.
#[track_caller]
pub fn expect_clean(outcome: &Outcome) {
    if let Some(difference) = &outcome.difference {
        panic!("{difference}");
    }
}
