//! Sums, tables and steps at the ends of numbers.

use crate::metrics::Quality;
use crate::stability::case::{Numbers, Promise};
use crate::stability::outcome::{Measurement, Stopped, TrialResult};
use crate::stability::subjects::Subjects;
use edof_core::display::{CODES, COLOUR_ADDRESS_BITS, DisplayMode};
use edof_core::draw::Draw;
use edof_core::frame::Frame422;
use edof_core::number::ACCUMULATOR_BITS;
use edof_core::number::{OutputSum, OutputWord};
use edof_core::{ColourFrame, Geometry, Noise, Stride, Tone, Window};
use edof_golden::overlap_add::overlap_add;
use edof_golden::{ColourTable, Counts, Curve, Display};
use edof_network::float::parameters::Layout;
use edof_network::float::pass::{Examples, Pass};
use edof_network::network::{Form, Recurrence, Shrinkage};
use edof_optics::{Sensor, expose};
use edof_train::adam::Adam;
use ndarray::{Array2, Axis};

/// Runs one of them.
pub(crate) fn numbers(
    subjects: &Subjects,
    given: Numbers,
    promise: &Promise,
) -> Result<TrialResult, Stopped> {
    let limit = |subject: &str| promise.limit(subject).unwrap_or(0.0);
    let seen = match given {
        Numbers::PsnrOfMegapixels(count) => vec![psnr(subjects, count, limit("psnr"))?],
        Numbers::SsimOfFlat => ssim()?,
        Numbers::GammaIndex => gamma(subjects),
        Numbers::DisplayOfExtremes => display(),
        Numbers::OverlapSums => return overlap(),
        Numbers::GradientInSingle => vec![gradient(limit("gradient.f32"))?],
        Numbers::Adam => adam(),
        Numbers::SensorOfAnyLight => sensor()?,
        Numbers::Requantize => vec![requantize(subjects)],
    };
    Ok(TrialResult::of(seen))
}

/// An error that is the same at every pixel: any rounding of the sum goes the same way.
fn psnr(subjects: &Subjects, megapixels: usize, limit: f64) -> Result<Measurement, Stopped> {
    let mut truth = ColourFrame::zeros(1000 * megapixels, 1000);
    truth.planes.fill(0.5);
    let mut estimate = truth.clone();
    estimate.planes.fill(0.503);
    let exact = -20.0 * f64::from(0.503f32 - 0.5f32).log10();
    let found = (subjects.psnr)(&truth, &estimate, 0)?;
    let off = Measurement::new("psnr", "dB off the exact one", (found - exact).abs(), limit);
    Ok(off.noted(format!("{found:.9} dB")))
}

fn ssim() -> Result<Vec<Measurement>, Stopped> {
    let flat = |level: f32| {
        let mut frame = ColourFrame::zeros(40, 40);
        frame.planes.fill(level);
        frame
    };
    let mut seen = vec![];
    for (a, b) in [(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.500_001)] {
        let quality = Quality::of(&flat(a), &flat(b), 8, Tone::Linear)?;
        let ssim = quality.number("ssim").unwrap_or(f64::NAN);
        let inside = (-1.0..=1.0 + 1e-12).contains(&ssim);
        let equal = a == b;
        let db = quality.psnr_db().is_finite() != equal;
        let what = format!("greys {a} and {b}: SSIM from −1 to 1, PSNR infinite for equal frames alone");
        seen.push(Measurement::fact("metrics", what, inside && db && (!equal || ssim > 1.0 - 1e-9)));
    }
    Ok(seen)
}

fn gamma(subjects: &Subjects) -> Vec<Measurement> {
    let last = (1i32 << COLOUR_ADDRESS_BITS) - 1;
    let ends = [i32::MIN, i32::MIN + 1, -1, 0, 1, last - 1, last, last + 1, last + 2, i32::MAX - 1, i32::MAX];
    let thinned = (i32::MIN..=i32::MAX).step_by(1_048_573);
    let lights: Vec<i32> = ends.into_iter().chain(thinned).chain(-40_000..40_000).collect();
    [Curve::Linear, Curve::Srgb, Curve::Bt709]
        .into_iter()
        .map(|curve| {
            let table = ColourTable::new(curve);
            let right = |light: &&i32| {
                let index = i64::from(**light).clamp(0, i64::from(last)) as usize;
                (subjects.encoded)(&table, OutputSum::from_bits(**light)) == table.entries()[index]
            };
            let wrong = lights.len() - lights.iter().filter(right).count();
            let what = "light beyond the table reads its first or last entry";
            Measurement::fact(format!("{curve:?}").to_lowercase(), what, wrong == 0)
                .noted(format!("{} lights, {wrong} wrong", lights.len()))
        })
        .collect()
}

