//! What of a raw frame says that it was read otherwise than it was taken. Nothing is proved by it: a frame may be dark, a scene may
//! be of any colours.

use edof_core::{CfaPhase, Channel, RawFrame};

/// A frame that uses less than this of the range is dim: values of 14 bits or fewer do.
const DIM: u16 = u16::MAX / 4;
/// Greens of one cell differ by less than this share of the mean light, in whole pictures.
const GREENS_DIFFER: f64 = 0.02;
/// And by less than this factor times the difference of red and blue.
const MORE_THAN_OTHERS: f64 = 4.0;

/// A reason to ask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReadWarning {
    /// The brightest of its pixels, of 65535, lies in the lowest quarter of the range.
    Dim(u16),
    /// What its phase takes for the two greens of a cell differ as red and blue do, and those as greens.
    Phase,
}

/// What is doubtful of a frame.
///
/// ```
/// use edof_core::{CfaPhase, RawFrame};
/// let frame = RawFrame::from_values(ndarray::Array2::from_elem((4, 6), 900), 16, CfaPhase::Rggb)?;
/// assert_eq!(edof_io::read_warnings::read_warnings(&frame), [edof_io::read_warnings::ReadWarning::Dim(900)]);
/// # Ok::<(), edof_core::frame::FrameError>(())
/// ```
#[must_use]
pub fn read_warnings(frame: &RawFrame) -> Vec<ReadWarning> {
    let brightest = frame.pixels().iter().copied().max().unwrap_or(0);
    let dim = (brightest < DIM).then_some(ReadWarning::Dim(brightest));
    dim.into_iter().chain(wrong_diagonal(frame).then_some(ReadWarning::Phase)).collect()
}

fn wrong_diagonal(frame: &RawFrame) -> bool {
    let mut sums = [[0.0; 2]; 2];
    for ((r, c), &v) in frame.pixels().indexed_iter() {
        sums[r % 2][c % 2] += f64::from(v);
    }
    greens_differ(sums, frame.phase())
}

/// Whether what a phase takes for the two greens of a cell differs as red and blue do, by sums of light over its places.
pub(crate) fn greens_differ(sums: [[f64; 2]; 2], phase: CfaPhase) -> bool {
    let mean = 0.25 * sums.iter().flatten().sum::<f64>();
    let is_green = |column: usize| phase.channel(0, column) == Channel::Green;
    let [rising, falling] = [(sums[0][1] - sums[1][0]).abs(), (sums[0][0] - sums[1][1]).abs()];
    let (greens, others) = if is_green(0) { (falling, rising) } else { (rising, falling) };
    greens > GREENS_DIFFER * mean && greens > MORE_THAN_OTHERS * others
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    /// A grey-blue picture with some structure behind the filters of one phase, read with another.
    fn read_as(taken: CfaPhase, stated: CfaPhase) -> Vec<ReadWarning> {
        let light = |r: usize, c: usize| 20_000 + 400 * ((r * 7 + c * 13) % 31) as u32;
        let values = Array2::from_shape_fn((40, 60), |(r, c)| {
            let share = [80, 100, 130][taken.channel(r, c).plane()];
            (light(r, c) * share / 100) as u16
        });
        read_warnings(&RawFrame::from_values(values, 16, stated).unwrap())
    }

    #[test]
    fn greens_on_the_wrong_diagonal_are_noticed_and_right_ones_are_not() {
        for taken in CfaPhase::ALL {
            for stated in CfaPhase::ALL {
                let same = |phase: CfaPhase| phase.channel(0, 0) == Channel::Green;
                let expected = if same(taken) == same(stated) { vec![] } else { vec![ReadWarning::Phase] };
                assert_eq!(read_as(taken, stated), expected, "{taken} as {stated}");
            }
        }
    }

    #[test]
    fn a_grey_frame_says_nothing_of_its_phase() {
        let values = Array2::from_shape_fn((40, 60), |(r, c)| 20_000 + 100 * ((r * 3 + c) % 17) as u16);
        for phase in CfaPhase::ALL {
            assert_eq!(read_warnings(&RawFrame::from_values(values.clone(), 16, phase).unwrap()), []);
        }
    }
}
