//! The whole way of a picture, from raw pixels to codes.

use super::display::Display;
use super::lines::Lines;
use super::table_reader::TableReader;
use super::window_reorder::WindowReorder;
use crate::blocks::Word;
use crate::blocks::chain::Chain;
use crate::blocks::frame_check::FrameCheck;
use crate::describe::{Circuit, kernel};
use edof_device::design::memory::SNAPSHOT_REGISTERS;
use edof_device::design::{Design, DesignError};
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// The whole way of a picture: lines of red-first raw frames in, lines of codes out, a pixel a beat.
/// What stands between them: windows, the calculator, overlap, lines, display. Frames follow one another without a pause.
#[derive(Circuit)]
#[circuit(default(TableReader), registers(clock, reset))]
pub struct StreamCore {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets the picture, and of what was written the calculator's registers; weights and tables stay. Held for 48 cycles or more.
    pub reset: Signal<In, Bit>,
    /// A reset leaves the calculator's registers and counters, too.
    pub preserve: Signal<In, Bit>,
    /// Forgets the picture too, but nothing that was written and no counter of the calculator. Held for as long as `reset`.
    pub flush: Signal<In, Bit>,
    /// The input raw pixel word is valid.
    pub pixels_valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub pixels_ready: Signal<Out, Bit>,
    /// The raw pixel word.
    pub pixels_data: Signal<In, Word>,
    /// The set of weights, looked at with each frame's first window.
    pub set: Signal<In, Bit>,
    /// Colour, or luma only, looked at with each frame's first codes.
    pub colour: Signal<In, Bit>,
    /// A pixel of codes stands on the output.
    pub picture_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub picture_ready: Signal<In, Bit>,
    /// Codes of the pixel: Y' low; high Cb' of the left pixel of a pair, Cr' of the right one.
    pub picture_data: Signal<Out, Word>,
    /// The pixel is the first of its frame.
    pub picture_user: Signal<Out, Bit>,
    /// The pixel is the last of its line.
    pub picture_last: Signal<Out, Bit>,
    /// A word of the calculator is to be written (`edof_device::design::memory::address`).
    pub write_valid: Signal<In, Bit>,
    /// Address of the word to write.
    pub write_address: Signal<In, Bits<25>>,
    /// Word to write.
    pub write_data: Signal<In, Bits<32>>,
    /// What of the calculator to show.
    pub status_address: Signal<In, Bits<7>>,
    /// Status word of the calculator, one cycle after its address.
    pub status: Signal<Out, Bits<32>>,
    /// A window was too short or too long.
    pub window_fault: Signal<Out, Bit>,
    /// Writes an entry of a display table.
    pub table_write: Signal<In, Bit>,
    /// Which: 0 luma, 1 red, 2 green, 3 blue.
    pub table_select: Signal<In, Bits<2>>,
    /// Entry.
    pub table_address: Signal<In, Bits<15>>,
    /// Word to write.
    pub table_data: Signal<In, Bits<12>>,
    /// Sets the three counters below to zero.
    pub clear: Signal<In, Bit>,
    /// Sums of overlapping patches that did not fit 16 bits.
    pub saturated_sums: Signal<Out, Bits<32>>,
    /// Chroma codes that were clamped (luma only).
    pub clamped_chroma: Signal<Out, Bits<32>>,
    /// Pixels with less than no or more than full light of a colour (colour).
    pub out_of_gamut: Signal<Out, Bits<32>>,
    /// Patches that left the calculator since reset.
    pub patches: Signal<Out, Bits<32>>,
    /// Cycles since reset in which a window or a patch stood at it.
    pub busy_cycles: Signal<Out, Bits<32>>,
    /// CRC-32 of the last whole frame's windows when the snapshot was taken.
    pub window_crc: Signal<Out, Bits<32>>,
    /// Which it was, modulo 256.
    pub window_frames: Signal<Out, Bits<8>>,
    /// The set of weights of the last patch.
    pub set_used: Signal<Out, Bit>,
    clear_state: Signal<Local, Bit>,
    #[reset(false)]
    set_q: DFF<Bit>,
    #[reset(false)]
    patch_done: DFF<Bit>,
    #[reset(false)]
    busy: DFF<Bit>,
    #[reset(0)]
    patches_q: DFF<Bits<32>>,
    #[reset(0)]
    busy_cycles_q: DFF<Bits<32>>,
    windows: WindowReorder,
    check: FrameCheck,
    snapshot_register: Constant<Bits<6>>,
    calculator: Chain,
    lines: Lines,
    display: Display,
    tables: TableReader,
}

impl StreamCore {
    /// The core of a design, its sets of weights starting with these networks, its display with these tables
    /// ([`Display::new`]).
    ///
    /// # Errors
    /// [`DesignError`] names what does not fit.
    pub fn new(
        design: &Design,
        sets: [&FixedNetwork; 2],
        luma: &[u64],
        colours: [&[u64]; 3],
    ) -> Result<Self, DesignError> {
        Ok(Self::from_parts(StreamCoreParts {
            windows: WindowReorder::of(design),
            check: FrameCheck::new(32, design.patches_per_frame() * design.stage(0).beats_in()),
            snapshot_register: Constant::new((SNAPSHOT_REGISTERS as u64).into()),
            calculator: Chain::checked(design, sets)?,
            lines: Lines::of(design),
            display: Display::new(luma, colours),
        }))
    }
}