/// The display step of docs/contract.md, section 5.2, for frames of one colour, in integers of 64 bits.
fn shown([y, cb, cr]: [i16; 3], table: &ColourTable) -> [u8; 3] {
    let [y, cb2, cr2] = [i64::from(y), 2 * i64::from(cb), 2 * i64::from(cr)];
    let light =
        [58_975 * cr2, -7015 * cb2 - 17_531 * cr2, 69_491 * cb2].map(|c| (y * 131_072 + c + 65_536) >> 17);
    let [r, g, b] = light.map(|v| i64::from(table.entries()[v.clamp(0, 16_383) as usize]));
    let luma = 16 + ((11_922 * r + 40_107 * g + 4049 * b + (1 << 19)) >> 20);
    let [r, g, b] = [r, g, b].map(|v| 4 * v);
    let first = 128 + ((-6572 * r - 22_107 * g + 28_679 * b + (1 << 21)) >> 22);
    let second = 128 + ((28_679 * r - 26_049 * g - 2630 * b + (1 << 21)) >> 22);
    [luma, first, second].map(|code| code.clamp(1, 254) as u8)
}

fn display() -> Vec<Measurement> {
    let words = [i16::MIN, i16::MIN + 1, -16_384, -1, 0, 1, 16_383, 16_384, 28_672, i16::MAX];
    let mut seen = vec![];
    for mode in DisplayMode::ALL {
        let display = Display::new(mode, Curve::Srgb);
        let (mut outside, mut wrong, mut frames) = (0, 0, 0);
        for colour in
            words.iter().flat_map(|y| words.iter().flat_map(move |cb| words.map(|cr| [*y, *cb, cr])))
        {
            let plane = |width, word| Array2::from_elem((2, width), OutputWord::from_bits(word));
            let frame =
                Frame422 { luma: plane(8, colour[0]), chroma: [plane(4, colour[1]), plane(4, colour[2])] };
            let (picture, _) = display.picture(&frame, (0, 0), (2, 8));
            let codes = picture.luma.iter().chain(picture.chroma.iter().flatten());
            outside += codes.filter(|code| !(CODES[0]..=CODES[1]).contains(*code)).count();
            let found = [picture.luma[(0, 2)], picture.chroma[0][(0, 1)], picture.chroma[1][(0, 1)]];
            if mode == DisplayMode::Colour {
                wrong += usize::from(found != shown(colour, &display.colours[0]));
            }
            frames += 1;
        }
        let name = format!("display {mode}");
        seen.push(
            Measurement::fact(&name, "no code is a sync", outside == 0).noted(format!("{frames} colours")),
        );
        if mode == DisplayMode::Colour {
            seen.push(Measurement::fact(&name, "codes are those of the contract", wrong == 0));
        }
    }
    seen
}

fn overlap() -> Result<TrialResult, Stopped> {
    let (size, stride) = ((18usize, 22usize), Stride::FINEST);
    let geometry = Geometry::new(Window::new(8)?, stride);
    let mut seen = vec![];
    let mut saturations = 0;
    for word in [OutputWord::MAX, OutputWord::MIN] {
        let mut counts = Counts::new(2);
        let frame = overlap_add(geometry, size, |_, _| vec![word; 128], &mut counts);
        let held = frame.luma.iter().chain(frame.chroma.iter().flatten()).all(|v| *v == word);
        let all = (2 * size.0 * size.1) as u64;
        let counted = counts.saturated_sums == all;
        seen.push(Measurement::fact(
            format!("sixteen words of {}", word.to_bits()),
            "held to the end, every place counted",
            held && counted,
        ));
        saturations += counts.saturated_sums;
    }
    Ok(TrialResult { saturations, ..TrialResult::of(seen) })
}

/// One gradient of a small network in both precisions.
fn gradient(limit: f64) -> Result<Measurement, Stopped> {
    const WINDOWS: usize = 16;
    let form = Form {
        window: Window::new(8)?,
        codes: 24,
        layers: 4,
        shrinkage: Shrinkage::OneSided,
        recurrence: Recurrence::Direct,
        linear_path: true,
        tied: false,
        exposures: 1,
    };
    let draw = &mut Draw::new(23);
    let mut noise = |length: usize, scale: f64| -> Vec<f64> {
        // Numbers that f32 holds, so that both start from the same.
        (0..length).map(|_| f64::from((draw.whole(-1000, 1000) as f64 * 1e-3 * scale) as f32)).collect()
    };
    let weights = noise(Layout::new(&form).len(), 0.1);
    let (inputs, targets) = (noise(WINDOWS * 64, 1.0), noise(WINDOWS * 192, 1.0));
    let narrow = |values: &[f64]| values.iter().map(|v| *v as f32).collect::<Vec<f32>>();
    let mut wide = vec![0.0; weights.len()];
    let examples = Examples { inputs: &inputs, targets: &targets, importance: &[1.0; WINDOWS] };
    Pass::<f64>::new(form, WINDOWS).gradient(&weights, &examples, &[1e-3; 3], &mut [0.0; WINDOWS], &mut wide);
    let mut single = vec![0.0; weights.len()];
    let (inputs, targets) = (narrow(&inputs), narrow(&targets));
    let examples = Examples { inputs: &inputs, targets: &targets, importance: &[1.0; WINDOWS] };
    let mut errors = [0.0; WINDOWS];
    Pass::<f32>::new(form, WINDOWS).gradient(
        &narrow(&weights),
        &examples,
        &[1e-3; 3],
        &mut errors,
        &mut single,
    );
    let off = wide.iter().zip(&single).map(|(a, b)| (a - f64::from(*b)).powi(2)).sum::<f64>().sqrt();
    let size = wide.iter().map(|v| v * v).sum::<f64>().sqrt();
    Ok(Measurement::new("gradient.f32", "off the gradient in f64, of its size", off / size, limit))
}

