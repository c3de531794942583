//! A network's matrices in a device's memory, and frames through them.

use crate::device::{Buffer, Device, Element, GpuError};
use edof_core::geometry::{PATCH, PATCH_PIXELS};
use edof_core::{Geometry, RawFrame};
use edof_network::network::{Form, Recurrence, Shrinkage};
use ndarray::Array2;
use opencl3::program::Program;
use std::sync::Mutex;

/// What a work-item makes of one patch, as in `network.cl`.
const ROWS: usize = 8;

/// Patches that go through the network together, at most, but at least a row of them: enough to keep a device busy, and words of all
/// boundaries in some tens of megabytes.
const PATCHES: usize = 16 * 1024;

/// A number that the kernels are compiled for.
pub(crate) trait Word: Element {
    /// Sum of overlapping patches.
    type Total: Element;
    /// Patches of a work-item, `EACH` in `network.cl`.
    const EACH: usize;
    /// Options of the compiler.
    const OPTIONS: &str;
}

/// The contract's words.
impl Word for i16 {
    type Total = i32;
    // Sums of 64 bits of more patches do not fit the registers of a GPU.
    const EACH: usize = 1;
    const OPTIONS: &str = "-cl-std=CL1.2 -D FIXED";
}

/// The float network's numbers.
impl Word for f32 {
    type Total = f32;
    const EACH: usize = 4;
    const OPTIONS: &str = "-cl-std=CL1.2";
}

/// Shifts of a stage; none of floats.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct StageShifts {
    pub base: u32,
    pub result: u32,
}

/// Shifts of F; none of floats.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct OutputShifts {
    pub dictionary: u32,
    pub linear_path: u32,
    pub result: u32,
}

/// What a network is made of, whatever its numbers: I's matrix and the distinct ones of the Ms.
pub(crate) struct Matrices<'a, T> {
    pub form: Form,
    pub code_bits: u32,
    pub analysis: &'a Array2<T>,
    pub recurrent: Vec<&'a Array2<T>>,
    pub thresholds: Vec<&'a [T]>,
    pub stages: Vec<StageShifts>,
    pub dictionary: &'a Array2<T>,
    pub linear_path: Option<&'a Array2<T>>,
    pub outputs: OutputShifts,
}

/// One plane of a picture: which of F's rows it has, in how many columns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub first_output: usize,
    /// Columns of a patch: 8, or 4 where every second pixel has a sample.
    pub block: usize,
}

impl Plane {
    /// Columns of the region in a frame of `width`.
    pub(crate) const fn width(self, width: usize) -> usize {
        width * self.block / PATCH
    }
}

/// A network on a device.
pub(crate) struct Engine<T> {
    pub(crate) device: Device,
    pub(crate) program: Program,
    form: Form,
    code_bits: u32,
    geometry: Geometry,
    analysis: Buffer<T>,
    recurrent: Vec<Buffer<T>>,
    thresholds: Vec<Buffer<T>>,
    stages: Vec<StageShifts>,
    dictionary: Buffer<T>,
    linear_path: Option<Buffer<T>>,
    outputs: OutputShifts,
    /// F's rows.
    rows: usize,
    /// Weight of each of a patch's pixels, where F's weights do not carry it.
    averaging: Buffer<f32>,
}

/// Words of some patches at every boundary.
pub(crate) struct Workspace<T> {
    pub(crate) y: Buffer<T>,
    pub(crate) stages: Vec<Words<T>>,
    pub(crate) out: Buffer<T>,
    /// Counters of I, each M, F: [`COUNTERS`] times `slots`.
    pub(crate) counts: Vec<Buffer<u32>>,
    /// Patches from one element to the next.
    pub(crate) pitch: usize,
    /// Counters of each kind. A patch counts in that of its number modulo `slots`.
    pub(crate) slots: usize,
}

/// A device's memory for the frames of one size.
pub(crate) struct FrameMemory<T: Word> {
    size: (usize, usize),
    pixels: Buffer<u16>,
    /// Sums of overlapping patches over each pixel, plane by plane.
    pub(crate) sums: [Buffer<T::Total>; 3],
    room: Workspace<T>,
}

