//! The closed-form linear proxy: how well the best linear map from a raw window to the colour patch at its centre can do behind a
//! camera, when it must serve every depth of a range at once.
//!
//! With y the window and x the patch, both of known covariance, the map of least mean square error is W = C_xy·C_yy⁻¹, the
//! covariances averaged over the range of ψ, and its error at one ψ is tr(C_xx − 2·W·C_yx(ψ) + W·C_yy(ψ)·Wᵀ). No training, no
//! pictures: a camera is judged in tens of milliseconds.

use crate::cosine::{EvenTransform, period};
use crate::psf::support::{OUTSIDE, rays_beyond};
use crate::psf::{NoPsf, Psf, Settings, channel_psfs, pixel_transfer, wavelengths};
use crate::statistics::{SIDE, Statistics, pair};
use edof_core::camera::{Camera, PhaseTerm, Spectrum, Symmetry};
use edof_core::geometry::{PATCH, Window};
use edof_core::words::number;
use edof_core::{CfaPhase, Channel};
use edof_numerics::{Cholesky, NotPositive};
use ndarray::Array2;

/// What a camera is judged for.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// Depths, as ψ.
    pub psis: Vec<f64>,
    /// Standard deviations of Gaussian sensor noise, full scale 1; each has its own estimator.
    pub noises: Vec<f64>,
    /// Raw pixels that the estimator sees.
    pub window: Window,
    /// How much the worst depth counts against the average over all, 0…1.
    pub worst_weight: f64,
}

/// What the linear estimator reaches behind a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// For each noise of the task, PSNR in dB (peak 1) at each ψ.
    pub psnr_db: Vec<Vec<f64>>,
    /// What a design maximises, in dB: the worst depth and the average, weighted, then averaged over noises.
    pub score_db: f64,
}

/// Noise that is always there: a 12-bit sensor's rounding. It keeps covariances invertible.
const ROUNDING: f64 = 1.0 / 4096.0 / 3.464_101_615;
/// Wavelengths that stand for a channel with a spectrum.
const WAVELENGTHS: usize = 3;

