//! The lenses of the comparison as cameras, for networks to be trained for.

use super::{Lens, Plan};
use edof_core::camera::Camera;
use edof_optics::estimator::JudgeError;

impl Plan {
    /// Every lens and aperture with every range.
    fn lenses(&self) -> Vec<(Lens, f64, f64)> {
        let clear = self.stops.iter().map(|stops| (Lens::Clear, *stops));
        let lenses = std::iter::once((Lens::Coded, 0.0)).chain(clear);
        lenses.flat_map(|(lens, stops)| self.ranges.iter().map(move |range| (lens, stops, *range))).collect()
    }

    /// Names of [`Plan::cameras`].
    #[must_use]
    pub fn camera_names(&self) -> Vec<String> {
        self.lenses().into_iter().map(|(lens, stops, range)| name(lens, stops, range)).collect()
    }

    /// Every lens, aperture and range as a camera, with the focus that is best in the brightest light.
    ///
    /// # Errors
    /// A lens that the estimator cannot judge.
    pub fn cameras(&self) -> Result<Vec<Camera>, JudgeError> {
        let brightest = self.electrons.iter().copied().fold(0.0, f64::max);
        let camera = |(lens, stops, range): (Lens, f64, f64)| {
            let best = self.best(lens, stops, range, &[brightest])?;
            let focus_psi = best.first().map_or(0.5 * range, |best| best.focus_psi);
            let word = if lens == Lens::Coded { "coded" } else { "clear" };
            let source = format!(
                "edof study aperture: the {word} lens, closed by {stops} stops, focused by the closed-form estimator."
            );
            Ok(Camera {
                name: name(lens, stops, range),
                psi_range: [0.0, range * (-stops).exp2()],
                source,
                ..self.focused(lens, stops, focus_psi)
            })
        };
        self.lenses().into_iter().map(camera).collect()
    }
}

/// As in `coded-8`, or `clear-0.5-8` for half a stop; the last number is the range's far end in ψ of the open aperture.
fn name(lens: Lens, stops: f64, range: f64) -> String {
    match lens {
        Lens::Coded => format!("coded-{range}"),
        Lens::Clear => format!("clear-{stops}-{range}"),
    }
}
