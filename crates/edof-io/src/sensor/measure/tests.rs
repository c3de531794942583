use super::*;
use crate::sensor::correction::place;
use edof_core::RawFrame;
use std::collections::BTreeSet;

const SIZE: Size = Size { width: 160, height: 120 };
const BLACK: f64 = 256.0;
const NOISE: f64 = 5.0;

/// A sensor of 12 bits with faults that are known.
struct Planted {
    columns: Vec<f64>,
    hot: BTreeSet<(usize, usize)>,
    dead: BTreeSet<(usize, usize)>,
    /// A column without light and one at full scale.
    lines: [usize; 2],
    /// Standard deviation of each pixel's own offset.
    pattern: f64,
}

/// Numbers from 0 to 1 that look random.
struct Random(u64);

impl Random {
    fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1u32 << 31)
    }

    /// Nearly Gaussian, of variance 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.even()).sum::<f64>() - 6.0
    }

    fn place(&mut self) -> (usize, usize) {
        let side = |share: f64, length: usize| ((share * length as f64) as usize).min(length - 1);
        (side(self.even(), SIZE.height), side(self.even(), SIZE.width))
    }
}

impl Planted {
    fn new(pattern: f64) -> Self {
        let mut random = Random(7);
        let lines = [60usize, 101];
        // Apart from each other and from the lines, so that what is around each is usual.
        let mut places = |count: usize, seen: &mut BTreeSet<(usize, usize)>| {
            let mut found = BTreeSet::new();
            while found.len() < count {
                let (r, c) = random.place();
                let near = |other: &(usize, usize)| r.abs_diff(other.0) < 5 && c.abs_diff(other.1) < 5;
                if lines.iter().all(|line| line.abs_diff(c) > 4) && !seen.iter().any(near) {
                    found.insert((r, c));
                    seen.insert((r, c));
                }
            }
            found
        };
        let mut seen = BTreeSet::new();
        let (hot, dead) = (places(40, &mut seen), places(25, &mut seen));
        let columns = (0..SIZE.width).map(|c| if c % 7 == 3 { 12.0 } else { -2.0 }).collect();
        Self { columns, hot, dead, lines, pattern }
    }

    /// Up to 30 % less light towards the last row and column, of each place another amount.
    fn shading(r: usize, c: usize) -> f64 {
        let (y, x) = (r as f64 / 120.0, c as f64 / 160.0);
        1.0 - [0.15, 0.125, 0.125, 0.1][place(r, c)] * (y + x)
    }

    fn frames(&self, count: usize, light: f64, seed: u64) -> Frames {
        let (mut own, mut random) = (Random(99), Random(seed));
        let own = Array2::from_shape_fn((SIZE.height, SIZE.width), |_| self.pattern * own.normal());
        let mut frame = || {
            let values = Array2::from_shape_fn((SIZE.height, SIZE.width), |(r, c)| {
                let response = if self.dead.contains(&(r, c)) { 0.5 } else { 1.0 };
                let hot = if self.hot.contains(&(r, c)) { 150.0 } else { 0.0 };
                let seen = light * Self::shading(r, c) * response;
                let value = BLACK + self.columns[c] + own[(r, c)] + hot + seen + NOISE * random.normal();
                let value = [(self.lines[0], 0.0), (self.lines[1], 4095.0)]
                    .into_iter()
                    .find(|(line, _)| *line == c)
                    .map_or(value, |(_, stuck)| stuck);
                value.round().clamp(0.0, 4095.0) as u16
            });
            RawFrame::from_values(values, 12, CfaPhase::Grbg).unwrap()
        };
        let mut frames = Frames::new(&frame());
        (1..count).for_each(|_| frames.add(&frame()).unwrap());
        frames
    }
}

fn sensor<'a>(dark: Option<&'a Frames>, flat: Option<&'a Frames>) -> Sensor<'a> {
    Sensor { size: SIZE, phase: CfaPhase::Grbg, depth: 12, dark, flat, known: Defects::default() }
}

