//! What the host sees of the board: the registers and windows of `edof_device::registers`.

use super::bank_guard::BankGuard;
use crate::describe::{Circuit, kernel};
use crate::ports::AxiLiteSlave;
use edof_device::design::Design;
use edof_device::registers::identity::{design_hash, weights_hash};
use edof_device::registers::map::{
    DISPLAY_TABLES, FRAME, PICTURE_PIXELS, REGISTERS, STAGE_COUNTERS, STAGE_READS, TILE_PIXELS, WEIGHT_SET,
    WEIGHTS,
};
use edof_device::registers::{Access, Register};
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// Where an access stands.
#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Phase {
    /// Waits for one.
    Idle,
    /// Looks whose word it is, and whether it carries its complement.
    Look,
    /// Finds out whether it may be written.
    Judge,
    /// Writes a register, or waits until a window has taken the word.
    Write,
    /// Sends the response to the write.
    WriteAnswer,
    /// Finds the register, or waits for what a stage shows.
    Read,
    /// Joins what was found.
    ReadJoin,
    /// Hands the word over.
    ReadAnswer,
}

/// The registers of the board behind AXI4-Lite: one access at a time, whole words.
///
/// A register is written four cycles after its word was taken, and read in three cycles. A window's word waits until it was taken, or found. Bits
/// that mean nothing read 0 and cannot be written. An address where nothing is, a part of a word, a read of what can only be written, and a
/// word that `protection` keeps out are answered with an error (2); the last are counted.
#[derive(Circuit)]
#[circuit(registers(clock))]
pub struct BoardRegisters {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Back to what the design was generated with.
    pub reset: Signal<In, Bit>,
    /// A reset leaves the bank in use and the hash of its network.
    pub preserve: Signal<In, Bit>,
    /// The host.
    pub bus: AxiLiteSlave,
    /// How the board is.
    pub status: Signal<In, Bits<32>>,
    /// Set-up of the chips on the board's bus.
    pub i2c_board: Signal<In, Bits<32>>,
    /// The size of the incoming picture.
    pub input_size: Signal<In, Bits<32>>,
    /// Set-up of the chips on the card's bus.
    pub i2c_card: Signal<In, Bits<32>>,
    /// The receiver's inputs.
    pub receiver: Signal<In, Bits<32>>,
    /// The size that it measures.
    pub receiver_size: Signal<In, Bits<32>>,
    /// What the receiver makes of the source's signal.
    pub receiver_format: Signal<In, Bits<32>>,
    /// The transmitter.
    pub transmitter: Signal<In, Bits<32>>,
    /// Raw frames that were written whole.
    pub input_frames: Signal<In, Bits<32>>,
    /// Raw frames that were begun and not completed: cable, wrong size or range, or a write that failed.
    pub input_broken: Signal<In, Bits<32>>,
    /// Frames on the cable that had another size than the design's.
    pub input_wrong: Signal<In, Bits<32>>,
    /// Frames on the cable that were given up because there was no room for a pixel.
    pub input_overruns: Signal<In, Bits<32>>,
    /// Bursts of raw frames that the memory answered with an error.
    pub input_write_errors: Signal<In, Bits<32>>,
    /// Raw frames that were begun to be read.
    pub raw_frames: Signal<In, Bits<32>>,
    /// Reads counted in `raw_frames` that repeat a frame because no newer one was complete.
    pub raw_late: Signal<In, Bits<32>>,
    /// Words of raw frames that came with an error.
    pub raw_read_errors: Signal<In, Bits<32>>,
    /// Cycles in which a window or a patch stood at the calculator.
    pub busy_cycles: Signal<In, Bits<32>>,
    /// Patches that left the calculator.
    pub patches: Signal<In, Bits<32>>,
    /// Sums of overlapping patches that did not fit 16 bits.
    pub saturated_sums: Signal<In, Bits<32>>,
    /// Chroma codes that were clamped (luma only).
    pub clamped_chroma: Signal<In, Bits<32>>,
    /// Pixels with less than no or more than full light of a colour (colour).
    pub out_of_gamut: Signal<In, Bits<32>>,
    /// Pictures that were written whole.
    pub picture_frames: Signal<In, Bits<32>>,
    /// Pictures that were begun and not completed.
    pub picture_broken: Signal<In, Bits<32>>,
    /// Bursts of pictures that the memory answered with an error.
    pub picture_write_errors: Signal<In, Bits<32>>,
    /// Pictures that were begun to be read.
    pub output_frames: Signal<In, Bits<32>>,
    /// Reads counted in `output_frames` that repeat a picture because no newer one was complete.
    pub output_late: Signal<In, Bits<32>>,
    /// Words of pictures that came with an error.
    pub output_read_errors: Signal<In, Bits<32>>,
    /// Pictures on the cable whose pixels came late.
    pub output_underruns: Signal<In, Bits<32>>,
    /// Frames on the UART that were given up, and bytes that were no command.
    pub uart_broken: Signal<In, Bits<32>>,
    /// Codes of line start and end that came inside of the pixels.
    pub input_codes: Signal<In, Bits<32>>,
    /// Words of such codes that were damaged.
    pub input_malformed: Signal<In, Bits<32>>,
    /// The answer to `chip_access`.
    pub chip_answer: Signal<In, Bits<32>>,
    /// Frames on the cable with a code outside of 64…191.
    pub input_range: Signal<In, Bits<32>>,
    /// CRC-32 of the last whole raw frame that the calculator took, as of the last snapshot.
    pub check_raw: Signal<In, Bits<32>>,
    /// Of its windows.
    pub check_windows: Signal<In, Bits<32>>,
    /// Of its codes.
    pub check_codes: Signal<In, Bits<32>>,
    /// Of the codes of a picture that left the memory.
    pub check_sent: Signal<In, Bits<32>>,
    /// Which frames these were, 8 bits each.
    pub check_frames: Signal<In, Bits<32>>,
    /// Cycles of the core's clock, of the input's, of the screen's.
    pub core_cycles: Signal<In, Bits<32>>,
    /// Of the input's.
    pub input_cycles: Signal<In, Bits<32>>,
    /// Of the screen's.
    pub screen_cycles: Signal<In, Bits<32>>,
    /// The first pixel of codes that the host can read.
    pub window_corner: Signal<Out, Bits<32>>,
    /// Writes a pixel of the tile; the pixel is in `weight_data`.
    pub tile_write: Signal<Out, Bit>,
    /// Pixel of the tile to write, or pixel of codes to read.
    pub tile_address: Signal<Out, Bits<12>>,
    /// Pixel of codes that is read, two cycles after its address.
    pub window_pixel: Signal<In, Bits<16>>,
    /// Writes a word of the host's frame: its place is in `tile_address`, the word in `weight_data`.
    pub frame_write: Signal<Out, Bit>,
    /// Blocks of the host's frame.
    pub frame_blocks: Signal<In, Bits<32>>,
    /// Its check.
    pub frame_check: Signal<In, Bits<32>>,
    /// What the board makes in place of raw frames.
    pub pattern: Signal<Out, Bits<32>>,
    /// What set-ups of the video chips use.
    pub video_setup: Signal<Out, Bits<32>>,
    /// What the host wants to read or write of a chip.
    pub chip_access: Signal<Out, Bits<32>>,
    /// Hash of the network in use.
    pub weights_hash: Signal<Out, Bits<32>>,
    /// What the host decides.
    pub control: Signal<Out, Bits<32>>,
    /// Holds what is written.
    pub scratch: Signal<Out, Bits<32>>,
    /// What of the calculator's stages to show: bit 6 what was read back, or a counter; stage (4 bits); which (2).
    pub stage_address: Signal<Out, Bits<7>>,
    /// A status word is requested.
    pub stage_valid: Signal<Out, Bit>,
    /// The requested status word is valid.
    pub stage_ready: Signal<In, Bit>,
    /// The requested status word.
    pub stage_counter: Signal<In, Bits<32>>,
    /// With `stage_ready`, `table_ready` or `weight_ready`: nothing was read or written, for the calculator's clock stands still.
    pub unreached: Signal<In, Bit>,
    /// The calculator's clock was lost: what its memories hold is in doubt until `weights_hash` is written.
    pub calculator_lost: Signal<In, Bit>,
    /// A word for a display table is offered.
    pub table_valid: Signal<Out, Bit>,
    /// The word for a display table is accepted.
    pub table_ready: Signal<In, Bit>,
    /// Table (2 bits) and entry (15).
    pub table_address: Signal<Out, Bits<17>>,
    /// The entry.
    pub table_data: Signal<Out, Bits<12>>,
    /// A word for the calculator is offered.
    pub weight_valid: Signal<Out, Bit>,
    /// The word for the calculator is accepted.
    pub weight_ready: Signal<In, Bit>,
    /// Where (`edof_device::design::memory::address`).
    pub weight_address: Signal<Out, Bits<25>>,
    /// Word to write.
    pub weight_data: Signal<Out, Bits<32>>,
    #[names(_registers)]
    addr: Vec<Constant<Bits<6>>>,
    #[literal]
    bits: Vec<Constant<Bits<32>>>,
    #[names(_registers)]
    start: Vec<Constant<Bits<32>>>,
    #[names(_windows)]
    base: [Constant<Bits<32>>; 7],
    #[names(_windows)]
    mask: [Constant<Bits<32>>; 7],
    phase: DFF<Phase>,
    address: DFF<Bits<32>>,
    word: DFF<Bits<32>>,
    is_bad: DFF<Bit>,
    // What the host decides.
    #[names(_controls)]
    host: [DFF<Bits<32>>; 8],
    // Where a word to write goes, known before it is judged.
    #[names(_controls)]
    at: [DFF<Bit>; 8],
    at_tables: DFF<Bit>,
    at_weights: DFF<Bit>,
    at_tile: DFF<Bit>,
    at_frame: DFF<Bit>,
    is_picture: DFF<Bit>,
    is_waiting: DFF<Bit>,
    guard: BankGuard,
    is_checked: DFF<Bit>,
    reject: DFF<Bit>,
    rejected_words: DFF<Bits<32>>,
    unchecked: DFF<Bit>,
    // A quarter of the registers each: one multiplexer for all is too long a path.
    found: [DFF<Bits<32>>; 4],
    found_any: DFF<Bit>,
    is_stage: DFF<Bit>,
    result: DFF<Bits<32>>,
    #[names(_registers)]
    value: Vec<Signal<Local, Bits<32>>>,
    at_any: Signal<Local, Bit>,
    is_unchecked: Signal<Local, Bit>,
    is_locked: Signal<Local, Bit>,
    is_protected: Signal<Local, Bit>,
    bank_only: Constant<Bits<32>>,
    in_area: Signal<Local, Bit>,
    #[names(_windows)]
    is_in: [Signal<Local, Bit>; 7],
    stage_word: Signal<Local, Bits<7>>,
    grant_write: Signal<Local, Bit>,
    grant_read: Signal<Local, Bit>,
    _count: usize,
    _registers: Vec<&'static str>,
    _controls: Vec<&'static str>,
    _windows: Vec<&'static str>,
}

