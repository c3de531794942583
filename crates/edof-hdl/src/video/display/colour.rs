//! One colour of the display.

use crate::blocks::delay::DelayOf;
use crate::describe::{Circuit, kernel};
use crate::video::scale::Scale;
use crate::video::table::Table;
use crate::video::{Factor, Wide};
use rust_hdl::prelude::*;

/// Red, green or blue of the display: light to its part of the sums for luma and chroma. `light` comes in cycle 5 of its pixel, `even`, `odd` and
/// `starts` in cycle 9, `odd_later` in cycle 10, `second` in cycle 12. The colour waits for the sums of the one before it.
#[derive(Circuit)]
#[circuit(default(Scale), registers(clock))]
pub struct DisplayColour {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Light, in two's complement.
    pub light: Signal<In, Bits<18>>,
    /// The pixel is the left one of a pair.
    pub even: Signal<In, Bit>,
    /// The pixel is the right one of a pair.
    pub odd: Signal<In, Bit>,
    /// The pixel is of its line's first pair.
    pub starts: Signal<In, Bit>,
    /// `odd`, a cycle later.
    pub odd_later: Signal<In, Bit>,
    /// The sum for chroma is that of Cr.
    pub second: Signal<In, Bits<1>>,
    /// Sum for luma of the colours before.
    pub luma_before: Signal<In, Wide>,
    /// Sum for luma.
    pub luma: Signal<Out, Wide>,
    /// Sum for chroma of the colours before.
    pub chroma_before: Signal<In, Wide>,
    /// Sum for chroma.
    pub chroma: Signal<Out, Wide>,
    /// There was less than no or more than full light, a cycle later.
    pub outside: Signal<Out, Bit>,
    /// Writes an entry of a table.
    pub table_write: Signal<In, Bit>,
    /// Which table.
    pub table_select: Signal<In, Bits<2>>,
    /// Entry to write, or to look at.
    pub table_address: Signal<In, Bits<15>>,
    /// Encoded light.
    pub table_data: Signal<In, Bits<12>>,
    /// What lay at that entry two cycles ago.
    pub table_word: Signal<Out, Bits<12>>,
    /// Number of this colour's table.
    number: Constant<Bits<2>>,
    /// There are colours before.
    waits: Constant<Bit>,
    #[signed]
    to_luma: Constant<Factor>,
    #[signed]
    to_cb: Constant<Factor>,
    #[signed]
    to_cr: Constant<Factor>,
    table: Table<12>,
    wait: DelayOf<27>,
    luma_sum: Scale,
    chroma_sum: Scale,
    address_6: DFF<Bits<14>>,
    outside_6: DFF<Bit>,
    encoded_9: DFF<Bits<12>>,
    even_q: DFF<Bits<14>>,
    before_q: DFF<Bits<14>>,
    outer_10: DFF<Bits<14>>,
    filtered_11: DFF<Bits<14>>,
    once_9: Signal<Local, Bits<14>>,
    now: Signal<Local, Bits<27>>,
    word: Signal<Local, Bits<27>>,
}

/// What colours differ in.
pub(super) struct ColourSetup {
    /// Number of its table, from 1.
    pub number: usize,
    /// Factors for Y', Cb' and Cr'.
    pub factors: [Constant<Factor>; 3],
    /// Its table.
    pub table: Table<12>,
}

impl DisplayColour {
    /// A colour; the first one has the table number 1.
    pub(super) fn new(setup: ColourSetup) -> Self {
        let before = setup.number - 1;
        let [to_luma, to_cb, to_cr] = setup.factors;
        Self::from_parts(DisplayColourParts {
            number: Constant::new((setup.number as u64).into()),
            waits: Constant::new(before > 0),
            to_luma,
            to_cb,
            to_cr,
            table: setup.table,
            // A sum is there two cycles after the words of its colour.
            wait: DelayOf::new(2 * before),
        })
    }
}

impl Logic for DisplayColour {
    #[kernel]
    fn update(&mut self) {
        self.table.clock.next = self.clock.val();
        self.wait.clock.next = self.clock.val();
        self.luma_sum.clock.next = self.clock.val();
        self.chroma_sum.clock.next = self.clock.val();

        // Cycles 6 to 9: the table, and a register more between block RAM and multipliers.
        self.address_6.d.next = self.light.val().get_bits::<14>(0);
        self.outside_6.d.next = false;
        if self.light.val().get_bit(17) {
            self.address_6.d.next = 0.into();
            self.outside_6.d.next = true;
        } else if self.light.val().get_bits::<3>(14).any() {
            self.address_6.d.next = 0x3fff.into();
            self.outside_6.d.next =
                self.light.val().get_bits::<2>(15).any() || self.light.val().get_bits::<14>(0).any();
        }
        self.outside.next = self.outside_6.q.val();
        self.table.read_address.next = bit_cast::<16, 14>(self.address_6.q.val());
        self.table.write_enable.next =
            self.table_write.val() && (self.table_select.val() == self.number.val());
        self.table.address.next = bit_cast::<16, 15>(self.table_address.val());
        self.table.write_data.next = self.table_data.val();
        self.table_word.next = self.table.data.val();
        self.encoded_9.d.next = self.table.read_data.val();

        // Cycles 9 to 11: the colour of a pair's odd pixel, of its even one twice, and of the odd one before, which a line's
        // first pair does not have: mirrored, it is the one after.
        self.once_9.next = bit_cast::<14, 12>(self.encoded_9.q.val());
        if self.even.val() {
            self.even_q.d.next = self.once_9.val();
        }
        if self.odd.val() {
            self.before_q.d.next = self.once_9.val();
        }
        self.outer_10.d.next = self.once_9.val() + self.before_q.q.val();
        if self.starts.val() {
            self.outer_10.d.next = self.once_9.val() << 1;
        }
        if self.odd_later.val() {
            self.filtered_11.d.next = self.outer_10.q.val() + (self.even_q.q.val() << 1);
        }

        // The sums, once those of the colours before are there.
        self.now.next = (bit_cast::<27, 1>(self.second.val()) << 26)
            | (bit_cast::<27, 14>(self.filtered_11.q.val()) << 12)
            | bit_cast::<27, 12>(self.encoded_9.q.val());
        self.wait.data.next = self.now.val();
        self.word.next = self.now.val();
        if self.waits.val() {
            self.word.next = self.wait.delayed.val();
        }
        self.luma_sum.value.next = bit_cast::<18, 12>(self.word.val().get_bits::<12>(0));
        self.luma_sum.factor.next = self.to_luma.val();
        self.luma_sum.addend.next = self.luma_before.val();
        self.luma.next = self.luma_sum.sum.val();
        self.chroma_sum.value.next = bit_cast::<18, 14>(self.word.val().get_bits::<14>(12));
        self.chroma_sum.factor.next = self.to_cb.val();
        if self.word.val().get_bit(26) {
            self.chroma_sum.factor.next = self.to_cr.val();
        }
        self.chroma_sum.addend.next = self.chroma_before.val();
        self.chroma.next = self.chroma_sum.sum.val();
    }
}
