use super::*;
use crate::float_reference::FloatReference;
use edof_core::draw::Draw;
use edof_core::number::bits_of;
use edof_core::{Stride, Window};
use edof_golden::scalar;
use edof_network::network::{Form, Shrinkage};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn no_window_is_further_off_than_the_bound(
        layers in 2usize..=5, shrinkage in prop::sample::select(&Shrinkage::ALL[..]), flags: [bool; 3], tight: bool,
        bits in 8u32..=16, seed: u64
    ) {
        let form = Form { codes: 5, ..form(layers, shrinkage, flags) };
        let fixed = edof_device::random::extreme(form, bits, Stride::PATCH, tight, seed);
        prop_assume!(fixed.check().is_ok());
        // Weights that are off by up to a last bit, too.
        let mut draw = Draw::new(seed);
        let mut real = Folded::of(&fixed);
        let step = unit(fixed.analysis.fraction);
        real.analysis.mapv_inplace(|w| w + step * draw.whole(-100, 100) as f64 * 0.01);
        let twin = FloatReference::<f64>::new(&fixed, &real);
        let bounds = bounds(&fixed, &real, Arithmetic::Words);
        for _ in 0..20 {
            let y = edof_device::random::extreme_window(&mut draw, 64);
            let (trace, values) = (scalar::run(&fixed, &y), twin.run(&y));
            let words = trace.layers.iter().map(|layer| &layer.b[..]).chain([bits_of(&trace.output)]);
            for ((words, values), bound) in words.zip(&values.stages).zip(&bounds) {
                for ((word, value), worst) in words.iter().zip(values).zip(&bound.worst) {
                    let off = (f64::from(*word) * bound.unit - value).abs();
                    prop_assert!(off <= worst * (1.0 + 1e-9) + 1e-9 * bound.unit, "{}: {off} {worst}", bound.name);
                }
            }
        }
    }
}

#[test]
fn one_stage_of_words_without_error_is_off_by_half_a_bit() {
    let fixed = edof_device::random::natural(8, 8, 3);
    let bounds = bounds(&fixed, &Folded::of(&fixed), Arithmetic::Words);
    assert_eq!(bounds.iter().map(|b| b.name.as_str()).collect::<Vec<_>>(), ["I", "M1", "M2", "F"]);
    assert_eq!(bounds[0].summary().worst_bits, 0.5);
    assert!((bounds[0].summary().deviation_bits - (1.0f64 / 12.0).sqrt()).abs() < 1e-12);
    assert!(bounds[1].summary().worst_bits > 0.5);
}

fn form(layers: usize, shrinkage: Shrinkage, flags: [bool; 3]) -> Form {
    Form {
        window: Window::new(8).unwrap(),
        codes: 3,
        layers,
        shrinkage,
        recurrence: if flags[0] { Recurrence::Difference } else { Recurrence::Direct },
        linear_path: flags[1],
        tied: flags[2],
        exposures: 1,
    }
}

/// Small networks of every form: weights of full size, and smaller ones that saturate less.
fn networks() -> impl Iterator<Item = (u64, FixedNetwork)> {
    (0..96u64).map(|seed| {
        let flags = [2, 4, 8].map(|bit| seed & bit != 0);
        let shrinkage = Shrinkage::ALL[seed as usize % Shrinkage::ALL.len()];
        let form = form(2 + (seed / 2 % 4) as usize, shrinkage, flags);
        let mut fixed = edof_device::random::extreme(form, 12, Stride::PATCH, seed % 5 == 0, seed);
        let divisor = [1, 16, 64, 256][(seed / 16 % 4) as usize];
        let matrices = [&mut fixed.analysis, &mut fixed.dictionary].into_iter();
        for matrix in matrices.chain(&mut fixed.recurrent).chain(&mut fixed.linear_path) {
            matrix.weights.mapv_inplace(|w| w / divisor);
        }
        fixed.thresholds.iter_mut().for_each(|theta| theta.mapv_inplace(|t| t / 64));
        (seed, fixed)
    })
}

