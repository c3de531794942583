//! When someone pauses.

use edof_core::draw::Draw;

/// Decides in each cycle whether to transfer. Random patterns change their rate now and then, so that full speed, single transfers and long pauses all occur.
#[derive(Debug, Clone)]
pub struct Throttle {
    draw: Draw,
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    Fixed(i64),
    Moods { percent: i64, left: i64 },
}

impl Throttle {
    /// Never pauses.
    #[must_use]
    pub const fn steady() -> Self {
        Self { draw: Draw::new(0), kind: Kind::Fixed(100) }
    }

    /// Transfers in that many of a hundred cycles.
    #[must_use]
    pub const fn percent(percent: i64, seed: u64) -> Self {
        Self { draw: Draw::new(seed), kind: Kind::Fixed(percent) }
    }

    /// A pace of changing mood.
    #[must_use]
    pub const fn drawn(seed: u64) -> Self {
        Self { draw: Draw::new(seed), kind: Kind::Moods { percent: 100, left: 0 } }
    }

    /// Whether to transfer in this cycle.
    pub fn goes(&mut self) -> bool {
        if let Kind::Moods { percent, left } = &mut self.kind {
            if *left == 0 {
                *percent = [100, 100, 85, 50, 20, 3][self.draw.whole(0, 5) as usize];
                *left = self.draw.whole(1, 120);
            }
            *left -= 1;
        }
        let (Kind::Fixed(percent) | Kind::Moods { percent, .. }) = self.kind;
        percent >= 100 || self.draw.whole(0, 99) < percent
    }
}
