//! The fixed-point network on a device: the words and counters of [`edof_golden::Golden`], bit for bit.

use crate::device::{Buffer, Device, GpuError};
use crate::engine::{COUNTERS, EVEN, Engine, Matrices, OutputShifts, Plane, StageShifts, Workspace};
use edof_golden::overlap_add::empty_frame;
use edof_golden::{Counts, GoldenFrame, LayerWords, StageCounts, Trace};
use edof_image::colour::OUTPUTS_422;
use edof_image::frame::Frame422;
use edof_image::geometry::{PATCH, PATCH_PIXELS};
use edof_image::{Geometry, RawFrame, ReconstructError, Reconstruction, Reconstructor};
use edof_network::FixedNetwork;
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
/// # let network = edof_random::natural(8, 8, 7);
/// # let raw = edof_image::RawFrame::from_values(ndarray::Array2::from_elem((32, 48), 700), 12, edof_image::CfaPhase::Rggb)?;
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
        Ok(Self { engine, geometry, name: name.into(), network })
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
        let mut counts = Counts::new(self.network.form.layers);
        let count = |room: &Workspace<i16>, patches: usize| {
            self.stages(room, patches)?.iter().for_each(|stages| counts.add(stages));
            Ok(())
        };
        let sums = self.engine.sums(&aligned, PLANES, count)?;
        let mut frame = empty_frame(height, width);
        let Frame422 { luma, chroma: [cb, cr] } = &mut frame;
        let mut clipped = self.engine.device.buffer(1)?;
        self.engine.device.clear(&mut clipped)?;
        for (plane, sums) in [luma, cb, cr].into_iter().zip(&sums) {
            let words = self.finish(sums, plane.len(), &clipped)?;
            plane.iter_mut().zip(words).for_each(|(at, word)| *at = word);
        }
        counts.saturated_sums = self.engine.device.read(&clipped, 1)?[0].into();
        Ok(GoldenFrame { frame, offset, size: raw.size(), counts })
    }

    /// Every boundary of each window: `windows` holds `window.pixels()` input words a window, one after the other.
    ///
    /// # Errors
    /// What the driver says.
    pub fn traces(&self, windows: &[i16]) -> Result<Vec<Trace>, GpuError> {
        let pixels = self.network.form.window.pixels();
        let patches = windows.len() / pixels;
        let mut room = self.engine.room(patches)?;
        let transposed: Vec<i16> =
            (0..pixels).flat_map(|i| (0..patches).map(move |p| windows[p * pixels + i])).collect();
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
        let stages = self.stages(&room, patches)?;
        let of = |all: &[i16], patch: usize| (0..codes).map(|i| all[i * patches + patch]).collect::<Vec<_>>();
        let trace = |(patch, stages)| Trace {
            input: windows[patch * pixels..][..pixels].to_vec(),
            layers: layers
                .iter()
                .map(|[b, z, sent]| LayerWords { b: of(b, patch), z: of(z, patch), sent: of(sent, patch) })
                .collect(),
            output: out[patch * OUTPUTS_422..][..OUTPUTS_422].to_vec(),
            stages,
        };
        Ok(stages.into_iter().enumerate().map(trace).collect())
    }

    /// Counters of the first patches, patch by patch.
    fn stages(&self, room: &Workspace<i16>, patches: usize) -> Result<Vec<Vec<StageCounts>>, GpuError> {
        let read = |counts| self.engine.device.read(counts, COUNTERS * room.pitch);
        let all = room.counts.iter().map(read).collect::<Result<Vec<_>, _>>()?;
        let stage = |counts: &[u32], patch: usize| {
            let counter = |i: usize| u64::from(counts[i * room.pitch + patch]);
            StageCounts {
                saturated_results: counter(0),
                saturated_codes: counter(1),
                saturated_differences: counter(2),
                nonzeros: counter(3),
            }
        };
        Ok((0..patches).map(|patch| all.iter().map(|counts| stage(counts, patch)).collect()).collect())
    }

    /// Words of sums.
    fn finish(&self, sums: &Buffer<i32>, length: usize, clipped: &Buffer<u32>) -> Result<Vec<i16>, GpuError> {
        let device = &self.engine.device;
        let words = device.buffer(length)?;
        let arguments = [sums.into(), length.into(), (&words).into(), clipped.into()];
        device.launch(&self.engine.program, "finish", &arguments, [length, 1])?;
        device.read(&words, length)
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