/// Real weights that are a little off the words.
fn near(fixed: &FixedNetwork, seed: u64) -> Folded {
    let mut draw = Draw::new(seed);
    let mut off = move |w: f64| w + draw.whole(-100, 100) as f64 * 1e-6;
    let mut real = Folded::of(fixed);
    real.analysis.mapv_inplace(&mut off);
    real.thresholds.iter_mut().for_each(|theta| theta.mapv_inplace(|t| off(t).max(0.0)));
    real.recurrent.iter_mut().for_each(|s| s.mapv_inplace(&mut off));
    real.dictionary.mapv_inplace(&mut off);
    real.linear_path.iter_mut().for_each(|r| r.mapv_inplace(&mut off));
    real
}

/// Least and most of one real number, and how far off what is computed can be.
type Line = [f64; 3];

fn magnitude([low, high, _]: Line) -> f64 {
    low.abs().max(high.abs())
}

/// One row of a product, number by number.
fn plain_sum(
    row: usize,
    base: Line,
    parts: &[(&Array2<f64>, &Array2<f64>, &[Line])],
    half: f64,
    relative: f64,
) -> Line {
    let [mut low, mut high, mut off] = base;
    let (mut size, mut count) = (magnitude(base) + off, 1.0);
    off += half;
    for (computed, exact, inputs) in parts {
        let mut differ = [0.0; 3];
        for (j, &[min, max, error]) in inputs.iter().enumerate() {
            let (w, x) = (computed[(row, j)], exact[(row, j)]);
            low += (x * min).min(x * max);
            high += (x * min).max(x * max);
            differ[0] += ((w - x) * min).min((w - x) * max);
            differ[1] += ((w - x) * min).max((w - x) * max);
            off += w.abs() * error;
            size += w.abs() * (magnitude([min, max, 0.0]) + error);
            count += 1.0;
        }
        off += magnitude(differ);
    }
    let many = (count + 3.0) * relative;
    [low, high, off + size * many / (1.0 - many)]
}

fn plain_held([low, high, off]: Line, [min, max]: [f64; 2]) -> Line {
    [low.clamp(min, max), high.clamp(min, max), off.min(max - min)]
}

fn plain_shrunk(shrinkage: Shrinkage, b: Line, used: f64, exact: f64, relative: f64) -> Line {
    let soft = |v: f64| (v - exact).max(0.0);
    let firm = |v: f64| if v > 2.0 * exact { v } else { 2.0 * soft(v) };
    let (low, high, farthest, slope) = match shrinkage {
        Shrinkage::TwoSided => (soft(b[0]) - soft(-b[0]), soft(b[1]) - soft(-b[1]), magnitude(b), 1.0),
        Shrinkage::OneSided => (soft(b[0]), soft(b[1]), b[1], 1.0),
        Shrinkage::Firm => (firm(b[0]) - firm(-b[0]), firm(b[1]) - firm(-b[1]), magnitude(b), 2.0),
    };
    let rounding = 3.0 * relative * (magnitude(b) + b[2] + exact.abs());
    let off = b[2] + (used - exact).abs() + rounding;
    [low, high, if farthest + off <= exact { 0.0 } else { slope * off }]
}

