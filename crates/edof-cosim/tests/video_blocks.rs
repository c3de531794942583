//! Every block and leaf of the video side, given the same stimulus in rust-hdl's simulation, in Verilator and in Icarus: the same outputs in
//! every cycle.

use crate::common::committed;
use crate::differential::{Last, RESET, agree, agree_with_images, bit, ported, resets, word};
use edof_core::Stride;
use edof_core::draw::Draw;
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_device::video::{Axis, VideoTiming};
use edof_golden::display::Picture;
use edof_golden::video::{Pins, Tmds, VideoOut as OutModel};
use edof_hdl::video::border::Border;
use edof_hdl::video::camera_in::CameraIn;
use edof_hdl::video::display::{Display, TABLE_IMAGES};
use edof_hdl::video::grey_join::GreyJoin;
use edof_hdl::video::overlap_add::OverlapAdd;
use edof_hdl::video::patch_pairs::PatchPairs;
use edof_hdl::video::queue::Queue;
use edof_hdl::video::raster_reorder::RasterReorder;
use edof_hdl::video::scale::Scale;
use edof_hdl::video::sink_rgb::{self, SinkRgb};
use edof_hdl::video::tmds_encoder::{BitCount, TmdsEncoder};
use edof_hdl::video::video_in::VideoIn;
use edof_hdl::video::video_out::VideoOut;
use edof_hdl::video::window_reorder::WindowReorder;
use edof_verilog::describe::Circuit;
use ndarray::Array2;
use rust_hdl::prelude::*;

ported!(
    BitCount,
    Border,
    CameraIn,
    Display,
    GreyJoin,
    OverlapAdd,
    PatchPairs,
    RasterReorder,
    SinkRgb,
    TmdsEncoder,
    VideoIn,
    VideoOut,
    WindowReorder,
    QueueTop,
    ScaleTop
);

/// Whether a stream may show something else: nothing stands there, or it was taken.
fn is_free(last: &Last, valid: &str, ready: &str) -> bool {
    last.cycle <= RESET || last.is("reset") || !last.is(valid) || last.is(ready)
}

fn small(stride: usize) -> Design {
    let mut design = committed("tiny");
    design.frame = FrameSize { width: 12, height: 10, stride: Stride::new(stride).unwrap() };
    design.check().unwrap();
    design
}

/// The leaf `edof_queue` in a module of its own.
#[derive(Circuit)]
struct QueueTop {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub push: Signal<In, Bit>,
    pub data: Signal<In, Bits<34>>,
    pub space: Signal<Out, Bit>,
    pub valid: Signal<Out, Bit>,
    pub ready: Signal<In, Bit>,
    pub front: Signal<Out, Bits<34>>,
    queue: Queue<34>,
}

impl Logic for QueueTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.queue.clock.next = self.clock.val();
        self.queue.reset.next = self.reset.val();
        self.queue.push.next = self.push.val();
        self.queue.data.next = self.data.val();
        self.space.next = self.queue.space.val();
        self.valid.next = self.queue.front_valid.val();
        self.queue.front_ready.next = self.ready.val();
        self.front.next = self.queue.front_data.val();
    }
}

#[test]
fn queue() {
    let top = QueueTop::from_parts(QueueTopParts { queue: Queue::new(7) });
    agree(top, RESET as usize, &[("front", "valid")], |b, draw, last| {
        b.reset.next = resets(last, draw);
        // A pipeline of five cycles: what it took in while there was room comes out whatever happens.
        let takes = last.cycle > RESET && last.is("space") && draw.whole(0, 9) > 0;
        b.push.next = takes;
        b.data.next = word(draw);
        b.ready.next = draw.whole(0, 9) > (last.cycle as i64 / 100) % 10;
    });
}

/// The leaf `edof_scale` in a module of its own.
#[derive(Circuit)]
#[circuit(default(Scale))]
struct ScaleTop {
    pub clock: Signal<In, Clock>,
    pub value: Signal<In, Bits<18>>,
    pub factor: Signal<In, Bits<18>>,
    pub addend: Signal<In, Bits<48>>,
    pub sum: Signal<Out, Bits<48>>,
    scale: Scale,
}

