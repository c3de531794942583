//! Capitals, digits and a few signs drawn by a round pen, of any size.

/// A letter, and its strokes: points of two hexadecimal digits, across and up, in twelfths of a capital's height.
type Glyph = (char, &'static [&'static str]);

#[rustfmt::skip]
const GLYPHS: [Glyph; 42] = [
    ('0', &["2c0a022050727a5c2c"]),
    ('1', &["193c30"]),
    ('2', &["0a2c5c7a780070"]),
    ('3', &["0a2c5c7a785626", "567472502002"]),
    ('4', &["606c0484"]),
    ('5', &["7c1c0627577572502002"]),
    ('6', &["7a5c2c0a0220507275572705"]),
    ('7', &["0c7c20"]),
    ('8', &["26080a2c5c7a785626", "2604022050727456"]),
    ('9', &["022050727a5c2c0a07255577"]),
    ('A', &["004c80", "1474"]),
    ('B', &["000c5c7a785606", "5684825000"]),
    ('C', &["8a6c2c0a02206082"]),
    ('D', &["000c5c8a825000"]),
    ('E', &["8c0c0080", "0666"]),
    ('F', &["8c0c00", "0666"]),
    ('G', &["8a6c2c0a022060828646"]),
    ('H', &["000c", "808c", "0686"]),
    ('I', &["000c"]),
    ('J', &["6c62402002"]),
    ('K', &["000c", "8c05", "3780"]),
    ('L', &["0c0070"]),
    ('M', &["000c458c80"]),
    ('N', &["000c808c"]),
    ('O', &["2c0a022060828a6c2c"]),
    ('P', &["000c5c8a885606"]),
    ('Q', &["2c0a022060828a6c2c", "5380"]),
    ('R', &["000c5c8a885606", "4680"]),
    ('S', &["8a6c2c0a0826668482602002"]),
    ('T', &["0c8c", "4c40"]),
    ('U', &["0c022060828c"]),
    ('V', &["0c408c"]),
    ('W', &["0c2049608c"]),
    ('X', &["008c", "0c80"]),
    ('Y', &["0c468c", "4640"]),
    ('Z', &["0c8c0080"]),
    ('.', &["0000"]),
    (',', &["1200"]),
    ('-', &["0656"]),
    (':', &["0000", "0808"]),
    ('=', &["0464", "0868"]),
    ('/', &["006c"]),
];

/// Twelfths of a capital's height from one letter's right edge to the next one's left.
const GAP: f64 = 4.5;
/// The same of a blank.
const BLANK: f64 = 4.0;
/// Radius of the pen in twelfths of a capital's height.
const PEN: f64 = 0.9;

/// A letter in its place.
#[derive(Debug, Clone, PartialEq)]
struct Letter {
    /// Where its leftmost stroke may begin.
    left: f64,
    /// Start and end of each straight stroke, in twelfths of a capital's height from the line's lower left corner.
    strokes: Vec<[(f64, f64); 2]>,
}

/// A line of text.
#[derive(Debug, Clone, PartialEq)]
pub struct Writing {
    letters: Vec<Letter>,
    /// Twelfths of a capital's height that it is wide.
    width: f64,
}

impl Writing {
    /// Lays out a text. Letters that are not capitals, digits or one of `.,-:=/` are blank.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let (mut letters, mut left) = (vec![], PEN);
        for letter in text.chars() {
            let Some((_, paths)) = GLYPHS.iter().find(|glyph| glyph.0 == letter) else {
                left += BLANK + GAP;
                continue;
            };
            let paths: Vec<Vec<(f64, f64)>> = paths.iter().map(|path| points(path)).collect();
            let width = paths.iter().flatten().fold(0.0f64, |width, point| width.max(point.0));
            let at = |point: (f64, f64)| (point.0 + left, point.1 + PEN);
            let strokes =
                paths.iter().flat_map(|path| path.windows(2).map(|ends| [at(ends[0]), at(ends[1])]));
            letters.push(Letter { left: left - PEN, strokes: strokes.collect() });
            left += width + GAP;
        }
        Self { letters, width: left - GAP + PEN }
    }

    /// Returns how wide it is if its capitals are `height` high.
    #[must_use]
    pub fn width(&self, height: f64) -> f64 {
        self.width * unit(height)
    }

    /// Returns whether there is ink at `x` and `y`, from the upper left corner of the line, its capitals `height` high.
    #[must_use]
    pub fn is_ink(&self, height: f64, x: f64, y: f64) -> bool {
        let at = (x / unit(height), (height - y) / unit(height));
        let letter = self.letters.partition_point(|letter| letter.left <= at.0).checked_sub(1);
        letter.is_some_and(|i| self.letters[i].strokes.iter().any(|&ends| distance(at, ends) <= PEN))
    }
}

/// A twelfth of what remains of a capital's height without the pen's own width.
fn unit(height: f64) -> f64 {
    height / (12.0 + 2.0 * PEN)
}

fn points(path: &str) -> Vec<(f64, f64)> {
    let digits: Vec<f64> = path.chars().filter_map(|c| c.to_digit(16)).map(f64::from).collect();
    digits.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect()
}

/// Distance of a point from the straight line between two others.
fn distance(at: (f64, f64), [from, to]: [(f64, f64); 2]) -> f64 {
    let (along, across) = (to.0 - from.0, to.1 - from.1);
    let length = along * along + across * across;
    let share = ((at.0 - from.0) * along + (at.1 - from.1) * across) / length.max(f64::MIN_POSITIVE);
    let share = share.clamp(0.0, 1.0);
    (at.0 - from.0 - share * along).hypot(at.1 - from.1 - share * across)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(text: &str) -> Vec<String> {
        let writing = Writing::new(text);
        let dot = |x, y| if writing.is_ink(13.8, x, y) { '#' } else { '.' };
        let row = |y: usize| (0..10).map(|x| dot(x as f64 + 0.9, 2.0 * y as f64 + 0.9)).collect();
        (0..7).map(row).collect()
    }

    #[test]
    fn letters_read_as_themselves() {
        assert_eq!(
            drawn("E"),
            [
                "#########.",
                "#.........",
                "#.........",
                "#######...",
                "#.........",
                "#.........",
                "#########."
            ]
        );
        assert!(drawn("?").iter().all(|row| row == ".........."));
    }

    #[test]
    fn no_two_letters_look_alike_and_each_is_within_its_line() {
        let all: std::collections::BTreeSet<_> =
            GLYPHS.iter().map(|(letter, _)| drawn(&letter.to_string())).collect();
        assert_eq!(all.len(), GLYPHS.len());
        for (_, paths) in GLYPHS {
            assert!(paths.iter().flat_map(|path| points(path)).all(|(x, y)| x <= 8.0 && y <= 12.0));
        }
    }

    #[test]
    fn a_line_is_as_wide_as_its_letters() {
        let width = |text| Writing::new(text).width(13.8);
        assert!((width("HH") - (2.0 * 8.0 + GAP + 2.0 * PEN)).abs() < 1e-9);
        assert!((width("H H") - width("HH") - (GAP + BLANK)).abs() < 1e-9);
    }
}
