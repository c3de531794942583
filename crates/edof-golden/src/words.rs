//! The words of a whole frame at every boundary between stages, for anybody who wants to check them (docs/contract.md, section 8).

use crate::frame::Golden;
use crate::scalar::sends_difference;
use crate::trace::{LayerWords, Trace};
use crate::windows::Mirrored;
use edof_core::RawFrame;
use edof_core::geometry::GeometryError;
use edof_core::number::{InputWord, bits_of};
use ndarray::Array3;
use rayon::prelude::*;

/// Words of all patches at one boundary: rows of patches × columns of patches × words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Boundary {
    /// `y`, `b1`, `z1`, `v1`, …, `f`.
    pub name: String,
    /// The words.
    pub words: Array3<i16>,
}

impl Golden {
    /// All words between the windows and F's outputs; what is sent (`v`) only where it is not z itself. It takes some 4 KiB a
    /// patch.
    ///
    /// # Errors
    /// [`GeometryError`] for frames too small for a window.
    pub fn words(&self, raw: &RawFrame) -> Result<Vec<Boundary>, GeometryError> {
        self.geometry().check_frame(raw.size())?;
        let (aligned, _) = raw.to_rggb();
        let (rows, columns) = self.geometry().patches(aligned.size().0, aligned.size().1);
        let pixels = self.network().form.window.pixels();
        let row_of_traces = |row| {
            let mut mirrored = Mirrored::empty(self.geometry());
            mirrored.take(&aligned, row..row + 1);
            let mut windows = vec![InputWord::ZERO; columns * pixels];
            let each = windows.chunks_exact_mut(pixels).enumerate();
            each.for_each(|(column, window)| mirrored.copy_window(row, column, window));
            self.fast().traces(&windows)
        };
        let traces: Vec<Trace> = (0..rows).into_par_iter().flat_map_iter(row_of_traces).collect();

        let gather = |name: String, part: &dyn Fn(&Trace) -> &[i16]| {
            let length = traces.first().map_or(0, |trace| part(trace).len());
            let mut words = Array3::zeros((rows, columns, length));
            let places = words.as_slice_mut().unwrap_or_default().chunks_exact_mut(length.max(1));
            places.zip(&traces).for_each(|(place, trace)| place.copy_from_slice(part(trace)));
            Boundary { name, words }
        };
        let mut all = vec![gather("y".to_owned(), &|trace| bits_of(&trace.input))];
        for t in 0..self.network().form.shrinkages() {
            let mut layer = |name: &str, part: fn(&LayerWords) -> &[i16]| {
                all.push(gather(format!("{name}{}", t + 1), &|trace| part(&trace.layers[t])));
            };
            layer("b", |layer| &layer.b);
            layer("z", |layer| &layer.z);
            if sends_difference(self.network(), t) {
                layer("v", |layer| &layer.sent);
            }
        }
        all.push(gather("f".to_owned(), &|trace| bits_of(&trace.output)));
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar;
    use crate::windows::window;
    use edof_core::{CfaPhase, Stride, Window};
    use edof_network::network::{Form, Recurrence, Shrinkage};
    use ndarray::{Array2, s};

    #[test]
    fn every_boundary_of_a_patch_lies_at_its_place_under_its_name() {
        let form = Form {
            window: Window::new(12).unwrap(),
            codes: 6,
            layers: 4,
            shrinkage: Shrinkage::OneSided,
            recurrence: Recurrence::Difference,
            linear_path: true,
            tied: false,
            exposures: 1,
        };
        let network = edof_device::random::extreme(form, 12, Stride::new(4).unwrap(), false, 4);
        let values = Array2::from_shape_fn((14, 18), |(r, c)| (r * 2003 + c * 331) as u16);
        let raw = RawFrame::from_values(values, 16, CfaPhase::Grbg).unwrap();
        let golden = Golden::new(network.clone()).unwrap();
        let all = golden.words(&raw).unwrap();
        let names: Vec<&str> = all.iter().map(|b| b.name.as_str()).collect();
        assert_eq!(names, ["y", "b1", "z1", "v1", "b2", "z2", "v2", "b3", "z3", "f"]);

        let (aligned, _) = raw.to_rggb();
        let y = window(&aligned, golden.geometry(), 2, 3);
        let trace = scalar::run(&network, &y);
        let y = bits_of(&y).to_vec();
        let expected = [&y, &trace.layers[0].b, &trace.layers[0].z, &trace.layers[0].sent];
        for (boundary, expected) in all.iter().zip(expected) {
            assert_eq!(boundary.words.slice(s![2, 3, ..]).to_vec(), *expected, "{}", boundary.name);
        }
        assert_eq!(all[9].words.slice(s![2, 3, ..]).to_vec(), bits_of(&trace.output));
    }
}
