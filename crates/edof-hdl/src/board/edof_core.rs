//! Everything between the pins' clocks and the memory, for any board.

use super::axi_pair::AxiPair;
use super::calculator_port::CalculatorPort;
use super::clock_watch::ClockWatch;
use super::cycle_count::CycleCount;
use super::frames::Frames;
use super::host_frame::HostFrame;
use super::pattern_source::PatternSource;
use super::picture_window::PictureWindow;
use super::power_on::PowerOn;
use super::read_agent::ReadAgent;
use super::registers::{BoardRegisters, Identity};
use super::tables::Tables;
use super::write_agent::WriteAgent;
use crate::blocks::frame_check::FrameCheck;
use crate::crossing::{BusSync, PixelFifo, ResetSync, Sync};
use crate::describe::{Circuit, kernel};
use crate::ports::{AxiLiteSlave, AxiReadMaster, AxiWriteMaster, StreamCut, StreamOut};
use crate::video::grey_join::GreyJoin;
use crate::video::stream_core::StreamCore;
use crate::video::video_in::VideoIn;
use crate::video::video_out::VideoOut;
use edof_device::design::memory::SNAPSHOT_REGISTERS;
use edof_device::design::{Design, DesignError};
use edof_device::fifos::CROSSING_PIXELS;
use edof_device::video::VideoTiming;
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// Everything between the pins' clocks and the memory: frames in, into DRAM, through the calculator, into DRAM again, and out to a screen.
///
/// Four clocks: that of the incoming pixels, that of memory and host, that of the calculator and all that stands with it between raw and
/// picture ([`StreamCore`]), that of the screen. `reset` may come at any time; each domain has its own that follows it. A clock that was lost
/// resets its own domain alone: the screen's (`screen_reset`), the calculator's (`calculator_reset`, or when it is seen to stand still), whose
/// frame is dropped on both sides. Every reset except the first preserves what the host wrote into the calculator, and which bank is in use. A
/// memory that stops serving (`dram_ready`) resets its agents alone, and the frames that it held are gone. The memory has one AXI4 port, the
/// host one of AXI4-Lite (`edof_device::registers`), both in the memory's clock. Nothing here knows of a vendor or a board.
#[derive(Circuit)]
#[circuit(
    default(
        ResetSync,
        BusSync,
        Sync,
        AxiPair,
        StreamCut,
        PowerOn,
        CalculatorPort,
        PictureWindow,
        CycleCount
    ),
    role(_role),
    registers(clock)
)]
pub struct EdofCore<const W: usize, const S: usize> {
    /// Clock of memory and host.
    pub clock: Signal<In, Clock>,
    /// Clock of the calculator.
    pub calculator_clock: Signal<In, Clock>,
    /// Clock of the incoming pixels.
    pub input_clock: Signal<In, Clock>,
    /// Clock of the screen.
    pub screen_clock: Signal<In, Clock>,
    /// Asynchronous reset of all domains.
    pub reset: Signal<In, Bit>,
    /// Resets the calculator's domain, in `clock`: the calculator's clock is not running or not yet locked.
    pub calculator_reset: Signal<In, Bit>,
    /// Resets the screen's domain, in `clock`: the screen's clock is not running or not yet locked.
    pub screen_reset: Signal<In, Bit>,
    /// Horizontal sync of the incoming video.
    pub input_hs: Signal<In, Bit>,
    /// Vertical sync.
    pub input_vs: Signal<In, Bit>,
    /// A pixel is on the bus.
    pub input_de: Signal<In, Bit>,
    /// Bits of the pixel: Y low, C high, each with seven bits of a raw pixel word.
    pub input_data: Signal<In, Bits<16>>,
    /// Horizontal sync of the screen.
    pub screen_hs: Signal<Out, Bit>,
    /// Vertical sync.
    pub screen_vs: Signal<Out, Bit>,
    /// A pixel is on the bus.
    pub screen_de: Signal<Out, Bit>,
    /// Codes of the pixel: Y' low, Cb' or Cr' high.
    pub screen_data: Signal<Out, Bits<16>>,
    /// Writes to the memory.
    pub dram_write: AxiWriteMaster<W, S>,
    /// Reads from the memory.
    pub dram_read: AxiReadMaster<W>,
    /// The host.
    pub host: AxiLiteSlave,
    /// The memory serves; low while it is in reset, in which it forgets what is in flight.
    pub dram_ready: Signal<In, Bit>,
    /// The video chips are set up.
    pub i2c_done: Signal<In, Bit>,
    /// A video chip did not answer.
    pub i2c_failed: Signal<In, Bit>,
    /// How each bus's set-up stands (registers `i2c_board`, `i2c_card`).
    pub i2c: [Signal<In, Bits<32>>; 2],
    /// What the chips say (registers `receiver` to `transmitter`).
    pub chips: [Signal<In, Bits<32>>; 4],
    /// Register `chip_answer`.
    pub chip_answer: Signal<In, Bits<32>>,
    /// Register `chip_access`.
    pub chip_access: Signal<Out, Bits<32>>,
    /// Register `video_setup`.
    pub video_setup: Signal<Out, Bits<32>>,
    /// Codes of line start and end inside of the pixels, in the input's clock (register `input_codes`).
    pub input_codes: Signal<In, Bits<32>>,
    /// Damaged ones (register `input_malformed`).
    pub input_malformed: Signal<In, Bits<32>>,
    /// Sets up the video chips once more, with its rise.
    pub i2c_restart: Signal<Out, Bit>,
    /// Frames on the host's line that were given up.
    pub uart_broken: Signal<In, Bits<32>>,
    /// The register `status`, for LEDs.
    pub status: Signal<Out, Bits<8>>,
    resets: [ResetSync; 4],
    calculator_flush: ResetSync,
    first_reset: ResetSync,
    // Of the core, the input, the screen.
    cycles: [CycleCount; 3],
    power_on: PowerOn,
    calculator_first: PowerOn,
    calculator_power_on: PowerOn,
    watch: ClockWatch,
    calculator_watch: ClockWatch,
    video_in: VideoIn,
    // Grey, and plain.
    carrier: Sync<2>,
    grey_join: GreyJoin,
    input_fifo: PixelFifo,
    input_status: BusSync<224>,
    patterns: PatternSource,
    host_frame: HostFrame,
    window: PictureWindow,
    raw_writer: WriteAgent<W, S>,
    raw_reader: ReadAgent<W>,
    raw_cut: StreamCut<16>,
    raw_fifo: PixelFifo,
    choices: Sync<2>,
    access: CalculatorPort,
    core: StreamCore,
    calculator_status: BusSync<232>,
    picture_fifo: PixelFifo,
    picture_writer: WriteAgent<W, S>,
    picture_reader: ReadAgent<W>,
    output_cut: StreamCut<16>,
    output_fifo: PixelFifo,
    video_out: VideoOut,
    screen_status: BusSync<96>,
    memory: AxiPair<W, S>,
    registers: BoardRegisters,
    input_word: Signal<Local, Bits<224>>,
    screen_word: Signal<Local, Bits<96>>,
    calculator_word: Signal<Local, Bits<232>>,
    state: Signal<Local, Bits<32>>,
    run: Signal<Local, Bit>,
    flush: Signal<Local, Bit>,
    skip: Signal<Local, Bit>,
    realign: DFF<Bit>,
    // CRCs of frames: raw ones taken, pictures made, pictures that leave.
    checks: [FrameCheck; 3],
    snapshot: DFF<Bit>,
    snapshot_register: Constant<Bits<6>>,
    check_frames: Signal<Local, Bits<32>>,
    // What leads to asynchronous sets, and to nothing else: why a domain begins anew.
    restart_screen: DFF<Bit>,
    restart_calculator: DFF<Bit>,
    flush_request: DFF<Bit>,
    power_up: DFF<Bit>,
    calculator_lost_q: DFF<Bit>,
    is_down: DFF<Bit>,
    // The memory does not serve: all frames in it are lost.
    memory_down: DFF<Bit>,
    agents_reset: Signal<Local, Bit>,
    clear_calculator: Signal<Local, Bit>,
    // A design has one core, so that its module needs no sizes in its name.
    _role: &'static str,
}