impl<T: Word> FrameMemory<T> {
    /// Rows and columns.
    pub(crate) const fn size(&self) -> (usize, usize) {
        self.size
    }
}

/// What a frame used, for the next one. Of two frames at a time, one reserves anew.
pub(crate) struct Kept<M>(Mutex<Option<M>>);

impl<M> Kept<M> {
    pub(crate) const fn nothing() -> Self {
        Self(Mutex::new(None))
    }

    pub(crate) fn take(&self) -> Option<M> {
        self.0.lock().ok()?.take()
    }

    pub(crate) fn keep(&self, memory: M) {
        if let Ok(mut kept) = self.0.lock() {
            *kept = Some(memory);
        }
    }
}

/// What a stage made.
pub(crate) struct Words<T> {
    pub(crate) b: Buffer<T>,
    pub(crate) z: Buffer<T>,
    pub(crate) sent: Buffer<T>,
}

/// Code of the device.
const SOURCE: &str = include_str!("network.cl");

/// Returns the options of the compiler for a network of a shrinkage.
fn options<T: Word>(shrinkage: Shrinkage) -> String {
    format!("{} -D EACH={} -D SHRUNK={}", T::OPTIONS, T::EACH, function(shrinkage))
}

/// Returns the name of the function in [`SOURCE`].
fn function(shrinkage: Shrinkage) -> String {
    shrinkage.name().replace('-', "_")
}

/// Counters of a patch and stage, in the order of `network.cl`.
pub(crate) const COUNTERS: usize = 4;

/// Counters of each kind that a frame's patches share: enough that few of them wait for one another, and few to read.
const SLOTS: usize = 1024;

impl<T: Word> Engine<T> {
    pub(crate) fn new(
        device: Device,
        matrices: &Matrices<'_, T>,
        geometry: Geometry,
        averaging: &[f32],
    ) -> Result<Self, GpuError> {
        let upload = |matrix: &Array2<T>| device.upload(&packed(matrix));
        let padded_theta = |theta: &&[T]| {
            let mut theta = theta.to_vec();
            theta.resize(theta.len().next_multiple_of(ROWS), T::default());
            device.upload(&theta)
        };
        Ok(Self {
            program: device.compile(SOURCE, &options::<T>(matrices.form.shrinkage))?,
            form: matrices.form,
            code_bits: matrices.code_bits,
            geometry,
            analysis: upload(matrices.analysis)?,
            recurrent: matrices.recurrent.iter().map(|s| upload(s)).collect::<Result<_, _>>()?,
            thresholds: matrices.thresholds.iter().map(padded_theta).collect::<Result<_, _>>()?,
            stages: matrices.stages.clone(),
            dictionary: upload(matrices.dictionary)?,
            linear_path: matrices.linear_path.map(upload).transpose()?,
            outputs: matrices.outputs,
            rows: matrices.dictionary.nrows(),
            averaging: device.upload(averaging)?,
            device,
        })
    }

    /// Room for `pitch` patches, with `slots` counters of each kind.
    pub(crate) fn room(&self, pitch: usize, slots: usize) -> Result<Workspace<T>, GpuError> {
        let device = &self.device;
        let codes = || device.buffer(self.form.codes * pitch);
        let words = |_| Ok(Words { b: codes()?, z: codes()?, sent: codes()? });
        Ok(Workspace {
            y: device.buffer(self.form.window.pixels() * pitch)?,
            stages: (0..self.form.shrinkages()).map(words).collect::<Result<_, GpuError>>()?,
            out: device.buffer(self.rows * pitch)?,
            counts: (0..self.form.layers)
                .map(|_| device.buffer(COUNTERS * slots))
                .collect::<Result<_, _>>()?,
            pitch,
            slots,
        })
    }

    /// Runs the first `patches` windows of a room through the network.
    pub(crate) fn run(&self, room: &mut Workspace<T>, patches: usize) -> Result<(), GpuError> {
        room.counts.iter_mut().try_for_each(|counts| self.device.clear(counts))?;
        (0..self.form.shrinkages()).try_for_each(|t| self.stage(room, t, patches))?;
        self.outputs(room, patches)
    }

