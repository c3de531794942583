//! The board without what belongs to a vendor: between the pins' clocks and the memory's port.

use super::clock_watch::ClockWatch;
use super::{AxiPair, BoardRegisters, Frames, Identity, ReadAgent, WriteAgent};
use crate::crossing::{BusSync, PixelFifo, ResetSync};
use crate::describe::Circuit;
use crate::ports::{AxiLiteSlave, AxiReadMaster, AxiWriteMaster, StreamOut};
use crate::video::stream_core::StreamCore;
use crate::video::video_in::VideoIn;
use crate::video::video_out::VideoOut;
use edof_spec::FixedNetwork;
use edof_spec::design::{Design, DesignError};
use edof_spec::video::VideoTiming;
use rust_hdl::prelude::*;

/// The board without what belongs to a vendor: raw pixels from a receiver's pins by way of memory to the calculator, its picture by way of
/// memory to a transmitter's pins; and the host's registers.
///
/// Three clocks that have nothing to do with each other: the receiver's, the transmitter's, and that of the core, the memory and the host.
/// `reset` may come from any domain; each has its own. While the receiver's clock stands still its domain is in reset, so that no
/// picture is made of the halves of two. Memory words have `W` bits, `S` bytes.
#[derive(Circuit)]
#[circuit(default(ResetSync, ClockWatch, BusSync, AxiPair))]
pub struct EdofCore<const W: usize, const S: usize> {
    /// Clock of the core, the memory and the host.
    pub clock: Signal<In, Clock>,
    /// Forgets everything but weights and tables.
    pub reset: Signal<In, Bit>,
    /// The receiver's pixel clock.
    pub input_clock: Signal<In, Clock>,
    /// Its horizontal sync.
    pub input_hs: Signal<In, Bit>,
    /// Its vertical sync.
    pub input_vs: Signal<In, Bit>,
    /// A pixel lies on its bus.
    pub input_de: Signal<In, Bit>,
    /// It: the raw pixel word's upper byte low.
    pub input_data: Signal<In, Bits<16>>,
    /// The transmitter's pixel clock.
    pub output_clock: Signal<In, Clock>,
    /// Its horizontal sync.
    pub output_hs: Signal<Out, Bit>,
    /// Its vertical sync.
    pub output_vs: Signal<Out, Bit>,
    /// A pixel lies on its bus.
    pub output_de: Signal<Out, Bit>,
    /// It: Y' low, Cb' or Cr' high.
    pub output_data: Signal<Out, Bits<16>>,
    /// Frames into memory.
    pub dram_write: AxiWriteMaster<W, S>,
    /// Frames out of memory.
    pub dram_read: AxiReadMaster<W>,
    /// The memory is calibrated.
    pub dram_ready: Signal<In, Bit>,
    /// The host.
    pub bus: AxiLiteSlave,
    /// Frames on the host's line that were given up.
    pub uart_broken: Signal<In, Bits<32>>,
    /// Register `i2c`: where the set-up of the video chips stands.
    pub i2c: Signal<In, Bits<32>>,
    /// All of them are set up.
    pub i2c_done: Signal<In, Bit>,
    /// One did not answer.
    pub i2c_failed: Signal<In, Bit>,
    /// Set them up once more, on a rise.
    pub i2c_restart: Signal<Out, Bit>,
    /// What the host holds of `status`, for lamps.
    pub status: Signal<Out, Bits<32>>,
    request: Signal<Local, Bit>,
    waits: Signal<Local, Bit>,
    shown: DFF<Bit>,
    status_now: Signal<Local, Bits<32>>,
    core_reset: ResetSync,
    input_reset: ResetSync,
    input_reset_here: ResetSync,
    output_reset: ResetSync,
    watch: ClockWatch,
    video_in: VideoIn,
    input_fifo: PixelFifo,
    raw_writer: WriteAgent<W, S>,
    raw_reader: ReadAgent<W>,
    core: StreamCore,
    picture_writer: WriteAgent<W, S>,
    picture_reader: ReadAgent<W>,
    output_fifo: PixelFifo,
    video_out: VideoOut,
    memory: AxiPair<W, S>,
    registers: BoardRegisters,
    input_state: BusSync<28>,
    input_counts: BusSync<64>,
    output_state: BusSync<64>,
}

/// What the core of a design is made of, besides its circuits.
#[derive(Debug, Clone, Copy)]
pub struct Contents<'a> {
    /// The networks that its two sets of weights start with.
    pub sets: [&'a FixedNetwork; 2],
    /// Luma codes that the display starts with.
    pub luma: &'a [u64],
    /// Encoded red, green and blue that it starts with.
    pub colours: [&'a [u64]; 3],
    /// What its registers say of it.
    pub identity: Identity,
}

/// How the core of a design uses the memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MemoryUse {
    /// Words of a burst.
    pub burst: usize,
    /// Words that an agent holds.
    pub depth: usize,
}