/// What differs from design to design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Identity {
    /// First 32 bits of the SHA-256 of the design.
    pub design_hash: u32,
    /// First 32 bits of the hash of the network that it starts with.
    pub weights_hash: u32,
    /// Columns and rows of its frame.
    pub frame: (u16, u16),
}

impl Identity {
    /// Returns the identity of a design that starts with a network.
    #[must_use]
    pub fn of(design: &Design, network: &FixedNetwork) -> Self {
        Self {
            design_hash: design_hash(design),
            weights_hash: weights_hash(design, network),
            frame: (design.frame.width as u16, design.frame.height as u16),
        }
    }
}

impl BoardRegisters {
    /// The registers of a design.
    #[must_use]
    pub fn new(design: &Design, identity: &Identity) -> Self {
        let constant = |value: u32| Constant::new(u64::from(value).into());
        let start = |name: &str, reset: u32| match name {
            "design_hash" => identity.design_hash,
            "frame_size" => u32::from(identity.frame.0) | u32::from(identity.frame.1) << 16,
            "weights_hash" => identity.weights_hash,
            _ => reset,
        };
        let windows =
            [STAGE_COUNTERS, DISPLAY_TABLES, WEIGHTS, STAGE_READS, TILE_PIXELS, PICTURE_PIXELS, FRAME];
        let word = |register: &Register| Constant::new((u64::from(register.address) / 4).into());
        let controls = REGISTERS.iter().filter(|register| register.access == Access::Control);
        Self::from_parts(BoardRegistersParts {
            addr: REGISTERS.iter().map(word).collect(),
            bits: REGISTERS.iter().map(|register| constant(register.mask())).collect(),
            start: REGISTERS.iter().map(|register| constant(start(register.name, register.reset))).collect(),
            base: windows.map(|window| constant(window.address)),
            mask: windows.map(|window| constant(!(window.bytes - 1))),
            guard: BankGuard::new(design),
            bank_only: constant(WEIGHT_SET),
            value: REGISTERS.iter().map(|_| Signal::default()).collect(),
            _count: REGISTERS.len(),
            _registers: REGISTERS.iter().map(|register| register.name).collect(),
            _controls: controls.map(|register| register.name).collect(),
            _windows: windows.iter().map(|window| window.name).collect(),
        })
    }
}

