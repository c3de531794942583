//! A turned rectangle in one quarter of a frame: a card, a parcel.

/// A rectangle with the middle of a quarter of the frame as its centre. Lengths are in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quarter {
    centre: (f64, f64),
    /// Half of its height and of its width.
    pub half: (f64, f64),
    cosine: f64,
    sine: f64,
}

impl Quarter {
    /// Places a rectangle in quarter `index`, row by row; `half` is in parts of the frame's height and width.
    #[must_use]
    pub fn new(index: usize, (height, width): (usize, usize), half: (f64, f64), degrees: f64) -> Self {
        let (height, width) = (height as f64, width as f64);
        let centre = (height * [0.25, 0.75][index / 2], width * [0.25, 0.75][index % 2]);
        let (sine, cosine) = degrees.to_radians().sin_cos();
        Self { centre, half: (half.0 * height, half.1 * width), cosine, sine }
    }

    /// Returns coordinates from the centre, along the rectangle's sides, of a point of the frame.
    #[must_use]
    pub fn local(&self, y: f64, x: f64) -> (f64, f64) {
        let (dy, dx) = (y - self.centre.0, x - self.centre.1);
        (self.cosine * dy - self.sine * dx, self.sine * dy + self.cosine * dx)
    }

    /// Returns the point of the frame that has these coordinates: the inverse of [`Quarter::local`].
    #[must_use]
    pub fn global(&self, y: f64, x: f64) -> (f64, f64) {
        (self.centre.0 + self.cosine * y + self.sine * x, self.centre.1 - self.sine * y + self.cosine * x)
    }

    /// Returns whether a pixel is certainly beside the rectangle.
    #[must_use]
    pub fn is_far_from(&self, row: usize, column: usize) -> bool {
        let reach = self.half.0.hypot(self.half.1) + 2.0;
        (row as f64 - self.centre.0).hypot(column as f64 - self.centre.1) > reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_point_comes_back_and_keeps_its_distance(y in -90.0..90.0, x in -90.0..90.0, degrees in -45.0..45.0) {
            let quarter = Quarter::new(3, (100, 200), (0.2, 0.2), degrees);
            let (row, column) = quarter.global(y, x);
            let back = quarter.local(row, column);
            prop_assert!((back.0 - y).hypot(back.1 - x) < 1e-9);
            prop_assert!((f64::hypot(y, x) - (row - 75.0).hypot(column - 150.0)).abs() < 1e-9);
        }
    }
}