/// Pixels between the clock domains, as a power of two.
const FIFO: usize = 6;

impl<const W: usize, const S: usize> EdofCore<W, S> {
    /// The core of a design for a timing of receiver and transmitter.
    ///
    /// # Errors
    /// [`DesignError`] names what does not fit.
    pub fn new(
        design: &Design,
        timing: VideoTiming,
        memory: MemoryUse,
        contents: &Contents<'_>,
    ) -> Result<Self, DesignError> {
        let frame = design.frame;
        let pixels = W / 16;
        if !(frame.width * frame.height).is_multiple_of(pixels) {
            return Err(DesignError::Field {
                field: "frame".into(),
                value: format!("{}x{}", frame.width, frame.height),
                expected: format!("a whole number of memory words, each of {pixels} pixels"),
            });
        }
        let bytes = (2 * frame.width * frame.height).next_multiple_of(1 << 12) as u32;
        let frames = |set: u32| Frames {
            width: frame.width,
            height: frame.height,
            buffers: [0, 1, 2].map(|buffer| (3 * set + buffer) * bytes),
            burst: memory.burst,
            depth: memory.depth,
        };
        // Without a vertical sync for two frames there is no signal.
        let patience = (2 * timing.line.total() * timing.frame.total()).min((1 << 24) - 1) as u32;
        Ok(Self::from_parts(EdofCoreParts {
            video_in: VideoIn::new(frame, patience),
            input_fifo: PixelFifo::new(FIFO),
            raw_writer: WriteAgent::new(&frames(0)),
            raw_reader: ReadAgent::new(&frames(0), false),
            core: StreamCore::new(design, contents.sets, contents.luma, contents.colours)?,
            picture_writer: WriteAgent::new(&frames(1)),
            picture_reader: ReadAgent::new(&frames(1), true),
            output_fifo: PixelFifo::new(FIFO),
            video_out: VideoOut::new(timing),
            registers: BoardRegisters::new(&contents.identity),
        }))
    }
}

