//! The float network on a device: the numbers of `edof-train`'s `FloatReconstructor` in RGB, up to the rounding of sums in another order.

use crate::device::{Device, GpuError};
use crate::engine::{Engine, FrameMemory, Kept, Matrices, OutputShifts, Plane, StageShifts};
use edof_core::colour::RGB_OUTPUTS;
use edof_core::geometry::{PATCH, PATCH_PIXELS};
use edof_core::overlap::Overlap;
use edof_core::reconstructor::Multiplications;
use edof_core::{ColourFrame, Geometry, RawFrame, ReconstructError, Reconstruction, Reconstructor, Stride};
use edof_network::Network;
use std::time::Instant;

/// Red, green, blue.
const PLANES: [Plane; 3] = [
    Plane { first_output: 0, block: PATCH },
    Plane { first_output: PATCH_PIXELS, block: PATCH },
    Plane { first_output: 2 * PATCH_PIXELS, block: PATCH },
];

/// A float network on a device.
pub struct GpuFloat {
    engine: Engine<f32>,
    network: Network,
    geometry: Geometry,
    name: String,
    /// What the last frame used, for the next one of its size.
    kept: Kept<FrameMemory<f32>>,
}

impl GpuFloat {
    /// Brings a network onto the device, for a stride. Reports call it by its network's name, with `.float.gpu`.
    ///
    /// # Errors
    /// [`GpuError`] for matrices that do not fit their form, or what the driver says.
    pub fn new(device: Device, network: Network, stride: Stride, overlap: Overlap) -> Result<Self, GpuError> {
        network.check()?;
        network.form.check_single()?;
        let geometry = Geometry::new(network.form.window, stride);
        let averaging: Vec<f32> = overlap.weights(stride).iter().map(|weight| *weight as f32).collect();
        let engine = Engine::new(device, &matrices(&network), geometry, &averaging)?;
        Ok(Self {
            name: format!("{}.float.gpu", network.origin.name),
            engine,
            network,
            geometry,
            kept: Kept::nothing(),
        })
    }

    /// The device.
    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.engine.device
    }

    /// Reconstructs a frame of any CFA phase.
    ///
    /// # Errors
    /// [`GpuError`] for frames too small for a window or too large for the device, or what the driver says.
    pub fn frame(&self, raw: &RawFrame) -> Result<ColourFrame, GpuError> {
        let (height, width) = raw.size();
        self.geometry.check_frame((height, width))?;
        let (aligned, (row, column)) = raw.to_rggb();
        let (rows, columns) = aligned.size();
        let mut memory = match self.kept.take().filter(|kept| kept.size() == (rows, columns)) {
            Some(kept) => kept,
            None => self.engine.memory((rows, columns), PLANES)?,
        };
        self.engine.sums(&mut memory, &aligned, PLANES, |_, _| Ok(()))?;
        let mut frame = ColourFrame::zeros(rows, columns);
        for (mut plane, sums) in frame.planes.outer_iter_mut().zip(&memory.sums) {
            self.engine.device.read_into(sums, plane.as_slice_mut().unwrap_or_default())?;
        }
        self.kept.keep(memory);
        Ok(if (rows, columns) == (height, width) { frame } else { frame.crop(row, column, height, width) })
    }
}

/// What the engine needs of a checked network.
fn matrices(network: &Network) -> Matrices<'_, f32> {
    Matrices {
        form: network.form,
        code_bits: 0,
        analysis: &network.analysis,
        recurrent: network.recurrent.iter().collect(),
        thresholds: network.thresholds.iter().filter_map(|theta| theta.as_slice()).collect(),
        stages: vec![StageShifts::default(); network.form.shrinkages()],
        dictionary: &network.dictionary,
        linear_path: network.linear_path.as_ref(),
        outputs: OutputShifts::default(),
    }
}

impl Reconstructor for GpuFloat {
    fn name(&self) -> &str {
        &self.name
    }

    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        Reconstruction::through(self.network.origin.values, raw, |raw| self.values(raw))
    }
}

impl GpuFloat {
    fn values(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        let start = Instant::now();
        let frame = self.frame(raw).map_err(|error| error.of(&self.name))?;
        let seconds = start.elapsed().as_secs_f64();
        let (height, width) = raw.to_rggb().0.size();
        let (rows, columns) = self.geometry.patches(height, width);
        let dense = (rows * columns) as u64 * self.network.form.dense_multiplications(RGB_OUTPUTS);
        Ok(Reconstruction {
            frame,
            seconds,
            multiplications: Some(Multiplications { dense, executed: dense }),
            counters: None,
            iterations: None,
        })
    }
}
