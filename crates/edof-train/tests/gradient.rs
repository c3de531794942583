//! The hand-written gradient of networks of one and of two exposures, compared with finite differences in f64, group of weights by group; then f32 is compared with f64.

use edof_core::Window;
use edof_core::colour::RGB_OUTPUTS;
use edof_network::float::parameters::Layout;
use edof_network::float::pass::{Examples, Pass};
use edof_network::float::real::Real;
use edof_network::network::{Form, Recurrence, Shrinkage};
use edof_numerics::random::Random;
use std::collections::BTreeMap;
use std::ops::Range;

const WINDOWS: usize = 3;
/// How far weights move for a difference, as a length over all of a group.
const STEP: f64 = 1e-5;
/// Directions tried for a group before its case counts as skipped.
const TRIES: usize = 5;

/// A network, windows, targets, and λ of each layer.
struct Case {
    form: Form,
    weights: Vec<f64>,
    inputs: Vec<f64>,
    targets: Vec<f64>,
    lambdas: Vec<f64>,
    random: Random,
}

impl Case {
    fn new(index: u64) -> Self {
        let mut random = Random::new(index, 0, 0);
        let shrinkage = Shrinkage::ALL[random.below(Shrinkage::ALL.len())];
        let mut flag = || random.below(2) == 1;
        let form = Form {
            window: Window::new(8).unwrap(),
            codes: 6,
            shrinkage,
            recurrence: if flag() { Recurrence::Difference } else { Recurrence::Direct },
            linear_path: flag(),
            tied: flag(),
            exposures: 1 + index as usize / 9 % 2,
            layers: 2 + index as usize % 9,
        };
        let mut noise = |length: usize, scale: f32| -> Vec<f64> {
            (0..length).map(|_| f64::from(random.between([-scale, scale]))).collect()
        };
        let layout = Layout::new(&form);
        let mut weights = noise(layout.len(), 0.3);
        for theta in &layout.thresholds {
            weights[theta.clone()].iter_mut().for_each(|t| *t = 0.02 + t.abs() * 0.2);
        }
        let (inputs, targets) = (noise(WINDOWS * form.inputs(), 1.0), noise(WINDOWS * RGB_OUTPUTS, 1.0));
        let lambdas = (0..form.shrinkages()).map(|t| 0.01 * (t + 1) as f64).collect();
        Self { form, weights, inputs, targets, lambdas, random }
    }

    /// Loss and gradient at `weights`, and on which side of each of the loss's kinks that is.
    fn at<T: Real>(&self, weights: &[f64]) -> (f64, Vec<f64>, Vec<i8>) {
        let of = |values: &[f64]| values.iter().map(|v| T::of(*v)).collect::<Vec<T>>();
        let (weights, inputs, targets) = (of(weights), of(&self.inputs), of(&self.targets));
        let (lambdas, importance) = (of(&self.lambdas), of(&[1.0, 0.5, 2.0]));
        let examples = Examples { inputs: &inputs, targets: &targets, importance: &importance };
        let mut pass = Pass::<T>::new(self.form, WINDOWS);
        let (mut errors, mut gradient) = ([T::zero(); WINDOWS], vec![T::zero(); weights.len()]);
        let loss = pass.gradient(&weights, &examples, &lambdas, &mut errors, &mut gradient);
        let side = |v: T| i8::from(v > T::zero()) - i8::from(v < T::zero());
        // A code has a kink at 0, and a firm one at 2θ.
        let layout = Layout::new(&self.form);
        let kinks = |t: usize| {
            let twice = weights[layout.thresholds[t].clone()].iter().map(|theta| *theta + *theta).cycle();
            pass.z(t).iter().zip(twice).flat_map(move |(z, twice)| [side(*z), side(z.abs() - twice)])
        };
        let mut sides: Vec<i8> = (0..self.form.shrinkages()).flat_map(kinks).collect();
        // The tone's curve is made of three pieces.
        let piece = |v: &T| i8::from(v.wide().abs() > 0.003_130_8) + i8::from(v.wide().abs() > 2.0);
        sides.extend(pass.forward(&weights, &inputs, WINDOWS).iter().map(piece));
        (loss.squared + loss.sparsity, gradient.iter().map(|g| g.wide()).collect(), sides)
    }

