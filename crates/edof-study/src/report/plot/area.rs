//! Rectangles on the page: where a name beside a point covers nothing.

/// Distance in pixels that names keep from a plotted line.
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

/// The part of a text that is nearest to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    /// As SVG calls it.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }

    /// Where in an area that is as wide as the text at most its anchor is.
    pub(super) fn of(self, area: &Area) -> f64 {
        match self {
            Self::Start => area.x[0],
            Self::Middle => 0.5 * (area.x[0] + area.x[1]),
            Self::End => area.x[1],
        }
    }
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

    /// Places of so much width and height around a point, the usual ones first: right, left, above, below, then aslant and further off; and which end
    /// of a text there is at the point.
    pub(super) fn beside(
        [x, y]: [f64; 2],
        [width, height]: [f64; 2],
    ) -> impl Iterator<Item = (Self, Anchor)> {
        let at = move |(anchor, top): (Anchor, f64)| {
            let left = match anchor {
                Anchor::Start => x + 6.0,
                Anchor::Middle => x - 0.5 * width,
                Anchor::End => x - 6.0 - width,
            };
            (Self { x: [left, left + width], y: [top, top + height] }, anchor)
        };
        let level = y - 0.5 * height;
        let (above, below) = (y - 5.0 - height, y + 5.0);
        let near =
            [(Anchor::Start, level), (Anchor::End, level), (Anchor::Middle, above), (Anchor::Middle, below)];
        let far = [12.0, -12.0, 24.0, -24.0]
            .into_iter()
            .flat_map(move |off| [(Anchor::Start, level + off), (Anchor::End, level + off)]);
        near.into_iter().chain(far).map(at)
    }

    /// Pixels that both cover.
    pub(super) fn shared(&self, other: &Self) -> f64 {
        let along = |a: [f64; 2], b: [f64; 2]| (a[1].min(b[1]) - a[0].max(b[0])).max(0.0);
        along(self.x, other.x) * along(self.y, other.y)
    }
}
