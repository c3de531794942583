//! Times of PSFs, blur and the design's judge on this machine: `cargo run --release -p edof-optics --example timing`. PSFs are compared
//! with the former sums, whole planes transformed one after another on a period that is a multiple of the support.

use edof_core::camera::{Aberration, Camera, Zernike};
use edof_core::{Channel, ColourFrame};
use edof_numerics::fft::{Complex64, Real};
use edof_numerics::sinc;
use edof_optics::Pupil;
use edof_optics::Statistics;
use edof_optics::cosine::{EvenTransform, fold_rows, period};
use edof_optics::design::default_task;
use edof_optics::estimator::judge;
use edof_optics::psf::{Settings, channel_psfs, psf, quarter_psf};
use edof_optics::{Blur, blur_frame};
use ndarray::Array2;
use std::hint::black_box;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let camera = Camera::resolve("ring-outer")?;
    let tell = |what: &str, repeats: u32, work: &mut dyn FnMut()| {
        let start = Instant::now();
        (0..repeats).for_each(|_| work());
        println!("{what:48} {:9.2} ms", 1e3 * start.elapsed().as_secs_f64() / f64::from(repeats));
    };
    for (name, settings) in [("99.9 % of the energy", Settings::default()), ("exact", Settings::exact())] {
        tell(&format!("PSF of one channel, {name}"), 4, &mut || {
            black_box(psf(&camera, Channel::Green, 6.0, &settings).unwrap());
        });
    }
    against_former_sums(&camera);
    let psfs = channel_psfs(&camera, 6.0, &Settings::default())?;
    for (height, width) in [(512, 768), (1080, 1920)] {
        let frame = ColourFrame::zeros(height, width);
        let plane = frame.planes.index_axis(ndarray::Axis(0), 1);
        let plan = Blur::new(height, width);
        let (spectrum, transfer) = (plan.spectrum(plane), plan.transfer(&psfs[1]));
        let size = format!("{width}x{height}");
        tell(&format!("{size}: spectrum of a plane"), 4, &mut || drop(black_box(plan.spectrum(plane))));
        tell(&format!("{size}: transfer of a PSF"), 4, &mut || drop(black_box(plan.transfer(&psfs[1]))));
        tell(&format!("{size}: one more plane blurred"), 4, &mut || {
            drop(black_box(plan.apply(&spectrum, &transfer)))
        });
        tell(&format!("{size}: three planes from nothing"), 2, &mut || {
            drop(black_box(blur_frame(&frame, &psfs)))
        });
    }
    let (statistics, task) = (Statistics::natural(), default_task(&camera));
    tell("a camera judged (nine depths, window 12)", 4, &mut || {
        drop(black_box(judge(&camera, &statistics, &task)))
    });
    Ok(())
}

/// Times of one-wavelength PSFs by the former sums and by the present ones, in turn, and how far the values are apart.
fn against_former_sums(camera: &Camera) {
    let repeats = 5;
    for support in [256, 512, 1024] {
        let (mut before, mut after) = (f64::INFINITY, f64::INFINITY);
        let mut apart = 0.0f64;
        for _ in 0..repeats {
            let start = Instant::now();
            let former = former_quarter_psf(camera, 535.0, 6.0, support);
            before = before.min(start.elapsed().as_secs_f64());
            let start = Instant::now();
            let present = quarter_psf(camera, 535.0, 6.0, support);
            after = after.min(start.elapsed().as_secs_f64());
            apart = former.iter().zip(&present).fold(apart, |most, (a, b)| most.max((a - b).abs()));
        }
        let times =
            format!("{:.1} ms, formerly {:.1} ms: {:.2} times", 1e3 * after, 1e3 * before, before / after);
        println!("PSF of a round lens, support {support:4}: {times} as fast, apart {apart:.1e}");
    }
    // A tilt of nothing is the same lens, but not a round one.
    let aberrations = Zernike(vec![Aberration { noll: 2, rms_nm: 0.0 }]);
    let tilted = Camera { aberrations, ..camera.clone() };
    let settings = Settings::default();
    let (mut before, mut after) = (f64::INFINITY, f64::INFINITY);
    let mut support = 0;
    for _ in 0..repeats {
        let start = Instant::now();
        support = black_box(psf(&tilted, Channel::Green, 6.0, &settings).unwrap()).support;
        after = after.min(start.elapsed().as_secs_f64());
        let start = Instant::now();
        drop(black_box(former_whole_psf(&tilted, 535.0, 6.0, support)));
        before = before.min(start.elapsed().as_secs_f64());
    }
    let times =
        format!("{:.1} ms, formerly {:.1} ms: {:.2} times", 1e3 * after, 1e3 * before, before / after);
    println!("PSF of any lens, support {support:4}: {times} as fast");
}

