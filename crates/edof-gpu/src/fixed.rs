//! The fixed-point network on a device: the words and counters of [`edof_golden::Golden`], bit for bit.

use crate::device::{Buffer, Device, GpuError};
use crate::engine::{
    COUNTERS, EVEN, Engine, FrameMemory, Kept, Matrices, OutputShifts, Plane, StageShifts, Workspace,
};
use edof_core::colour::OUTPUTS_422;
use edof_core::frame::Frame422;
use edof_core::geometry::{PATCH, PATCH_PIXELS};
use edof_core::number::{InputWord, OutputWord, bits_of_mut, words_of};
use edof_core::{Geometry, RawFrame, ReconstructError, Reconstruction, Reconstructor};
use edof_golden::{Counts, GoldenFrame, LayerWords, StageCounts, Trace};
use edof_network::FixedNetwork;
use ndarray::Array2;
use std::time::Instant;

/// Luma, Cb, Cr.
const PLANES: [Plane; 3] = [
    Plane { first_output: 0, block: PATCH },
    Plane { first_output: PATCH_PIXELS, block: PATCH / 2 },
    Plane { first_output: PATCH_PIXELS * 3 / 2, block: PATCH / 2 },
];

/// A fixed-point network on a device.
///
/// ```
/// use edof_gpu::{Device, GpuGolden};
/// # let network = edof_device::random::natural(8, 8, 7);
/// # let raw = edof_core::RawFrame::from_values(ndarray::Array2::from_elem((32, 48), 700), 12, edof_core::CfaPhase::Rggb)?;
/// // `network` came out of edof_network::weight_file::load_fixed.
/// if let Ok(device) = Device::open(None) {
///     let frame = GpuGolden::new(device, network.clone(), "net.fixed.gpu")?.frame(&raw)?;
///     assert_eq!(frame, edof_golden::Golden::new(network)?.frame(&raw)?);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct GpuGolden {
    engine: Engine<i16>,
    network: FixedNetwork,
    geometry: Geometry,
    name: String,
    /// What the last frame used, for the next one of its size.
    kept: Kept<Memory>,
}

/// A device's memory for the frames of one size.
struct Memory {
    frame: FrameMemory<i16>,
    /// Words of a plane.
    words: Buffer<i16>,
    clipped: Buffer<u32>,
}

impl GpuGolden {
    /// Checks the network and brings it onto the device. `name` is what reports call it.
    ///
    /// # Errors
    /// [`GpuError`] for a network that could not run exactly, or what the driver says.
    pub fn new(device: Device, network: FixedNetwork, name: impl Into<String>) -> Result<Self, GpuError> {
        network.check()?;
        let geometry = Geometry::new(network.form.window, network.stride);
        let engine = Engine::new(device, &matrices(&network), geometry, &EVEN)?;
        Ok(Self { engine, geometry, name: name.into(), network, kept: Kept::nothing() })
    }

