//! What the display does in each cycle.

use super::Display;
use crate::describe::kernel;
use rust_hdl::prelude::*;

impl Logic for Display {
    #[kernel]
    fn update(&mut self) {
        self.to_2.clock.next = self.clock.val();
        self.to_6.clock.next = self.clock.val();
        self.to_9.clock.next = self.clock.val();
        self.to_10.clock.next = self.clock.val();
        self.to_11.clock.next = self.clock.val();
        self.to_12.clock.next = self.clock.val();
        self.to_16.clock.next = self.clock.val();
        self.to_18.clock.next = self.clock.val();
        self.to_19.clock.next = self.clock.val();
        self.red_light.clock.next = self.clock.val();
        self.green_light.clock.next = self.clock.val();
        self.green_whole.clock.next = self.clock.val();
        self.blue_light.clock.next = self.clock.val();
        self.red_to_5.clock.next = self.clock.val();
        self.cr_to_2.clock.next = self.clock.val();
        self.blue_to_5.clock.next = self.clock.val();
        self.luma_table.clock.next = self.clock.val();
        self.lookup.clock.next = self.clock.val();
        self.luma_to_16.clock.next = self.clock.val();
        self.site_to_19.clock.next = self.clock.val();
        self.queue.clock.next = self.clock.val();
        self.queue.reset.next = self.reset.val();

        // In: the pair that is shown, and the one after it.
        self.ready.next = self.queue.space.val() && !self.next_valid.q.val();
        self.accept.next = self.valid.val() && self.queue.space.val() && !self.next_valid.q.val();
        self.step_even.next = self.held_valid.q.val() && !self.odd.q.val();
        self.step_odd.next = self.held_valid.q.val()
            && self.odd.q.val()
            && (self.held_last.q.val() || self.next_valid.q.val());
        self.advance.next = self.step_odd.val() || !self.held_valid.q.val();
        if self.advance.val() {
            self.held_valid.d.next = self.next_valid.q.val();
            self.held_luma.d.next = self.next_luma.q.val();
            self.held_chroma.d.next = self.next_chroma.q.val();
            self.held_first.d.next = self.next_first.q.val();
            self.held_last.d.next = self.next_last.q.val();
            self.next_valid.d.next = false;
        }
        if self.accept.val() {
            self.next_valid.d.next = true;
            self.next_luma.d.next = self.luma.val();
            self.next_chroma.d.next = self.chroma.val();
            self.next_first.d.next = self.first.val();
            self.next_last.d.next = self.last.val();
        }
        if self.step_even.val() {
            self.odd.d.next = true;
        }
        if self.step_odd.val() {
            self.odd.d.next = false;
            self.starts.d.next = self.held_last.q.val();
        }
        self.colour_now.next = self.colour_q.q.val();
        if self.held_first.q.val() && !self.odd.q.val() {
            self.colour_now.next = self.colour.val();
        }
        if self.step_even.val() {
            self.colour_q.d.next = self.colour_now.val();
        }

        // Cycle 0: the pixel, its chroma doubled. What travels with it: bit 0 it is one, 1 odd, 2 of its line's first pair,
        // 3 of its frame's first, 4 of its line's last, 5 in colour.
        self.marks.next = 0.into();
        if self.step_even.val() {
            self.marks.next = 1.into();
        }
        if self.step_odd.val() {
            self.marks.next = 3.into();
        }
        self.marks_0.d.next = self.marks.val()
            | (bit_cast::<6, 1>(self.starts.q.val().into()) << 2)
            | (bit_cast::<6, 1>(self.held_first.q.val().into()) << 3)
            | (bit_cast::<6, 1>(self.held_last.q.val().into()) << 4)
            | (bit_cast::<6, 1>(self.colour_now.val().into()) << 5);
        self.neighbour.next = self.next_chroma.q.val();
        if self.held_last.q.val() || !self.odd.q.val() {
            self.neighbour.next = self.held_chroma.q.val();
        }
        self.cb_here.next = bit_cast::<18, 16>(self.held_chroma.q.val().get_bits::<16>(0));
        if self.held_chroma.q.val().get_bit(15) {
            self.cb_here.next = bit_cast::<18, 16>(self.held_chroma.q.val().get_bits::<16>(0)) | 0x3_0000;
        }
        self.cr_here.next = bit_cast::<18, 16>(self.held_chroma.q.val().get_bits::<16>(16));
        if self.held_chroma.q.val().get_bit(31) {
            self.cr_here.next = bit_cast::<18, 16>(self.held_chroma.q.val().get_bits::<16>(16)) | 0x3_0000;
        }
        self.cb_there.next = bit_cast::<18, 16>(self.neighbour.val().get_bits::<16>(0));
        if self.neighbour.val().get_bit(15) {
            self.cb_there.next = bit_cast::<18, 16>(self.neighbour.val().get_bits::<16>(0)) | 0x3_0000;
        }
        self.cr_there.next = bit_cast::<18, 16>(self.neighbour.val().get_bits::<16>(16));
        if self.neighbour.val().get_bit(31) {
            self.cr_there.next = bit_cast::<18, 16>(self.neighbour.val().get_bits::<16>(16)) | 0x3_0000;
        }
        self.cb_0.d.next = self.cb_here.val() + self.cb_there.val();
        self.cr_0.d.next = self.cr_here.val() + self.cr_there.val();
        self.luma_0.d.next = self.held_luma.q.val().get_bits::<16>(0);
        if self.odd.q.val() {
            self.luma_0.d.next = self.held_luma.q.val().get_bits::<16>(16);
        }
        self.site_0.d.next = self.held_chroma.q.val();
        self.to_2.data.next = self.marks_0.q.val();
        self.to_6.data.next = self.to_2.delayed.val();
        self.to_9.data.next = self.to_6.delayed.val();
        self.to_10.data.next = self.to_9.delayed.val();
        self.to_11.data.next = self.to_10.delayed.val();
        self.to_12.data.next = self.to_11.delayed.val();
        self.to_16.data.next = self.to_12.delayed.val();
        self.to_18.data.next = self.to_16.delayed.val();
        self.to_19.data.next = self.to_18.delayed.val();

        // To cycle 5: light. Luma joins a cycle after chroma.
        self.luma_1.d.next = self.luma_0.q.val();
        self.light_base.next = (bit_cast::<48, 16>(self.luma_1.q.val()) << 17) | self.light_half.val();
        if self.luma_1.q.val().get_bit(15) {
            self.light_base.next = (bit_cast::<48, 16>(self.luma_1.q.val()) << 17)
                | self.light_half.val()
                | self.light_sign.val();
        }
        self.red_light.value.next = self.cr_0.q.val();
        self.red_light.factor.next = self.red_of_cr.val();
        self.red_light.addend.next = self.light_base.val();
        self.green_light.value.next = self.cb_0.q.val();
        self.green_light.factor.next = self.green_of_cb.val();
        self.green_light.addend.next = self.light_base.val();
        self.cr_to_2.data.next = self.cr_0.q.val();
        self.green_whole.value.next = self.cr_to_2.delayed.val();
        self.green_whole.factor.next = self.green_of_cr.val();
        self.green_whole.addend.next = self.green_light.sum.val();
        self.blue_light.value.next = self.cb_0.q.val();
        self.blue_light.factor.next = self.blue_of_cb.val();
        self.blue_light.addend.next = self.light_base.val();
        self.red_to_5.data.next = self.red_light.sum.val().get_bits::<18>(17);
        self.blue_to_5.data.next = self.blue_light.sum.val().get_bits::<18>(17);
        self.colours[0].light.next = self.red_to_5.delayed.val();
        self.colours[1].light.next = self.green_whole.sum.val().get_bits::<18>(17);
        self.colours[2].light.next = self.blue_to_5.delayed.val();

        // Cycles 6 to 18: colours, one after the other. To cycle 16 luma, to cycle 18 Cb, to cycle 19 Cr of a pair, whose filtered
        // colours stand for two cycles.
        self.odd_9.next = self.to_9.delayed.val().get_bit(0) && self.to_9.delayed.val().get_bit(1);
        self.even_9.next = self.to_9.delayed.val().get_bit(0) && !self.to_9.delayed.val().get_bit(1);
        self.odd_10.next = self.to_10.delayed.val().get_bit(0) && self.to_10.delayed.val().get_bit(1);
        self.second.next = 0.into();
        if self.to_12.delayed.val().get_bit(0) && self.to_12.delayed.val().get_bit(1) {
            self.second.next = 1.into();
        }
        for i in 0..3 {
            self.colours[i].clock.next = self.clock.val();
            self.colours[i].even.next = self.even_9.val();
            self.colours[i].odd.next = self.odd_9.val();
            self.colours[i].starts.next = self.to_9.delayed.val().get_bit(2);
            self.colours[i].odd_later.next = self.odd_10.val();
            self.colours[i].second.next = self.second.val();
            self.colours[i].table_write.next = self.table_write.val();
            self.colours[i].table_select.next = self.table_select.val();
            self.colours[i].table_address.next = self.table_address.val();
            self.colours[i].table_data.next = self.table_data.val();
        }
        self.colours[0].luma_before.next = 0.into();
        self.colours[1].luma_before.next = self.colours[0].luma.val();
        self.colours[2].luma_before.next = self.colours[1].luma.val();
        self.colours[0].chroma_before.next = 0.into();
        if self.to_12.delayed.val().get_bit(5) || self.colour_13.q.val() {
            self.colours[0].chroma_before.next = self.chroma_base.val();
        }
        self.colour_13.d.next = self.to_12.delayed.val().get_bit(5);
        self.colours[1].chroma_before.next = self.colours[0].chroma.val();
        self.colours[2].chroma_before.next = self.colours[1].chroma.val();
        self.cb_19.d.next = self.colours[2].chroma.val().get_bits::<8>(22);

        // Luma only: a table for luma, read in cycles 1 to 3; chroma rounds in cycles 1 and 2.
        self.index_1.d.next = self.luma_0.q.val().get_bits::<15>(0);
        if self.luma_0.q.val().get_bit(15) {
            self.index_1.d.next = 0.into();
        }
        self.luma_table.read_address.next = bit_cast::<16, 15>(self.index_1.q.val());
        self.luma_table.write_enable.next = self.table_write.val() && (self.table_select.val() == 0);
        self.luma_table.address.next = bit_cast::<16, 15>(self.table_address.val());
        self.luma_table.write_data.next = self.table_data.val().get_bits::<8>(0);
        // A register of its own behind block RAM: a shift register's input takes longer.
        self.luma_to_4.clock.next = self.clock.val();
        self.luma_to_4.data.next = self.luma_table.read_data.val();
        self.luma_to_16.data.next = self.luma_to_4.delayed.val();
        self.lookup.data.next = self.table_select.val();
        self.table_word.next = bit_cast::<12, 8>(self.luma_table.data.val());
        if self.lookup.delayed.val() == 1 {
            self.table_word.next = self.colours[0].table_word.val();
        } else if self.lookup.delayed.val() == 2 {
            self.table_word.next = self.colours[1].table_word.val();
        } else if self.lookup.delayed.val() == 3 {
            self.table_word.next = self.colours[2].table_word.val();
        }
        for i in 0..2 {
            self.sites[i].clock.next = self.clock.val();
        }
        self.sites[0].word.next = self.site_0.q.val().get_bits::<16>(0);
        self.sites[1].word.next = self.site_0.q.val().get_bits::<16>(16);
        self.site_to_19.data.next =
            (bit_cast::<16, 8>(self.sites[1].code.val()) << 8) | bit_cast::<16, 8>(self.sites[0].code.val());

        // Black and the half for rounding come last: as a constant addend they would stand before a multiplier's own adder.
        self.luma_code.next = self.colours[2].luma.val().get_bits::<9>(19) + self.luma_base.val();

        // Out: the codes of a pair, once those of its odd pixel are there.
        self.luma_17.d.next = self.luma_to_16.delayed.val();
        if self.to_16.delayed.val().get_bit(5) {
            self.luma_17.d.next = self.luma_code.val().get_bits::<8>(1);
        }
        self.luma_18.d.next = self.luma_17.q.val();
        self.luma_19.d.next = self.luma_18.q.val();
        if self.to_18.delayed.val().get_bit(0) && !self.to_18.delayed.val().get_bit(1) {
            self.even_luma.d.next = self.luma_18.q.val();
        }
        self.site_19.next = self.site_to_19.delayed.val();
        if self.to_19.delayed.val().get_bit(5) {
            self.site_19.next = (bit_cast::<16, 8>(self.colours[2].chroma.val().get_bits::<8>(22)) << 8)
                | bit_cast::<16, 8>(self.cb_19.q.val());
        }
        self.ends_19.next = self.to_19.delayed.val().get_bits::<2>(3);
        self.push_20.d.next = self.to_19.delayed.val().get_bit(0) && self.to_19.delayed.val().get_bit(1);
        self.done_20.d.next = (bit_cast::<34, 2>(self.ends_19.val()) << 32)
            | (bit_cast::<34, 8>(self.site_19.val().get_bits::<8>(8)) << 24)
            | (bit_cast::<34, 8>(self.luma_19.q.val()) << 16)
            | (bit_cast::<34, 8>(self.site_19.val().get_bits::<8>(0)) << 8)
            | bit_cast::<34, 8>(self.even_luma.q.val());
        self.queue.push.next = self.push_20.q.val();
        self.queue.data.next = self.done_20.q.val();
        self.queue.front_ready.next = self.pixels_ready.val() && self.right.q.val();
        self.pixels_valid.next = self.queue.front_valid.val();
        self.pixels_data.next = self.queue.front_data.val().get_bits::<16>(0);
        self.pixels_user.next = self.queue.front_data.val().get_bit(32);
        self.pixels_last.next = false;
        if self.right.q.val() {
            self.pixels_data.next = self.queue.front_data.val().get_bits::<16>(16);
            self.pixels_user.next = false;
            self.pixels_last.next = self.queue.front_data.val().get_bit(33);
        }
        if self.queue.front_valid.val() && self.pixels_ready.val() {
            self.right.d.next = !self.right.q.val();
        }

        // What could not be shown.
        self.gamut_7.d.next = self.to_6.delayed.val().get_bit(0)
            && self.to_6.delayed.val().get_bit(5)
            && (self.colours[0].outside.val()
                || self.colours[1].outside.val()
                || self.colours[2].outside.val());
        if self.gamut_7.q.val() {
            self.gamut_q.d.next = self.gamut_q.q.val() + 1;
        }
        self.clamped_3.d.next = 0.into();
        if self.to_2.delayed.val().get_bit(0)
            && self.to_2.delayed.val().get_bit(1)
            && !self.to_2.delayed.val().get_bit(5)
        {
            if self.sites[0].clamped.val() && self.sites[1].clamped.val() {
                self.clamped_3.d.next = 2.into();
            } else if self.sites[0].clamped.val() || self.sites[1].clamped.val() {
                self.clamped_3.d.next = 1.into();
            }
        }
        self.clamped_q.d.next = self.clamped_q.q.val() + bit_cast::<32, 2>(self.clamped_3.q.val());
        self.out_of_gamut.next = self.gamut_q.q.val();
        self.clamped_chroma.next = self.clamped_q.q.val();
        if self.clear.val() {
            self.gamut_q.d.next = 0.into();
            self.clamped_q.d.next = 0.into();
        }

        if self.reset.val() {
            self.next_valid.d.next = false;
            self.held_valid.d.next = false;
            self.odd.d.next = false;
            self.colour_q.d.next = false;
            self.right.d.next = false;
            self.starts.d.next = true;
            self.marks_0.d.next = 0.into();
            self.gamut_q.d.next = 0.into();
            self.clamped_q.d.next = 0.into();
        }
    }
}
