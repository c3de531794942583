use super::*;
use edof_core::{Stride, Window};
use ndarray::array;

fn form(layers: usize, recurrence: Recurrence, linear_path: bool) -> Form {
    Form {
        window: Window::new(8).unwrap(),
        codes: 2,
        layers,
        shrinkage: Shrinkage::OneSided,
        recurrence,
        linear_path,
        tied: false,
        exposures: 1,
    }
}

/// A network whose weights are small enough that an eighth more fits.
fn network(layers: usize, recurrence: Recurrence, linear_path: bool) -> FixedNetwork {
    let mut fixed =
        edof_device::random::extreme(form(layers, recurrence, linear_path), 8, Stride::PATCH, false, 2);
    let matrices = [&mut fixed.analysis, &mut fixed.dictionary].into_iter();
    for matrix in matrices.chain(&mut fixed.recurrent).chain(&mut fixed.linear_path) {
        matrix.weights.mapv_inplace(|w| w / 2);
    }
    fixed
}

/// Rounding to nearest: inputs that go their own ways.
fn nearest(form: &Form) -> Rounding {
    Rounding::new(&Calibration::new(form), &vec![1.0; form.codes], form)
}

fn options(bits: u32) -> QuantizeOptions {
    QuantizeOptions { bits, ..QuantizeOptions::default() }
}

#[test]
fn the_range_used_is_the_largest_scaled_code_or_change_of_each_layer() {
    let mut seen = Calibration::new(&form(3, Recurrence::Difference, false));
    seen.codes = vec![vec![1.0, 2.0], vec![3.0, 4.0]];
    seen.changes = vec![vec![0.0, 0.0], vec![9.0, 1.0]];
    assert_eq!(used(&seen, &[2.0, 0.5]), [2.0, 18.0]);
    assert_eq!(used(&seen, &[0.25, 4.0]), [8.0, 16.0]);
}

#[test]
fn words_are_nearest_with_ties_up_and_held_to_their_width() {
    assert_eq!([8, 12, 16].map(max_word), [127.0, 2047.0, 32767.0]);
    let words = [(0.75, 2, 3), (0.125, 2, 1), (-0.125, 2, 0), (-0.375, 2, -1), (-0.3, 2, -1), (3.0, 0, 3)];
    for (value, fraction, expected) in words {
        assert_eq!(word(value, fraction, 8), expected, "{value}");
    }
    assert_eq!((word(1000.0, 0, 8), word(-1000.0, 0, 8), word(-127.6, 0, 8)), (127, -128, -128));
    assert_eq!((word(40000.0, 0, 16), word(-40000.0, 0, 16)), (32767, -32768));
}

#[test]
fn thresholds_below_zero_become_zero_where_shrinkage_is_two_sided() {
    let theta = array![-0.5, 0.25, 9.0];
    assert_eq!(thresholds(&theta, 4, 8, Shrinkage::OneSided), array![-8, 4, 127]);
    assert_eq!(thresholds(&theta, 4, 8, Shrinkage::TwoSided), array![0, 4, 127]);
    let mut folded = Folded::of(&network(3, Recurrence::Direct, false));
    folded.thresholds = vec![array![0.5, -0.25], array![0.125, 1.0]];
    let all = all_thresholds(&folded, &[4, 3], 8, Shrinkage::OneSided);
    assert_eq!(all, [array![8, -4], array![1, 8]]);
}

#[test]
fn a_matrix_has_the_most_fraction_bits_at_which_its_largest_weight_fits() {
    let of = |value: f64| weight_fraction("dictionary", &array![[0.0, value], [0.01, -0.02]], 8);
    let cases =
        [(1.0, 6), (-1.0, 6), (127.4 / 64.0, 6), (127.6 / 64.0, 5), (127.4, 0), (-100.0, 0), (0.5, 7)];
    for (value, fraction) in cases {
        assert_eq!(of(value), Ok(fraction), "{value}");
    }
    assert_eq!(of(-127.6), Err(QuantizeError::Large { what: "dictionary", value: 127.6, bits: 8 }));
    assert_eq!(weight_fraction("recurrent", &Array2::zeros((2, 2)), 8), Ok(24));
}

#[test]
fn codes_have_the_most_fraction_bits_that_leave_headroom_and_hold_thresholds() {
    let mut folded = Folded::of(&network(6, Recurrence::Direct, false));
    folded.thresholds = vec![array![0.0, 60.0]; 5];
    folded.thresholds[2] = array![1.0, -4.0];
    let of = |recurrence| code_fractions(&folded, &[1.0, 10.0, 1.0, 0.0, 1e6], &options(8), recurrence);
    assert_eq!(of(Recurrence::Direct), [5, 2, 4, 24, 0]);
    assert_eq!(of(Recurrence::Difference), [0; 5]);
    // Headroom that just fills the range, except for rounding.
    let full = |share: f64| code_fractions(&folded, &[127.0 / 64.0 * share], &options(8), Recurrence::Direct);
    assert_eq!((full(1.0 + 1e-14), full(1.0 + 1e-9)), (vec![5], vec![4]));
}

