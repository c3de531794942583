//! Cubic masks and their kin: what theory says of their PSFs, the same masks by other names, and derivatives by their coefficients.

use edof_core::Channel;
use edof_core::camera::{
    Aberration, Camera, HeightMap, Mask, Monomial, Parameter, Polynomial, Term, Zernike,
};
use edof_optics::gradient::{parameters, psf_gradient};
use edof_optics::psf::{Psf, Settings, psf};
use edof_optics::{Footprint, otf};
use ndarray::Array2;

const GLASS: [f64; 2] = [1.458, 0.00354];

/// A clear lens with a polynomial in its pupil, by the powers of x and y and radians at 460 nm.
fn masked(terms: &[(u32, u32, f64)], cauchy: Option<[f64; 2]>) -> Camera {
    let terms = terms.iter().map(|&(x, y, rad)| Monomial { x, y, rad }).collect();
    let mask = Mask::from_iter([Polynomial { at_nm: 460.0, cauchy, terms }]);
    let camera = Camera { mask, ..Camera::resolve("clear").unwrap() };
    camera.check().unwrap();
    camera
}

fn cubic(alpha: f64) -> Camera {
    masked(&[(3, 0, alpha), (0, 3, alpha)], None)
}

/// The candidates of the design notes on what no lens can pass.
const CANDIDATES: [&[(u32, u32, f64)]; 2] = [
    &[(3, 0, 2.3), (0, 3, 2.3), (2, 1, 0.2), (1, 2, 0.2)],
    &[
        (3, 0, 5.8),
        (0, 3, 5.8),
        (2, 1, 1.2),
        (1, 2, 1.2),
        (4, 1, -2.2),
        (1, 4, -2.2),
        (3, 2, 3.3),
        (2, 3, 3.3),
    ],
];

fn green(camera: &Camera, psi: f64, settings: &Settings) -> Psf {
    psf(camera, Channel::Green, psi, settings).unwrap()
}

/// Largest difference of two kernels about their middles, as a share of the peak.
fn apart(a: &Psf, b: &Psf) -> f64 {
    let half = a.side().min(b.side()) / 2;
    let part = |psf: &Psf| {
        let first = psf.side() / 2 - half;
        psf.kernel()
            .slice(ndarray::s![first.., first..])
            .slice(ndarray::s![..=2 * half, ..=2 * half])
            .to_owned()
    };
    let (a, b) = (part(a), part(b));
    let peak = b.iter().fold(0.0f32, |max, v| max.max(*v));
    f64::from(a.iter().zip(&b).fold(0.0f32, |max, (a, b)| max.max((a - b).abs())) / peak)
}

/// The mean of the PSF is that of the rays: 2·F#·(λ/2π)·mean of the phase's gradient over the disk. Of x³ that is 3/4, whatever the defocus. Pixels are so
/// small that sampling folds no frequency onto zero.
#[test]
fn the_centre_of_the_light_moves_as_the_mean_slope_says_and_not_with_defocus() {
    let camera = Camera { pixel_pitch_um: 1.5, ..masked(&[(3, 0, 6.0), (0, 3, -2.0)], None) };
    let expected = |alpha: f64| {
        0.75 * alpha * (460.0 / 535.0) * camera.wave_um(535.0) / std::f64::consts::PI / camera.pixel_pitch_um
    };
    for psi in [0.0, 5.0] {
        let psf = green(&camera, psi, &Settings::default());
        let half = (psf.side() / 2) as f64;
        let (right, down) = psf.kernel().indexed_iter().fold((0.0, 0.0), |(right, down), ((r, c), v)| {
            (right + f64::from(*v) * (c as f64 - half), down + f64::from(*v) * (r as f64 - half))
        });
        assert!((right - expected(6.0)).abs() < 0.03, "psi {psi}: {right} of {}", expected(6.0));
        assert!((down - expected(2.0)).abs() < 0.03, "psi {psi}: {down} of {}", expected(2.0));
    }
}

/// Dowski and Cathey: behind a strong cubic phase the MTF hardly changes with defocus and has no zeros, while a clear lens loses all contrast.
#[test]
fn contrast_behind_a_cubic_mask_hardly_changes_with_defocus() {
    let spread = |camera: &Camera, per_mm: f64| {
        let contrast = |psi: f64| otf(camera, Channel::Green, psi, Footprint::Lens).unwrap().at(per_mm).abs();
        let curve: Vec<f64> = (0..=4).map(|i| contrast(2.0 * f64::from(i))).collect();
        let least = curve.iter().copied().fold(f64::INFINITY, f64::min);
        (least, least / curve.iter().copied().fold(0.0, f64::max))
    };
    let coded = cubic(25.0);
    for per_mm in [40.0, 80.0, 120.0] {
        let (least, even) = spread(&coded, per_mm);
        assert!(least > 0.05 && even > 0.6, "{per_mm}: {least}, {even}");
    }
    let (_, even) = spread(&Camera::resolve("clear").unwrap(), 80.0);
    assert!(even < 0.1, "{even}");
}

#[test]
fn an_odd_phase_makes_psfs_of_no_round_or_mirror_symmetry() {
    let kernel = green(&cubic(5.0), 0.0, &Settings::default());
    assert_eq!(kernel.symmetries(), [false; 3]);
    // x³ + y³ is symmetric about the diagonal from the lower left, and throws light to the upper right.
    let last = kernel.side() - 1;
    let mirrored =
        Psf::new(Array2::from_shape_fn((last + 1, last + 1), |(r, c)| kernel.kernel()[(last - c, last - r)]));
    assert!(apart(&mirrored.unwrap(), &kernel) < 1e-5);
    let corner = |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| {
        kernel.kernel().slice(ndarray::s![rows, columns]).sum()
    };
    let (upper_right, lower_left) =
        (corner(0..last / 2, last / 2 + 1..last + 1), corner(last / 2 + 1..last + 1, 0..last / 2));
    assert!(upper_right > 3.0 * lower_left, "{upper_right} {lower_left}");
}

