//! Whole frames: every window through the network, patches added up, 4:2:2 out.

use crate::display::{Display, DisplayCounts, Picture};
use crate::fast::Fast;
use crate::overlap_add::overlap_add;
use crate::scalar;
use crate::trace::Counts;
use crate::windows::window;
use edof_core::colour::rgb_part_from_422;
use edof_core::geometry::GeometryError;
use edof_core::{ColourFrame, Frame422, Geometry, RawFrame};
use edof_network::FixedNetwork;
use edof_network::fixed_network::FixedNetworkError;

/// The golden pipeline, ready to run frames on all threads.
#[derive(Debug, Clone)]
pub struct Golden {
    fast: Fast,
    geometry: Geometry,
}

/// A reconstructed frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GoldenFrame {
    /// The board's words before the display step, for the frame with red first ([`RawFrame::to_rggb`]): as large as the raw frame,
    /// or two rows or columns larger where its colour filter starts with another colour.
    pub frame: Frame422,
    /// Rows and columns of it that come before the raw frame's first.
    pub offset: (usize, usize),
    /// Rows and columns of the raw frame.
    pub size: (usize, usize),
    /// Counters of all stages.
    pub counts: Counts,
}

impl GoldenFrame {
    /// The frame in red, green and blue, as large as the raw frame: values as the network gives them.
    #[must_use]
    pub fn colour(&self) -> ColourFrame {
        rgb_part_from_422(&self.frame, self.offset, self.size)
    }

    /// The codes that leave the board, as large as the raw frame, and what the display step could not show.
    #[must_use]
    pub fn picture(&self, display: &Display) -> (Picture, DisplayCounts) {
        display.picture(&self.frame, self.offset, self.size)
    }

    /// As [`GoldenFrame::picture`], in the memory of another picture.
    pub fn picture_into(&self, display: &Display, picture: &mut Picture) -> DisplayCounts {
        display.picture_into(&self.frame, self.offset, self.size, picture)
    }
}

impl Golden {
    /// # Errors
    /// [`FixedNetworkError`] for a network that could not run exactly.
    pub fn new(network: FixedNetwork) -> Result<Self, FixedNetworkError> {
        network.check()?;
        let geometry = Geometry::new(network.form.window, network.stride);
        Ok(Self { fast: Fast::new(network), geometry })
    }

    /// The kernels it runs on, patch by patch.
    #[must_use]
    pub const fn fast(&self) -> &Fast {
        &self.fast
    }

    /// Reconstructs a frame of light: its words in the network's own values ([`edof_network::network::Origin::values`]) are the golden ones, and
    /// the second value is the picture's light.
    ///
    /// # Errors
    /// As [`Golden::frame`].
    pub fn frame_of_light(&self, raw: &RawFrame) -> Result<(GoldenFrame, ColourFrame), GeometryError> {
        let values = self.network().origin.values;
        let out = self.frame(&raw.encoded(values))?;
        let mut light = out.colour();
        values.lighten(&mut light);
        Ok((out, light))
    }

    /// Where patches and windows lie.
    #[must_use]
    pub const fn geometry(&self) -> Geometry {
        self.geometry
    }

    /// The network it runs.
    #[must_use]
    pub const fn network(&self) -> &FixedNetwork {
        self.fast.network()
    }
}

/// The specification's frame, one patch after the other: slow, and equal to [`Golden::frame`] in every word and count.
///
/// # Errors
/// [`GeometryError`] for frames too small for a window.
pub fn scalar_frame(network: &FixedNetwork, raw: &RawFrame) -> Result<GoldenFrame, GeometryError> {
    let geometry = Geometry::new(network.form.window, network.stride);
    geometry.check_frame(raw.size())?;
    let (aligned, offset) = raw.to_rggb();
    let (height, width) = aligned.size();
    let mut patches = Counts::new(network.form.layers);
    let mut sums = Counts::new(network.form.layers);
    let patch = |row, column| {
        let trace = scalar::run(network, &window(&aligned, geometry, row, column));
        patches.add(&trace.stages);
        trace.output
    };
    let frame = overlap_add(geometry, (height, width), patch, &mut sums);
    patches.merge(&sums);
    Ok(GoldenFrame { frame, offset, size: raw.size(), counts: patches })
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::{CfaPhase, Tone};
    use ndarray::Array2;

    #[test]
    fn a_frame_of_light_is_encoded_before_the_network_and_its_picture_decoded() {
        let mut network = edof_device::random::natural(8, 8, 2);
        let values = Array2::from_shape_fn((16, 24), |(r, c)| ((r * 997 + c * 131) % 4096) as u16);
        let raw = RawFrame::from_values(values, 12, CfaPhase::Gbrg).unwrap();
        let of_light = Golden::new(network.clone()).unwrap();
        let (out, light) = of_light.frame_of_light(&raw).unwrap();
        assert_eq!((&out, light), (&of_light.frame(&raw).unwrap(), out.colour()));
        network.origin.values = Tone::Srgb;
        let encoded = Golden::new(network).unwrap();
        let (out, light) = encoded.frame_of_light(&raw).unwrap();
        assert_eq!(out, of_light.frame(&raw.encoded(Tone::Srgb)).unwrap());
        let exact = Tone::Srgb.decoded(&out.colour()).planes;
        assert!(light.planes.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-6 * b.abs().max(1.0)));
    }

    #[test]
    fn a_frame_too_small_is_rejected_alike_in_all_phases_by_the_size_that_was_given() {
        let golden = Golden::new(edof_device::random::natural(8, 8, 1)).unwrap();
        let frame = |side, phase| {
            golden.frame(&RawFrame::from_values(Array2::zeros((side, side)), 8, phase).unwrap())
        };
        for phase in CfaPhase::ALL {
            let error = frame(8, phase).unwrap_err().to_string();
            assert_eq!(error, "frame 8x8: both sides must be at least 10 pixels for a window of 8");
            assert_eq!(frame(10, phase).unwrap().colour().size(), (10, 10));
        }
    }
}
