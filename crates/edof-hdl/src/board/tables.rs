//! Memory images beside those of the calculator: the display's tables, and the programs that set up video chips.

use crate::video::display::TABLE_IMAGES;
use edof_device::design::Design;
use edof_device::i2c;
use std::fmt::Write;

/// The display tables that a design starts with: luma codes; encoded red, green and blue.
#[derive(Debug, Clone, Copy)]
pub struct Tables<'a> {
    /// 2¹⁵ luma codes.
    pub luma: &'a [u64],
    /// 2¹⁴ entries of 12 bits for each colour.
    pub colours: [&'a [u64]; 3],
}

impl Tables<'_> {
    /// Returns path and text of each image: those of the display tables, and those of the set-ups of the design's board.
    #[must_use]
    pub fn images(&self, design: &Design) -> Vec<(String, String)> {
        // Codes of 8 bits, encoded light of 12.
        let [red, green, blue] = self.colours;
        let all = [(self.luma, 2), (red, 3), (green, 3), (blue, 3)];
        let display = TABLE_IMAGES.iter().zip(all).map(|(path, (words, digits))| {
            let text = words.iter().fold(String::new(), |mut text, word| {
                // Writing to a String cannot fail.
                let _ = writeln!(text, "{word:0digits$x}");
                text
            });
            (path.to_string(), text)
        });
        let setups = design.board.setups();
        let setups = setups.map(|setup| (setup.image.to_owned(), i2c::image(&design.program(setup))));
        display.chain(setups).collect()
    }
}