#[test]
fn what_was_planted_is_found_and_nothing_else() {
    let planted = Planted::new(0.0);
    let (dark, flat) = (planted.frames(8, 0.0, 1), planted.frames(8, 2000.0, 2));
    let (correction, report) = sensor(Some(&dark), Some(&flat)).measured(&Limits::default()).unwrap();
    let tables = correction.tables();
    let found: BTreeSet<_> = tables.defects.pixels.iter().map(|[r, c]| (*r as usize, *c as usize)).collect();
    let wanted: BTreeSet<_> = planted.hot.union(&planted.dead).copied().collect();
    assert_eq!(found, wanted);
    assert_eq!((&tables.defects.columns[..], &tables.defects.rows[..]), (&[60, 101][..], &[][..]));
    let told = report.dark.unwrap();
    assert_eq!((told.hot, told.cold, told.per_pixel, report.lost.len()), (40, 0, false, 0));
    assert!((told.noise - NOISE).abs() < 0.1, "{}", told.noise);
    // Offsets in words of 16 bits: 16 in a sensor value.
    for ((r, c), found) in tables.offsets().indexed_iter().filter(|((_, c), _)| !planted.lines.contains(c)) {
        let (found, planted) = (f64::from(*found) / 16.0, BLACK + planted.columns[c]);
        assert!((found - planted).abs() < 1.0, "{r}, {c}: {found} {planted}");
    }
    for (at, gain) in correction.light(&flat_frame(&planted)).unwrap().pixels().indexed_iter() {
        let expected = 65536.0 * 2000.0 / (4096.0 - BLACK);
        assert!((f64::from(*gain) / expected - 1.0).abs() < 0.02, "{at:?}: {gain} of {expected}");
    }
    let shading = report.flat.unwrap().shading;
    assert!(shading.iter().zip([1.35, 1.45, 1.35]).all(|(a, b)| (a - b).abs() < 0.04), "{shading:?}");
}

/// A flat frame without noise.
fn flat_frame(planted: &Planted) -> RawFrame {
    let values = Array2::from_shape_fn((SIZE.height, SIZE.width), |(r, c)| {
        (BLACK + planted.columns[c] + 2000.0 * Planted::shading(r, c)).round() as u16
    });
    RawFrame::from_values(values, 12, CfaPhase::Grbg).unwrap()
}

#[test]
fn pixels_have_offsets_of_their_own_where_the_frames_support_it() {
    let planted = Planted::new(4.0);
    let of = |frames: &Frames| sensor(Some(frames), None).measured(&Limits::default()).unwrap();
    let (many, report) = of(&planted.frames(16, 0.0, 3));
    assert!(report.dark.unwrap().per_pixel);
    // The offset of a pixel leaves the error of a mean of 16 frames.
    let left = {
        let (truth, mut random) = (planted.frames(256, 0.0, 4).mean(), many.tables().offsets());
        random.indexed_iter_mut().filter(|(at, _)| many.defects().mask()[*at]).for_each(|(_, v)| *v = 0);
        let off = truth.indexed_iter().filter(|(at, _)| !many.defects().mask()[*at]);
        let off: Vec<f64> = off
            .map(|(at, v)| f64::from(*v) - f64::from(random[at]) / 16.0)
            .filter(|v| v.abs() < 60.0)
            .collect();
        (off.iter().map(|v| v * v).sum::<f64>() / off.len() as f64).sqrt()
    };
    assert!(left < 1.6, "{left}");
    // One frame tells no pattern from noise; two know less of a pixel than its column and row do where the pattern is faint.
    for (planted, frames) in [(planted, 1), (Planted::new(2.0), 2)] {
        let (few, report) = of(&planted.frames(frames, 0.0, 5));
        assert!(few.tables().pixels.is_none() && !report.dark.unwrap().per_pixel, "{frames}");
    }
}

#[test]
fn frames_without_noise_make_no_defects() {
    let planted = Planted { hot: BTreeSet::new(), dead: BTreeSet::new(), ..Planted::new(0.0) };
    let one = Frames::new(&flat_frame(&planted));
    let (correction, report) =
        sensor(None, Some(&one)).measured(&Limits { black: Black::from(256), ..Limits::default() }).unwrap();
    assert_eq!((&correction.tables().defects, report.flat.unwrap().dead), (&Defects::default(), 0));
    let dark =
        Frames::new(&RawFrame::from_values(Array2::from_elem((120, 160), 64), 12, CfaPhase::Grbg).unwrap());
    let (correction, report) = sensor(Some(&dark), None).measured(&Limits::default()).unwrap();
    assert_eq!((&correction.tables().defects, report.dark.unwrap().black), (&Defects::default(), [64.0; 4]));
}

