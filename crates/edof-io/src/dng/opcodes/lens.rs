//! Corrections of the lens: vignetting and distortion about an optical centre. Distances are in units of that from the centre to the
//! farthest corner.

use super::parameters::Parameters;
use ndarray::{ArrayView2, ArrayViewMut2};

/// Gain 1 + k₀r² + k₁r⁴ + … + k₄r¹⁰ about a centre.
#[derive(Debug, Clone, PartialEq)]
pub struct Vignette {
    gains: [f64; 5],
    centre: Centre,
}

/// A centre as shares of the image's width and height.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Centre {
    x: f64,
    y: f64,
}

/// The centre in pixels, and the distance of the farthest corner from it.
#[derive(Debug, Clone, Copy)]
struct Scale {
    x: f64,
    y: f64,
    radius: f64,
}

impl Centre {
    fn read(parameters: &mut Parameters<'_>) -> Option<Self> {
        let [x, y] = parameters.doubles()?;
        ((0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y)).then_some(Self { x, y })
    }

    fn scale(self, (height, width): (usize, usize)) -> Scale {
        let (height, width) = (height as f64, width as f64);
        let (x, y) = (self.x * width, self.y * height);
        let radius = x.max(width - x).hypot(y.max(height - y));
        Scale { x, y, radius }
    }
}

impl Scale {
    /// Distances of a pixel's middle from the centre, to the right and down.
    fn of(self, row: usize, column: usize) -> (f64, f64) {
        ((column as f64 + 0.5 - self.x) / self.radius, (row as f64 + 0.5 - self.y) / self.radius)
    }
}

impl Vignette {
    /// FixVignetteRadial; none for wrong parameters.
    pub fn read(mut parameters: Parameters<'_>) -> Option<Self> {
        let gains = parameters.doubles()?;
        let centre = Centre::read(&mut parameters)?;
        parameters.is_empty().then_some(Self { gains, centre })
    }

    /// Multiplies planes of equal size by the gain. Values stay between 0 and 1.
    pub fn apply(&self, planes: &mut [ArrayViewMut2<'_, f32>]) {
        for plane in planes {
            let scale = self.centre.scale(plane.dim());
            for ((row, column), value) in plane.indexed_iter_mut() {
                let (x, y) = scale.of(row, column);
                let square = x * x + y * y;
                let gain = 1.0 + self.gains.iter().rev().fold(0.0, |sum, k| (sum + k) * square);
                *value = (f64::from(*value) * gain).clamp(0.0, 1.0) as f32;
            }
        }
    }
}

/// Where a corrected picture's pixels are in the one that the lens made.
#[derive(Debug, Clone, PartialEq)]
pub struct Warp {
    is_fisheye: bool,
    /// One for all planes, or one for each.
    planes: Vec<Distortion>,
    centre: Centre,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Distortion {
    radial: [f64; 4],
    tangential: [f64; 2],
}

impl Warp {
    /// WarpFisheye or WarpRectilinear; none for wrong parameters.
    pub fn read(is_fisheye: bool, mut parameters: Parameters<'_>) -> Option<Self> {
        let count = parameters.whole().filter(|count| [1, 3].contains(count))?;
        let mut distortion = || {
            let radial = parameters.doubles()?;
            let tangential = if is_fisheye { [0.0; 2] } else { parameters.doubles()? };
            Some(Distortion { radial, tangential })
        };
        let planes = (0..count).map(|_| distortion()).collect::<Option<Vec<_>>>()?;
        let centre = Centre::read(&mut parameters)?;
        parameters.is_empty().then_some(Self { is_fisheye, planes, centre })
    }

