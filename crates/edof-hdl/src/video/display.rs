//! From overlap-added words to the codes on the wire (docs/contract.md, section 5).

mod chroma_code;
mod colour;
mod kernel;

use super::queue::Queue;
use super::scale::Scale;
use super::table::Table;
use super::{Factor, Wide};
use crate::blocks::delay::Delay;
use crate::blocks::{Pair, Word};
use crate::describe::Circuit;
use chroma_code::ChromaCode;
use colour::{ColourSetup, DisplayColour};
use edof_core::display::{BLACK, CHROMA_ZERO, TO_CHROMA, TO_LUMA, TO_RGB, ToChroma, ToLuma, ToRgb};
use rust_hdl::prelude::*;

// Where the luma code begins in its sum, and the half below it.
const _: () = assert!(ToLuma::FRAC_NBITS == 20);

/// From overlap-added words to the 8-bit codes on the wire: luma only by one table, or colour by a table for each of red, green, blue.
/// Pairs of pixels in, pixels out, line by line; one pixel a cycle, so a pair every second cycle, 26 cycles from a pair's successor,
/// whose chroma its right pixel needs, to its codes. `colour` is looked at with each frame's first pair. A table may be written at any
/// time; pixels on their way may read either entry. Counters stand a few cycles later.
#[derive(Circuit)]
#[circuit(default(ChromaCode, Delay, Scale), registers(clock))]
pub struct Display {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets the picture; tables stay.
    pub reset: Signal<In, Bit>,
    /// The input pair of pixels is valid.
    pub valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Luma words of the pair, the left pixel low.
    pub luma: Signal<In, Pair>,
    /// Chroma words of the pair, Cb low.
    pub chroma: Signal<In, Pair>,
    /// The pixel is the first of its frame.
    pub first: Signal<In, Bit>,
    /// The pixel is the last of its line.
    pub last: Signal<In, Bit>,
    /// Colour, or luma only.
    pub colour: Signal<In, Bit>,
    /// The output pixel is valid.
    pub pixels_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub pixels_ready: Signal<In, Bit>,
    /// Codes of the pixel: Y' low; high Cb' of the left pixel of a pair, Cr' of the right one.
    pub pixels_data: Signal<Out, Word>,
    /// The pixel is the first of its frame.
    pub pixels_user: Signal<Out, Bit>,
    /// The pixel is the last of its line.
    pub pixels_last: Signal<Out, Bit>,
    /// Writes an entry of a table.
    pub table_write: Signal<In, Bit>,
    /// Which: 0 luma, 1 red, 2 green, 3 blue.
    pub table_select: Signal<In, Bits<2>>,
    /// Entry to write, or to look at: a luma word, or light.
    pub table_address: Signal<In, Bits<15>>,
    /// A luma code, or encoded light.
    pub table_data: Signal<In, Bits<12>>,
    /// What lay at that entry two cycles ago.
    pub table_word: Signal<Out, Bits<12>>,
    /// Sets both counters to zero.
    pub clear: Signal<In, Bit>,
    /// Chroma codes that were clamped (luma only).
    pub clamped_chroma: Signal<Out, Bits<32>>,
    /// Pixels with less than no or more than full light of a colour (colour).
    pub out_of_gamut: Signal<Out, Bits<32>>,
    #[signed]
    red_of_cr: Constant<Factor>,
    #[signed]
    green_of_cb: Constant<Factor>,
    #[signed]
    green_of_cr: Constant<Factor>,
    #[signed]
    blue_of_cb: Constant<Factor>,
    light_half: Constant<Wide>,
    light_sign: Constant<Wide>,
    luma_base: Constant<Bits<9>>,
    chroma_base: Constant<Wide>,
    next_valid: DFF<Bit>,
    next_luma: DFF<Pair>,
    next_chroma: DFF<Pair>,
    next_first: DFF<Bit>,
    next_last: DFF<Bit>,
    held_valid: DFF<Bit>,
    held_luma: DFF<Pair>,
    held_chroma: DFF<Pair>,
    held_first: DFF<Bit>,
    held_last: DFF<Bit>,
    odd: DFF<Bit>,
    starts: DFF<Bit>,
    colour_q: DFF<Bit>,
    marks_0: DFF<Bits<6>>,
    luma_0: DFF<Word>,
    site_0: DFF<Pair>,
    cb_0: DFF<Factor>,
    cr_0: DFF<Factor>,
    luma_1: DFF<Word>,
    to_2: Delay<6, 2>,
    to_6: Delay<6, 4>,
    to_9: Delay<6, 3>,
    to_10: Delay<6, 1>,
    to_11: Delay<6, 1>,
    to_12: Delay<6, 1>,
    to_16: Delay<6, 4>,
    to_18: Delay<6, 2>,
    to_19: Delay<6, 1>,
    red_light: Scale,
    green_light: Scale,
    green_whole: Scale,
    blue_light: Scale,
    red_to_5: Delay<18, 2>,
    cr_to_2: Delay<18, 2>,
    blue_to_5: Delay<18, 2>,
    colours: [DisplayColour; 3],
    gamut_7: DFF<Bit>,
    colour_13: DFF<Bit>,
    cb_19: DFF<Bits<8>>,
    index_1: DFF<Bits<15>>,
    luma_table: Table<8>,
    lookup: Delay<2, 2>,
    luma_to_4: Delay<8, 1>,
    luma_to_16: Delay<8, 12>,
    sites: [ChromaCode; 2],
    clamped_3: DFF<Bits<2>>,
    site_to_19: Delay<16, 17>,
    luma_17: DFF<Bits<8>>,
    luma_18: DFF<Bits<8>>,
    luma_19: DFF<Bits<8>>,
    even_luma: DFF<Bits<8>>,
    push_20: DFF<Bit>,
    done_20: DFF<Bits<34>>,
    queue: Queue<34>,
    right: DFF<Bit>,
    clamped_q: DFF<Bits<32>>,
    gamut_q: DFF<Bits<32>>,
    accept: Signal<Local, Bit>,
    step_even: Signal<Local, Bit>,
    step_odd: Signal<Local, Bit>,
    advance: Signal<Local, Bit>,
    colour_now: Signal<Local, Bit>,
    neighbour: Signal<Local, Pair>,
    marks: Signal<Local, Bits<6>>,
    cb_here: Signal<Local, Factor>,
    cr_here: Signal<Local, Factor>,
    cb_there: Signal<Local, Factor>,
    cr_there: Signal<Local, Factor>,
    light_base: Signal<Local, Wide>,
    odd_9: Signal<Local, Bit>,
    even_9: Signal<Local, Bit>,
    odd_10: Signal<Local, Bit>,
    second: Signal<Local, Bits<1>>,
    site_19: Signal<Local, Bits<16>>,
    ends_19: Signal<Local, Bits<2>>,
    luma_code: Signal<Local, Bits<9>>,
}