#[test]
fn codes_give_up_fraction_bits_until_no_shift_is_negative() {
    let legal = |codes: &[u32], analysis, recurrent: &[u32], recurrence| {
        let mut codes = codes.to_vec();
        let form = form(codes.len() + 1, recurrence, false);
        make_shifts_legal(&mut codes, analysis, recurrent, form);
        codes
    };
    let direct =
        |codes: &[u32], analysis, recurrent: &[u32]| legal(codes, analysis, recurrent, Recurrence::Direct);
    assert_eq!(direct(&[24, 3, 9], 12, &[2, 4]), [7, 3, 7]);
    assert_eq!(direct(&[24, 20, 5, 5], 12, &[0, 0, 0]), [5, 5, 5, 5]);
    assert_eq!(direct(&[24, 20, 5, 9], 12, &[3, 2, 1]), [6, 9, 5, 6]);
    assert_eq!(direct(&[24, 24], 2, &[9]), [17, 24]);
    assert_eq!(direct(&[10, 12, 14], 12, &[24, 24]), [10, 12, 14]);
    assert_eq!(legal(&[24, 24, 24], 3, &[0, 0], Recurrence::Difference), [18; 3]);
    assert_eq!(legal(&[9, 9, 9], 3, &[0, 0], Recurrence::Difference), [9; 3]);
}

/// Takes a bit as [`Fractions::mend`] does: what the fractions of S, D and R are then, or the error.
fn mended(
    fixed: &FixedNetwork,
    what: &'static str,
) -> Result<(Vec<u32>, u32, Option<u32>), FixedNetworkError> {
    let mut fractions = Fractions {
        codes: fixed.code_fractions.clone(),
        analysis: fixed.analysis.fraction,
        recurrent: fixed.recurrent.iter().map(|s| s.fraction).collect(),
        dictionary: fixed.dictionary.fraction,
        linear: fixed.linear_path.as_ref().map(|r| r.fraction),
    };
    fractions.mend(fixed, FixedNetworkError::Overflow { what, bits: 49 })?;
    Ok((fractions.recurrent, fractions.dictionary, fractions.linear))
}

#[test]
fn only_matrices_whose_sums_are_too_wide_give_up_a_bit() {
    let mut fixed = network(4, Recurrence::Direct, false);
    fixed.code_bits = 16;
    fixed.recurrent.iter_mut().for_each(|s| s.weights.fill(0));
    let with = |codes: [u32; 3], recurrent: [u32; 2]| {
        let mut fixed = fixed.clone();
        fixed.code_fractions = codes.to_vec();
        fixed.recurrent.iter_mut().zip(recurrent).for_each(|(s, fraction)| s.fraction = fraction);
        (fixed.accumulator_bits(), mended(&fixed, "M"))
    };
    let overflow = Err(FixedNetworkError::Overflow { what: "M", bits: 49 });
    // A base of 16 bits may be shifted up by 31: then it fills the accumulator.
    let (bits, fractions) = with([0, 24, 10], [31, 24]);
    assert_eq!((bits[1], bits[2]), (48, 65));
    assert_eq!(fractions.unwrap().0, [31, 23]);
    assert_eq!(with([0, 8, 10], [32, 23]).1.unwrap().0, [31, 23]);
    assert_eq!(with([0, 8, 10], [32, 24]).1.unwrap().0, [31, 23]);
    assert_eq!(with([0, 40, 10], [40, 0]).1.unwrap().0, [39, 0]);
    // Nothing is wide: no bit of S would help.
    assert_eq!(with([0, 8, 10], [31, 23]).1, overflow);
}

#[test]
fn the_finer_product_of_the_last_layer_gives_up_a_bit() {
    let with = |last: u32, dictionary: u32, linear: Option<u32>| {
        let mut fixed = network(3, Recurrence::Direct, linear.is_some());
        fixed.code_fractions[1] = last;
        fixed.dictionary.fraction = dictionary;
        fixed.linear_path.iter_mut().for_each(|r| r.fraction = linear.unwrap());
        mended(&fixed, "F").map(|(_, dictionary, linear)| (dictionary, linear))
    };
    assert_eq!(with(10, 5, Some(1)), Ok((5, Some(0))));
    assert_eq!(with(10, 6, Some(1)), Ok((5, Some(1))));
    assert_eq!(with(10, 9, Some(8)), Ok((9, Some(7))));
    assert_eq!(with(10, 1, Some(0)), Ok((0, Some(0))));
    assert_eq!(with(10, 1, None), Ok((0, None)));
    let overflow = |what| FixedNetworkError::Overflow { what, bits: 49 };
    assert_eq!(with(10, 0, Some(0)), Err(overflow("F")));
    assert_eq!(with(10, 0, None), Err(overflow("F")));
    assert_eq!(mended(&network(3, Recurrence::Direct, true), "I"), Err(overflow("I")));
}

