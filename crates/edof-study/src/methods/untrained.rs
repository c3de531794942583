//! The paper's network before training (paper §3, Algorithm 1): ISTA in the pursuits' dictionary, cut off after T − 1 shrinkages.
//!
//! One dictionary for all depths: sharp atoms D, and B, the mean of what the camera shows of them at ψ = 1…8. A = (1/L)Bᵀ, S = I − (1/L)BᵀB
//! and θ = μ/L. With DC removed the colours' own atoms are fitted rather than pursued: B without its share of them, and what they give
//! to the patch goes past the layers on the linear path.

use crate::methods::dictionary::{Dictionary, FREE};
use crate::methods::pursuit::{colours, shown};
use crate::methods::settings::UntrainedSettings;
use edof_core::camera::Camera;
use edof_network::Network;
use edof_network::network::{Form, Origin, Recurrence, Shrinkage};
use edof_numerics::sparse::lasso::step_bound;
use edof_optics::Statistics;
use edof_optics::estimator::SeenError;
use ndarray::{Array1, Array2, Axis, concatenate, s};

/// The network behind a camera.
///
/// # Errors
/// [`SeenError`]: a depth that the camera has no PSFs for, or statistics of photographs that are no covariances.
pub fn network(
    name: &str,
    dictionary: &Dictionary,
    camera: &Camera,
    settings: &UntrainedSettings,
) -> Result<Network, SeenError> {
    let UntrainedSettings { layers, dc_removed, penalty, ref depths, window, .. } = *settings;
    let statistics = Statistics::natural();
    let mut seen = Array2::<f32>::zeros((window.pixels(), dictionary.atoms.ncols() - FREE));
    for &psi in depths {
        seen.scaled_add(1.0 / depths.len() as f32, &shown(dictionary, camera, psi, &statistics, window)?);
    }
    let free = colours(window);
    let sharp_free = dictionary.atoms.slice(s![.., ..FREE]);
    let sharp_others = dictionary.atoms.slice(s![.., FREE..]);
    // Colours' atoms have no pixel in common, so least squares fit each for itself.
    let lengths = free.map_axis(Axis(0), |atom| atom.dot(&atom));
    let fit = free.t().to_owned() / lengths.insert_axis(Axis(1));
    let shares = fit.dot(&seen);
    let (blurred, sharp) = if dc_removed {
        (&seen - &free.dot(&shares), &sharp_others - &sharp_free.dot(&shares))
    } else {
        (concatenate![Axis(1), free, seen], dictionary.atoms.clone())
    };
    let codes = blurred.ncols();
    let gram = blurred.t().dot(&blurred);
    let bound = step_bound(gram.view());
    let mut theta = Array1::from_elem(codes, penalty / bound);
    if !dc_removed {
        theta.slice_mut(s![..FREE]).fill(0.0);
    }
    let form = Form {
        window,
        codes,
        layers,
        shrinkage: Shrinkage::TwoSided,
        recurrence: Recurrence::Direct,
        linear_path: dc_removed,
        tied: true,
        exposures: 1,
    };
    Ok(Network {
        form,
        analysis: &blurred.t() / bound,
        thresholds: vec![theta; form.shrinkages()],
        recurrent: vec![Array2::eye(codes) - &gram / bound; form.recurrent_matrices()],
        dictionary: sharp,
        linear_path: dc_removed.then(|| sharp_free.dot(&fit)),
        origin: Origin::untrained(name, camera.clone()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::settings::BLIND_DEPTHS;
    use edof_core::overlap::Overlap;
    use edof_core::{CfaPhase, RawFrame, Reconstructor, Stride, Window};
    use edof_network::float::reconstruct::{FloatReconstructor, Output};
    use edof_numerics::random::Random;
    use edof_numerics::sparse::lasso::{Effort, Lasso};

    #[test]
    fn it_is_ista_of_one_step_a_shrinkage() {
        let (camera, dictionary) = (Camera::resolve("ring-2018").unwrap(), Dictionary::load(None).unwrap());
        let window = Window::new(8).unwrap();
        let mut random = Random::new(7, 0, 0);
        let values = Array2::from_shape_simple_fn((16, 16), || (30_000.0 + 8000.0 * random.normal()) as u16);
        let corners = [(0, 0), (0, 8), (8, 0), (8, 8)];
        let signals = Array2::from_shape_fn((4, 64), |(i, pixel)| {
            let (row, column) = corners[i];
            f32::from(values[(row + pixel / 8, column + pixel % 8)]) / 65536.0
        });
        let raw = RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap();

        let statistics = Statistics::natural();
        let mut own = Array2::<f32>::zeros((64, dictionary.atoms.ncols() - FREE));
        for psi in BLIND_DEPTHS {
            own.scaled_add(0.125, &shown(&dictionary, &camera, psi, &statistics, window).unwrap());
        }
        let seen = concatenate![Axis(1), colours(window), own];
        let penalty = 0.004;
        for (dc_removed, free) in [(false, 0), (true, FREE)] {
            let mut penalties = Array1::from_elem(seen.ncols(), penalty);
            penalties.slice_mut(s![..FREE]).fill(0.0);
            let lasso = Lasso::new(seen.view(), penalties.view(), free);
            for layers in [3, 8] {
                let effort = Effort { steps: layers - 1, tolerance: 0.0 };
                let patches = lasso.ista(signals.view(), effort).codes.dot(&dictionary.atoms.t());
                let settings = UntrainedSettings {
                    penalty,
                    ..UntrainedSettings::usual(layers, dc_removed, Stride::PATCH)
                };
                let network = network("n", &dictionary, &camera, &settings).unwrap();
                let float = FloatReconstructor::new(
                    network,
                    Stride::new(8).unwrap(),
                    Overlap::default(),
                    Output::Rgb,
                );
                let frame = float.unwrap().reconstruct(&raw).unwrap().frame;
                for ((i, value), &theirs) in patches.indexed_iter() {
                    let (row, column) = corners[i];
                    let ours = frame.planes[(value / 64, row + value % 64 / 8, column + value % 8)];
                    assert!(
                        (ours - theirs).abs() < 1e-4,
                        "T {layers}, DC removed {dc_removed}: {ours} {theirs}"
                    );
                }
            }
        }
    }
}