fn adam() -> Vec<Measurement> {
    const LENGTH: usize = 9;
    const RATE: f32 = 0.01;
    // (1 − β₁)/√(1 − β₂): the longest step there is, in units of the rate.
    const LONGEST: f64 = 3.17;
    let mut seen = vec![];
    for size in [0.0f32, 1e-30, 1.0, 1e18] {
        let (mut adam, mut weights) = (Adam::new(LENGTH), vec![0.5; LENGTH]);
        let mut longest = 0.0f64;
        for step in 0..400 {
            let before = weights.clone();
            // Sparse and sudden, which makes the longest steps.
            let gradient: Vec<f32> =
                (0..LENGTH).map(|i| if (step + i) % 97 == 0 { size } else { 0.0 }).collect();
            adam.step(&mut weights, &gradient, RATE, &[1.0; LENGTH]);
            let moved = weights.iter().zip(&before).map(|(a, b)| f64::from((a - b).abs() / RATE));
            longest = moved.fold(longest, |longest, v| if v <= longest { longest } else { v });
        }
        let state = adam.mean.iter().chain(&adam.square).chain(&weights).all(|v| v.is_finite());
        let name = format!("gradients of {size:e}");
        seen.push(Measurement::fact(&name, "weights and moments stay finite", state));
        seen.push(Measurement::new(&name, "longest step, of the rate", longest, LONGEST));
    }
    seen
}

fn sensor() -> Result<Vec<Measurement>, Stopped> {
    let mut light = ColourFrame::zeros(8, 20);
    let levels = [0.0, -1.0, f32::MIN, 1.0, 2.0, 1e30, f32::MAX, f32::MIN_POSITIVE, 0.5, -1e-30];
    light.planes.axis_iter_mut(Axis(2)).enumerate().for_each(|(c, mut column)| column.fill(levels[c / 2]));
    let mut seen = vec![];
    for depth in [8, 10, 12, 14, 16] {
        for noise in [Noise::None, Noise::gaussian(1.0), Noise::sensor(10_000.0)] {
            let raw = expose(&light, &Sensor { depth, noise, seed: 3, ..Sensor::default() })?;
            let max = (1u32 << depth) - 1;
            let (values, none) = (raw.values(), noise == Noise::None);
            let inside = values.iter().all(|v| u32::from(*v) <= max);
            let ends = !none || (values[(0, 3)] == 0 && u32::from(values[(0, 11)]) == max);
            seen.push(Measurement::fact(
                format!("{depth} bits, noise {noise}"),
                "every value is one of the sensor's",
                inside && ends,
            ));
        }
    }
    Ok(seen)
}

/// Every shift and width, sums at their ends and about every tie.
fn requantize(subjects: &Subjects) -> Measurement {
    let draw = &mut Draw::new(29);
    let (mut wrong, mut tried) = (0u64, 0u64);
    for (shift, bits) in (0..48u32).flat_map(|shift| (8..=16u32).map(move |bits| (shift, bits))) {
        let full = 1i64 << (ACCUMULATOR_BITS - 1);
        let (tie, end) = (1i64 << shift >> 1, 1i128 << (bits - 1 + shift));
        let near = |v: i128| (-2..=2).map(move |d| v + d);
        let ends = [-end, end, end - i128::from(tie), -end - i128::from(tie)].into_iter().flat_map(near);
        let drawn = (0..20).map(|_| i128::from(draw.whole(-full, full - 1)));
        let sums = near(0).chain(near(tie.into())).chain(near(-i128::from(tie))).chain(ends).chain(drawn);
        for sum in sums.chain([-i128::from(full), i128::from(full) - 1]) {
            let Some(acc) = i64::try_from(sum).ok().filter(|v| (-full..full).contains(v)) else { continue };
            let half = if shift == 0 { 0 } else { i128::from(tie) };
            let exact = (sum + half).div_euclid(1i128 << shift);
            let max = (1i128 << (bits - 1)) - 1;
            let held = exact.clamp(-max - 1, max);
            let (word, saturated) = (subjects.requantize)(acc, shift, bits);
            wrong += u64::from((i128::from(word), saturated) != (held, held != exact));
            tried += 1;
        }
    }
    Measurement::fact("requantize", "rounded and held as in 128 bits", wrong == 0)
        .noted(format!("{tried} sums, {wrong} wrong"))
}