#[test]
fn settled_matrices_keep_their_words_and_all_others_are_rounded_anew() {
    for linear_path in [false, true] {
        let like = network(4, Recurrence::Direct, linear_path);
        let more = |m: &FixedMatrix| FixedMatrix { weights: &m.weights + 8, fraction: m.fraction };
        let mut moved = like.clone();
        moved.analysis = more(&like.analysis);
        moved.recurrent = like.recurrent.iter().map(more).collect();
        moved.dictionary = more(&like.dictionary);
        moved.linear_path = like.linear_path.as_ref().map(more);
        moved.thresholds[1].fill(3);
        for settled in 0..=3 {
            let found = rounded_to(&Folded::of(&moved), &like, &nearest(&like.form), settled);
            let mut expected = moved.clone();
            if settled > 0 {
                expected.analysis = like.analysis.clone();
            }
            expected.recurrent[..settled.saturating_sub(1)]
                .clone_from_slice(&like.recurrent[..settled.saturating_sub(1)]);
            assert_eq!(found, expected, "{settled} settled");
        }
    }
}

/// Integers of a small network whose R has this value throughout, for codes that use so much.
fn of_two_codes(linear_path: f64, used: &[f64], bits: u32) -> FixedNetwork {
    let form = form(4, Recurrence::Direct, true);
    let folded = Folded {
        analysis: Array2::from_elem((2, 64), 0.01),
        thresholds: vec![array![0.25, -0.5]; 3],
        recurrent: vec![Array2::from_elem((2, 2), 0.25), Array2::from_elem((2, 2), -1.5)],
        dictionary: Array2::from_elem((128, 2), 0.75),
        linear_path: Some(Array2::from_elem((128, 64), linear_path)),
    };
    let float = Network {
        form,
        analysis: Array2::zeros((2, 64)),
        thresholds: vec![],
        recurrent: vec![],
        dictionary: Array2::zeros((192, 2)),
        linear_path: None,
        origin: network(2, Recurrence::Direct, false).origin,
    };
    integers(&folded, used, &nearest(&form), &float, &options(bits), "hash").unwrap()
}

#[test]
fn a_network_of_words_has_the_finest_formats_and_states_what_it_was_made_from() {
    let fixed = of_two_codes(0.015_625, &[0.4, 0.9, 0.2], 8);
    assert_eq!(fixed.code_fractions, [7, 6, 7]);
    assert_eq!((fixed.analysis.fraction, fixed.analysis.weights[(1, 63)]), (13, 82));
    assert_eq!((fixed.recurrent[0].fraction, fixed.recurrent[0].weights[(1, 0)]), (8, 64));
    assert_eq!((fixed.recurrent[1].fraction, fixed.recurrent[1].weights[(0, 1)]), (6, -96));
    assert_eq!((fixed.dictionary.fraction, fixed.dictionary.weights[(127, 1)]), (7, 96));
    let r = fixed.linear_path.as_ref().unwrap();
    assert_eq!((r.fraction, r.weights[(127, 63)]), (12, 64));
    assert_eq!(fixed.thresholds, [array![32, -64], array![16, -32], array![32, -64]]);
    assert_eq!((fixed.float_hash.as_str(), fixed.code_bits, fixed.quantized), ("hash", 8, None));
}

#[test]
fn a_linear_path_finer_than_the_codes_product_gives_up_bits_until_designs_have_the_sum() {
    let fixed = of_two_codes(0.0005, &[0.4, 0.9, 0.9], 16);
    let r = fixed.linear_path.as_ref().unwrap().fraction;
    assert_eq!((fixed.accumulator_bits().last(), fixed.dictionary.fraction), (Some(&DESIGN_SUM_BITS), 15));
    assert!(r < MAX_FRACTION, "{r}");
}

#[test]
fn products_that_are_a_little_too_far_apart_for_a_narrow_multiplier_are_brought_together() {
    let alignment =
        |fixed: &FixedNetwork| fixed.final_shifts().dictionary.max(fixed.final_shifts().linear_path);
    let mut met = 0;
    for largest in (1..40).map(|i| 0.05 * f64::from(i)) {
        let fixed = of_two_codes(largest, &[0.4, 0.9, 0.9], 16);
        let found = alignment(&fixed);
        assert!(!(MAX_ALIGNMENT + 1..=MAX_ALIGNMENT + SPARED_BITS).contains(&found), "{largest}: {found}");
        met += u32::from(found == MAX_ALIGNMENT);
    }
    assert!(met > 0);
}