impl<const W: usize, const S: usize> EdofCore<W, S> {
    /// Makes the core of a design. Its sets of weights start with these networks, its display with these tables.
    ///
    /// # Errors
    /// [`DesignError`] names what does not fit what, or what the board lacks.
    pub fn new(
        design: &Design,
        sets: [&FixedNetwork; 2],
        identity: &Identity,
        tables: &Tables,
    ) -> Result<Self, DesignError> {
        Self::on_screen(design, sets, identity, tables, VideoTiming::of_frame(design.frame))
    }

    /// [`EdofCore::new`] with the timing of a screen that has the size of the frames.
    ///
    /// # Errors
    /// As [`EdofCore::new`].
    pub fn on_screen(
        design: &Design,
        sets: [&FixedNetwork; 2],
        identity: &Identity,
        tables: &Tables,
        screen: VideoTiming,
    ) -> Result<Self, DesignError> {
        design.check_board()?;
        let memory = &design.board.memory;
        let frames = |buffers| Frames {
            width: design.frame.width,
            height: design.frame.height,
            buffers,
            burst: memory.burst_words,
            depth: memory.agent_words(),
        };
        let crossing = CROSSING_PIXELS.ilog2() as usize;
        let (raw, picture) = (frames(memory.raw_buffers), frames(memory.picture_buffers));
        Ok(Self::from_parts(EdofCoreParts {
            video_in: VideoIn::new(design.frame, design.incoming().signal_time_out()),
            grey_join: GreyJoin::new(design.frame),
            watch: ClockWatch::new(true),
            calculator_watch: ClockWatch::new(false),
            input_fifo: PixelFifo::new(crossing),
            patterns: PatternSource::new(design.frame),
            host_frame: HostFrame::new(design.frame),
            raw_writer: WriteAgent::new(&raw),
            raw_reader: ReadAgent::new(&raw),
            raw_fifo: PixelFifo::new(crossing),
            core: StreamCore::new(design, sets, tables.luma, tables.colours)?,
            picture_fifo: PixelFifo::new(crossing),
            picture_writer: WriteAgent::new(&picture),
            picture_reader: ReadAgent::new(&picture),
            output_fifo: PixelFifo::new(crossing),
            video_out: VideoOut::new(screen),
            registers: BoardRegisters::new(design, identity),
            checks: std::array::from_fn(|_| FrameCheck::new(16, design.frame.width * design.frame.height)),
            snapshot_register: Constant::new((SNAPSHOT_REGISTERS as u64).into()),
            _role: "",
        }))
    }
}