    /// I (`t` = 0) or an M.
    fn stage(&self, room: &Workspace<T>, t: usize, patches: usize) -> Result<(), GpuError> {
        let codes = self.form.codes;
        let before = t.checked_sub(1).map(|before| &room.stages[before]);
        let base = match self.form.recurrence {
            Recurrence::Direct => &room.stages[0],
            Recurrence::Difference => before.unwrap_or(&room.stages[0]),
        };
        let (weights, vectors, inputs) = match before {
            None => (&self.analysis, &room.y, self.form.window.pixels()),
            Some(before) => (&self.recurrent[self.form.recurrent_index(t - 1)], &before.sent, codes),
        };
        let here = &room.stages[t];
        let sends_difference =
            self.form.recurrence == Recurrence::Difference && t + 1 < self.form.shrinkages();
        let padded = codes.next_multiple_of(ROWS);
        self.device.launch(
            &self.program,
            "stage",
            &[
                inputs.into(),
                codes.into(),
                padded.into(),
                patches.into(),
                room.pitch.into(),
                weights.into(),
                (&self.thresholds[t]).into(),
                vectors.into(),
                before.is_some().into(),
                self.stages[t].base.into(),
                (&base.b).into(),
                self.stages[t].result.into(),
                self.code_bits.into(),
                sends_difference.into(),
                before.is_some().into(),
                (&before.unwrap_or(here).z).into(),
                (&here.b).into(),
                (&here.z).into(),
                (&here.sent).into(),
                room.slots.into(),
                (&room.counts[t]).into(),
            ],
            [patches.div_ceil(T::EACH), padded / ROWS],
        )
    }

    /// F.
    fn outputs(&self, room: &Workspace<T>, patches: usize) -> Result<(), GpuError> {
        let last = self.form.shrinkages() - 1;
        self.device.launch(
            &self.program,
            "outputs",
            &[
                self.form.codes.into(),
                self.form.window.pixels().into(),
                self.rows.into(),
                patches.into(),
                room.pitch.into(),
                (&self.dictionary).into(),
                (&room.stages[last].sent).into(),
                self.outputs.dictionary.into(),
                self.linear_path.is_some().into(),
                self.linear_path.as_ref().unwrap_or(&self.dictionary).into(),
                (&room.y).into(),
                self.outputs.linear_path.into(),
                self.outputs.result.into(),
                (&room.out).into(),
                room.slots.into(),
                (&room.counts[last + 1]).into(),
            ],
            [patches.div_ceil(T::EACH), self.rows / ROWS],
        )
    }

    /// Memory for frames of a size that fits the geometry.
    pub(crate) fn memory(
        &self,
        (height, width): (usize, usize),
        planes: [Plane; 3],
    ) -> Result<FrameMemory<T>, GpuError> {
        let (rows, columns) = self.geometry.patches(height, width);
        let pitch = (PATCHES / columns).clamp(1, rows) * columns;
        self.check_size(height * width, pitch)?;
        let sums = |plane: Plane| self.device.buffer(height * plane.width(width));
        Ok(FrameMemory {
            size: (height, width),
            pixels: self.device.buffer(height * width)?,
            sums: [sums(planes[0])?, sums(planes[1])?, sums(planes[2])?],
            room: self.room(pitch, SLOTS)?,
        })
    }

    /// Leaves in `memory` the sums of a red-first frame of its size. `ran(room, patches)` sees each lot of patches.
    pub(crate) fn sums(
        &self,
        memory: &mut FrameMemory<T>,
        raw: &RawFrame,
        planes: [Plane; 3],
        mut ran: impl FnMut(&Workspace<T>, usize) -> Result<(), GpuError>,
    ) -> Result<(), GpuError> {
        let FrameMemory { size, pixels, sums, room } = memory;
        let (rows, columns) = self.geometry.patches(size.0, size.1);
        self.device.write(pixels, raw.pixels().as_standard_layout().as_slice().unwrap_or_default())?;
        sums.iter_mut().try_for_each(|sums| self.device.clear(sums))?;
        let rows_at_once = room.pitch / columns;
        for first in (0..rows).step_by(rows_at_once) {
            let lot = PatchBatch { first, rows: rows_at_once.min(rows - first), columns, size: *size };
            self.windows(pixels, room, &lot)?;
            self.run(room, lot.rows * columns)?;
            planes.iter().zip(&*sums).try_for_each(|(plane, sums)| self.overlap(room, &lot, *plane, sums))?;
            ran(room, lot.rows * columns)?;
        }
        Ok(())
    }

