//! Reconstruction by sparse pursuit (paper §3): each raw window as a sum of few atoms as the camera shows them, B·D_ψ, and the patch as
//! the same sum of sharp ones.
//!
//! Blind, the dictionary is the concatenation D_Ψ of those of ψ = 1…8; with ψ known it is that of one ψ. What a sharp atom looks like to
//! the camera follows from its PSFs and from how photographs vary around a patch ([`seen_of_patch`]), so any camera will do.

use crate::methods::dictionary::{Dictionary, FREE};
use crate::methods::patchwork::Patchwork;
use crate::methods::settings::{Depths, Pursuit, PursuitSettings};
use edof_core::camera::Camera;
use edof_core::geometry::PATCH;
use edof_core::reconstructor::Counters;
use edof_core::{CfaPhase, RawFrame, ReconstructError, Reconstruction, Reconstructor, Window};
use edof_numerics::sparse::lasso::{Effort, Lasso};
use edof_numerics::sparse::omp::{Omp, Stop};
use edof_optics::Statistics;
use edof_optics::estimator::{SeenError, seen_of_patch};
use ndarray::{Array1, Array2, ArrayView2, Axis, concatenate, s};
use std::time::Instant;

/// A pursuit in the dictionary of one camera.
pub struct PursuitReconstructor {
    name: String,
    work: Patchwork,
    solver: Solver,
    /// Sharp atoms as rows, in the order of the seen ones.
    sharp: Array2<f32>,
}

enum Solver {
    Omp(Omp<f32>, Stop<f32>),
    Fista(Lasso<f32>, Effort<f32>),
}

impl PursuitReconstructor {
    /// Prepares the dictionary of a camera; `psi` is the scene's depth, for a pursuit with ψ known.
    ///
    /// # Errors
    /// [`SeenError`]: a depth that the camera has no PSFs for, or statistics of photographs that are no covariances.
    pub fn new(
        name: String,
        dictionary: &Dictionary,
        camera: &Camera,
        psi: f64,
        settings: &PursuitSettings,
    ) -> Result<Self, SeenError> {
        let psis = match &settings.depths {
            Depths::Known => &[psi][..],
            Depths::Of(psis) => psis,
        };
        let (seen, sharp) = dictionaries(dictionary, camera, psis, settings.window)?;
        let solver = match settings.pursuit {
            Pursuit::Omp { atoms } => Solver::Omp(Omp::new(seen.view(), FREE), Stop::at_atoms(atoms)),
            Pursuit::Fista { steps, penalty, tolerance } => {
                let penalties = Array1::from_elem(seen.ncols(), penalty);
                Solver::Fista(Lasso::new(seen.view(), penalties.view(), FREE), Effort { steps, tolerance })
            }
        };
        Ok(Self { name, work: Patchwork::new(settings.window, settings.stride), solver, sharp })
    }
}

/// Atoms as the camera shows them (window pixels × atoms) and sharp ones (atoms × 192): the free ones once, all others for each ψ.
fn dictionaries(
    dictionary: &Dictionary,
    camera: &Camera,
    psis: &[f64],
    window: Window,
) -> Result<(Array2<f32>, Array2<f32>), SeenError> {
    let statistics = Statistics::natural();
    let own = dictionary.atoms.slice(s![.., FREE..]);
    let mut seen = vec![colours(window)];
    let mut sharp = vec![dictionary.atoms.slice(s![.., ..FREE]).t().to_owned()];
    for &psi in psis {
        seen.push(shown(dictionary, camera, psi, &statistics, window)?);
        sharp.push(own.t().to_owned());
    }
    let join = |axis, parts: &[Array2<f32>]| {
        let views: Vec<ArrayView2<'_, f32>> = parts.iter().map(|part| part.view()).collect();
        concatenate(axis, &views).unwrap_or_else(|e| unreachable!("parts of one dictionary fit: {e}"))
    };
    Ok((join(Axis(1), &seen), join(Axis(0), &sharp)))
}

/// All atoms but the free ones as the camera shows them at a depth: window pixels × atoms.
pub(crate) fn shown(
    dictionary: &Dictionary,
    camera: &Camera,
    psi: f64,
    statistics: &Statistics,
    window: Window,
) -> Result<Array2<f32>, SeenError> {
    let map = seen_of_patch(camera, psi, statistics, window)?.mapv(|v| v as f32);
    Ok(map.dot(&dictionary.atoms.slice(s![.., FREE..])))
}

