//! White balance of a stream: none, fixed, or by the grey world.

use edof_core::{RawFrame, Tone};
use edof_io::rendering::WhiteBalance;

/// Share of the way to a frame's own balance that each frame goes.
const DAMPING: f64 = 0.1;
/// Cells that are looked at: one in so many, each way.
const EVERY: usize = 8;
/// Cells with a pixel of more light than this say nothing: it may be cut off.
const FULL: u16 = 64_000;
/// Gains between these are believed.
const BELIEVED: [f64; 2] = [0.125, 8.0];

/// Where the white balance of a stream comes from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Balance {
    /// The sensor's own colours.
    #[default]
    None,
    /// The same for all frames.
    Fixed(WhiteBalance),
    /// Grey world: colours whose means over the frame are equal, followed slowly from frame to frame.
    Auto,
}

/// The balance of the frames until now.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Follower {
    balance: Balance,
    /// Gains of red and blue over green, once a frame has been seen.
    followed: Option<[f64; 2]>,
}

impl Follower {
    pub(super) const fn new(balance: Balance) -> Self {
        Self { balance, followed: None }
    }

    /// Returns the gains of red, green and blue for a frame of a tone's values, the smallest 1.
    pub(super) fn gains(&mut self, frame: &RawFrame, values: Tone) -> [f64; 3] {
        let gains = match self.balance {
            Balance::None => [1.0; 3],
            Balance::Fixed(balance) => balance.into(),
            Balance::Auto => {
                let [red, blue] = self.follow(frame, values);
                [red, 1.0, blue]
            }
        };
        let least = gains.into_iter().fold(f64::INFINITY, f64::min);
        gains.map(|gain| gain / least)
    }

    fn follow(&mut self, frame: &RawFrame, values: Tone) -> [f64; 2] {
        let [red, green, blue] = sums(frame, values);
        let own = |colour: f64| {
            let gain = 0.5 * green / colour;
            if gain.is_finite() { gain.clamp(BELIEVED[0], BELIEVED[1]) } else { 1.0 }
        };
        let own = [own(red), own(blue)];
        let towards = |before: f64, own: f64| before * (own / before).powf(DAMPING);
        let followed = self.followed.map_or(own, |[red, blue]| [towards(red, own[0]), towards(blue, own[1])]);
        self.followed = Some(followed);
        followed
    }
}

/// Returns the light of red, green (twice the pixels) and blue over some cells of a frame.
fn sums(frame: &RawFrame, values: Tone) -> [f64; 3] {
    let (height, width) = frame.size();
    let mut sums = [0.0; 3];
    for row in (0..height - 1).step_by(2 * EVERY) {
        for column in (0..width - 1).step_by(2 * EVERY) {
            let places = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(r, c)| (row + r, column + c));
            let light = places.map(|place| values.decode_word(frame.pixels()[place]));
            if light.iter().all(|light| *light < FULL) {
                for ((r, c), light) in places.into_iter().zip(light) {
                    sums[frame.phase().channel(r, c) as usize] += f64::from(light);
                }
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::{CfaPhase, Channel};
    use ndarray::Array2;

    fn flat(phase: CfaPhase, colours: [u16; 3]) -> RawFrame {
        let values = Array2::from_shape_fn((32, 64), |(r, c)| colours[phase.channel(r, c) as usize]);
        RawFrame::from_values(values, 16, phase).unwrap()
    }

    #[test]
    fn a_grey_world_is_made_grey_in_every_phase() {
        assert_eq!([Channel::Red, Channel::Green, Channel::Blue].map(|channel| channel as usize), [0, 1, 2]);
        for phase in CfaPhase::ALL {
            let gains =
                Follower::new(Balance::Auto).gains(&flat(phase, [10_000, 20_000, 40_000]), Tone::Linear);
            assert_eq!(gains, [4.0, 2.0, 1.0]);
        }
        let encoded = flat(CfaPhase::Rggb, [10_000, 20_000, 40_000]).encoded(Tone::Srgb).into_owned();
        let gains = Follower::new(Balance::Auto).gains(&encoded, Tone::Srgb);
        assert!(
            gains.into_iter().zip([4.0, 2.0, 1.0]).all(|(found, gain)| (found / gain - 1.0).abs() < 0.01)
        );
    }

    #[test]
    fn a_change_of_light_is_followed_slowly() {
        let mut follower = Follower::new(Balance::Auto);
        let of = |follower: &mut Follower, red| {
            follower.gains(&flat(CfaPhase::Rggb, [red, 20_000, 20_000]), Tone::Linear)[0]
        };
        assert!((of(&mut follower, 20_000) - 1.0).abs() < 1e-9);
        let first = of(&mut follower, 10_000);
        assert!((first - 2f64.powf(0.1)).abs() < 1e-9, "{first}");
        let last = (0..60).map(|_| of(&mut follower, 10_000)).last().unwrap();
        assert!((last - 2.0).abs() < 0.01, "{last}");
    }

    #[test]
    fn dark_and_full_frames_change_nothing() {
        for level in [0, 65_535] {
            assert_eq!(
                Follower::new(Balance::Auto).gains(&flat(CfaPhase::Rggb, [level; 3]), Tone::Linear),
                [1.0; 3]
            );
        }
        let fixed = Balance::Fixed("2,1,4".parse().unwrap());
        assert_eq!(Follower::new(fixed).gains(&flat(CfaPhase::Rggb, [1; 3]), Tone::Linear), [2.0, 1.0, 4.0]);
        assert_eq!(Follower::new(Balance::None).gains(&flat(CfaPhase::Rggb, [1; 3]), Tone::Linear), [1.0; 3]);
    }
}