impl Logic for StreamCore {
    #[kernel]
    fn update(&mut self) {
        self.windows.clock.next = self.clock.val();
        self.calculator.clock.next = self.clock.val();
        self.lines.clock.next = self.clock.val();
        self.display.clock.next = self.clock.val();
        self.clear_state.next = self.reset.val() || self.flush.val();
        self.windows.reset.next = self.clear_state.val();
        self.calculator.reset.next = self.reset.val() && !self.preserve.val();
        self.calculator.flush.next = self.clear_state.val();
        self.lines.reset.next = self.clear_state.val();
        self.display.reset.next = self.clear_state.val();

        self.windows.pixels_valid.next = self.pixels_valid.val();
        self.pixels_ready.next = self.windows.pixels_ready.val();
        self.windows.pixels_data.next = self.pixels_data.val();
        self.windows.set.next = self.set.val();

        self.calculator.window_valid.next = self.windows.out_valid.val();
        self.windows.out_ready.next = self.calculator.window_ready.val();
        self.calculator.window_data.next = self.windows.out_pixels.val();
        self.calculator.window_last.next = self.windows.out_last.val();
        self.calculator.window_set.next = self.windows.out_set.val();

        self.check.clock.next = self.clock.val();
        self.check.reset.next = self.clear_state.val();
        self.check.valid.next = self.windows.out_valid.val() && self.calculator.window_ready.val();
        self.check.data.next = self.windows.out_pixels.val();
        // The write that copies the counters of the stages copies this, too.
        self.check.snapshot.next = self.write_valid.val()
            && (self.write_address.val().get_bits::<6>(19) == self.snapshot_register.val());
        self.window_crc.next = self.check.crc.val();
        self.window_frames.next = self.check.frames.val();

        self.lines.valid.next = self.calculator.patch_valid.val();
        self.calculator.patch_ready.next = self.lines.ready.val();
        self.lines.data.next = self.calculator.patch_data.val();

        self.display.valid.next = self.lines.out_valid.val();
        self.lines.out_ready.next = self.display.ready.val();
        self.display.luma.next = self.lines.out_luma.val();
        self.display.chroma.next = self.lines.out_chroma.val();
        self.display.first.next = self.lines.out_first.val();
        self.display.last.next = self.lines.out_last.val();
        self.display.colour.next = self.colour.val();

        self.picture_valid.next = self.display.pixels_valid.val();
        self.display.pixels_ready.next = self.picture_ready.val();
        self.picture_data.next = self.display.pixels_data.val();
        self.picture_user.next = self.display.pixels_user.val();
        self.picture_last.next = self.display.pixels_last.val();

        // The host.
        self.calculator.write_valid.next = self.write_valid.val();
        self.calculator.write_address.next = self.write_address.val();
        self.calculator.write_data.next = self.write_data.val();
        self.calculator.status_address.next = self.status_address.val();
        self.status.next = self.calculator.status.val() | self.tables.status.val();
        self.window_fault.next = self.calculator.window_fault.val();
        self.tables.clock.next = self.clock.val();
        self.tables.reset.next = self.reset.val();
        self.tables.host_write.next = self.table_write.val();
        self.tables.host_select.next = self.table_select.val();
        self.tables.host_address.next = self.table_address.val();
        self.tables.host_data.next = self.table_data.val();
        self.tables.write_valid.next = self.write_valid.val();
        self.tables.write_address.next = self.write_address.val();
        self.tables.write_data.next = self.write_data.val();
        self.tables.status_address.next = self.status_address.val();
        self.tables.table_word.next = self.display.table_word.val();
        self.display.table_write.next = self.tables.table_write.val();
        self.display.table_select.next = self.tables.table_select.val();
        self.display.table_address.next = self.tables.table_address.val();
        self.display.table_data.next = self.tables.table_data.val();
        self.display.clear.next = self.clear.val();
        self.lines.clear.next = self.clear.val();
        self.saturated_sums.next = self.lines.saturated_sums.val();
        self.clamped_chroma.next = self.display.clamped_chroma.val();
        self.out_of_gamut.next = self.display.out_of_gamut.val();
        self.patch_done.d.next =
            self.calculator.patch_valid.val() && self.lines.ready.val() && self.calculator.patch_last.val();
        self.busy.d.next = self.windows.out_valid.val() || self.calculator.patch_valid.val();
        if self.calculator.patch_valid.val() {
            self.set_q.d.next = self.calculator.patch_set.val();
        }
        self.set_used.next = self.set_q.q.val();
        if self.patch_done.q.val() {
            self.patches_q.d.next = self.patches_q.q.val() + 1;
        }
        if self.busy.q.val() {
            self.busy_cycles_q.d.next = self.busy_cycles_q.q.val() + 1;
        }
        self.patches.next = self.patches_q.q.val();
        self.busy_cycles.next = self.busy_cycles_q.q.val();
    }
}