/// A coefficient in two's complement.
fn factor(value: i32) -> Constant<Factor> {
    Constant::new(((value as u64) & 0x3_ffff).into())
}

/// One half of the last place kept, and `zero` of those.
fn base(shift: u32, zero: u64) -> Constant<Wide> {
    Constant::new(((1u64 << (shift - 1)) + (zero << shift)).into())
}

/// Where the images of the tables lie, by the table's number.
pub const TABLE_IMAGES: [&str; 4] =
    ["mem/display_luma.mem", "mem/display_red.mem", "mem/display_green.mem", "mem/display_blue.mem"];

impl Display {
    /// The display with the tables that it starts with: 2¹⁵ luma codes and 2¹⁴ entries of 12 bits for red, green and blue.
    #[must_use]
    pub fn new(luma: &[u64], colours: [&[u64]; 3]) -> Self {
        let colour = |i: usize| {
            DisplayColour::new(ColourSetup {
                number: i + 1,
                factors: [
                    factor(TO_LUMA[i].to_bits()),
                    factor(TO_CHROMA[0][i].to_bits()),
                    factor(TO_CHROMA[1][i].to_bits()),
                ],
                table: Table::loaded(TABLE_IMAGES[i + 1], colours[i]),
            })
        };
        Self::from_parts(DisplayParts {
            red_of_cr: factor(TO_RGB[0][1].to_bits()),
            green_of_cb: factor(TO_RGB[1][0].to_bits()),
            green_of_cr: factor(TO_RGB[1][1].to_bits()),
            blue_of_cb: factor(TO_RGB[2][0].to_bits()),
            light_half: base(ToRgb::FRAC_NBITS, 0),
            light_sign: Constant::new((((1u64 << 48) - 1) & !((1 << (16 + ToRgb::FRAC_NBITS)) - 1)).into()),
            luma_base: Constant::new((2 * u64::from(BLACK) + 1).into()),
            chroma_base: base(ToChroma::FRAC_NBITS, CHROMA_ZERO as u64),
            colours: std::array::from_fn(colour),
            luma_table: Table::loaded(TABLE_IMAGES[0], luma),
            queue: Queue::new(16),
        })
    }
}