impl Logic for ScaleTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.scale.clock.next = self.clock.val();
        self.scale.value.next = self.value.val();
        self.scale.factor.next = self.factor.val();
        self.scale.addend.next = self.addend.val();
        self.sum.next = self.scale.sum.val();
    }
}

#[test]
fn scale() {
    agree(ScaleTop::default(), 4, &[], |b, draw, _| {
        b.value.next = word(draw);
        b.factor.next = word(draw);
        b.addend.next = word(draw);
    });
}

#[test]
fn patch_pairs() {
    let qualified = ["out_luma", "out_chroma"].map(|port| (port, "out_valid"));
    agree(PatchPairs::default(), RESET as usize, &qualified, |b, draw, last| {
        b.reset.next = resets(last, draw);
        if is_free(last, "valid", "ready") {
            b.valid.next = draw.whole(0, 3) > 0;
            b.data.next = word(draw);
        }
        b.out_ready.next = draw.whole(0, 9) > (last.cycle as i64 / 200) % 10;
    });
}

#[test]
fn overlap_add() {
    for stride in [4, 2] {
        let qualified = ["out_luma", "out_chroma"].map(|port| (port, "out_valid"));
        agree(OverlapAdd::of(&small(stride)).unwrap(), RESET as usize, &qualified, |b, draw, last| {
            b.reset.next = resets(last, draw);
            b.clear.next = draw.whole(0, 999) == 0;
            if is_free(last, "valid", "ready") {
                b.valid.next = draw.whole(0, 3) > 0;
                b.luma.next = word(draw);
                b.chroma.next = word(draw);
            }
            b.out_ready.next = draw.whole(0, 9) > (last.cycle as i64 / 200) % 10;
        });
    }
}

#[test]
fn raster_reorder() {
    let qualified = ["out_luma", "out_chroma", "out_first", "out_last"].map(|port| (port, "out_valid"));
    agree(RasterReorder::of(&small(8)), RESET as usize, &qualified, |b, draw, last| {
        b.reset.next = resets(last, draw);
        if is_free(last, "valid", "ready") {
            b.valid.next = draw.whole(0, 3) > 0;
            b.luma.next = word(draw);
            b.chroma.next = word(draw);
        }
        b.out_ready.next = draw.whole(0, 9) > (last.cycle as i64 / 200) % 10;
    });
}

#[test]
fn window_reorder() {
    let qualified = ["out_pixels", "out_last", "out_set"].map(|port| (port, "out_valid"));
    agree(WindowReorder::of(&small(4)), RESET as usize, &qualified, |b, draw, last| {
        b.reset.next = resets(last, draw);
        b.set.next = bit(draw);
        if is_free(last, "pixels_valid", "pixels_ready") {
            b.pixels_valid.next = draw.whole(0, 3) > 0;
            b.pixels_data.next = word(draw);
        }
        b.out_ready.next = draw.whole(0, 9) > (last.cycle as i64 / 200) % 10;
    });
}

#[test]
fn display() {
    let (luma, colour): (Vec<u64>, Vec<u64>) =
        ((0..1 << 15).map(|i| i / 129).collect(), (0..1 << 14).map(|i| i / 4).collect());
    let text = |words: &[u64]| words.iter().map(|word| format!("{word:x}\n")).collect::<String>();
    let contents = [text(&luma), text(&colour), text(&colour), text(&colour)];
    let images: Vec<(String, String)> = TABLE_IMAGES.map(String::from).into_iter().zip(contents).collect();
    let qualified = ["pixels_data", "pixels_user", "pixels_last"].map(|port| (port, "pixels_valid"));
    let block = Display::new(&luma, [&colour, &colour, &colour]);
    agree_with_images(block, RESET as usize, &qualified, &images, |b, draw, last| {
        b.reset.next = resets(last, draw);
        b.clear.next = draw.whole(0, 999) == 0;
        b.colour.next = bit(draw);
        if is_free(last, "valid", "ready") {
            b.valid.next = draw.whole(0, 3) > 0;
            b.luma.next = word(draw);
            b.chroma.next = word(draw);
            b.first.next = draw.whole(0, 60) == 0;
            b.last.next = draw.whole(0, 8) == 0;
        }
        b.table_write.next = draw.whole(0, 9) == 0;
        b.table_select.next = word(draw);
        b.table_address.next = (draw.bits() & 0x3fff).into();
        b.table_data.next = word(draw);
        b.pixels_ready.next = draw.whole(0, 9) > (last.cycle as i64 / 200) % 10;
    });
}