/// Points along a side of the former period.
fn former_period(camera: &Camera, nm: f64, support: usize) -> (usize, f64) {
    let wave = camera.wave_um(nm) / camera.pixel_pitch_um;
    (support * (2.0 / wave).ceil().max(1.0) as usize, support as f64 / (2.0 * wave))
}

fn former_quarter_psf(camera: &Camera, nm: f64, psi: f64, support: usize) -> Array2<f64> {
    let (points, radius) = former_period(camera, nm, support);
    let n = points / 2 + 1;
    let samples = (radius.ceil() as usize + 1).min(n);
    let pupil = Pupil::new(camera, nm, psi);
    let sampled = Array2::from_shape_fn((samples, samples), |(r, c)| {
        pupil.sample((r as f64).hypot(c as f64) / radius, 1.0 / radius)
    });
    let transform = EvenTransform::new(n);
    let both = |plane: Array2<f64>, transform: &EvenTransform<f64>, keep: usize| {
        let half_way = transform.rows_transposed(plane.view(), keep);
        transform.rows_transposed(half_way.view(), keep)
    };
    let squared = |part: Array2<f64>| both(part, &transform, n).mapv_into(|v| v * v);
    let intensity = squared(sampled.mapv(|p| p.re)) + squared(sampled.mapv(|p| p.im));
    let otf = both(intensity, &transform, (2 * samples).min(n));
    let light = otf[(0, 0)];
    let footprint = |q: usize| sinc(q as f64 / support as f64);
    let seen = Array2::from_shape_fn(otf.dim(), |(r, c)| otf[(r, c)] / light * footprint(r) * footprint(c));
    let side = support / 2 + 1;
    let folded = fold_rows(fold_rows(seen.view(), side).t(), side);
    let scale = 1.0 / (period(side) * period(side)) as f64;
    both(folded, &EvenTransform::new(side), side).mapv(|v| (v * scale).max(0.0))
}

fn former_whole_psf(camera: &Camera, nm: f64, psi: f64, support: usize) -> Array2<f64> {
    let (n, radius) = former_period(camera, nm, support);
    let pupil = Pupil::new(camera, nm, psi);
    let frequency = |q: usize| if 2 * q < n { q as isize } else { q as isize - n as isize };
    let sampled = Array2::from_shape_fn((n, n), |(r, c)| {
        let rho = (frequency(r) as f64).hypot(frequency(c) as f64) / radius;
        if rho > 1.1 { Complex64::default() } else { pupil.sample(rho, 1.0 / radius) }
    });
    let otf = former_transform(former_transform(sampled).mapv(|v| Complex64::new(v.norm_sqr(), 0.0)));
    let mut folded = Array2::from_elem((support, support), Complex64::default());
    for ((r, c), value) in otf.indexed_iter() {
        let cycles = [r, c].map(|q| frequency(q) as f64 / support as f64);
        let at = [r, c].map(|q| frequency(q).rem_euclid(support as isize) as usize);
        folded[at] += value.conj() * (sinc(cycles[0]) * sinc(cycles[1]) / otf[(0, 0)].re);
    }
    former_transform(folded).mapv(|v| v.re.max(0.0) / (support * support) as f64)
}

fn former_transform(plane: Array2<Complex64>) -> Array2<Complex64> {
    let n = plane.nrows();
    let fft = f64::forward(n);
    let rows = |plane: Array2<Complex64>| {
        let mut data: Vec<Complex64> = plane.iter().copied().collect();
        fft.process(&mut data);
        Array2::from_shape_fn((n, n), |(r, c)| data[c * n + r])
    };
    rows(rows(plane))
}