/// The worst cases again, one number after the other.
fn plain_worst(fixed: &FixedNetwork, real: &Folded, arithmetic: Arithmetic) -> Vec<Vec<f64>> {
    let (own, form) = (Folded::of(fixed), fixed.form);
    let single = arithmetic == Arithmetic::Single;
    let used = if single { real } else { &own };
    let relative = if single { 0.5f64.powi(24) } else { 0.0 };
    let format = |t: usize| match fixed.code_fractions.get(t) {
        Some(fraction) => (fixed.code_bits, 0.5f64.powi(*fraction as i32)),
        None => (16, 0.5f64.powi(14)),
    };
    let range = |t: usize| {
        let (bits, unit) = format(t);
        let full = 2f64.powi(bits as i32 - 1);
        [-full * unit, (full - 1.0) * unit]
    };
    let half = |shift: u32, t: usize| if single || shift == 0 { 0.0 } else { 0.5 * format(t).1 };
    let y = vec![[0.0, 32767.0 / 32768.0, 0.0]; 64];
    let parts = [(&used.analysis, &real.analysis, &y[..])];
    let first = (0..3).map(|i| {
        plain_held(plain_sum(i, [0.0; 3], &parts, half(fixed.analysis_shift(), 0), relative), range(0))
    });
    let mut b: Vec<Vec<Line>> = vec![first.collect()];
    let mut before = vec![[0.0; 3]; 3];
    for t in 0..form.layers - 1 {
        let z: Vec<Line> = (0..3)
            .map(|i| {
                let (used, exact) = (used.thresholds[t][i], real.thresholds[t][i]);
                plain_held(plain_shrunk(form.shrinkage, b[t][i], used, exact, relative), range(t))
            })
            .collect();
        let next: Vec<Line> = if t < form.layers - 2 {
            let s = form.recurrent_index(t);
            let difference = form.recurrence == Recurrence::Difference;
            let change = |(z, before): (&Line, &Line)| {
                let real = [z[0] - before[1], z[1] - before[0], 0.0];
                let rounding = relative * magnitude(real);
                plain_held([real[0], real[1], z[2] + before[2] + rounding], range(t))
            };
            let sent: Vec<Line> =
                if difference && t > 0 { z.iter().zip(&before).map(change).collect() } else { z.clone() };
            let base = if difference { &b[t] } else { &b[0] };
            let parts = [(&used.recurrent[s], &real.recurrent[s], &sent[..])];
            let half = half(fixed.middle_shifts(t).result, t + 1);
            (0..3).map(|i| plain_sum(i, base[i], &parts, half, relative)).collect()
        } else {
            let mut parts = vec![(&used.dictionary, &real.dictionary, &z[..])];
            parts.extend(used.linear_path.iter().zip(&real.linear_path).map(|(u, r)| (u, r, &y[..])));
            let half = half(fixed.final_shifts().result, t + 1);
            (0..128).map(|i| plain_sum(i, [0.0; 3], &parts, half, relative)).collect()
        };
        b.push(next.into_iter().map(|line| plain_held(line, range(t + 1))).collect());
        before = z;
    }
    b.iter().map(|stage| stage.iter().map(|line| line[2]).collect()).collect()
}

fn assert_near(found: &[f64], expected: &[f64], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= 1e-11 * b.abs(), "{what}: {a:e} {b:e}");
    }
}

#[test]
fn the_worst_case_is_what_intervals_give_number_by_number() {
    let mut free = 0;
    for (seed, fixed) in networks() {
        let real = near(&fixed, seed);
        for arithmetic in [Arithmetic::Words, Arithmetic::Single] {
            let found = bounds(&fixed, &real, arithmetic);
            let expected = plain_worst(&fixed, &real, arithmetic);
            assert_eq!(found.len(), expected.len());
            for (bound, worst) in found.iter().zip(&expected) {
                assert_near(&bound.worst, worst, &format!("seed {seed}, {arithmetic:?}, {}", bound.name));
                free += usize::from(bound.worst.iter().any(|w| *w < 0.1));
            }
        }
    }
    assert!(free > 300, "{free}: hardly any bound is below its range");
}

/// What an error of 1 in coefficient `i` of b_t becomes in every later stage where every code is open.
fn impulse(fixed: &FixedNetwork, own: &Folded, t: usize, i: usize) -> Vec<Vec<f64>> {
    let (form, mut b) = (fixed.form, vec![Array1::<f64>::zeros(3); t + 1]);
    b[t][i] = 1.0;
    for layer in t..form.layers - 2 {
        let s = &own.recurrent[form.recurrent_index(layer)];
        let next = match (form.recurrence, layer) {
            (Recurrence::Direct, _) => &b[0] + &s.dot(&b[layer]),
            (Recurrence::Difference, 0) => &b[0] + &s.dot(&b[0]),
            (Recurrence::Difference, _) => &b[layer] + &s.dot(&(&b[layer] - &b[layer - 1])),
        };
        b.push(next);
    }
    let outputs = own.dictionary.dot(&b[form.layers - 2]);
    b.iter().chain([&outputs]).map(|v| v.to_vec()).collect()
}