/// The free atoms, a patch of one colour each, as every camera shows them: no blur changes what does not vary.
pub(crate) fn colours(window: Window) -> Array2<f32> {
    let side = window.side();
    Array2::from_shape_fn((window.pixels(), FREE), |(i, plane)| {
        let channel = CfaPhase::Rggb.channel(i / side, i % side);
        if channel.plane() == plane { 1.0 / PATCH as f32 } else { 0.0 }
    })
}

impl Reconstructor for PursuitReconstructor {
    fn name(&self) -> &str {
        &self.name
    }

    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        let start = Instant::now();
        let (mut nonzeros, mut steps) = (0, 0);
        let (frame, patches) = self.work.frame(raw, |windows| match &self.solver {
            Solver::Omp(omp, stop) => {
                let codes = omp.codes(windows, *stop);
                nonzeros += codes.nonzeros();
                // One atom a step; the free ones are there before the first.
                steps += (codes.nonzeros() - codes.signals() * FREE) as u64;
                codes.synthesis(self.sharp.view())
            }
            Solver::Fista(lasso, effort) => {
                let descent = lasso.fista(windows, *effort);
                steps += descent.steps;
                let codes = descent.codes;
                nonzeros += codes.iter().filter(|z| **z != 0.0).count();
                codes.dot(&self.sharp)
            }
        })?;
        let counters = Counters { patches: patches as u64, nonzeros: vec![nonzeros as u64], saturations: 0 };
        let seconds = start.elapsed().as_secs_f64();
        let iterations = Some(steps as f64 / patches as f64);
        Ok(Reconstruction { frame, seconds, multiplications: None, counters: Some(counters), iterations })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::Stride;

    fn method(psis: &[f64], pursuit: Pursuit, stride: usize) -> PursuitReconstructor {
        let camera = Camera::resolve("ring-2018").unwrap();
        let (depths, stride) = (Depths::Of(psis.to_vec()), Stride::new(stride).unwrap());
        let settings = PursuitSettings::usual(pursuit, depths, stride);
        let dictionary = Dictionary::load(None).unwrap();
        PursuitReconstructor::new("p".into(), &dictionary, &camera, 0.0, &settings).unwrap()
    }

    #[test]
    fn one_colour_is_reconstructed_exactly_by_every_pursuit() {
        let colour = [9000u16, 30_000, 50_000];
        for phase in CfaPhase::ALL {
            let values = Array2::from_shape_fn((24, 32), |(r, c)| colour[phase.channel(r, c).plane()]);
            let raw = RawFrame::from_values(values, 16, phase).unwrap();
            for pursuit in
                [Pursuit::Omp { atoms: 4 }, Pursuit::Fista { steps: 50, penalty: 0.01, tolerance: 1e-4 }]
            {
                let out = method(&[4.0, 8.0], pursuit, 4).reconstruct(&raw).unwrap();
                for ((p, _, _), &v) in out.frame.planes.indexed_iter() {
                    assert!(
                        (v - f32::from(colour[p]) / 65536.0).abs() < 2e-3,
                        "{phase} {pursuit:?} {p}: {v}"
                    );
                }
            }
        }
    }

    /// A grey pattern in focus: the dictionary of that ψ recognises it in its raw windows.
    #[test]
    fn a_pattern_is_reconstructed_better_with_its_depth_known() {
        let pattern = |r: usize, c: usize| 0.5 + 0.25 * (r as f32 * 0.9).sin() * (c as f32 * 0.7).cos();
        let sharp = edof_core::ColourFrame {
            planes: ndarray::Array3::from_shape_fn((3, 48, 64), |(_, r, c)| pattern(r, c)),
        };
        let camera = Camera::resolve("ring-2018").unwrap();
        let psfs =
            edof_optics::psf::channel_psfs(&camera, 5.0, &edof_optics::psf::Settings::default()).unwrap();
        let light = edof_optics::blur_frame(&sharp, &psfs);
        let values = Array2::from_shape_fn((48, 64), |(r, c)| {
            let plane = CfaPhase::Rggb.channel(r, c).plane();
            (light.planes[(plane, r, c)] * 65535.0) as u16
        });
        let raw = RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap();
        let error = |psis: &[f64]| {
            let out = method(psis, Pursuit::Omp { atoms: 6 }, 2).reconstruct(&raw).unwrap();
            let inner = s![.., 8..40, 8..56];
            let e = &out.frame.planes.slice(inner) - &sharp.planes.slice(inner);
            e.mapv(|v| v * v).mean().unwrap()
        };
        let (known, wrong) = (error(&[5.0]), error(&[0.0]));
        assert!(known < 0.7 * wrong, "{known} {wrong}");
    }
}