/// A bus with random lines and frames, mostly of the right size.
struct Bus {
    column: i64,
    row: i64,
    width: i64,
    height: i64,
}

impl Bus {
    fn step(&mut self, draw: &mut Draw) -> (bool, bool, bool) {
        self.column += 1;
        if self.column == self.width + 8 {
            (self.column, self.row) = (0, self.row + 1);
            self.width = if draw.whole(0, 40) == 0 { draw.whole(1, 20) } else { 12 };
        }
        if self.row == self.height + 4 {
            self.row = 0;
            self.height = if draw.whole(0, 3) == 0 { draw.whole(1, 14) } else { 10 };
        }
        let de = self.row < self.height && self.column < self.width;
        (self.column > self.width + 3, self.row > self.height + 1, de)
    }
}

#[test]
fn camera_in() {
    agree(CameraIn::new(16), RESET as usize, &[], |b, draw, last| {
        b.reset.next = resets(last, draw);
        b.camera_vs.next = last.cycle % 700 < 30;
        b.camera_href.next = last.cycle < 600 && last.cycle % 40 > 7;
        b.camera_data.next = word(draw);
    });
}

#[test]
fn video_in() {
    let mut bus = Bus { column: 0, row: 0, width: 12, height: 10 };
    let qualified = ["pixels_data", "pixels_user", "pixels_last"].map(|port| (port, "pixels_valid"));
    let block = VideoIn::new(FrameSize { width: 12, height: 10, stride: Stride::PATCH }, 700);
    agree(block, RESET as usize, &qualified, move |b, draw, last| {
        b.reset.next = resets(last, draw);
        let (hs, vs, de) = bus.step(draw);
        b.hs.next = hs;
        b.vs.next = vs && last.cycle % 2000 < 1200;
        b.de.next = de;
        b.data.next = word(draw);
        b.plain.next = last.cycle % 6000 > 4000;
        b.pixels_ready.next = draw.whole(0, 99) > 0;
    });
}

#[test]
fn grey_join() {
    let mut sent = 0;
    let frame = FrameSize { width: 12, height: 4, stride: Stride::PATCH };
    let qualified = ["pixels.data", "pixels.user", "pixels.last"].map(|port| (port, "pixels.valid"));
    agree(GreyJoin::new(frame), RESET as usize, &qualified, move |b, draw, last| {
        b.reset.next = resets(last, draw);
        b.grey.next = last.cycle % 3000 > 800;
        if is_free(last, "source.valid", "source.ready") {
            b.source.valid.next = draw.whole(0, 9) > 0;
            // Mostly marks that fit, of halves by turns.
            let mark = u16::from(sent % 96 >= 48 && sent % 12 == 1) << 9;
            b.source.data.next = (u64::from(draw.bits() as u16 & 0xfdff | mark)).into();
            b.source.user.next = sent % 48 == 0;
            b.source.last.next = sent % 12 == 11;
            sent += if draw.whole(0, 400) == 0 { 2 } else { 1 };
        }
        b.pixels.ready.next = draw.whole(0, 3) > 0;
    });
}

#[test]
fn video_out() {
    let timing = VideoTiming {
        line: Axis { active: 12, front: 2, sync: 3, back: 3 },
        frame: Axis { active: 10, front: 1, sync: 2, back: 2 },
        pixel_khz: 1000,
    };
    let mut sent = 0;
    agree(VideoOut::new(timing), RESET as usize, &[], move |b, draw, last| {
        b.reset.next = resets(last, draw);
        if is_free(last, "pixels_valid", "pixels_ready") {
            b.pixels_valid.next = draw.whole(0, 60) > 0;
            b.pixels_data.next = word(draw);
            b.pixels_user.next = sent % 120 == 0 || draw.whole(0, 500) == 0;
            sent += 1;
        }
        b.pixels_last.next = bit(draw);
    });
}