#[test]
fn frames_that_show_nothing_are_rejected_by_name() {
    let planted = Planted::new(0.0);
    let refused = |light: f64, limits: Limits| {
        let flat = planted.frames(1, light, 9);
        sensor(None, Some(&flat)).measured(&limits).unwrap_err().to_string()
    };
    let limits = Limits { black: Black::from(256), ..Limits::default() };
    assert!(
        refused(60.0, limits).starts_with("flat frames: the light of red is 1."),
        "{}",
        refused(60.0, limits)
    );
    assert!(refused(4200.0, limits).contains("expected 5 to 90 %; change exposure or light"));
    let white = |white: f64| refused(2000.0, Limits { white: Some(white), ..limits });
    assert_eq!(white(200.0), "white level 200: must be above black, 256.0, and at most 4096");
    assert!(white(1000.0).contains("is less than a quarter of full scale, 4096; state the bits"));
    let mut frames = planted.frames(1, 0.0, 1);
    let other = RawFrame::from_values(Array2::zeros((120, 160)), 10, CfaPhase::Grbg).unwrap();
    let told = frames.add(&other).unwrap_err().to_string();
    assert!(
        told.starts_with("a frame of 160x120 of phase grbg with 10 bits, expected one of 160x120"),
        "{told}"
    );
    let outside = Sensor {
        known: Defects { pixels: vec![[0, 160]], ..Defects::default() },
        ..sensor(Some(&frames), None)
    };
    let told = outside.measured(&Limits::default()).unwrap_err().to_string();
    assert_eq!(told, "defective pixel at row 0, column 160: outside of frames of 160x120");
}

#[test]
fn a_scene_is_no_dark_frame_and_no_flat_one() {
    let texture = |light: f64, swing: f64| {
        let mut random = Random(5);
        let value = |_| (light + swing * random.normal()).clamp(0.0, 4095.0) as u16;
        let values = Array2::from_shape_fn((SIZE.height, SIZE.width), value);
        Frames::new(&RawFrame::from_values(values, 12, CfaPhase::Grbg).unwrap())
    };
    let refused = |sensor: Sensor<'_>| sensor.measured(&Limits::default()).unwrap_err();
    let (lit, scene, even) = (texture(1200.0, 3.0), texture(500.0, 200.0), texture(2000.0, 3.0));
    let told = refused(sensor(Some(&lit), None)).to_string();
    assert!(
        told.starts_with("dark frames: black is 1200 of 4096, expected at most 819; take them with"),
        "{told}"
    );
    assert!(matches!(
        refused(sensor(Some(&scene), None)),
        MeasureError::NotDark { what: "pixels spread by", .. }
    ));
    let rough = texture(2000.0, 500.0);
    assert!(matches!(refused(sensor(None, Some(&rough))), MeasureError::NotFlat { .. }));
    assert!(sensor(None, Some(&even)).measured(&Limits::default()).is_ok());
    // Light that is weak makes a correction, with doubts.
    let weak = sensor(Some(&texture(400.0, 60.0)), None).measured(&Limits::default()).unwrap().1.doubts;
    assert!(matches!(weak[..], [Doubt::Pattern(_), Doubt::Noise(_)]), "{weak:?}");
    assert_eq!(sensor(Some(&texture(256.0, 3.0)), None).measured(&Limits::default()).unwrap().1.doubts, []);
    // Light that falls off towards the corners, and columns that do not answer to it.
    let leak = |light: f64, dead: f64| {
        let mut random = Random(9);
        let values = Array2::from_shape_fn((SIZE.height, SIZE.width), |(r, c)| {
            let [y, x] = [r as f64 / 60.0 - 1.0, c as f64 / 80.0 - 1.0];
            let light = if c == 50 { dead } else { light * (1.0 - 0.2 * (y * y + x * x)) };
            (168.0 + light + 3.0 * random.normal()).clamp(0.0, 4095.0) as u16
        });
        let frames = Frames::new(&RawFrame::from_values(values, 12, CfaPhase::Grbg).unwrap());
        sensor(Some(&frames), None).measured(&Limits::default()).unwrap().1.doubts
    };
    let found = leak(120.0, 0.0);
    assert!(matches!(found[..], [Doubt::Line(_), Doubt::Slope(_)]), "{found:?}");
    assert_eq!(leak(0.0, 0.0), []);
    // One that is stuck at 0 says nothing of light.
    assert_eq!(leak(0.0, -168.0), []);
    // Words of another packing: most pixels are as ever, the others anything.
    let mut random = Random(3);
    let mixed = Array2::from_shape_fn((SIZE.height, SIZE.width), |_| {
        let value = if random.even() < 0.1 { 4000.0 * random.even() } else { 200.0 + random.even() };
        value as u16
    });
    let mixed = Frames::new(&RawFrame::from_values(mixed, 12, CfaPhase::Grbg).unwrap());
    assert!(matches!(refused(sensor(Some(&mixed), None)), MeasureError::TooManyDefects { .. }));
}