impl<const W: usize, const S: usize> Logic for EdofCore<W, S> {
    #[hdl_gen]
    fn update(&mut self) {
        // Domains. The receiver's is in reset while its clock stands still, on both sides of its FIFO.
        self.core_reset.clock.next = self.clock.val();
        self.core_reset.reset.next = self.reset.val();
        self.output_reset.clock.next = self.output_clock.val();
        self.output_reset.reset.next = self.reset.val();
        self.watch.clock.next = self.clock.val();
        self.watch.watched.next = self.input_clock.val();
        self.watch.reset.next = self.core_reset.domain_reset.val();
        self.request.next = self.reset.val() || self.watch.stopped.val();
        self.input_reset.clock.next = self.input_clock.val();
        self.input_reset.reset.next = self.request.val();
        self.input_reset_here.clock.next = self.clock.val();
        self.input_reset_here.reset.next = self.request.val();

        // The receiver.
        self.video_in.clock.next = self.input_clock.val();
        self.video_in.reset.next = self.input_reset.domain_reset.val();
        self.video_in.hs.next = self.input_hs.val();
        self.video_in.vs.next = self.input_vs.val();
        self.video_in.de.next = self.input_de.val();
        self.video_in.data.next = self.input_data.val();
        self.input_fifo.from_clock.next = self.input_clock.val();
        self.input_fifo.from_reset.next = self.input_reset.domain_reset.val();
        self.input_fifo.to_clock.next = self.clock.val();
        self.input_fifo.to_reset.next = self.input_reset_here.domain_reset.val();
        self.input_fifo.from.valid.next = self.video_in.pixels_valid.val();
        self.input_fifo.from.data.next = self.video_in.pixels_data.val();
        self.input_fifo.from.user.next = self.video_in.pixels_user.val();
        self.input_fifo.from.last.next = self.video_in.pixels_last.val();
        self.video_in.pixels_ready.next = self.input_fifo.from.ready.val();

        // Raw frames by way of memory to the calculator. Between two frames they wait while the host says so.
        self.raw_writer.clock.next = self.clock.val();
        self.raw_writer.reset.next = self.core_reset.domain_reset.val();
        StreamOut::<16>::join(&mut self.input_fifo.to, &mut self.raw_writer.pixels);
        self.raw_reader.clock.next = self.clock.val();
        self.raw_reader.reset.next = self.core_reset.domain_reset.val();
        self.raw_writer.reading.next = self.raw_reader.reading.val();
        self.raw_reader.newest.next = self.raw_writer.newest.val();
        self.core.clock.next = self.clock.val();
        self.core.reset.next = self.core_reset.domain_reset.val();
        self.waits.next = self.raw_reader.pixels.user.val() && !self.registers.control.val().get_bit(0);
        self.core.pixels_valid.next = self.raw_reader.pixels.valid.val() && !self.waits.val();
        self.core.pixels_data.next = self.raw_reader.pixels.data.val();
        self.raw_reader.pixels.ready.next = self.core.pixels_ready.val() && !self.waits.val();
        self.core.colour.next = self.registers.control.val().get_bit(1);
        self.core.set.next = self.registers.control.val().get_bit(2);

        // Pictures by way of memory to the transmitter.
        self.picture_writer.clock.next = self.clock.val();
        self.picture_writer.reset.next = self.core_reset.domain_reset.val();
        self.picture_writer.pixels.valid.next = self.core.picture_valid.val();
        self.picture_writer.pixels.data.next = self.core.picture_data.val();
        self.picture_writer.pixels.user.next = self.core.picture_user.val();
        self.picture_writer.pixels.last.next = self.core.picture_last.val();
        self.core.picture_ready.next = self.picture_writer.pixels.ready.val();
        self.picture_reader.clock.next = self.clock.val();
        self.picture_reader.reset.next = self.core_reset.domain_reset.val();
        self.picture_writer.reading.next = self.picture_reader.reading.val();
        self.picture_reader.newest.next = self.picture_writer.newest.val();
        self.output_fifo.from_clock.next = self.clock.val();
        self.output_fifo.from_reset.next = self.core_reset.domain_reset.val();
        self.output_fifo.to_clock.next = self.output_clock.val();
        self.output_fifo.to_reset.next = self.output_reset.domain_reset.val();
        StreamOut::<16>::join(&mut self.picture_reader.pixels, &mut self.output_fifo.from);
        self.video_out.clock.next = self.output_clock.val();
        self.video_out.reset.next = self.output_reset.domain_reset.val();
        self.video_out.pixels_valid.next = self.output_fifo.to.valid.val();
        self.video_out.pixels_data.next = self.output_fifo.to.data.val();
        self.video_out.pixels_user.next = self.output_fifo.to.user.val();
        self.video_out.pixels_last.next = self.output_fifo.to.last.val();
        self.output_fifo.to.ready.next = self.video_out.pixels_ready.val();
        self.output_hs.next = self.video_out.hs.val();
        self.output_vs.next = self.video_out.vs.val();
        self.output_de.next = self.video_out.de.val();
        self.output_data.next = self.video_out.data.val();

        // Memory.
        self.memory.clock.next = self.clock.val();
        self.memory.reset.next = self.core_reset.domain_reset.val();
        AxiWriteMaster::<W, S>::join(&mut self.raw_writer.dram, &mut self.memory.write_0);
        AxiWriteMaster::<W, S>::join(&mut self.picture_writer.dram, &mut self.memory.write_1);
        AxiReadMaster::<W>::join(&mut self.raw_reader.dram, &mut self.memory.read_0);
        AxiReadMaster::<W>::join(&mut self.picture_reader.dram, &mut self.memory.read_1);
        AxiWriteMaster::<W, S>::link(&mut self.dram_write, &mut self.memory.dram_write);
        AxiReadMaster::<W>::link(&mut self.dram_read, &mut self.memory.dram_read);

        // The host.
        self.registers.clock.next = self.clock.val();
        self.registers.reset.next = self.core_reset.domain_reset.val();
        AxiLiteSlave::link(&mut self.bus, &mut self.registers.bus);
        self.core.status_address.next = self.registers.stage_address.val();
        self.registers.stage_counter.next = self.core.status.val();
        self.core.table_write.next = self.registers.table_valid.val();
        self.core.table_select.next = self.registers.table_address.val().get_bits::<2>(15);
        self.core.table_address.next = self.registers.table_address.val().get_bits::<15>(0);
        self.core.table_data.next = self.registers.table_data.val();
        self.registers.table_ready.next = true;
        self.core.write_valid.next = self.registers.weight_valid.val();
        self.registers.weight_ready.next = true;
        self.core.write_address.next = self.registers.weight_address.val();
        self.core.write_data.next = self.registers.weight_data.val();
        self.core.clear.next = false;
        self.i2c_restart.next = self.registers.control.val().get_bit(3);

        // What it sees. Words of other domains come whole: 0 to 12 width, 13 to 25 height, 26 present, 27 fits; two counters.
        self.input_state.from_clock.next = self.input_clock.val();
        self.input_state.from_reset.next = self.input_reset.domain_reset.val();
        self.input_state.to_clock.next = self.clock.val();
        self.input_state.to_reset.next = self.input_reset_here.domain_reset.val();
        self.input_state.valid.next = true;
        self.input_state.word.next = (bit_cast::<28, 1>(self.video_in.fits.val().into()) << 27)
            | (bit_cast::<28, 1>(self.video_in.present.val().into()) << 26)
            | (bit_cast::<28, 13>(self.video_in.height.val()) << 13)
            | bit_cast::<28, 13>(self.video_in.width.val());
        self.input_counts.from_clock.next = self.input_clock.val();
        self.input_counts.from_reset.next = self.input_reset.domain_reset.val();
        self.input_counts.to_clock.next = self.clock.val();
        self.input_counts.to_reset.next = self.input_reset_here.domain_reset.val();
        self.input_counts.valid.next = true;
        self.input_counts.word.next = (bit_cast::<64, 32>(self.video_in.overruns.val()) << 32)
            | bit_cast::<64, 32>(self.video_in.wrong_frames.val());
        self.output_state.from_clock.next = self.output_clock.val();
        self.output_state.from_reset.next = self.output_reset.domain_reset.val();
        self.output_state.to_clock.next = self.clock.val();
        self.output_state.to_reset.next = self.core_reset.domain_reset.val();
        self.output_state.valid.next = true;
        self.output_state.word.next = (bit_cast::<64, 32>(self.video_out.late_pixels.val()) << 32)
            | bit_cast::<64, 32>(self.video_out.shown_frames.val());

        // Registers.
        dff_setup!(self, clock, shown);
        if self.output_state.arrived.val().get_bits::<32>(0).any() {
            self.shown.d.next = true;
        }
        if self.core_reset.domain_reset.val() {
            self.shown.d.next = false;
        }
        self.status_now.next = bit_cast::<32, 1>(self.dram_ready.val().into())
            | (bit_cast::<32, 1>(self.input_state.arrived.val().get_bits::<1>(26)) << 1)
            | (bit_cast::<32, 1>(self.input_state.arrived.val().get_bits::<1>(27)) << 2)
            | (bit_cast::<32, 1>(self.shown.q.val().into()) << 3)
            | (bit_cast::<32, 1>(self.i2c_done.val().into()) << 4)
            | (bit_cast::<32, 1>(self.i2c_failed.val().into()) << 5)
            | (bit_cast::<32, 1>(self.core.set_used.val().into()) << 6);
        self.registers.status.next = self.status_now.val();
        self.status.next = self.status_now.val();
        self.registers.i2c.next = self.i2c.val();
        self.registers.input_size.next =
            (bit_cast::<32, 13>(self.input_state.arrived.val().get_bits::<13>(13)) << 16)
                | bit_cast::<32, 13>(self.input_state.arrived.val().get_bits::<13>(0));
        self.registers.input_frames.next = self.raw_writer.frames.val();
        self.registers.input_broken.next = self.raw_writer.broken.val();
        self.registers.input_wrong.next = self.input_counts.arrived.val().get_bits::<32>(0);
        self.registers.input_overruns.next = self.input_counts.arrived.val().get_bits::<32>(32);
        self.registers.input_write_errors.next = self.raw_writer.errors.val();
        self.registers.raw_frames.next = self.raw_reader.frames.val();
        self.registers.raw_late.next = self.raw_reader.late.val();
        self.registers.raw_read_errors.next = self.raw_reader.errors.val();
        self.registers.picture_frames.next = self.picture_writer.frames.val();
        self.registers.picture_broken.next = self.picture_writer.broken.val();
        self.registers.picture_write_errors.next = self.picture_writer.errors.val();
        self.registers.output_frames.next = self.picture_reader.frames.val();
        self.registers.output_late.next = self.picture_reader.late.val();
        self.registers.output_read_errors.next = self.picture_reader.errors.val();
        self.registers.output_underruns.next = self.output_state.arrived.val().get_bits::<32>(32);
        self.registers.saturated_sums.next = self.core.saturated_sums.val();
        self.registers.clamped_chroma.next = self.core.clamped_chroma.val();
        self.registers.out_of_gamut.next = self.core.out_of_gamut.val();
        self.registers.busy_cycles.next = self.core.busy_cycles.val();
        self.registers.uart_broken.next = self.uart_broken.val();
    }
}