impl<const W: usize, const S: usize> Logic for EdofCore<W, S> {
    #[kernel]
    fn update(&mut self) {
        // Clocks and resets.
        self.cycles[0].clock.next = self.clock.val();
        self.cycles[0].reset.next = self.resets[1].domain_reset.val();
        self.cycles[1].clock.next = self.input_clock.val();
        self.cycles[1].reset.next = self.resets[0].domain_reset.val();
        self.cycles[2].clock.next = self.screen_clock.val();
        self.cycles[2].reset.next = self.resets[2].domain_reset.val();
        self.resets[0].clock.next = self.input_clock.val();
        self.resets[0].reset.next = self.reset.val();
        self.resets[1].clock.next = self.clock.val();
        self.resets[1].reset.next = self.reset.val();
        self.restart_screen.d.next = self.resets[1].domain_reset.val() || self.screen_reset.val();
        self.resets[2].clock.next = self.screen_clock.val();
        self.resets[2].reset.next = self.restart_screen.q.val();
        self.is_down.d.next = self.calculator_reset.val() || self.calculator_watch.stopped.val();
        self.calculator_lost_q.d.next = self.resets[1].domain_reset.val()
            || self.calculator_reset.val()
            || self.calculator_watch.stopped.val();
        self.restart_calculator.d.next = self.resets[1].domain_reset.val()
            || self.calculator_reset.val()
            || self.calculator_watch.stopped.val();
        self.resets[3].clock.next = self.calculator_clock.val();
        self.resets[3].reset.next = self.restart_calculator.q.val();
        self.calculator_flush.clock.next = self.calculator_clock.val();
        self.memory_down.d.next = !self.dram_ready.val();
        self.agents_reset.next = self.resets[1].domain_reset.val() || self.memory_down.q.val();
        // The calculator drops its frame when the memory is lost, and can be reached until the memory is back.
        self.flush_request.d.next =
            self.registers.control.val().get_bit(4) || (!self.dram_ready.val() && !self.memory_down.q.val());
        self.calculator_flush.reset.next = self.flush_request.q.val();
        // What looks at a clock is reset by the first reset alone: a longer one is no clock that stands still.
        self.first_reset.clock.next = self.calculator_clock.val();
        self.power_up.d.next = self.power_on.first.val();
        self.first_reset.reset.next = self.power_up.q.val();
        self.calculator_watch.clock.next = self.clock.val();
        self.calculator_watch.reset.next = self.power_on.first.val();
        self.calculator_watch.watched.next = self.calculator_clock.val();
        self.calculator_watch.watched_reset.next = self.first_reset.domain_reset.val();
        self.watch.clock.next = self.clock.val();
        self.watch.reset.next = self.resets[1].domain_reset.val();
        self.watch.watched.next = self.input_clock.val();
        self.watch.watched_reset.next = self.resets[0].domain_reset.val();
        self.video_in.clock.next = self.input_clock.val();
        self.video_in.reset.next = self.resets[0].domain_reset.val();
        self.carrier.clock.next = self.input_clock.val();
        self.grey_join.clock.next = self.input_clock.val();
        self.grey_join.reset.next = self.resets[0].domain_reset.val();
        self.input_fifo.from_clock.next = self.input_clock.val();
        self.input_fifo.from_reset.next = self.resets[0].domain_reset.val();
        self.input_fifo.to_clock.next = self.clock.val();
        self.input_fifo.to_reset.next = self.resets[1].domain_reset.val();
        self.input_status.from_clock.next = self.input_clock.val();
        self.input_status.from_reset.next = self.resets[0].domain_reset.val();
        self.input_status.to_clock.next = self.clock.val();
        self.input_status.to_reset.next = self.resets[1].domain_reset.val();
        self.raw_writer.clock.next = self.clock.val();
        self.raw_writer.reset.next = self.agents_reset.val();
        self.raw_reader.clock.next = self.clock.val();
        self.raw_reader.reset.next = self.agents_reset.val();
        self.raw_cut.clock.next = self.clock.val();
        self.raw_cut.reset.next = self.agents_reset.val();
        StreamOut::<16>::join(&mut self.raw_reader.pixels, &mut self.raw_cut.from);
        self.core.clock.next = self.calculator_clock.val();
        self.core.reset.next = self.resets[3].domain_reset.val();
        self.calculator_power_on.clock.next = self.calculator_clock.val();
        self.calculator_power_on.reset.next = self.resets[3].domain_reset.val();
        self.core.preserve.next = !self.calculator_power_on.first.val();
        self.calculator_first.clock.next = self.clock.val();
        self.calculator_first.reset.next = self.calculator_lost_q.q.val();
        self.registers.calculator_lost.next = self.is_down.q.val() && !self.calculator_first.first.val();
        // What the host wrote, and which bank is in use, outlive a reset: a bank that is half written comes into use by none.
        self.power_on.clock.next = self.clock.val();
        self.power_on.reset.next = self.resets[1].domain_reset.val();
        self.registers.preserve.next = !self.power_on.first.val();
        self.picture_writer.clock.next = self.clock.val();
        self.picture_writer.reset.next = self.agents_reset.val();
        self.picture_reader.clock.next = self.clock.val();
        self.picture_reader.reset.next = self.agents_reset.val();
        self.output_cut.clock.next = self.clock.val();
        self.output_cut.reset.next = self.agents_reset.val();
        StreamOut::<16>::join(&mut self.picture_reader.pixels, &mut self.output_cut.from);
        self.memory.clock.next = self.clock.val();
        self.memory.reset.next = self.agents_reset.val();
        self.memory.memory_reset.next = !self.dram_ready.val() || self.power_on.first.val();
        self.registers.clock.next = self.clock.val();
        self.registers.reset.next = self.resets[1].domain_reset.val();
        self.output_fifo.from_clock.next = self.clock.val();
        self.output_fifo.from_reset.next = self.resets[1].domain_reset.val();
        self.output_fifo.to_clock.next = self.screen_clock.val();
        self.output_fifo.to_reset.next = self.resets[2].domain_reset.val();
        self.video_out.clock.next = self.screen_clock.val();
        self.video_out.reset.next = self.resets[2].domain_reset.val();
        self.screen_status.from_clock.next = self.screen_clock.val();
        self.screen_status.from_reset.next = self.resets[2].domain_reset.val();
        self.screen_status.to_clock.next = self.clock.val();
        self.screen_status.to_reset.next = self.resets[1].domain_reset.val();

        // Video in.
        self.video_in.hs.next = self.input_hs.val();
        self.video_in.vs.next = self.input_vs.val();
        self.video_in.de.next = self.input_de.val();
        self.video_in.data.next = self.input_data.val();
        self.carrier.from.next = self.registers.video_setup.val().get_bits::<2>(1);
        self.grey_join.grey.next = self.carrier.to.val().get_bit(0);
        self.video_in.plain.next = self.carrier.to.val().get_bit(1);
        self.grey_join.source.valid.next = self.video_in.pixels_valid.val();
        self.grey_join.source.data.next = self.video_in.pixels_data.val();
        self.grey_join.source.user.next = self.video_in.pixels_user.val();
        self.grey_join.source.last.next = self.video_in.pixels_last.val();
        self.video_in.pixels_ready.next = self.grey_join.source.ready.val();
        self.input_fifo.from.valid.next = self.grey_join.pixels.valid.val();
        self.input_fifo.from.data.next = self.grey_join.pixels.data.val();
        self.input_fifo.from.user.next = self.grey_join.pixels.user.val();
        self.input_fifo.from.last.next = self.grey_join.pixels.last.val();
        self.grey_join.pixels.ready.next = self.input_fifo.from.ready.val();
        self.patterns.clock.next = self.clock.val();
        self.patterns.reset.next = self.resets[1].domain_reset.val();
        self.patterns.select.next = self.registers.pattern.val().get_bits::<3>(0);
        StreamOut::<16>::join(&mut self.input_fifo.to, &mut self.patterns.source);
        StreamOut::<16>::join(&mut self.patterns.pixels, &mut self.host_frame.source);
        self.host_frame.clock.next = self.clock.val();
        self.host_frame.reset.next = self.agents_reset.val();
        self.host_frame.select.next = self.registers.pattern.val().get_bit(3);
        self.host_frame.write.next = self.registers.frame_write.val();
        self.host_frame.address.next = self.registers.tile_address.val();
        self.host_frame.data.next = self.registers.weight_data.val();
        self.registers.frame_blocks.next = self.host_frame.blocks.val();
        self.registers.frame_check.next = self.host_frame.check.val();
        StreamOut::<16>::join(&mut self.host_frame.pixels, &mut self.raw_writer.pixels);

        self.flush.next = self.registers.control.val().get_bit(4)
            || self.calculator_lost_q.q.val()
            || self.memory_down.q.val();
        // Through the memory to the calculator, as long as the host lets it run. What is in flight between the two domains goes with a flush, or
        // with a reset of either.
        self.clear_calculator.next =
            self.resets[3].domain_reset.val() || self.calculator_flush.domain_reset.val();
        self.raw_fifo.from_clock.next = self.clock.val();
        self.raw_fifo.from_reset.next = self.resets[1].domain_reset.val() || self.flush.val();
        self.raw_fifo.to_clock.next = self.calculator_clock.val();
        self.raw_fifo.to_reset.next = self.clear_calculator.val();
        self.picture_fifo.from_clock.next = self.calculator_clock.val();
        self.picture_fifo.from_reset.next = self.clear_calculator.val();
        self.picture_fifo.to_clock.next = self.clock.val();
        self.picture_fifo.to_reset.next = self.resets[1].domain_reset.val() || self.flush.val();
        self.raw_writer.corrupted.next = false;
        self.raw_writer.reading.next = self.raw_reader.reading.val();
        // The host writes a frame once, and looks at what becomes of it for as long as it likes.
        self.raw_reader.repeats.next = self.registers.pattern.val().get_bit(3);
        self.raw_reader.newest.next = self.raw_writer.newest.val();
        self.run.next = self.registers.control.val().get_bit(0);
        // After a flush what is left of the frame is thrown away.
        self.skip.next = self.flush.val() || (self.realign.q.val() && !self.raw_cut.to.user.val());
        if self.flush.val() {
            self.realign.d.next = true;
        } else if self.raw_cut.to.valid.val() && self.raw_cut.to.user.val() {
            self.realign.d.next = false;
        }
        if self.resets[1].domain_reset.val() {
            self.realign.d.next = false;
        }
        self.raw_fifo.from.valid.next = self.raw_cut.to.valid.val() && self.run.val() && !self.skip.val();
        self.raw_fifo.from.data.next = self.raw_cut.to.data.val();
        self.raw_fifo.from.user.next = false;
        self.raw_fifo.from.last.next = false;
        self.raw_cut.to.ready.next = self.skip.val() || (self.raw_fifo.from.ready.val() && self.run.val());
        self.core.flush.next = self.calculator_flush.domain_reset.val();
        self.core.pixels_valid.next = self.raw_fifo.to.valid.val();
        self.core.pixels_data.next = self.raw_fifo.to.data.val();
        self.raw_fifo.to.ready.next = self.core.pixels_ready.val();
        self.choices.clock.next = self.calculator_clock.val();
        self.choices.from.next = self.registers.control.val().get_bits::<2>(1);
        self.core.colour.next = self.choices.to.val().get_bit(0);
        self.core.set.next = self.choices.to.val().get_bit(1);
        self.core.clear.next = false;

        // Through the memory to the screen.
        self.picture_fifo.from.valid.next = self.core.picture_valid.val();
        self.picture_fifo.from.data.next = self.core.picture_data.val();
        self.picture_fifo.from.user.next = self.core.picture_user.val();
        self.picture_fifo.from.last.next = self.core.picture_last.val();
        self.core.picture_ready.next = self.picture_fifo.from.ready.val();
        StreamOut::<16>::join(&mut self.picture_fifo.to, &mut self.picture_writer.pixels);
        self.picture_writer.corrupted.next = self.raw_reader.corrupted.val();
        self.picture_writer.reading.next = self.picture_reader.reading.val();
        self.picture_reader.repeats.next = true;
        self.picture_reader.newest.next = self.picture_writer.newest.val();
        self.output_fifo.from.valid.next = self.output_cut.to.valid.val();
        self.output_fifo.from.data.next = self.output_cut.to.data.val();
        self.output_fifo.from.user.next = self.output_cut.to.user.val();
        self.output_fifo.from.last.next = self.output_cut.to.last.val();
        self.output_cut.to.ready.next = self.output_fifo.from.ready.val();
        self.video_out.pixels_valid.next = self.output_fifo.to.valid.val();
        self.video_out.pixels_data.next = self.output_fifo.to.data.val();
        self.video_out.pixels_user.next = self.output_fifo.to.user.val();
        self.video_out.pixels_last.next = self.output_fifo.to.last.val();
        self.output_fifo.to.ready.next = self.video_out.pixels_ready.val();
        self.screen_hs.next = self.video_out.hs.val();
        self.screen_vs.next = self.video_out.vs.val();
        self.screen_de.next = self.video_out.de.val();
        self.screen_data.next = self.video_out.data.val();

        // The host's window: a tile that the pattern repeats, and a part of the codes, or of the raw words that were taken.
        self.window.clock.next = self.clock.val();
        self.window.reset.next = self.resets[1].domain_reset.val() || self.flush.val();
        self.window.tile_address.next = self.patterns.tile_address.val();
        self.patterns.tile_pixel.next = self.window.tile_pixel.val();
        self.window.write.next = self.registers.tile_write.val();
        self.window.write_address.next = self.registers.tile_address.val();
        self.window.write_data.next = self.registers.weight_data.val().get_bits::<16>(0);
        self.window.valid.next = self.picture_fifo.to.valid.val() && self.picture_writer.pixels.ready.val();
        self.window.data.next = self.picture_fifo.to.data.val();
        self.window.user.next = self.picture_fifo.to.user.val();
        self.window.last.next = self.picture_fifo.to.last.val();
        if self.registers.window_corner.val().get_bit(31) {
            self.window.valid.next = self.raw_fifo.from.valid.val() && self.raw_fifo.from.ready.val();
            self.window.data.next = self.raw_cut.to.data.val();
            self.window.user.next = self.raw_cut.to.user.val();
            self.window.last.next = self.raw_cut.to.last.val();
        }
        self.window.corner.next = self.registers.window_corner.val();
        self.window.read_address.next = self.registers.tile_address.val();
        self.registers.window_pixel.next = self.window.read_data.val();

        // What passes is checked. The write that copies the counters of the stages copies these, too.
        for i in 0..3 {
            self.checks[i].clock.next = self.clock.val();
            self.checks[i].snapshot.next = self.snapshot.q.val();
            self.checks[i].reset.next = self.resets[1].domain_reset.val() || self.flush.val();
        }
        self.checks[2].reset.next = self.agents_reset.val();
        self.checks[0].valid.next = self.raw_fifo.from.valid.val() && self.raw_fifo.from.ready.val();
        self.checks[0].data.next = bit_cast::<32, 16>(self.raw_cut.to.data.val());
        self.checks[1].valid.next =
            self.picture_fifo.to.valid.val() && self.picture_writer.pixels.ready.val();
        self.checks[1].data.next = bit_cast::<32, 16>(self.picture_fifo.to.data.val());
        self.checks[2].valid.next = self.output_cut.to.valid.val() && self.output_fifo.from.ready.val();
        self.checks[2].data.next = bit_cast::<32, 16>(self.output_cut.to.data.val());
        self.snapshot.d.next = self.registers.weight_valid.val()
            && self.access.ready.val()
            && (self.registers.weight_address.val().get_bits::<6>(19) == self.snapshot_register.val());
        self.registers.check_raw.next = self.checks[0].crc.val();
        self.registers.check_windows.next = self.calculator_status.arrived.val().get_bits::<32>(192);
        self.registers.check_codes.next = self.checks[1].crc.val();
        self.registers.check_sent.next = self.checks[2].crc.val();
        self.check_frames.next = bit_cast::<32, 8>(self.checks[0].frames.val())
            | (bit_cast::<32, 8>(self.calculator_status.arrived.val().get_bits::<8>(224)) << 8)
            | (bit_cast::<32, 8>(self.checks[1].frames.val()) << 16)
            | (bit_cast::<32, 8>(self.checks[2].frames.val()) << 24);
        self.registers.check_frames.next = self.check_frames.val();

        // Memory.
        AxiWriteMaster::<W, S>::join(&mut self.raw_writer.dram, &mut self.memory.write_0);
        AxiWriteMaster::<W, S>::join(&mut self.picture_writer.dram, &mut self.memory.write_1);
        AxiReadMaster::<W>::join(&mut self.raw_reader.dram, &mut self.memory.read_0);
        AxiReadMaster::<W>::join(&mut self.picture_reader.dram, &mut self.memory.read_1);
        AxiWriteMaster::<W, S>::link(&mut self.dram_write, &mut self.memory.dram_write);
        AxiReadMaster::<W>::link(&mut self.dram_read, &mut self.memory.dram_read);

        // What the other domains say, again and again.
        self.input_word.next = (bit_cast::<224, 32>(self.video_in.overruns.val()))
            | (bit_cast::<224, 32>(self.video_in.wrong_frames.val()) << 32)
            | (bit_cast::<224, 13>(self.video_in.width.val()) << 64)
            | (bit_cast::<224, 13>(self.video_in.height.val()) << 80)
            | (bit_cast::<224, 32>(self.input_codes.val()) << 96)
            | (bit_cast::<224, 32>(self.input_malformed.val()) << 128)
            | (bit_cast::<224, 32>(self.video_in.range_frames.val()) << 160)
            | (bit_cast::<224, 32>(self.cycles[1].count.val()) << 192);
        if self.video_in.present.val() {
            self.input_word.next = self.input_word.val() | (bit_cast::<224, 13>(1.into()) << 77);
        }
        if self.video_in.fits.val() {
            self.input_word.next = self.input_word.val() | (bit_cast::<224, 13>(1.into()) << 78);
        }
        self.input_status.word.next = self.input_word.val();
        self.input_status.valid.next = true;
        self.screen_word.next = bit_cast::<96, 32>(self.video_out.late_pixels.val())
            | (bit_cast::<96, 32>(self.video_out.shown_frames.val()) << 32)
            | (bit_cast::<96, 32>(self.cycles[2].count.val()) << 64);
        self.screen_status.word.next = self.screen_word.val();
        self.screen_status.valid.next = true;
        self.calculator_status.from_clock.next = self.calculator_clock.val();
        self.calculator_status.from_reset.next = self.resets[3].domain_reset.val();
        self.calculator_status.to_clock.next = self.clock.val();
        self.calculator_status.to_reset.next = self.resets[1].domain_reset.val();
        self.calculator_word.next = bit_cast::<232, 32>(self.core.saturated_sums.val())
            | (bit_cast::<232, 32>(self.core.clamped_chroma.val()) << 32)
            | (bit_cast::<232, 32>(self.core.out_of_gamut.val()) << 64)
            | (bit_cast::<232, 32>(self.core.patches.val()) << 96)
            | (bit_cast::<232, 32>(self.core.busy_cycles.val()) << 128)
            | (bit_cast::<232, 32>(self.core.window_crc.val()) << 192)
            | (bit_cast::<232, 8>(self.core.window_frames.val()) << 224);
        if self.core.set_used.val() {
            self.calculator_word.next = self.calculator_word.val() | (bit_cast::<232, 2>(1.into()) << 160);
        }
        if self.core.window_fault.val() {
            self.calculator_word.next = self.calculator_word.val() | (bit_cast::<232, 2>(2.into()) << 160);
        }
        self.calculator_status.word.next = self.calculator_word.val();
        self.calculator_status.valid.next = true;

        // The host.
        AxiLiteSlave::link(&mut self.host, &mut self.registers.bus);
        self.access.clock.next = self.clock.val();
        self.access.reset.next = self.calculator_lost_q.q.val();
        self.access.is_down.next = self.is_down.q.val();
        self.access.weight_valid.next = self.registers.weight_valid.val();
        self.access.table_valid.next = self.registers.table_valid.val();
        self.access.stage_valid.next = self.registers.stage_valid.val();
        self.access.address.next = self.registers.weight_address.val();
        if self.registers.stage_valid.val() {
            self.access.address.next = bit_cast::<25, 7>(self.registers.stage_address.val());
        }
        self.access.data.next = self.registers.weight_data.val();
        self.registers.weight_ready.next = self.access.ready.val();
        self.registers.table_ready.next = self.access.ready.val();
        self.registers.stage_ready.next = self.access.ready.val();
        self.registers.unreached.next = self.access.error.val();
        self.registers.stage_counter.next = self.access.read_value.val();
        self.access.to_clock.next = self.calculator_clock.val();
        self.access.to_reset.next = self.resets[3].domain_reset.val();
        self.access.status.next = self.core.status.val();
        self.core.write_valid.next = self.access.write_weight.val();
        self.core.write_address.next = self.access.to_address.val();
        self.core.write_data.next = self.access.to_data.val();
        self.core.status_address.next = self.access.to_address.val().get_bits::<7>(0);
        self.core.table_write.next = self.access.write_table.val();
        self.core.table_select.next = self.access.to_address.val().get_bits::<2>(15);
        self.core.table_address.next = self.access.to_address.val().get_bits::<15>(0);
        self.core.table_data.next = self.access.to_data.val().get_bits::<12>(0);
        self.i2c_restart.next = self.registers.control.val().get_bit(3);
        self.state.next = 0.into();
        if self.dram_ready.val() {
            self.state.next = self.state.val() | 1;
        }
        // Without its clock the receiver's side says what it said last.
        if self.input_status.arrived.val().get_bit(77) && !self.watch.stopped.val() {
            self.state.next = self.state.val() | 2;
        }
        if self.input_status.arrived.val().get_bit(78) && !self.watch.stopped.val() {
            self.state.next = self.state.val() | 4;
        }
        if self.screen_status.arrived.val().get_bits::<32>(32).any() {
            self.state.next = self.state.val() | 8;
        }
        if self.i2c_done.val() {
            self.state.next = self.state.val() | 16;
        }
        if self.i2c_failed.val() {
            self.state.next = self.state.val() | 32;
        }
        if self.calculator_status.arrived.val().get_bit(160) {
            self.state.next = self.state.val() | 64;
        }
        if self.calculator_status.arrived.val().get_bit(161) {
            self.state.next = self.state.val() | 128;
        }
        if !self.is_down.q.val() {
            self.state.next = self.state.val() | 256;
        }
        self.status.next = self.state.val().get_bits::<8>(0);
        self.registers.status.next = self.state.val();
        self.registers.i2c_board.next = self.i2c[0].val();
        self.registers.i2c_card.next = self.i2c[1].val();
        self.registers.receiver.next = self.chips[0].val();
        self.registers.receiver_size.next = self.chips[1].val();
        self.registers.receiver_format.next = self.chips[2].val();
        self.registers.transmitter.next = self.chips[3].val();
        self.registers.chip_answer.next = self.chip_answer.val();
        self.chip_access.next = self.registers.chip_access.val();
        self.video_setup.next = self.registers.video_setup.val();
        self.registers.input_codes.next = self.input_status.arrived.val().get_bits::<32>(96);
        self.registers.input_malformed.next = self.input_status.arrived.val().get_bits::<32>(128);
        self.registers.input_size.next = (self.input_status.arrived.val().get_bits::<32>(64)) & 0x1fff_1fff;
        self.registers.input_frames.next = self.raw_writer.frames.val();
        self.registers.input_broken.next = self.raw_writer.broken.val();
        self.registers.input_wrong.next = self.input_status.arrived.val().get_bits::<32>(32);
        self.registers.input_overruns.next = self.input_status.arrived.val().get_bits::<32>(0);
        self.registers.input_write_errors.next = self.raw_writer.errors.val();
        self.registers.raw_frames.next = self.raw_reader.frames.val();
        self.registers.raw_late.next = self.raw_reader.late.val();
        self.registers.raw_read_errors.next = self.raw_reader.errors.val();
        self.registers.busy_cycles.next = self.calculator_status.arrived.val().get_bits::<32>(128);
        self.registers.patches.next = self.calculator_status.arrived.val().get_bits::<32>(96);
        self.registers.saturated_sums.next = self.calculator_status.arrived.val().get_bits::<32>(0);
        self.registers.clamped_chroma.next = self.calculator_status.arrived.val().get_bits::<32>(32);
        self.registers.out_of_gamut.next = self.calculator_status.arrived.val().get_bits::<32>(64);
        self.registers.picture_frames.next = self.picture_writer.frames.val();
        self.registers.picture_broken.next = self.picture_writer.broken.val();
        self.registers.picture_write_errors.next = self.picture_writer.errors.val();
        self.registers.output_frames.next = self.picture_reader.frames.val();
        self.registers.output_late.next = self.picture_reader.late.val();
        self.registers.output_read_errors.next = self.picture_reader.errors.val();
        self.registers.output_underruns.next = self.screen_status.arrived.val().get_bits::<32>(0);
        self.registers.uart_broken.next = self.uart_broken.val();
        self.registers.core_cycles.next = self.cycles[0].count.val();
        self.registers.input_cycles.next = self.input_status.arrived.val().get_bits::<32>(192);
        self.registers.screen_cycles.next = self.screen_status.arrived.val().get_bits::<32>(64);
        self.registers.input_range.next = self.input_status.arrived.val().get_bits::<32>(160);
    }
}