/// Noll's polynomials in x and y: Z8 = √8(3x³ + 3xy² − 2x), Z10 = √8(x³ − 3xy²), Z11 = √5(6(x² + y²)² − 6(x² + y²) + 1).
#[test]
fn zernike_terms_are_the_polynomials_that_noll_published() {
    let root = 8f64.sqrt();
    let five = 5f64.sqrt();
    type Terms = Vec<(u32, u32, f64)>;
    let published: [(u32, Terms); 3] = [
        (8, vec![(3, 0, 3.0 * root), (1, 2, 3.0 * root), (1, 0, -2.0 * root)]),
        (10, vec![(3, 0, root), (1, 2, -3.0 * root)]),
        (
            11,
            vec![
                (4, 0, 6.0 * five),
                (2, 2, 12.0 * five),
                (0, 4, 6.0 * five),
                (2, 0, -6.0 * five),
                (0, 2, -6.0 * five),
            ],
        ),
    ];
    for (noll, terms) in published {
        // One radian root mean square at 460 nm.
        let zernike = Zernike(vec![Aberration { noll, rms_nm: 460.0 / std::f64::consts::TAU }]);
        let named = Camera { mask: Mask::from_iter([zernike]), ..Camera::resolve("clear").unwrap() };
        let [named, spelled] =
            [named, masked(&terms, None)].map(|camera| green(&camera, 2.0, &Settings::default()));
        assert!(apart(&named, &spelled) < 1e-5, "{noll}: {}", apart(&named, &spelled));
    }
}

#[test]
fn a_polynomial_in_glass_is_the_height_map_of_its_surface() {
    for terms in CANDIDATES {
        let camera = masked(terms, Some(GLASS));
        let side = 512;
        let place = |i: usize| (i as f64 + 0.5) / f64::from(side as u32) * 2.0 - 1.0;
        let phase = |r: usize, c: usize| {
            let (x, y) = (place(c), -place(r));
            terms.iter().map(|&(i, j, rad)| rad * x.powi(i as i32) * y.powi(j as i32)).sum::<f64>()
        };
        let phases = Array2::from_shape_fn((side, side), |(r, c)| phase(r, c));
        let (low, high) = phases.iter().fold((0.0f64, 0.0f64), |(low, high), v| (low.min(*v), high.max(*v)));
        let rad_per_um = edof_core::camera::etched_rad(1.0, GLASS, 460.0);
        let mut map = HeightMap {
            file: "mask.png".into(),
            white_um: (high - low) / rad_per_um,
            cauchy: GLASS,
            sha256: String::new(),
            heights: None,
        };
        map.take(phases.mapv(|v| ((v - low) / (high - low)) as f32), "mask.png".into(), "clear").unwrap();
        let pictured = Camera { mask: Mask::from_iter([map]), ..camera.clone() };
        for (channel, psi) in [(Channel::Red, 0.0), (Channel::Green, 4.0), (Channel::Blue, 8.0)] {
            let of = |camera: &Camera| psf(camera, channel, psi, &Settings::default()).unwrap();
            let difference = apart(&of(&camera), &of(&pictured));
            assert!(difference < 1e-3, "{channel:?} {psi}: {difference}");
        }
    }
}

#[test]
fn a_strong_cubic_has_room_or_is_refused_with_what_helps() {
    let settings = Settings::default();
    let strong = green(&cubic(90.0), 8.0, &settings);
    assert!(
        strong.support >= 512 && strong.energy_beyond < 0.02,
        "{} {}",
        strong.support,
        strong.energy_beyond
    );
    let refused = psf(&cubic(1500.0), Channel::Green, 0.0, &settings).unwrap_err().to_string();
    assert!(refused.ends_with("use less defocus or larger pixels, a weaker polynomial"), "{refused}");
}

#[test]
fn derivatives_by_coefficients_agree_with_finite_differences() {
    let settings = Settings { energy: 0.98, ..Settings::default() };
    let camera = masked(CANDIDATES[1], Some(GLASS));
    let gradient = psf_gradient(&camera, 3.0, &settings).unwrap();
    assert_eq!((gradient.len(), parameters(&camera).len()), (9, 9));
    let moved = |index: usize, by: f64| {
        let mut moved = camera.clone();
        let term: &mut Term = &mut moved.mask.terms_mut()[0];
        let mut values: Vec<f64> = term.parameters(460.0).into_iter().map(Parameter::value).collect();
        match values.get_mut(index) {
            Some(value) => *value += by,
            None => moved.focus_psi += by,
        }
        let term: &mut Term = &mut moved.mask.terms_mut()[0];
        term.set(&values, 460.0);
        moved
    };
    for (index, planes) in gradient.iter().enumerate() {
        for (channel, plane) in Channel::ALL.into_iter().zip(planes) {
            let step = 4e-3;
            let [low, high] =
                [-step, step].map(|by| psf(&moved(index, by), channel, 3.0, &settings).unwrap());
            let expected = (high.kernel() - low.kernel()).mapv(|v| f64::from(v) / (2.0 * step));
            let largest = expected.iter().fold(0.0f64, |max, v| max.max(v.abs()));
            let error = (plane - &expected).iter().fold(0.0f64, |max, v| max.max(v.abs())) / largest;
            assert!(error < 2e-3, "{index} {channel:?}: {error}");
            assert!(plane.sum().abs() < 1e-9);
        }
    }
}
