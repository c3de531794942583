//! DVI from 4:2:2 to the pins of a cable: what a screen that knows the standard alone gets there, in Verilator. Mistakes that are put into the
//! circuit are found.

use crate::support;
use edof_board::chip_models::dvi::{Frame, decoded};
use edof_board::chip_models::hdmi::{Axis as LinkAxis, Timing};
use edof_core::Stride;
use edof_core::draw::Draw;
use edof_cosim::bench::{Actor, Bench, ClockId};
use edof_cosim::system::first_light::{self, DviCable};
use edof_cosim::verilator::{Library, Model, Start};
use edof_cosim::{Error, Source};
use edof_device::design::FrameSize;
use edof_device::video::{Axis, VideoTiming};
use edof_golden::Picture;
use edof_golden::video::tmds::{CONTROL, Tmds};
use edof_golden::video::video_out::{BLACK_PIXEL, VideoOut};
use edof_hdl::video::dvi::Dvi;
use ndarray::Array2;
use std::collections::{BTreeSet, HashSet};

/// A screen, and a picture in its middle.
const SCREEN: VideoTiming = VideoTiming {
    line: Axis { active: 24, front: 4, sync: 14, back: 6 },
    frame: Axis { active: 11, front: 2, sync: 2, back: 3 },
    pixel_khz: 25_000,
};
const PICTURE: FrameSize = FrameSize { width: 14, height: 6, stride: Stride::PATCH };

/// Every byte in every state that an encoder reaches: the symbols, the states (half their disparity), what a decoder makes of them.
#[test]
fn bytes_come_back_in_every_state_of_the_encoder() {
    let (mut states, mut open) = (HashSet::from([Tmds::default()]), vec![Tmds::default()]);
    let mut symbols = BTreeSet::new();
    while let Some(state) = open.pop() {
        for byte in 0..=255 {
            let mut next = state;
            let symbol = next.pixel(byte);
            assert_eq!(decoded(symbol), Ok(byte), "{byte} after {}", state.disparity);
            symbols.insert(symbol);
            if states.insert(next) {
                open.push(next);
            }
        }
    }
    let reached: BTreeSet<i32> = states.iter().map(|state| state.disparity).collect();
    assert_eq!(reached, (-4..=4).map(|pairs| 2 * pairs).collect());
    // Wikipedia, "Transition-minimized differential signaling": 460 of the 1,024 symbols are data. DVI 1.0, section 3: few transitions are data, many control.
    assert_eq!(symbols.len(), 460);
    let transitions = |symbol: u16| ((symbol ^ symbol >> 1) & 0x1ff).count_ones();
    assert!(symbols.iter().all(|symbol| transitions(*symbol) <= 5));
    assert!(CONTROL.iter().all(|symbol| transitions(*symbol) >= 7));
}

/// Symbols by hand from the flow chart of DVI 1.0's encoder, bit 9 first, and its four of control.
#[test]
fn symbols_are_those_of_the_standard() {
    for (bytes, symbols) in [
        ([0x00, 0x00], [0b01_0000_0000, 0b11_1111_1111]),
        ([0xff, 0xff], [0b10_0000_0000, 0b00_1111_1111]),
        ([0x01, 0x10], [0b01_1111_1111, 0b01_1111_0000]),
        ([0x55, 0x80], [0b01_0011_0011, 0b01_1000_0000]),
    ] {
        let mut encoder = Tmds::default();
        assert_eq!(bytes.map(|byte| encoder.pixel(byte)), symbols, "{bytes:02x?}");
    }
    assert_eq!(CONTROL.map(decoded), [0, 1, 2, 3].map(Err));
    assert_eq!(CONTROL, [0x354, 0x0ab, 0x154, 0x2ab]);
}

/// The bus of a picture that comes again and again.
struct Bus {
    clock: ClockId,
    ports: [usize; 4],
    model: VideoOut,
    codes: Vec<u16>,
    next: usize,
}

impl Actor for Bus {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let taken = self.model.step(Some((self.codes[self.next], self.next == 0)));
        self.next = (self.next + usize::from(taken)) % self.codes.len();
        let pins = self.model.pins();
        let values = [pins.hs.into(), pins.vs.into(), pins.de.into(), pins.data.into()];
        self.ports.into_iter().zip(values).try_for_each(|(port, value)| model.poke(port, value))
    }
}

fn codes(seed: u64) -> Vec<u16> {
    let draw = &mut Draw::new(seed);
    // Some pixels in a row are alike.
    let mut code = BLACK_PIXEL;
    let each = (0..PICTURE.width * PICTURE.height).map(|_| {
        if draw.whole(0, 2) > 0 {
            code = (draw.bits() >> 48) as u16;
        }
        code
    });
    each.collect()
}