#[test]
fn deviations_are_the_root_of_the_squares_of_all_impulses() {
    for (seed, fixed) in networks() {
        let (own, form) = (Folded::of(&fixed), fixed.form);
        let variance = |shift: u32, fraction: u32| match shift {
            0 => 0.0,
            _ => 0.25f64.powi(fraction as i32) / 12.0,
        };
        let mut squares = vec![vec![0.0; 3]; form.layers - 1];
        squares.push(vec![variance(fixed.final_shifts().result, 14); 128]);
        for t in 0..form.layers - 1 {
            let shift = if t == 0 { fixed.analysis_shift() } else { fixed.middle_shifts(t - 1).result };
            let variance = variance(shift, fixed.code_fractions[t]);
            for i in 0..3 {
                for (sum, reached) in squares.iter_mut().zip(impulse(&fixed, &own, t, i)) {
                    sum.iter_mut().zip(reached).for_each(|(sum, r)| *sum += variance * r * r);
                }
            }
        }
        let found = bounds(&fixed, &own, Arithmetic::Words);
        assert_eq!(found.len(), squares.len());
        for (bound, squares) in found.iter().zip(&squares) {
            let expected: Vec<f64> = squares.iter().map(|v| v.sqrt()).collect();
            assert_near(&bound.deviation, &expected, &format!("seed {seed}, {}", bound.name));
        }
        let single = bounds(&fixed, &own, Arithmetic::Single);
        assert!(single.iter().all(|b| b.deviation == vec![0.0; b.worst.len()]));
    }
}

#[test]
fn a_stage_is_told_by_its_largest_numbers_in_units_of_its_last_bit() {
    let bound = StageBound {
        name: "I".to_owned(),
        unit: 0.25,
        worst: vec![1.0, 3.0, 2.0],
        deviation: vec![0.5, 0.125],
    };
    assert_eq!(bound.summary(), BoundSummary { worst_bits: 12.0, deviation_bits: 2.0 });
    let fixed = edof_device::random::natural(8, 8, 3);
    let units: Vec<f64> =
        bounds(&fixed, &Folded::of(&fixed), Arithmetic::Words).iter().map(|b| b.unit).collect();
    assert_eq!(units, [15, 14, 14, 14].map(|f| 0.5f64.powi(f)));
}

fn interval(min: &[f64], max: &[f64]) -> Interval {
    Interval { min: Array1::from(min.to_vec()), max: Array1::from(max.to_vec()) }
}

#[test]
fn intervals_add_subtract_and_shrink_as_their_ends_do() {
    let (a, b) = (interval(&[1.0, -5.0], &[2.0, 3.0]), interval(&[10.0, -1.0], &[20.0, 4.0]));
    let ends = |i: &Interval| (i.min.to_vec(), i.max.to_vec());
    assert_eq!(ends(&a.plus(&b)), (vec![11.0, -6.0], vec![22.0, 7.0]));
    assert_eq!(ends(&a.minus(&b)), (vec![-19.0, -9.0], vec![-8.0, 4.0]));
    assert_eq!(ends(&a.held([-2.0, 1.5])), (vec![1.0, -2.0], vec![1.5, 1.5]));
    assert_eq!(ends(&a.map(|v, i| v + i as f64)), (vec![1.0, -4.0], vec![2.0, 4.0]));
    assert_eq!(a.size().to_vec(), [2.0, 5.0]);
}

#[test]
fn a_matrix_reaches_its_extremes_at_corners() {
    let matrix = ndarray::array![[2.0, -3.0, 0.5], [0.0, 1.0, -1.0]];
    let v = interval(&[-1.0, 2.0, 4.0], &[3.0, 5.0, 8.0]);
    let corner =
        |bits: usize| Array1::from_shape_fn(3, |i| if bits >> i & 1 == 0 { v.min[i] } else { v.max[i] });
    let corners: Vec<Array1<f64>> = (0..8).map(|bits| matrix.dot(&corner(bits))).collect();
    let found = v.through(&matrix);
    for row in 0..2 {
        assert_eq!(found.min[row], corners.iter().map(|c| c[row]).fold(f64::MAX, f64::min));
        assert_eq!(found.max[row], corners.iter().map(|c| c[row]).fold(f64::MIN, f64::max));
    }
}