impl Logic for BoardRegisters {
    #[kernel]
    fn update(&mut self) {
        for i in 0..8 {
            self.host[i].clock.next = self.clock.val();
            self.host[i].d.next = self.host[i].q.val();
            self.at[i].clock.next = self.clock.val();
        }
        for i in 0..4 {
            self.found[i].clock.next = self.clock.val();
        }

        // An access is taken: writes first.
        self.grant_write.next =
            (self.phase.q.val() == Phase::Idle) && self.bus.aw_valid.val() && self.bus.w_valid.val();
        self.grant_read.next =
            (self.phase.q.val() == Phase::Idle) && self.bus.ar_valid.val() && !self.grant_write.val();
        if self.grant_write.val() {
            self.address.d.next = self.bus.aw_addr.val();
            self.word.d.next = self.bus.w_data.val();
            self.is_bad.d.next =
                (self.bus.w_strb.val() != 15) || self.bus.aw_addr.val().get_bits::<2>(0).any();
        } else if self.grant_read.val() {
            self.address.d.next = self.bus.ar_addr.val();
            self.is_bad.d.next = self.bus.ar_addr.val().get_bits::<2>(0).any();
        }
        self.in_area.next = !self.address.q.val().get_bits::<24>(8).any();
        for i in 0..7 {
            self.is_in[i].next = (self.address.q.val() & self.mask[i].val()) == self.base[i].val();
        }

        // What all registers hold, in the order of the map: constants, what the host decides, what the board says.
        for i in 0..4 {
            self.value[i].next = self.start[i].val();
        }
        for i in 4..8 {
            self.value[i].next = self.host[i - 4].q.val();
        }
        self.value[8].next = self.status.val();
        if self.unchecked.q.val() {
            self.value[8].next = self.status.val() | 0x200;
        }
        self.value[9].next = self.i2c_board.val();
        self.value[10].next = self.input_size.val();
        self.value[11].next = self.i2c_card.val();
        self.value[12].next = self.receiver.val();
        self.value[13].next = self.receiver_size.val();
        self.value[14].next = self.receiver_format.val();
        self.value[15].next = self.transmitter.val();
        self.value[16].next = self.input_frames.val();
        self.value[17].next = self.input_broken.val();
        self.value[18].next = self.input_wrong.val();
        self.value[19].next = self.input_overruns.val();
        self.value[20].next = self.input_write_errors.val();
        self.value[21].next = self.raw_frames.val();
        self.value[22].next = self.raw_late.val();
        self.value[23].next = self.raw_read_errors.val();
        self.value[24].next = self.busy_cycles.val();
        self.value[25].next = self.patches.val();
        self.value[26].next = self.saturated_sums.val();
        self.value[27].next = self.clamped_chroma.val();
        self.value[28].next = self.out_of_gamut.val();
        self.value[29].next = self.picture_frames.val();
        self.value[30].next = self.picture_broken.val();
        self.value[31].next = self.picture_write_errors.val();
        self.value[32].next = self.output_frames.val();
        self.value[33].next = self.output_late.val();
        self.value[34].next = self.output_read_errors.val();
        self.value[35].next = self.output_underruns.val();
        self.value[36].next = self.uart_broken.val();
        self.value[37].next = self.rejected_words.q.val();
        self.value[38].next = self.input_codes.val();
        self.value[39].next = self.input_malformed.val();
        self.value[40].next = self.host[4].q.val();
        self.value[41].next = self.host[5].q.val();
        self.value[42].next = self.chip_answer.val();
        self.value[43].next = self.input_range.val();
        self.value[44].next = self.host[6].q.val();
        self.value[45].next = self.check_raw.val();
        self.value[46].next = self.check_windows.val();
        self.value[47].next = self.check_codes.val();
        self.value[48].next = self.check_sent.val();
        self.value[49].next = self.check_frames.val();
        self.value[50].next = self.core_cycles.val();
        self.value[51].next = self.input_cycles.val();
        self.value[52].next = self.screen_cycles.val();
        self.value[53].next = self.host[7].q.val();
        self.value[54].next = self.frame_blocks.val();
        self.value[55].next = self.frame_check.val();

        // The register at the address, in the quarter that it belongs to.
        for i in 0..4 {
            self.found[i].d.next = 0.into();
        }
        self.found_any.d.next = false;
        for i in 0..self._count {
            if self.address.q.val().get_bits::<6>(2) == self.addr[i].val() {
                self.found[i / 14].d.next = self.value[i].val() & self.bits[i].val();
                self.found_any.d.next = self.in_area.val();
            }
        }
        self.is_picture.d.next = self.is_in[5].val();
        self.is_stage.d.next = self.is_in[0].val() || self.is_in[3].val();

        // What protection keeps out: words of the bank in use or of both, of tables in use, and words that should carry their complement.
        self.guard.clock.next = self.clock.val();
        self.guard.address.next = self.address.q.val().get_bits::<25>(2);
        self.guard.set.next = self.host[1].q.val().get_bit(2);
        self.guard.both.next = self.host[3].q.val().get_bit(2);
        self.is_checked.d.next =
            (self.word.q.val().get_bits::<16>(16) ^ self.word.q.val().get_bits::<16>(0)) == 0xffff;
        for i in 4..8 {
            self.at[i - 4].d.next =
                self.in_area.val() && (self.address.q.val().get_bits::<6>(2) == self.addr[i].val());
        }
        for i in 40..42 {
            self.at[i - 36].d.next =
                self.in_area.val() && (self.address.q.val().get_bits::<6>(2) == self.addr[i].val());
        }
        self.at[6].d.next =
            self.in_area.val() && (self.address.q.val().get_bits::<6>(2) == self.addr[44].val());
        self.at[7].d.next =
            self.in_area.val() && (self.address.q.val().get_bits::<6>(2) == self.addr[53].val());
        self.at_tile.d.next = self.is_in[4].val();
        self.at_frame.d.next = self.is_in[6].val();
        self.at_tables.d.next = self.is_in[1].val();
        self.at_weights.d.next = self.is_in[2].val();
        self.at_any.next = self.at[0].q.val()
            || self.at[1].q.val()
            || self.at[2].q.val()
            || self.at[3].q.val()
            || self.at[4].q.val()
            || self.at[5].q.val()
            || self.at[6].q.val()
            || self.at[7].q.val();
        self.is_unchecked.next = !self.is_checked.q.val()
            && ((self.at[1].q.val() && self.host[3].q.val().get_bit(1)) || self.at[3].q.val());
        self.is_locked.next = self.host[3].q.val().get_bit(0)
            && ((self.at_tables.q.val() && self.host[1].q.val().get_bit(0))
                || (self.at_weights.q.val() && self.guard.hits.val()));
        self.is_protected.next = false;
        if self.reject.q.val() {
            self.rejected_words.d.next = self.rejected_words.q.val() + 1;
        }

        self.table_valid.next = false;
        self.weight_valid.next = false;
        self.tile_write.next = false;
        self.frame_write.next = false;
        self.stage_valid.next = false;
        match self.phase.q.val() {
            Phase::Idle => {
                if self.grant_write.val() {
                    self.phase.d.next = Phase::Look;
                } else if self.grant_read.val() {
                    self.phase.d.next = Phase::Read;
                }
            }
            Phase::Look => {
                self.phase.d.next = Phase::Judge;
            }
            Phase::Judge => {
                self.phase.d.next = Phase::Write;
            }
            Phase::Write => {
                // Of all addresses this one alone is neither locked nor checked: what decides about others is too long a way.
                if self.at[0].q.val() && !self.is_bad.q.val() {
                    self.unchecked.d.next = false;
                }
                if self.is_bad.q.val() {
                    self.phase.d.next = Phase::WriteAnswer;
                } else if self.is_locked.val() {
                    self.is_protected.next = true;
                    self.phase.d.next = Phase::WriteAnswer;
                } else if self.at_tables.q.val() {
                    self.table_valid.next = true;
                    if self.table_ready.val() {
                        self.is_bad.d.next = self.unreached.val();
                        self.phase.d.next = Phase::WriteAnswer;
                    }
                } else if self.at_weights.q.val() {
                    self.weight_valid.next = true;
                    if self.weight_ready.val() {
                        self.is_bad.d.next = self.unreached.val();
                        self.phase.d.next = Phase::WriteAnswer;
                    }
                } else if self.at_tile.q.val() {
                    self.tile_write.next = true;
                    self.phase.d.next = Phase::WriteAnswer;
                } else if self.at_frame.q.val() {
                    self.frame_write.next = true;
                    self.phase.d.next = Phase::WriteAnswer;
                } else {
                    self.phase.d.next = Phase::WriteAnswer;
                    self.is_protected.next = self.is_unchecked.val();
                    if !self.is_unchecked.val() {
                        for i in 4..8 {
                            if self.at[i - 4].q.val() {
                                self.host[i - 4].d.next = self.word.q.val() & self.bits[i].val();
                            }
                        }
                        for i in 40..42 {
                            if self.at[i - 36].q.val() {
                                self.host[i - 36].d.next = self.word.q.val() & self.bits[i].val();
                            }
                        }
                        if self.at[6].q.val() {
                            self.host[6].d.next = self.word.q.val() & self.bits[44].val();
                        }
                        if self.at[7].q.val() {
                            self.host[7].d.next = self.word.q.val() & self.bits[53].val();
                        }
                    }
                    self.is_bad.d.next = !self.at_any.val();
                }
            }
            Phase::WriteAnswer => {
                if self.bus.b_ready.val() {
                    self.phase.d.next = Phase::Idle;
                }
            }
            Phase::Read => {
                // A pixel of codes comes a cycle later than all else.
                self.is_waiting.d.next = self.is_in[5].val();
                if self.is_waiting.q.val() || !self.is_in[5].val() {
                    self.is_waiting.d.next = false;
                    self.phase.d.next = Phase::ReadJoin;
                }
            }
            Phase::ReadJoin => {
                self.phase.d.next = Phase::ReadAnswer;
                self.result.d.next = 0.into();
                if self.is_bad.q.val()
                    || !(self.found_any.q.val() || self.is_stage.q.val() || self.is_picture.q.val())
                {
                    self.is_bad.d.next = true;
                } else if self.is_stage.q.val() {
                    self.stage_valid.next = true;
                    self.result.d.next = self.stage_counter.val();
                    self.is_bad.d.next = self.stage_ready.val() && self.unreached.val();
                    if !self.stage_ready.val() {
                        self.phase.d.next = Phase::ReadJoin;
                    }
                } else if self.is_picture.q.val() {
                    self.result.d.next = bit_cast::<32, 16>(self.window_pixel.val());
                } else {
                    self.result.d.next = self.found[0].q.val()
                        | self.found[1].q.val()
                        | self.found[2].q.val()
                        | self.found[3].q.val();
                }
            }
            Phase::ReadAnswer => {
                if self.bus.r_ready.val() {
                    self.phase.d.next = Phase::Idle;
                }
            }
        }
        self.reject.d.next = self.is_protected.val();
        if self.is_protected.val() {
            self.is_bad.d.next = true;
        }
        if self.reset.val() {
            self.phase.d.next = Phase::Idle;
            self.reject.d.next = false;
            self.is_waiting.d.next = false;
            self.rejected_words.d.next = 0.into();
            self.unchecked.d.next = self.preserve.val() && self.unchecked.q.val();
            for i in 4..8 {
                self.host[i - 4].d.next = self.start[i].val();
            }
            for i in 40..42 {
                self.host[i - 36].d.next = self.start[i].val();
            }
            self.host[6].d.next = self.start[44].val();
            self.host[7].d.next = self.start[53].val();
            if self.preserve.val() {
                self.host[0].d.next = self.host[0].q.val();
                self.host[1].d.next = self.start[5].val() | (self.host[1].q.val() & self.bank_only.val());
            }
        }

        if self.calculator_lost.val() {
            self.unchecked.d.next = true;
        }

        self.bus.aw_ready.next = self.grant_write.val();
        self.bus.w_ready.next = self.grant_write.val();
        self.bus.b_valid.next = self.phase.q.val() == Phase::WriteAnswer;
        self.bus.b_resp.next = 0.into();
        self.bus.ar_ready.next = self.grant_read.val();
        self.bus.r_valid.next = self.phase.q.val() == Phase::ReadAnswer;
        self.bus.r_data.next = self.result.q.val();
        self.bus.r_resp.next = 0.into();
        if self.is_bad.q.val() {
            self.bus.b_resp.next = 2.into();
            self.bus.r_resp.next = 2.into();
        }
        self.weights_hash.next = self.host[0].q.val();
        self.control.next = self.host[1].q.val();
        self.scratch.next = self.host[2].q.val();
        self.video_setup.next = self.host[4].q.val();
        self.chip_access.next = self.host[5].q.val();
        self.pattern.next = self.host[6].q.val();
        self.window_corner.next = self.host[7].q.val();
        self.tile_address.next = self.address.q.val().get_bits::<12>(2);
        self.stage_word.next = bit_cast::<7, 6>(self.address.q.val().get_bits::<6>(2));
        if self.is_in[3].val() {
            self.stage_word.next = bit_cast::<7, 6>(self.address.q.val().get_bits::<6>(2)) | 0x40;
        }
        self.stage_address.next = self.stage_word.val();
        self.table_address.next = self.address.q.val().get_bits::<17>(2);
        self.table_data.next = self.word.q.val().get_bits::<12>(0);
        self.weight_address.next = self.address.q.val().get_bits::<25>(2);
        self.weight_data.next = self.word.q.val();
    }
}