/// Bytes, some of which come again and again; then symbols of control.
#[test]
fn tmds_encoder() {
    let (mut model, mut sent) = (Tmds::default(), std::collections::VecDeque::new());
    let mut byte = 0;
    agree(TmdsEncoder::default(), 8, &[], move |b, draw, last| {
        // What was sent four cycles ago, and its disparity in pairs.
        if sent.len() == 5 {
            let (symbol, disparity): (u16, i32) = sent.pop_front().unwrap();
            assert_eq!(last.port("symbol"), u64::from(symbol), "cycle {}", last.cycle);
            assert_eq!(last.port("disparity"), (disparity / 2) as u64 & 15, "cycle {}", last.cycle);
        }
        let (de, control) = (last.cycle % 200 > 20, draw.whole(0, 3) as u8);
        if draw.whole(0, 3) == 0 {
            byte = draw.whole(0, 255) as u8;
        }
        b.de.next = de;
        b.byte.next = u64::from(byte).into();
        b.control.next = u64::from(control).into();
        let symbol = if de { model.pixel(byte) } else { model.control(control) };
        sent.push_back((symbol, model.disparity));
    });
}

#[test]
fn bit_count() {
    agree(BitCount::default(), 1, &[], |b, draw, _| b.bits.next = word(draw));
}

/// Lines of random codes and lengths, and pauses: each cycle's pixel, and what the golden sink shows of it (blue low).
fn shown_lines(draw: &mut Draw) -> Vec<(Option<u16>, u64)> {
    let mut cycles = vec![(None, 0); 8];
    while cycles.len() < 4_000 {
        let codes: Vec<u16> = (0..2 * draw.whole(1, 12)).map(|_| (draw.bits() >> 48) as u16).collect();
        let plane = |bytes: Vec<u8>| Array2::from_shape_vec((1, bytes.len()), bytes).unwrap();
        let chroma =
            |which| plane(codes.iter().skip(which).step_by(2).map(|code| (code >> 8) as u8).collect());
        let luma = plane(codes.iter().map(|code| *code as u8).collect());
        let shown = Picture { luma, chroma: [chroma(0), chroma(1)] }.shown();
        let colours = |x: usize| (0..3).fold(0, |word, i| word | u64::from(shown[(2 - i, 0, x)]) << (8 * i));
        cycles.extend(codes.iter().enumerate().map(|(x, code)| (Some(*code), colours(x))));
        cycles.extend((0..draw.whole(1, 6)).map(|_| (None, 0)));
    }
    cycles
}

#[test]
fn sink_rgb() {
    let cycles = shown_lines(&mut Draw::new(7));
    agree(SinkRgb::default(), 24, &[], move |b, draw, last| {
        let now = last.cycle as usize;
        if now > 16 {
            assert_eq!(last.port("colours"), cycles[now - 1 - sink_rgb::LATENCY].1, "cycle {now}");
        }
        b.de.next = cycles[now].0.is_some();
        b.data.next = cycles[now].0.map_or_else(|| word(draw), |code| u64::from(code).into());
    });
}

/// The syncs of a screen, and where its pixels are.
#[test]
fn border() {
    let screen = VideoTiming {
        line: Axis { active: 17, front: 2, sync: 3, back: 4 },
        frame: Axis { active: 11, front: 1, sync: 2, back: 3 },
        pixel_khz: 1000,
    };
    let (mut bus, mut tops) = (OutModel::new(screen), 0);
    let [mut before, mut now] = [Pins::default(); 2];
    agree(Border::new(screen), RESET as usize, &[], move |b, draw, last| {
        b.reset.next = resets(last, draw);
        // Resets come in the second half alone.
        if (RESET..1_500).contains(&last.cycle) {
            let expected = [before.hs, before.vs, before.de && tops > 0];
            assert_eq!(
                ["hs_later", "vs_later", "de"].map(|port| last.is(port)),
                expected,
                "cycle {}",
                last.cycle
            );
        }
        bus.step(None);
        let pins = bus.pins();
        tops += u64::from(last.cycle > RESET && pins.vs && !now.vs);
        (before, now) = (now, pins);
        b.hs.next = pins.hs;
        b.vs.next = pins.vs;
    });
}