    fn groups(&self) -> Vec<(String, Range<usize>)> {
        let layout = Layout::new(&self.form);
        let mut groups = vec![("A".to_owned(), layout.analysis), ("D".to_owned(), layout.dictionary)];
        groups.extend(self.form.linear_path.then(|| ("R".to_owned(), layout.linear_path)));
        let numbered = |name: &'static str, ranges: Vec<Range<usize>>| {
            ranges.into_iter().enumerate().map(move |(i, range)| (format!("{name}{}", i + 1), range))
        };
        groups.extend(numbered("theta", layout.thresholds));
        groups.extend(numbered("S", layout.recurrent));
        groups
    }

    /// Slope of the loss along a random direction of one group: the gradient's, and that of a difference; none where every
    /// direction tried crosses a kink or is level.
    fn slopes(&mut self, range: &Range<usize>) -> Option<(f64, f64)> {
        let (_, gradient, sides) = self.at::<f64>(&self.weights);
        (0..TRIES).find_map(|_| {
            let direction: Vec<f64> = range.clone().map(|_| f64::from(self.random.normal())).collect();
            let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
            let moved = |sign: f64| {
                let mut weights = self.weights.clone();
                let along = direction.iter().map(|d| sign * STEP * d / length);
                weights[range.clone()].iter_mut().zip(along).for_each(|(w, d)| *w += d);
                self.at::<f64>(&weights)
            };
            let ((above, _, right), (below, _, left)) = (moved(1.0), moved(-1.0));
            let slope: f64 =
                direction.iter().zip(&gradient[range.clone()]).map(|(d, g)| d * g / length).sum();
            let measured = (above - below) / (2.0 * STEP);
            (right == sides && left == sides && measured.abs() > 1e-3).then_some((slope, measured))
        })
    }
}

#[test]
fn the_gradient_of_every_group_equals_finite_differences() {
    let mut counts: BTreeMap<String, [u32; 2]> = BTreeMap::new();
    for index in 0..180 {
        let mut case = Case::new(index);
        let loss = case.at::<f64>(&case.weights).0;
        for (name, range) in case.groups() {
            let slopes = case.slopes(&range);
            let count = counts.entry(name.clone()).or_default();
            count[usize::from(slopes.is_some())] += 1;
            if let Some((slope, measured)) = slopes {
                // Beside 10⁻⁶ of the slope, what rounding leaves open in the difference of two losses.
                let tolerance = 1e-6 * measured.abs() + 8.0 * f64::EPSILON * loss / STEP;
                assert!(
                    (slope - measured).abs() < tolerance,
                    "{name} of case {index}, {:?}: {slope} {measured}",
                    case.form
                );
            }
        }
    }
    // A, D, R, nine θ, eight S: none may hide behind kinks or in silence. A firm θ has no slope while no code is between θ and 2θ.
    assert_eq!(counts.len(), 3 + 9 + 8);
    for (name, [skipped, checked]) in counts {
        assert!(checked >= 5 && checked >= 3 * skipped, "{name}: {checked} checked, {skipped} skipped");
    }
}

#[test]
fn single_precision_gives_the_gradient_of_double_precision() {
    let mut compared = 0;
    for index in 0..90 {
        let mut case = Case::new(index);
        case.weights.iter_mut().for_each(|w| *w = f64::from(*w as f32));
        let ((loss, wide, sides), (narrow_loss, narrow, narrow_sides)) =
            (case.at::<f64>(&case.weights), case.at::<f32>(&case.weights));
        if sides != narrow_sides {
            continue;
        }
        assert!((loss - narrow_loss).abs() < 1e-5 * loss);
        for (name, range) in case.groups() {
            let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
            let size = norm(&mut wide[range.clone()].iter().copied());
            let error = norm(&mut wide[range.clone()].iter().zip(&narrow[range.clone()]).map(|(a, b)| a - b));
            assert!(error <= 1e-4 * size, "{name} of case {index}: {error} of {size}");
        }
        compared += 1;
    }
    assert!(compared > 80, "{compared} of 90");
}

#[test]
fn the_gradient_for_the_inputs_equals_finite_differences() {
    let mut measured_cases = 0;
    for index in 0..60 {
        let mut case = Case::new(index);
        let importance = [1.0, 0.5, 2.0];
        let examples = Examples { inputs: &case.inputs, targets: &case.targets, importance: &importance };
        let mut pass = Pass::<f64>::new(case.form, WINDOWS);
        let (mut errors, mut unused) = ([0.0; WINDOWS], vec![0.0; case.weights.len()]);
        pass.gradient(&case.weights, &examples, &case.lambdas, &mut errors, &mut unused);
        let mut gradient = vec![0.0; case.inputs.len()];
        pass.input_gradient(&case.weights, WINDOWS, &mut gradient);
        let direction: Vec<f64> = gradient.iter().map(|_| f64::from(case.random.normal())).collect();
        let inputs = case.inputs.clone();
        let mut moved = |sign: f64| {
            case.inputs = inputs.iter().zip(&direction).map(|(y, d)| y + sign * 1e-6 * d).collect();
            case.at::<f64>(&case.weights)
        };
        let ((here, _, sides), (above, _, right), (below, _, left)) = (moved(0.0), moved(1.0), moved(-1.0));
        if right != sides || left != sides {
            continue;
        }
        let slope: f64 = direction.iter().zip(&gradient).map(|(d, g)| d * g).sum();
        let measured = (above - below) / 2e-6;
        assert!(
            (slope - measured).abs() < 1e-5 * slope.abs() + 1e-8 * here.abs(),
            "{index}: {slope}, {measured}"
        );
        measured_cases += 1;
    }
    assert!(measured_cases > 30, "{measured_cases} cases without a kink");
}