    /// Warps planes of equal size.
    pub fn apply(&self, planes: &mut [ArrayViewMut2<'_, f32>]) {
        for (plane, distortion) in planes.iter_mut().zip(self.planes.iter().cycle()) {
            let source = plane.to_owned();
            let scale = self.centre.scale(source.dim());
            for ((row, column), value) in plane.indexed_iter_mut() {
                let (x, y) = self.place(distortion, scale.of(row, column));
                let at = [y * scale.radius + scale.y - 0.5, x * scale.radius + scale.x - 0.5];
                *value = bicubic(source.view(), at);
            }
        }
    }

    /// Where the light of a place comes from.
    fn place(&self, distortion: &Distortion, (x, y): (f64, f64)) -> (f64, f64) {
        let square = x * x + y * y;
        let of = |square: f64| distortion.radial.iter().rev().fold(0.0, |sum, k| sum * square + k);
        if self.is_fisheye {
            let radius = square.sqrt();
            let angle = radius.atan();
            let factor = if radius > 0.0 { angle * of(angle * angle) / radius } else { of(0.0) };
            return (x * factor, y * factor);
        }
        let [t0, t1] = distortion.tangential;
        let factor = of(square);
        (
            x * factor + t0 * 2.0 * x * y + t1 * (square + 2.0 * x * x),
            y * factor + t1 * 2.0 * x * y + t0 * (square + 2.0 * y * y),
        )
    }
}

/// The value between pixels by cubic convolution (a = −½), which keeps values at pixels; beyond the border, that of the border.
fn bicubic(image: ArrayView2<'_, f32>, [row, column]: [f64; 2]) -> f32 {
    let (height, width) = image.dim();
    let weights = |t: f64| {
        let (t2, t3) = (t * t, t * t * t);
        [
            -0.5 * t3 + t2 - 0.5 * t,
            1.5 * t3 - 2.5 * t2 + 1.0,
            -1.5 * t3 + 2.0 * t2 + 0.5 * t,
            0.5 * t3 - 0.5 * t2,
        ]
    };
    // Places far outside are those of the border; polynomials may leave the range of numbers.
    let place = |at: f64, end: usize| {
        let at = if at.is_nan() { 0.0 } else { at.clamp(-2.0, end as f64 + 1.0) };
        (at.floor() as isize, weights(at - at.floor()))
    };
    let ((top, down), (left, across)) = (place(row, height), place(column, width));
    let clamped = |at: isize, end: usize| at.clamp(0, end as isize - 1) as usize;
    let line = |row: usize| -> f64 {
        let at = |offset: isize| f64::from(image[(row, clamped(left + offset, width))]);
        (-1..3).zip(across).map(|(offset, weight)| weight * at(offset)).sum()
    };
    let rows = (-1..3).zip(down).map(|(offset, weight)| weight * line(clamped(top + offset, height)));
    rows.sum::<f64>() as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    fn slope() -> Array2<f32> {
        Array2::from_shape_fn((20, 30), |(r, c)| 0.2 + 0.01 * r as f32 + 0.005 * c as f32)
    }

    #[test]
    fn a_warp_that_moves_nothing_keeps_every_value() {
        let centre = Centre { x: 0.4, y: 0.6 };
        let distortion = Distortion { radial: [1.0, 0.0, 0.0, 0.0], tangential: [0.0; 2] };
        let warp = Warp { is_fisheye: false, planes: vec![distortion], centre };
        let mut image = slope();
        warp.apply(&mut [image.view_mut()]);
        for (found, expected) in image.iter().zip(&slope()) {
            assert!((found - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn a_factor_of_a_half_takes_light_from_half_the_distance() {
        let distortion = Distortion { radial: [0.5, 0.0, 0.0, 0.0], tangential: [0.0; 2] };
        let warp = Warp { is_fisheye: false, planes: vec![distortion], centre: Centre { x: 0.5, y: 0.5 } };
        let mut image = slope();
        warp.apply(&mut [image.view_mut()]);
        // The middle of pixel (4, 6) is 5.5 rows above and 8.5 columns before the centre; light comes from half of that.
        let expected = 0.2 + 0.01 * (9.5 - 5.5 / 2.0) + 0.005 * (14.5 - 8.5 / 2.0);
        assert!((f64::from(image[(4, 6)]) - expected).abs() < 1e-6);
    }
}