/// What cannot be judged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum JudgeError {
    /// A lens whose PSFs do not follow from rings alone.
    #[error(
        "camera {camera}: has {what}, which the linear estimator does not know; it judges lenses of rings alone"
    )]
    Lens { camera: String, what: &'static str },
    /// Blur that the statistics have no room for: it would come back from the other side.
    #[error(
        "psi {}: camera {camera} throws {:.0} % of the light more than {} pixels from the centre, where the estimator's statistics end; use less defocus or larger pixels",
        number(*psi), 100.0 * share, SIDE / 2
    )]
    Reach { camera: String, psi: f64, share: f64 },
    /// Nothing to judge it for.
    #[error("task: has no {0}, expected at least one")]
    Empty(&'static str),
    /// No statistics.
    #[error(transparent)]
    Statistics(#[from] NotPositive),
}

/// Rejects what would be judged as something else.
fn check(camera: &Camera, task: &Task) -> Result<(), JudgeError> {
    let shaped = || camera.terms().find(|term| term.symmetry() == Symmetry::None).map(PhaseTerm::what);
    if let Some(what) = camera.psf_bank.as_ref().map(|_| "a PSF bank").or_else(shaped) {
        return Err(JudgeError::Lens { camera: camera.name.clone(), what });
    }
    let too_far = task.psis.iter().map(|&psi| (psi, rays_beyond(camera, psi, 0.5 * SIDE as f64)));
    if let Some((psi, share)) = too_far.into_iter().find(|(_, share)| *share > OUTSIDE) {
        return Err(JudgeError::Reach { camera: camera.name.clone(), psi, share });
    }
    let empty = [(task.psis.is_empty(), "depth"), (task.noises.is_empty(), "noise")];
    empty.into_iter().find(|(empty, _)| *empty).map_or(Ok(()), |(_, what)| Err(JudgeError::Empty(what)))
}

/// Judges a camera.
///
/// # Errors
/// [`JudgeError`]: a lens of more than rings, a task without depths or noises, or statistics that are no covariances.
pub fn judge(camera: &Camera, statistics: &Statistics, task: &Task) -> Result<Verdict, JudgeError> {
    check(camera, task)?;
    let sites = Sites::new(task.window);
    let seen: Vec<Seen> = task.psis.iter().map(|&psi| Seen::new(camera, psi, statistics, &sites)).collect();
    let share = 1.0 / seen.len() as f64;
    let mut mean_yy = Array2::zeros(seen[0].yy.dim());
    let mut mean_yx = Array2::zeros(seen[0].yx.dim());
    for s in &seen {
        mean_yy.scaled_add(share, &s.yy);
        mean_yx.scaled_add(share, &s.yx);
    }
    let patch_variance: f64 =
        (0..3).map(|channel| statistics.covariance(channel, channel) * (PATCH * PATCH) as f64).sum();
    let outputs = mean_yx.ncols() as f64;
    let mut psnr_db = vec![];
    for &noise in &task.noises {
        let variance = noise * noise + ROUNDING * ROUNDING;
        let mut noisy = mean_yy.clone();
        noisy.diag_mut().iter_mut().for_each(|v| *v += variance);
        let map = Cholesky::new(noisy.view())?.solve(mean_yx.view());
        let gram = map.dot(&map.t());
        let noise_error = variance * gram.diag().sum();
        let error =
            |s: &Seen| patch_variance - 2.0 * (&map * &s.yx).sum() + (&gram * &s.yy).sum() + noise_error;
        psnr_db
            .push(seen.iter().map(|s| -10.0 * (error(s).max(1e-12) / outputs).log10()).collect::<Vec<_>>());
    }
    let score = |db: &Vec<f64>| {
        let worst = db.iter().copied().fold(f64::INFINITY, f64::min);
        let average = db.iter().sum::<f64>() / db.len() as f64;
        task.worst_weight * worst + (1.0 - task.worst_weight) * average
    };
    let score_db = psnr_db.iter().map(score).sum::<f64>() / psnr_db.len() as f64;
    Ok(Verdict { psnr_db, score_db })
}

/// What a raw window (red first) is expected to be for each sharp patch at its centre, both about the mean colour: the map of least
/// mean square error C_yx·C_xx⁻¹, window pixels × 192. It is the paper's B·H_ψ (section 3), with what lies around the patch and is
/// blurred into it foretold by how photographs vary.
///
/// # Errors
/// [`SeenError`]: a depth that the camera has no PSFs for, or statistics that are no covariances.
pub fn seen_of_patch(
    camera: &Camera,
    psi: f64,
    statistics: &Statistics,
    window: Window,
) -> Result<Array2<f64>, SeenError> {
    let sites = Sites::new(window);
    // PSFs of the user, and those of a lens with errors, need not be even.
    let yx = if camera.psf_bank.is_none() && camera.symmetry() == Symmetry::Round {
        Seen::new(camera, psi, statistics, &sites).yx
    } else {
        crossed(&channel_psfs(camera, psi, &Settings::default())?, statistics, &sites)
    };
    let sharp = covariances(
        &sites.patch,
        &sites.patch,
        &correlations(&sites, |a, b| statistics.spectra[pair(a, b)].clone()),
    );
    // Photographs are rounded to 8 bits.
    let rounded = sharp + Array2::<f64>::eye(sites.patch.len()) * (1.0 / 255.0f64.powi(2) / 12.0);
    Ok(Cholesky::new(rounded.view())?.solve(yx.t()).reversed_axes())
}

/// A camera whose view of patches cannot be foretold.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SeenError {
    /// A depth that the camera has no PSFs for.
    #[error(transparent)]
    Psf(#[from] NoPsf),
    /// No statistics.
    #[error(transparent)]
    Statistics(#[from] NotPositive),
}

/// Covariances of a window with its patch behind PSFs of any shape: a pixel that is seen is the sum of what lies around it, so is its
/// covariance with a sharp one. Lags beyond the statistics' torus count as its farthest.
fn crossed(psfs: &[Psf; 3], statistics: &Statistics, sites: &Sites) -> Array2<f64> {
    let half = psfs.iter().map(|psf| psf.side() / 2).max().unwrap_or(0);
    let max = (sites.reach + half + 1).min(SIDE / 2 + 1);
    let wide = Sites { window: vec![], patch: vec![], reach: max };
    let sharp = correlations(&wide, |a, b| statistics.spectra[pair(a, b)].clone());
    // Lags of −reach…reach, row by row.
    let reach = sites.reach as isize;
    let maps: Vec<Array2<f64>> = (0..9)
        .map(|channels| {
            let (kernel, sharp) = (psfs[channels / 3].kernel(), &sharp[channels]);
            let middle = (kernel.nrows() / 2) as isize;
            let far = |lag: isize| lag.unsigned_abs().min(max - 1);
            let side = (2 * reach + 1) as usize;
            Array2::from_shape_fn((side, side), |(i, j)| {
                let (down, right) = (i as isize - reach, j as isize - reach);
                let term = |((r, c), k): ((usize, usize), &f32)| {
                    let lag = (down - (r as isize - middle), right - (c as isize - middle));
                    f64::from(*k) * sharp[(far(lag.0), far(lag.1))]
                };
                kernel.indexed_iter().map(term).sum()
            })
        })
        .collect();
    Array2::from_shape_fn((sites.window.len(), sites.patch.len()), |(i, j)| {
        let ((r, c, a), (s, d, b)) = (sites.window[i], sites.patch[j]);
        let lag = |x: usize, y: usize| (x as isize - y as isize + reach) as usize;
        maps[3 * a + b][(lag(r, s), lag(c, d))]
    })
}

/// Row, column, channel.
type Site = (usize, usize, usize);

/// Pixels of a window and of its patch, rows and columns counted from the window's corner.
struct Sites {
    window: Vec<Site>,
    patch: Vec<Site>,
    reach: usize,
}

impl Sites {
    fn new(window: Window) -> Self {
        let side = window.side();
        let margin = window.margin();
        let raw = |i: usize| (i / side, i % side, CfaPhase::Rggb.channel(i / side, i % side).plane());
        let colour = |i: usize| {
            let (plane, pixel) = (i / (PATCH * PATCH), i % (PATCH * PATCH));
            (margin + pixel / PATCH, margin + pixel % PATCH, plane)
        };
        Self {
            window: (0..side * side).map(raw).collect(),
            patch: (0..3 * PATCH * PATCH).map(colour).collect(),
            reach: side,
        }
    }
}

/// Covariance of two channels at each distance up to the window's reach, for all nine pairs, from their spectra.
fn correlations(sites: &Sites, spectrum: impl Fn(usize, usize) -> Array2<f64>) -> Vec<Array2<f64>> {
    let plan = EvenTransform::new(SIDE / 2 + 1);
    let scale = 1.0 / (period(SIDE / 2 + 1) as f64).powi(2);
    let correlation = |spectrum: Array2<f64>| {
        let half_way = plan.rows_transposed(spectrum.view(), sites.reach);
        plan.rows_transposed(half_way.view(), sites.reach) * scale
    };
    (0..9).map(|i| correlation(spectrum(i / 3, i % 3))).collect()
}

/// Covariances of all `rows` with all `columns`.
fn covariances(rows: &[Site], columns: &[Site], correlations: &[Array2<f64>]) -> Array2<f64> {
    Array2::from_shape_fn((rows.len(), columns.len()), |(i, j)| {
        let ((r, c, a), (s, d, b)) = (rows[i], columns[j]);
        correlations[3 * a + b][(r.abs_diff(s), c.abs_diff(d))]
    })
}

/// Covariances at one depth.
struct Seen {
    yy: Array2<f64>,
    yx: Array2<f64>,
}

impl Seen {
    fn new(camera: &Camera, psi: f64, statistics: &Statistics, sites: &Sites) -> Self {
        let blur = Channel::ALL.map(|channel| transfer(camera, channel, psi));
        let spectrum = |a: usize, b: usize| &statistics.spectra[pair(a, b)];
        let blurred = correlations(sites, |a, b| spectrum(a, b) * &blur[a] * &blur[b]);
        let crossed = correlations(sites, |a, b| spectrum(a, b) * &blur[a]);
        let yy = covariances(&sites.window, &sites.window, &blurred);
        let yx = covariances(&sites.window, &sites.patch, &crossed);
        Self { yy, yx }
    }
}

/// What blur does to each frequency of a channel, on the statistics' torus.
fn transfer(camera: &Camera, channel: Channel, psi: f64) -> Array2<f64> {
    let spectrum = camera.spectrum(channel);
    let lines = match spectrum {
        Spectrum::Line(nm) => vec![*nm],
        Spectrum::Sampled(_) => wavelengths(spectrum, WAVELENGTHS),
    };
    let share = 1.0 / lines.len() as f64;
    let planes = lines.iter().map(|&nm| pixel_transfer(camera, nm, psi, SIDE) * share);
    planes.reduce(|sum, plane| sum + plane).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::{Aberration, Zernike};

    fn task(noise: f64) -> Task {
        Task {
            psis: vec![0.0, 2.0, 4.0, 6.0, 8.0],
            noises: vec![noise],
            window: Window::new(8).unwrap(),
            worst_weight: 0.5,
        }
    }

    #[test]
    fn a_lens_that_rings_do_not_describe_and_an_empty_task_are_rejected() {
        let ring = Camera::resolve("ring-2018").unwrap();
        let refused = |camera: &Camera, task: &Task| {
            judge(camera, &Statistics::natural(), task).unwrap_err().to_string()
        };
        let mut tilted = ring.clone();
        tilted.aberrations = Zernike(vec![Aberration { noll: 7, rms_nm: 20.0 }]);
        assert!(
            refused(&tilted, &task(0.01)).starts_with("camera ring-2018: has aberrations, which the linear")
        );
        let nowhere = Task { psis: vec![], ..task(0.01) };
        assert_eq!(refused(&ring, &nowhere), "task: has no depth, expected at least one");
        let silent = Task { noises: vec![], ..task(0.01) };
        assert_eq!(refused(&ring, &silent), "task: has no noise, expected at least one");
    }

    #[test]
    fn psfs_as_they_are_give_what_the_lens_gives_and_move_with_the_picture() {
        let camera = Camera::resolve("ring-2018").unwrap();
        let (statistics, sites) = (Statistics::natural(), Sites::new(Window::new(8).unwrap()));
        let lens = Seen::new(&camera, 4.0, &statistics, &sites).yx;
        let psfs = channel_psfs(&camera, 4.0, &Settings { energy: 0.9999, ..Settings::default() }).unwrap();
        let own = crossed(&psfs, &statistics, &sites);
        let largest = lens.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let apart = (&own - &lens).iter().fold(0.0f64, |m, v| m.max(v.abs()));
        assert!(apart < 1e-2 * largest, "{apart} of {largest}");
        // Light that arrives a row lower: a pixel knows of one row of the patch what it knew of the next.
        let moved = psfs.map(|psf| {
            let mut kernel = Array2::zeros((psf.side() + 2, psf.side() + 2));
            kernel.slice_mut(ndarray::s![2.., 1..=psf.side()]).assign(psf.kernel());
            Psf::new(kernel).unwrap()
        });
        let moved = crossed(&moved, &statistics, &sites);
        for (j, &(row, column, plane)) in sites.patch.iter().enumerate() {
            let next = sites.patch.iter().position(|p| *p == (row + 1, column, plane));
            let columns = next.map(|next| (moved.column(j), own.column(next)));
            assert!(columns.is_none_or(|(a, b)| (&a - &b).iter().all(|e| e.abs() < 1e-6 * largest)));
        }
    }

    fn verdict(name: &str, noise: f64) -> Verdict {
        judge(&Camera::resolve(name).unwrap(), &Statistics::natural(), &task(noise)).unwrap()
    }

    fn worst(verdict: &Verdict) -> f64 {
        verdict.psnr_db[0].iter().copied().fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_patch_is_seen_in_its_colours_and_without_its_detail_where_it_is_out_of_focus() {
        let seen = |psi| {
            let camera = Camera::resolve("clear").unwrap();
            seen_of_patch(&camera, psi, &Statistics::natural(), Window::new(8).unwrap()).unwrap()
        };
        let patch = |value: &dyn Fn(usize, usize) -> f64| {
            ndarray::Array1::from_shape_fn(192, |i| value(i / 64, i % 8))
        };
        // Red first: the raw values of a patch of one colour show each pixel's filter.
        let red = seen(8.0).dot(&patch(&|plane, _| if plane == 0 { 1.0 } else { 0.0 }));
        for (pixel, &value) in red.indexed_iter() {
            let measured = pixel / 8 % 2 == 0 && pixel % 2 == 0;
            assert!((value - if measured { 1.0 } else { 0.0 }).abs() < 0.15, "pixel {pixel}: {value}");
        }
        let fine = patch(&|_, column| [1.0, 1.0, -1.0, -1.0][column % 4]);
        let contrast = |psi| seen(psi).dot(&fine).mapv(|v| v * v).sum();
        assert!(
            contrast(0.0) > 20.0 && contrast(8.0) < 0.25 * contrast(0.0),
            "{} {}",
            contrast(0.0),
            contrast(8.0)
        );
    }

    /// The order in which trained networks put these cameras at their worst depth.
    #[test]
    fn the_proxy_ranks_cameras_as_trained_networks_do() {
        for noise in [0.0, 0.01] {
            let order =
                ["clear", "ring-2018", "clear-mid", "ring-outer"].map(|name| worst(&verdict(name, noise)));
            assert!(order.is_sorted(), "noise {noise}: {order:?}");
        }
    }

    #[test]
    fn noise_costs_and_a_larger_window_gains() {
        let (clean, noisy) = (verdict("ring-outer", 0.0), verdict("ring-outer", 0.01));
        assert!(noisy.score_db < clean.score_db - 0.5);
        let wide = Task { window: Window::new(12).unwrap(), ..task(0.0) };
        let camera = Camera::resolve("ring-outer").unwrap();
        assert!(judge(&camera, &Statistics::natural(), &wide).unwrap().score_db > clean.score_db);
    }

    /// A camera without blur or noise leaves the demosaicing error only, the same at every depth.
    #[test]
    fn a_pinhole_sees_every_depth_alike() {
        let mut pinhole = Camera::resolve("clear").unwrap();
        pinhole.aperture_radius_mm = 0.8;
        pinhole.pixel_pitch_um = 30.0;
        pinhole.psi_range = [0.0, 1.0];
        let few = Task { psis: vec![0.0, 1.0], ..task(0.0) };
        let [a, b] = judge(&pinhole, &Statistics::natural(), &few).unwrap().psnr_db[0][..] else {
            panic!("two")
        };
        assert!((a - b).abs() < 0.1, "{a} {b}");
    }
}
