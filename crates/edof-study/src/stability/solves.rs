//! Systems of equations that are nearly, or wholly, singular; each with its condition number.

use crate::stability::case::{Promise, System};
use crate::stability::outcome::{Measurement, Stopped, TrialResult};
use crate::stability::pursuits::condition;
use crate::stability::subjects::Subjects;
use edof_core::draw::Draw;
use edof_numerics::Cholesky;
use ndarray::Array2;

/// The ridge that dictionaries are solved for with.
const RIDGE: f64 = 1e-4;
const INPUTS: usize = 12;
const OUTPUTS: usize = 5;

/// Solves one system.
pub(crate) fn solve(subjects: &Subjects, system: System, promise: &Promise) -> Result<TrialResult, Stopped> {
    Ok(TrialResult::of(match system {
        System::Hilbert(rows) => hilbert(rows)?,
        System::RankOneMoments(rows) => rank_one(rows, promise),
        System::TwinInputs => least_squares(subjects, 400, &|draw, inputs| {
            let half: Vec<f32> = (0..inputs / 2).map(|_| uniform(draw)).collect();
            half.iter().flat_map(|v| [*v, *v]).collect()
        }),
        System::DeadInput => least_squares(subjects, 400, &|draw, inputs| {
            (0..inputs).map(|i| if i == 4 { 0.0 } else { uniform(draw) }).collect()
        }),
        System::FewSamples => {
            least_squares(subjects, INPUTS / 3, &|draw, inputs| (0..inputs).map(|_| uniform(draw)).collect())
        }
    }))
}

fn uniform(draw: &mut Draw) -> f32 {
    draw.whole(-1000, 1000) as f32 * 1e-3
}

fn size(matrix: &Array2<f64>) -> f64 {
    matrix.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Backward error of a solution: the least relative change of the matrix that makes it exact, for one right side.
fn hilbert(rows: usize) -> Result<Vec<Measurement>, Stopped> {
    let matrix = Array2::from_shape_fn((rows, rows), |(r, c)| 1.0 / (r + c + 1) as f64);
    let factor = Cholesky::new(matrix.view())?;
    let right = Array2::from_shape_fn((rows, 1), |(r, _)| f64::from(u8::from(r % 2 == 0)));
    let x = factor.solve(right.view());
    let error = size(&(matrix.dot(&x) - &right)) / (size(&matrix) * size(&x));
    // N. J. Higham, "Accuracy and stability of numerical algorithms" (2002), theorem 10.4 and the remark after it.
    let limit = (4 * rows * (3 * rows + 1)) as f64 * 0.5 * f64::EPSILON;
    let seen = Measurement::new("cholesky.f64", "relative backward error", error, limit);
    Ok(vec![
        Measurement::fact("cholesky.f64", "every number is finite", x.iter().all(|v| v.is_finite())),
        seen.noted(format!("condition {:.1e}", condition(&matrix))),
    ])
}

/// Moments of inputs that all go together: right sides that occur are still solved.
fn rank_one(rows: usize, promise: &Promise) -> Vec<Measurement> {
    let axis = Array2::from_shape_fn((rows, 1), |(r, _)| 1.0 + r as f64);
    let moments = axis.dot(&axis.t());
    let x = Cholesky::of_moments(moments.view()).solve(moments.view());
    let error = size(&(moments.dot(&x) - &moments)) / size(&moments);
    let mut seen =
        vec![Measurement::fact("moments.f64", "every number is finite", x.iter().all(|v| v.is_finite()))];
    seen.extend(promise.limit("moments.f64").map(|limit| {
        let one =
            Measurement::new("moments.f64", "what is not solved of a right side that occurs", error, limit);
        one.noted(format!("condition {:.1e} with lifted pivots", condition(&moments)))
    }));
    seen
}

/// A map with a ridge. With λ the lift of every pivot, no singular value s of the inputs passes more than s/(s² + λ) ≤ 1/(2√λ): the map
/// is at most ‖x‖/(2√λ).
fn least_squares(
    subjects: &Subjects,
    samples: usize,
    input: &dyn Fn(&mut Draw, usize) -> Vec<f32>,
) -> Vec<Measurement> {
    let draw = &mut Draw::new(17);
    let mut y = Array2::zeros((samples, INPUTS));
    for mut row in y.outer_iter_mut() {
        row.iter_mut().zip(input(draw, INPUTS)).for_each(|(to, v)| *to = v);
    }
    let x = Array2::from_shape_fn((samples, OUTPUTS), |_| uniform(draw));
    let map = (subjects.least_squares)(y.view(), x.view(), RIDGE).mapv(f64::from);
    let (y, x) = (y.mapv(f64::from), x.mapv(f64::from));
    let moments = y.t().dot(&y);
    let lift = RIDGE * moments.diag().mean().unwrap_or(0.0);
    let lifted = &moments + &(Array2::<f64>::eye(INPUTS) * lift);
    // What the normal equations leave, beside what f32 does to the map.
    let left = size(&(lifted.dot(&map.t()) - y.t().dot(&x)));
    let allowed = size(&lifted) * size(&map) * f64::from(f32::EPSILON) + 1e-9 * size(&y.t().dot(&x));
    let name = "least-squares";
    vec![
        Measurement::fact(name, "every number is finite", map.iter().all(|v| v.is_finite())),
        Measurement::new(
            name,
            "size of the map, of what the ridge allows",
            size(&map),
            0.5 * size(&x) / lift.sqrt(),
        ),
        Measurement::new(
            name,
            "what is left of the normal equations, of f32's rounding of the map",
            left / allowed,
            1.0,
        )
        .noted(format!("condition {:.1e} with the ridge", condition(&lifted))),
    ]
}