    /// Cuts the windows of a lot out of a frame.
    fn windows(&self, pixels: &Buffer<u16>, room: &Workspace<T>, lot: &PatchBatch) -> Result<(), GpuError> {
        let patches = lot.rows * lot.columns;
        self.device.launch(
            &self.program,
            "windows",
            &[
                pixels.into(),
                lot.size.0.into(),
                lot.size.1.into(),
                self.form.window.side().into(),
                self.geometry.stride.pixels().into(),
                self.geometry.window_start(0).into(),
                lot.first.into(),
                lot.columns.into(),
                patches.into(),
                room.pitch.into(),
                (&room.y).into(),
            ],
            [patches, self.form.window.pixels()],
        )
    }

    /// Adds a lot's patches to the sums of a plane.
    fn overlap(
        &self,
        room: &Workspace<T>,
        lot: &PatchBatch,
        plane: Plane,
        sums: &Buffer<T::Total>,
    ) -> Result<(), GpuError> {
        let (stride, width) = (self.geometry.stride.pixels(), plane.width(lot.size.1));
        let (start, step) = (self.geometry.patch_start(0), stride * plane.block / PATCH);
        let top = self.geometry.patch_start(lot.first).max(0);
        let lines = (lot.rows * stride + PATCH).min(lot.size.0 - top.unsigned_abs());
        self.device.launch(
            &self.program,
            "overlap",
            &[
                (&room.out).into(),
                self.rows.into(),
                plane.first_output.into(),
                plane.block.into(),
                lot.size.0.into(),
                width.into(),
                stride.into(),
                step.into(),
                start.into(),
                (start * plane.block as isize / PATCH as isize).into(),
                lot.first.into(),
                lot.rows.into(),
                lot.columns.into(),
                top.into(),
                (&self.averaging).into(),
                sums.into(),
            ],
            [width, lines],
        )
    }

    /// Whether a frame's buffers, and the words of `pitch` patches, fit the device, and its pixels the kernels' 32-bit counts.
    fn check_size(&self, pixels: usize, pitch: usize) -> Result<(), GpuError> {
        if i32::try_from(pixels).is_err() {
            return Err(GpuError::TooManyPixels(pixels));
        }
        let boundaries = self.form.window.pixels() + 3 * self.form.codes * self.form.shrinkages() + self.rows;
        let pixel = size_of::<u16>() + 3 * size_of::<T::Total>() + 3 * size_of::<T>();
        let needed = pitch * boundaries * size_of::<T>() + pixels * pixel;
        self.device.check_memory(needed as u64)
    }
}

/// Some rows of patches of a frame.
struct PatchBatch {
    first: usize,
    rows: usize,
    columns: usize,
    size: (usize, usize),
}

/// A matrix as the kernels read it: input after input, rows padded to a multiple of [`ROWS`].
fn packed<T: Element>(matrix: &Array2<T>) -> Vec<T> {
    let (rows, inputs) = matrix.dim();
    let padded = rows.next_multiple_of(ROWS);
    let mut packed = vec![T::default(); inputs * padded];
    for ((row, input), value) in matrix.indexed_iter() {
        packed[input * padded + row] = *value;
    }
    packed
}

/// A patch's pixels have equal weight if F's weights contain the averaging window.
pub(crate) const EVEN: [f32; PATCH_PIXELS] = [1.0; PATCH_PIXELS];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shrinkage_has_a_function_of_words_and_one_of_floats() {
        for shrinkage in Shrinkage::ALL {
            let head =
                format!("\nword {}(word b, word theta, int bits, uint *clipped) {{", function(shrinkage));
            assert_eq!(SOURCE.matches(&head).count(), 2, "{head}");
        }
    }
}