#[test]
fn a_code_that_cannot_pass_its_threshold_even_with_its_error_is_not_off() {
    for (shrinkage, [first, last]) in [
        (Shrinkage::OneSided, [0.0, 0.375]),
        (Shrinkage::TwoSided, [0.125, 0.375]),
        (Shrinkage::Firm, [0.25, 0.75]),
    ] {
        let form = form(2, shrinkage, [false; 3]);
        let mut fixed = edof_device::random::extreme(form, 16, Stride::PATCH, false, 1);
        fixed.code_fractions[0] = 14;
        fixed.thresholds[0] = ndarray::array![12288, 12288, 12288];
        let own = Folded::of(&fixed);
        let work = Work { fixed: &fixed, reference: &own, computed: &own, arithmetic: Arithmetic::Words };
        let b = Known {
            real: interval(&[-0.75, 0.0, 0.0], &[0.0, 0.5, 0.5]),
            off: ndarray::array![0.125, 0.25, 0.375],
        };
        let off = work.shrunk(0, &b, [-2.0, 2.0]).off.to_vec();
        assert_eq!(off, [first, 0.0, last]);
    }
}

/// A float network whose rows of A are those of the words, each divided by a scale.
fn float(fixed: &FixedNetwork, scales: [f64; 3]) -> Network {
    let words = Folded::of(fixed);
    Network {
        form: fixed.form,
        analysis: Array2::from_shape_fn((3, 64), |(r, c)| (words.analysis[(r, c)] / scales[r]) as f32),
        thresholds: vec![Array1::from_elem(3, 0.5); 2],
        recurrent: vec![Array2::from_elem((3, 3), 0.25)],
        dictionary: Array2::from_elem((192, 3), 0.125),
        linear_path: None,
        origin: fixed.origin.clone(),
    }
}

#[test]
fn the_reference_is_the_float_network_in_the_units_of_the_words() {
    let fixed =
        edof_device::random::extreme(form(3, Shrinkage::OneSided, [false; 3]), 12, Stride::PATCH, false, 7);
    let network = float(&fixed, [4.0, 0.5, -2.0]);
    let found = reference(&fixed, &network).unwrap();
    // No scale is negative: the third row stays as it is.
    let scales = [4.0, 0.5, 1.0];
    let expected = crate::fold::fold(&network, &scales, fixed.stride, fixed.overlap);
    assert_near(found.analysis.as_slice().unwrap(), expected.analysis.as_slice().unwrap(), "A");
    assert_near(&found.thresholds[1].to_vec(), &[2.0, 0.25, 0.5], "theta");
    assert_near(found.recurrent[0].as_slice().unwrap(), expected.recurrent[0].as_slice().unwrap(), "S");
    assert_near(found.dictionary.as_slice().unwrap(), expected.dictionary.as_slice().unwrap(), "D");
    assert!(found.linear_path.is_none());
}

#[test]
fn rows_that_have_nothing_in_common_with_the_words_keep_their_scale_and_other_forms_none() {
    let fixed =
        edof_device::random::extreme(form(3, Shrinkage::OneSided, [false; 3]), 12, Stride::PATCH, false, 7);
    let mut network = float(&fixed, [1.0; 3]);
    network.analysis.row_mut(1).fill(0.0);
    let found = reference(&fixed, &network).unwrap();
    assert_near(&found.thresholds[0].to_vec(), &[0.5; 3], "theta");
    network.form.tied = true;
    assert!(reference(&fixed, &network).is_none());
}

#[test]
fn errors_are_told_against_words_alone_and_against_the_float_network_where_there_is_one() {
    let fixed =
        edof_device::random::extreme(form(3, Shrinkage::OneSided, [false; 3]), 12, Stride::PATCH, false, 7);
    let network = float(&fixed, [4.0, 0.5, 1.0]);
    let summaries = |real: &Folded| {
        bounds(&fixed, real, Arithmetic::Words).iter().map(StageBound::summary).collect::<Vec<_>>()
    };
    let rounding = summaries(&Folded::of(&fixed));
    let weights = summaries(&reference(&fixed, &network).unwrap());
    let errors = stage_errors(&fixed, Some(&network));
    assert_eq!(errors.iter().map(|e| e.stage.as_str()).collect::<Vec<_>>(), ["I", "M1", "F"]);
    for (i, error) in errors.iter().enumerate() {
        assert_eq!((&error.rounding, error.weights.as_ref()), (&rounding[i], Some(&weights[i])));
    }
    assert_ne!(rounding, weights);
    assert!(stage_errors(&fixed, None).iter().all(|error| error.weights.is_none()));
}