/// What the whole screen shows.
fn shown(codes: &[u16]) -> Vec<[u8; 3]> {
    let (width, height) = (PICTURE.width, PICTURE.height);
    let plane = |width: usize, bytes: Vec<u8>| Array2::from_shape_vec((height, width), bytes).unwrap();
    let chroma = |which: usize| codes.iter().skip(which).step_by(2).map(|code| (code >> 8) as u8).collect();
    let luma = codes.iter().map(|code| *code as u8).collect();
    let picture = Picture {
        luma: plane(width, luma),
        chroma: [plane(width / 2, chroma(0)), plane(width / 2, chroma(1))],
    };
    first_light::on_screen(&picture, SCREEN)
}

/// The circuit's frames and what each should show. A word of the serialiser's that changed since the last edge of its bits is seen inverted.
fn frames(seed: u64, edit: &dyn Fn(&str, String) -> String) -> (Result<Vec<Frame>, String>, Vec<[u8; 3]>) {
    let mut source = Source::circuit(&mut Dvi::new(SCREEN)).unwrap().metastable();
    for (name, text) in &mut source.files {
        *text = edit(name, std::mem::take(text));
        if name == "edof_serialiser.v" {
            *text = text.replace("? word_q[10*lane", "? word_seen[10*lane").replace(
                "    reg [2:0] count_q",
                "    reg [10*LANES-1:0] before_q;\n    always @(posedge bit_clock_i) before_q <= word_q;\n    \
                 wire [10*LANES-1:0] word_seen = word_q ^ {10*LANES{word_q != before_q}};\n    reg [2:0] count_q",
            );
            assert!(text.contains("word_seen[10*lane"), "{text}");
        }
    }
    let library = Library::build(&source, &support::options()).unwrap();
    let mut bench = Bench::new(library.start(&Start { seed, ..Start::default() }).unwrap(), seed);
    let clock = bench.clock("clock_i", 40_000).unwrap();
    let bit_clock = bench.multiple("bit_clock_i", 5, clock).unwrap();
    let port = |name: &str| source.port(name).unwrap();
    let (model, codes) = (VideoOut::new(SCREEN.around(PICTURE)), codes(seed));
    let expected = shown(&codes);
    let ports = ["hs_i", "vs_i", "de_i", "data_i"].map(port);
    let mut bus = Bus { clock, ports, model, codes, next: 0 };
    let mut cable = DviCable::new(port("pins_o"), bit_clock);
    bench.set("reset_i", 1).unwrap();
    // Words are cut until changes that are seen early or late lie around the serialiser's count.
    bench.steps(2_000, &mut [&mut bus]).unwrap();
    bench.set("reset_i", 0).unwrap();
    let frame = 6 * SCREEN.line.total() * SCREEN.frame.total();
    bench.steps(7 * frame, &mut [&mut cable, &mut bus]).unwrap();
    (cable.receiver.frames(), expected)
}

fn is_right((frames, expected): &(Result<Vec<Frame>, String>, Vec<[u8; 3]>)) -> bool {
    let axis = |Axis { active, front, sync, back }| LinkAxis { active, front, sync, back };
    let timing = Timing { line: axis(SCREEN.line), frame: axis(SCREEN.frame), khz: 0 };
    frames.as_ref().is_ok_and(|frames| {
        frames.len() >= 4
            && frames.iter().all(|frame| frame.timing == timing && frame.negative == [true; 2])
            && frames[1..].iter().all(|frame| frame.pixels == *expected)
    })
}

#[test]
fn a_screen_gets_every_pixel_and_the_standards_timing_whatever_the_phase_of_the_clocks() {
    for seed in 1..9 {
        let found = frames(seed, &|_, text| text);
        assert!(is_right(&found), "seed {seed}: {:?}", found.0);
    }
}

#[test]
fn mistakes_on_the_way_to_the_pins_are_found() {
    for (file, right, wrong) in [
        ("tmds_encoder", "disparity_4_q[3] == balance[3]", "disparity_4_q[3] != balance[3]"),
        ("sink_rgb", "next_cr = (odd_2_q && de_1_q)", "next_cr = odd_2_q"),
        ("border", "if (row_q == END_ROW)", "if (row_q == END_ROW - 13'd1)"),
        ("edof_ddr_out", "first_1_q <= first_i;", "first_1_q <= second_i;"),
        ("edof_serialiser", "bits_q[10*lane+2 +: 8]", "bits_q[10*lane+1 +: 8]"),
        ("edof_serialiser", "else count_q <= count_q >= 3'd4", "else count_q <= count_q >= 3'd3"),
        ("edof_serialiser", "wire is_off = ", "wire is_off = 1'b0 && "),
        // Three moments of a change never end in the middle.
        ("edof_serialiser", "count_q == 3'd2 ? 3'd2 : 3'd0", "3'd1"),
    ] {
        let edit = |name: &str, text: String| {
            if !name.starts_with(file) {
                return text;
            }
            assert_eq!(text.matches(right).count(), 1, "{right}: {text}");
            text.replace(right, wrong)
        };
        assert!((1..9).any(|seed| !is_right(&frames(seed, &edit))), "{wrong} is not found");
    }
}
