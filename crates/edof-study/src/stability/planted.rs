//! Injected instabilities: each must break a case of the suite that names it. And the quick suite itself, on the product's own functions.

use crate::metrics::MetricError;
use crate::stability::bench::{Bench, Trained};
use crate::stability::case::{self, Case};
use crate::stability::subjects::Subjects;
use crate::stability::suite::Suite;
use edof_core::ColourFrame;
use edof_core::number::{InputWord, OutputSum, OutputWord, bits_of};
use edof_golden::fast::Fast;
use edof_golden::{ColourTable, Trace, scalar};
use edof_network::weight_file;
use ndarray::{Array2, ArrayView2};
use std::ops::ControlFlow;
use std::path::Path;

/// Windows of bounds: moments.
const WINDOWS: usize = 300;

/// One trained network and its integers.
fn trained() -> Vec<Trained> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../weights");
    let name = "paper-t4";
    let float = weight_file::load_network(&folder.join(format!("{name}.safetensors"))).unwrap();
    let fixed = weight_file::load_fixed(&folder.join(format!("{name}.fixed.safetensors"))).unwrap();
    vec![Trained { name: name.to_owned(), float, fixed }]
}

fn run(subjects: Subjects, chosen: impl Fn(&Case) -> bool) -> Suite {
    let mut bench = Bench::new(trained(), WINDOWS);
    bench.subjects = subjects;
    let cases: Vec<Case> = case::own().unwrap().into_iter().filter(chosen).collect();
    Suite::run(&bench, &cases, |_, _| ControlFlow::Continue(())).unwrap()
}

/// Whether a fault is found by these cases, and none of them would break without it.
fn found(subjects: Subjects, expected: &[&str]) {
    let chosen = |case: &Case| expected.contains(&case.id.as_str());
    let (with, without) = (run(subjects, chosen), run(Subjects::default(), chosen));
    let mut broken = with.broken();
    broken.sort_unstable();
    assert_eq!(broken, expected, "{}", with.to_text());
    assert_eq!(without.broken(), Vec::<&str>::new(), "{}", without.to_text());
    for id in expected {
        assert!(with.verdict().contains(id), "{}", with.verdict());
    }
}

#[test]
fn every_quick_promise_holds() {
    let other_networks = |case: &Case| match &case.trial {
        case::Trial::Words(words) => {
            matches!(&words.network, case::WordNetwork::Trained(name) if name != "paper-t4")
        }
        case::Trial::Bounds { network } => network.starts_with("edof-"),
        _ => false,
    };
    let suite = run(Subjects::default(), |case| !case.slow && !other_networks(case));
    assert!(suite.cases.len() > 80, "{}", suite.cases.len());
    assert_eq!(suite.broken(), Vec::<&str>::new(), "{}", suite.to_text());
}

/// The shift of I off by one.
#[test]
fn a_shift_off_by_one_is_found() {
    fn words(fast: &Fast, windows: &[InputWord]) -> Vec<Trace> {
        let mut network = fast.network().clone();
        network.analysis.fraction += 1;
        let pixels = network.form.window.pixels();
        windows.chunks_exact(pixels).map(|window| scalar::run(&network, window)).collect()
    }
    let subjects = Subjects { words, ..Subjects::default() };
    found(subjects, &["bounds-drawn-8-8", "words-extreme", "words-signs-of-rows"]);
}

#[test]
fn a_missing_saturation_is_found() {
    /// F's outputs as they come out of an adder of 16 bits.
    fn words(fast: &Fast, windows: &[InputWord]) -> Vec<Trace> {
        let network = fast.network();
        let shifts = network.final_shifts();
        let mut traces = fast.traces(windows);
        for trace in &mut traces {
            let z = &trace.layers[trace.layers.len() - 1].sent;
            for (row, word) in trace.output.iter_mut().enumerate() {
                let sum = |weights: ndarray::ArrayView1<'_, i16>, v: &[i16]| {
                    weights.iter().zip(v).map(|(w, v)| i64::from(*w) * i64::from(*v)).sum::<i64>()
                };
                let linear = network
                    .linear_path
                    .as_ref()
                    .map_or(0, |r| sum(r.weights.row(row), bits_of(&trace.input)));
                let all = (sum(network.dictionary.weights.row(row), z) << shifts.dictionary)
                    + (linear << shifts.linear_path);
                let half = if shifts.result == 0 { 0 } else { 1 << (shifts.result - 1) };
                *word = OutputWord::from_bits(((all + half) >> shifts.result) as i16);
            }
        }
        traces
    }
    fn requantize(acc: i64, shift: u32, _bits: u32) -> (i16, bool) {
        let half = if shift == 0 { 0 } else { 1 << (shift - 1) };
        (((acc + half) >> shift) as i16, false)
    }
    let subjects = Subjects { words, requantize, ..Subjects::default() };
    found(subjects, &["requantize", "words-extreme", "words-largest-weights"]);
}

/// Normal equations by elimination, nothing added to their diagonal.
#[test]
fn an_unregularised_solve_is_found() {
    fn least_squares(y: ArrayView2<'_, f32>, x: ArrayView2<'_, f32>, _ridge: f64) -> Array2<f32> {
        let (y, x) = (y.mapv(f64::from), x.mapv(f64::from));
        let (mut a, mut b) = (y.t().dot(&y), y.t().dot(&x));
        let n = a.nrows();
        for i in 0..n {
            for j in (0..n).filter(|j| *j != i) {
                let factor = a[(j, i)] / a[(i, i)];
                let (from, right) = (a.row(i).to_owned(), b.row(i).to_owned());
                a.row_mut(j).scaled_add(-factor, &from);
                b.row_mut(j).scaled_add(-factor, &right);
            }
        }
        Array2::from_shape_fn((b.ncols(), n), |(o, i)| (b[(i, o)] / a[(i, i)]) as f32)
    }
    let subjects = Subjects { least_squares, ..Subjects::default() };
    found(subjects, &["solve-dead-input", "solve-few-samples", "solve-twin-inputs"]);
}

#[test]
fn a_sum_over_a_megapixel_in_single_precision_is_found() {
    fn psnr(truth: &ColourFrame, estimate: &ColourFrame, _border: usize) -> Result<f64, MetricError> {
        let sum =
            truth.planes.iter().zip(&estimate.planes).fold(0.0f32, |sum, (a, b)| sum + (a - b) * (a - b));
        Ok(-10.0 * f64::from(sum / truth.planes.len() as f32).log10())
    }
    found(Subjects { psnr, ..Subjects::default() }, &["psnr-megapixel"]);
}

#[test]
fn an_index_that_is_not_held_to_its_table_is_found() {
    fn encoded(table: &ColourTable, light: OutputSum) -> u16 {
        table.entries()[light.to_bits() as usize]
    }
    found(Subjects { encoded, ..Subjects::default() }, &["gamma-index"]);
    // Wrapped instead of out of bounds: nothing panics.
    fn wrapped(table: &ColourTable, light: OutputSum) -> u16 {
        table.entries()[(light.to_bits() & 16_383) as usize]
    }
    found(Subjects { encoded: wrapped, ..Subjects::default() }, &["gamma-index"]);
}
