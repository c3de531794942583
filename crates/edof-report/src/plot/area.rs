//! Rectangles on the page: where a name beside a point covers nothing.

/// Pixels of a line drawn from which names keep away.
const STEP_ALONG: f64 = 8.0;

/// Points along a line through others, without its corners.
pub(super) fn along(corners: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let between = |pair: &[[f64; 2]]| {
        let [[a, b], [c, d]] = [pair[0], pair[1]];
        let steps = ((c - a).hypot(d - b) / STEP_ALONG) as usize;
        (1..=steps).map(move |step| {
            let share = step as f64 / (steps + 1) as f64;
            [a + share * (c - a), b + share * (d - b)]
        })
    };
    corners.windows(2).flat_map(between).collect()
}

/// An upright rectangle, in pixels from the upper left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
}

impl Area {
    /// A square of N pixels to each side of a point.
    pub(super) const fn around([x, y]: [f64; 2], reach: f64) -> Self {
        Self { x: [x - reach, x + reach], y: [y - reach, y + reach] }
    }

    /// Places of so much width and height around a point, the usual ones first: right, left, above, below, then aslant and further off.
    pub(super) fn beside([x, y]: [f64; 2], [width, height]: [f64; 2]) -> impl Iterator<Item = Self> {
        let at = move |left: f64, top: f64| Self { x: [left, left + width], y: [top, top + height] };
        let (right, left, middle) = (x + 6.0, x - 6.0 - width, x - 0.5 * width);
        let level = y - 0.5 * height;
        let near = [(right, level), (left, level), (middle, y - 5.0 - height), (middle, y + 5.0)];
        let far = [12.0, -12.0, 24.0, -24.0]
            .into_iter()
            .flat_map(move |off| [(right, level + off), (left, level + off)]);
        near.into_iter().chain(far).map(move |(left, top)| at(left, top))
    }

    /// Pixels that both cover.
    pub(super) fn shared(&self, other: &Self) -> f64 {
        let along = |a: [f64; 2], b: [f64; 2]| (a[1].min(b[1]) - a[0].max(b[0])).max(0.0);
        along(self.x, other.x) * along(self.y, other.y)
    }
}