    /// The device.
    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.engine.device
    }

    /// Reconstructs a frame of any CFA phase, as [`edof_golden::Golden::frame`] does.
    ///
    /// # Errors
    /// [`GpuError`] for frames too small for a window or too large for the device, or what the driver says.
    pub fn frame(&self, raw: &RawFrame) -> Result<GoldenFrame, GpuError> {
        self.geometry.check_frame(raw.size())?;
        let (aligned, offset) = raw.to_rggb();
        let (height, width) = aligned.size();
        let mut memory = self.memory(height, width)?;
        let mut counts = Counts::new(self.network.form.layers);
        let count = |room: &Workspace<i16>, patches: usize| {
            counts.patches += patches as u64;
            let stages = self.stages(room)?;
            stages
                .iter()
                .zip(&mut counts.stages)
                .for_each(|(slots, sum)| slots.iter().for_each(|slot| *sum += *slot));
            Ok(())
        };
        self.engine.sums(&mut memory.frame, &aligned, PLANES, count)?;
        let mut frame = Frame422::zeros(height, width);
        let Frame422 { luma, chroma: [cb, cr] } = &mut frame;
        self.engine.device.clear(&mut memory.clipped)?;
        for (plane, sums) in [luma, cb, cr].into_iter().zip(&memory.frame.sums) {
            self.finish(sums, plane, &memory)?;
        }
        counts.saturated_sums = self.engine.device.read(&memory.clipped, 1)?[0].into();
        self.kept.keep(memory);
        Ok(GoldenFrame { frame, offset, size: raw.size(), counts })
    }

    /// The memory of the frame before, if that had this size.
    fn memory(&self, height: usize, width: usize) -> Result<Memory, GpuError> {
        if let Some(memory) = self.kept.take().filter(|kept| kept.frame.size() == (height, width)) {
            return Ok(memory);
        }
        let device = &self.engine.device;
        let frame = self.engine.memory((height, width), PLANES)?;
        Ok(Memory { frame, words: device.buffer(height * width)?, clipped: device.buffer(1)? })
    }

    /// Every boundary of each window: `windows` holds `window.pixels()` input words a window, one after the other.
    ///
    /// # Errors
    /// What the driver says.
    pub fn traces(&self, windows: &[InputWord]) -> Result<Vec<Trace>, GpuError> {
        let pixels = self.network.form.window.pixels();
        let patches = windows.len() / pixels;
        let mut room = self.engine.room(patches, patches)?;
        let transposed: Vec<i16> =
            (0..pixels).flat_map(|i| (0..patches).map(move |p| windows[p * pixels + i].to_bits())).collect();
        self.engine.device.write(&mut room.y, &transposed)?;
        self.engine.run(&mut room, patches)?;
        let codes = self.network.form.codes;
        let words = |buffer: &Buffer<i16>| self.engine.device.read(buffer, codes * patches);
        let layers: Vec<[Vec<i16>; 3]> = room
            .stages
            .iter()
            .map(|layer| Ok([words(&layer.b)?, words(&layer.z)?, words(&layer.sent)?]))
            .collect::<Result<_, GpuError>>()?;
        let out = self.engine.device.read(&room.out, OUTPUTS_422 * patches)?;
        let stages = self.stages(&room)?;
        let of = |all: &[i16], patch: usize| (0..codes).map(|i| all[i * patches + patch]).collect::<Vec<_>>();
        let trace = |patch: usize| Trace {
            input: windows[patch * pixels..][..pixels].to_vec(),
            layers: layers
                .iter()
                .map(|[b, z, sent]| LayerWords { b: of(b, patch), z: of(z, patch), sent: of(sent, patch) })
                .collect(),
            output: words_of(&out[patch * OUTPUTS_422..][..OUTPUTS_422]).to_vec(),
            stages: stages.iter().map(|slots| slots[patch]).collect(),
        };
        Ok((0..patches).map(trace).collect())
    }

    /// Counters of each stage, slot by slot.
    fn stages(&self, room: &Workspace<i16>) -> Result<Vec<Vec<StageCounts>>, GpuError> {
        let stage = |counts| {
            let counts = self.engine.device.read(counts, COUNTERS * room.slots)?;
            let counter = |i: usize, slot: usize| u64::from(counts[i * room.slots + slot]);
            let of = |slot| StageCounts {
                saturated_results: counter(0, slot),
                saturated_codes: counter(1, slot),
                saturated_differences: counter(2, slot),
                nonzeros: counter(3, slot),
            };
            Ok((0..room.slots).map(of).collect())
        };
        room.counts.iter().map(stage).collect()
    }

    /// Words of a plane's sums.
    fn finish(
        &self,
        sums: &Buffer<i32>,
        plane: &mut Array2<OutputWord>,
        memory: &Memory,
    ) -> Result<(), GpuError> {
        let device = &self.engine.device;
        let arguments = [sums.into(), plane.len().into(), (&memory.words).into(), (&memory.clipped).into()];
        device.launch(&self.engine.program, "finish", &arguments, [plane.len(), 1])?;
        device.read_into(&memory.words, bits_of_mut(plane.as_slice_mut().unwrap_or_default()))
    }
}

/// What the engine needs of a checked network.
fn matrices(network: &FixedNetwork) -> Matrices<'_, i16> {
    let first = StageShifts { base: 0, result: network.analysis_shift() };
    let middle = (0..network.form.middle_layers()).map(|layer| {
        let shifts = network.middle_shifts(layer);
        StageShifts { base: shifts.base, result: shifts.result }
    });
    let last = network.final_shifts();
    Matrices {
        form: network.form,
        code_bits: network.code_bits,
        analysis: &network.analysis.weights,
        recurrent: network.recurrent.iter().map(|s| &s.weights).collect(),
        thresholds: network.thresholds.iter().filter_map(|theta| theta.as_slice()).collect(),
        stages: std::iter::once(first).chain(middle).collect(),
        dictionary: &network.dictionary.weights,
        linear_path: network.linear_path.as_ref().map(|r| &r.weights),
        outputs: OutputShifts {
            dictionary: last.dictionary,
            linear_path: last.linear_path,
            result: last.result,
        },
    }
}

impl Reconstructor for GpuGolden {
    fn name(&self) -> &str {
        &self.name
    }

    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        Reconstruction::through(self.network.origin.values, raw, |raw| self.values(raw))
    }
}

impl GpuGolden {
    fn values(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        let start = Instant::now();
        let out = self.frame(raw).map_err(|error| error.of(&self.name))?;
        let seconds = start.elapsed().as_secs_f64();
        let mut multiplications = out.counts.multiplications(&self.network);
        // Zeros are multiplied here as all else.
        multiplications.executed = multiplications.dense;
        Ok(Reconstruction {
            frame: out.colour(),
            seconds,
            multiplications: Some(multiplications),
            counters: Some(out.counts.counters()),
            iterations: None,
        })
    }
}
