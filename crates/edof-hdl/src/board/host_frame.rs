//! A raw frame that the host writes.

use crate::blocks::Row;
use crate::blocks::crc::Crc;
use crate::blocks::ram::{Ram, Shape};
use crate::describe::{Circuit, kernel};
use crate::ports::{StreamIn, StreamOut};
use edof_device::design::FrameSize;
use edof_device::host_frame::{MAX_BLOCK_PIXELS, block_lines};
use rust_hdl::prelude::*;

/// What becomes of a block.
#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Phase {
    /// The host writes it.
    Fill,
    /// Its words pass the CRC.
    Read,
    /// The CRC follows, and is compared.
    Judge,
    /// Its pixels leave.
    Send,
}

/// Pixels of the source, or in their place a frame of the host, block by block, one pixel in four cycles at most.
///
/// A block is some lines (`edof_device::host_frame`). The host writes its words, then its check. The block leaves
/// only if the check is right, so a frame has nothing but right blocks in order. With `select` 0 the source's
/// pixels pass without a register, from a frame's first pixel on. With 1 they are thrown away, as soon as none is
/// offered and not taken. Back to 0, a block in progress leaves first.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct HostFrame {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Begins anew.
    pub reset: Signal<In, Bit>,
    /// The host's frame in place of the source's.
    pub select: Signal<In, Bit>,
    /// A word of the host comes.
    pub write: Signal<In, Bit>,
    /// Which word: bit 11 is 0 for two pixels of the block; 1 for its check, or with bit 0 to restart the frame.
    pub address: Signal<In, Row>,
    /// The word.
    pub data: Signal<In, Bits<32>>,
    /// The source's pixels.
    pub source: StreamIn<16>,
    /// Pixels.
    pub pixels: StreamOut<16>,
    /// Register `frame_blocks`.
    pub blocks: Signal<Out, Bits<32>>,
    /// Register `frame_check`.
    pub check: Signal<Out, Bits<32>>,
    last_word: Constant<Row>,
    last_column: Constant<Bits<12>>,
    frame_blocks: Constant<Bits<16>>,
    ram: Ram<32>,
    crc: Crc,
    #[reset(false)]
    on: DFF<Bit>,
    // A frame of the source passes.
    #[reset(false)]
    in_frame: DFF<Bit>,
    #[reset(Phase::Fill)]
    phase: DFF<Phase>,
    #[reset(0)]
    accepted: DFF<Bits<16>>,
    #[reset(0)]
    check_q: DFF<Bits<32>>,
    expected: DFF<Bits<32>>,
    matches: DFF<Bit>,
    word: DFF<Row>,
    #[reset(false)]
    begins: DFF<Bit>,
    // A word was asked for one to four cycles ago: it is on the RAM's output two cycles after, in the CRC four.
    #[reset(0)]
    reads: DFF<Bits<4>>,
    pause: DFF<Bits<2>>,
    // The word's second pixel is next.
    is_second: DFF<Bit>,
    column: DFF<Bits<12>>,
    #[reset(true)]
    is_first: DFF<Bit>,
    #[reset(false)]
    valid: DFF<Bit>,
    pixel: DFF<Bits<16>>,
    first: DFF<Bit>,
    last: DFF<Bit>,
    passes: Signal<Local, Bit>,
    fills: Signal<Local, Bit>,
}

impl HostFrame {
    /// For frames of a size.
    ///
    /// # Panics
    /// For lines that no agent supports; the check of a design excludes them (`edof_device::board`).
    #[must_use]
    pub fn new(frame: FrameSize) -> Self {
        let lines = block_lines(frame.width, frame.height);
        let pixels = lines * frame.width;
        assert!(frame.width.is_multiple_of(2) && pixels <= MAX_BLOCK_PIXELS, "a block of {pixels} pixels");
        Self::from_parts(HostFrameParts {
            last_word: Constant::new((pixels as u64 / 2 - 1).into()),
            last_column: Constant::new((frame.width as u64 - 1).into()),
            frame_blocks: Constant::new(((frame.height / lines) as u64).into()),
            crc: Crc::new(32),
            ram: Ram::new(Shape::registered(MAX_BLOCK_PIXELS / 2), &[]),
        })
    }
}

impl Logic for HostFrame {
    #[kernel]
    fn update(&mut self) {
        self.ram.clock.next = self.clock.val();
        self.crc.clock.next = self.clock.val();

        // Words of the host, while no block is on its way.
        self.fills.next = self.write.val() && self.on.q.val() && (self.phase.q.val() == Phase::Fill);
        self.ram.write_enable.next = self.fills.val() && !self.address.val().get_bit(11);
        self.ram.write_address.next = self.address.val();
        self.ram.write_data.next = self.data.val();

        // The check before the block, then its words, into the CRC.
        self.begins.d.next = false;
        self.reads.d.next = self.reads.q.val() << 1;
        self.ram.read_address.next = self.word.q.val();
        self.crc.data.next = self.check_q.q.val();
        if self.reads.q.val().get_bit(1) {
            self.crc.data.next = self.ram.read_data.val();
        }
        self.crc.first.next = self.begins.q.val();
        self.crc.valid.next = self.begins.q.val() || self.reads.q.val().get_bit(2);
        self.matches.d.next = self.crc.crc.val() == self.expected.q.val();

        // What becomes of a block.
        match self.phase.q.val() {
            Phase::Fill => {
                self.word.d.next = 0.into();
                if self.fills.val() && self.address.val().get_bit(11) {
                    if self.address.val().get_bit(0) {
                        self.accepted.d.next = 0.into();
                        self.check_q.d.next = 0.into();
                        self.column.d.next = 0.into();
                        self.is_first.d.next = true;
                    } else if self.accepted.q.val() != self.frame_blocks.val() {
                        self.begins.d.next = true;
                        self.expected.d.next = self.data.val();
                        self.phase.d.next = Phase::Read;
                    }
                }
            }
            Phase::Read => {
                self.reads.d.next = (self.reads.q.val() << 1) | 1;
                self.word.d.next = self.word.q.val() + 1;
                if self.word.q.val() == self.last_word.val() {
                    self.word.d.next = 0.into();
                    self.phase.d.next = Phase::Judge;
                }
            }
            Phase::Judge => {
                self.pause.d.next = 0.into();
                self.is_second.d.next = false;
                if !self.reads.q.val().any() {
                    self.phase.d.next = Phase::Fill;
                    if self.matches.q.val() {
                        self.check_q.d.next = self.expected.q.val();
                        self.phase.d.next = Phase::Send;
                    }
                }
            }
            Phase::Send => {
                if self.valid.q.val() {
                    self.pause.d.next = 0.into();
                } else if self.pause.q.val() != 2 {
                    self.pause.d.next = self.pause.q.val() + 1;
                } else {
                    self.valid.d.next = true;
                    self.pixel.d.next = self.ram.read_data.val().get_bits::<16>(0);
                    self.first.d.next = self.is_first.q.val();
                    self.is_first.d.next = false;
                    self.last.d.next = self.column.q.val() == self.last_column.val();
                    self.column.d.next = self.column.q.val() + 1;
                    if self.column.q.val() == self.last_column.val() {
                        self.column.d.next = 0.into();
                    }
                    self.is_second.d.next = !self.is_second.q.val();
                    if self.is_second.q.val() {
                        self.pixel.d.next = self.ram.read_data.val().get_bits::<16>(16);
                        self.word.d.next = self.word.q.val() + 1;
                        if self.word.q.val() == self.last_word.val() {
                            self.word.d.next = 0.into();
                            self.accepted.d.next = self.accepted.q.val() + 1;
                            self.phase.d.next = Phase::Fill;
                        }
                    }
                }
            }
        }
        if self.valid.q.val() && self.pixels.ready.val() {
            self.valid.d.next = false;
        }

        // Whose pixels pass. What is offered stands until it is taken.
        self.passes.next = self.in_frame.q.val() || self.source.user.val();
        if self.source.valid.val() && self.source.user.val() {
            self.in_frame.d.next = true;
        }
        if self.on.q.val() {
            self.in_frame.d.next = false;
            // A block that begins in this cycle leaves first.
            if !self.select.val()
                && (self.phase.q.val() == Phase::Fill)
                && !self.valid.q.val()
                && !self.fills.val()
            {
                self.on.d.next = false;
            }
        } else {
            self.accepted.d.next = 0.into();
            self.check_q.d.next = 0.into();
            self.column.d.next = 0.into();
            self.is_first.d.next = true;
            if self.select.val()
                && !(self.source.valid.val() && self.passes.val() && !self.pixels.ready.val())
            {
                self.on.d.next = true;
            }
        }
        self.source.ready.next = self.pixels.ready.val() || self.on.q.val() || !self.passes.val();
        self.pixels.valid.next = self.source.valid.val() && self.passes.val();
        self.pixels.data.next = self.source.data.val();
        self.pixels.user.next = self.source.user.val();
        self.pixels.last.next = self.source.last.val();
        if self.on.q.val() {
            self.pixels.valid.next = self.valid.q.val();
            self.pixels.data.next = self.pixel.q.val();
            self.pixels.user.next = self.first.q.val();
            self.pixels.last.next = self.last.q.val();
        }
        self.check.next = self.check_q.q.val();
        self.blocks.next = bit_cast::<32, 16>(self.accepted.q.val());
        if self.phase.q.val() != Phase::Fill {
            self.blocks.next = bit_cast::<32, 16>(self.accepted.q.val()) | 0x1_0000;
        }
    }
}
