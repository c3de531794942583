//! The camera's set-up: what it makes a model of the chip send.

use edof_board::chip_models::ov7670::Scene;
use edof_board::chip_models::{Master, Ov7670};
use edof_board::simulated::setup::{ChipBus, Setup};
use edof_core::draw::Draw;
use edof_core::geometry::Stride;
use edof_device::design::FrameSize;
use edof_device::i2c::{Action, Cause, Entry, ov7670};
use edof_golden::video::{CameraIn, VideoIn};
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

const FRAME: FrameSize = FrameSize { width: 34, height: 22, stride: Stride::PATCH };
/// Picoseconds of a millisecond.
const MILLISECOND: u64 = 1_000_000_000;
/// Cycles of a frame.
const CYCLES: usize = 784 * 510;

/// Light that differs from pixel to pixel and from colour to colour.
fn light(column: usize, row: usize) -> [u8; 3] {
    let place = 4 * (row * 656 + column) as u64;
    [0, 1, 2].map(|colour| (Draw::new(place + colour).bits() >> 56) as u8)
}

/// Red first, from the middle of the usual picture of 640×480, which is eight columns and four rows inside of the array; its first pixel is blue.
fn seen(size: FrameSize) -> Vec<u8> {
    let middle = |whole: usize, part: usize| (whole - part) / 4 * 2;
    let (left, top) = (8 + middle(640, size.width) + 1, 4 + middle(480, size.height) + 1);
    let row =
        |row: usize| (0..size.width).map(move |column| light(left + column, top + row)[row % 2 + column % 2]);
    (0..size.height).flat_map(row).collect()
}

/// The camera on two wires, as what sets it up sees it.
struct Bus(Rc<RefCell<Ov7670>>);

impl ChipBus for Bus {
    fn write(&mut self, device: u8, bytes: &[u8]) -> Result<(), Cause> {
        Master::new(&mut *self.0.borrow_mut()).write(device, bytes).map_err(|_| Cause::Refused)
    }

    fn read(&mut self, device: u8, pointer: &[u8]) -> Result<u8, Cause> {
        let read = Master::new(&mut *self.0.borrow_mut()).read(device, pointer, 1);
        read.map(|bytes| bytes[0]).map_err(|_| Cause::Refused)
    }
}

/// A camera after a program has run in true milliseconds; none if the program fails.
fn set_up(program: Vec<Entry>) -> Option<Ov7670> {
    let scene: Scene = Box::new(light);
    let camera = Rc::new(RefCell::new(Ov7670::new(scene, MILLISECOND)));
    let mut setup = Setup::new(Bus(Rc::clone(&camera)), program, true);
    let mut now = Duration::ZERO;
    while !setup.is_done && !setup.has_failed() {
        let on = setup.slots(8) >> (8 * (ov7670::PINS - 8));
        camera.borrow_mut().set_pins(now.as_nanos() as u64 * 1000, on & 1 == 0, on & 2 == 2);
        now += setup.step(0);
    }
    let is_done = setup.is_done;
    drop(setup);
    is_done.then(|| Rc::into_inner(camera).unwrap().into_inner())
}

fn program(size: FrameSize) -> Vec<Entry> {
    ov7670::program(ov7670::TIMING.around(size), [0, 0])
}

/// What the core's receiver takes for frames in two of the camera's; the words' lower bits are 0.
fn frames(camera: &mut Ov7670, size: FrameSize) -> Vec<Vec<u8>> {
    let mut bus = CameraIn::new(0);
    let mut receiver = VideoIn::new(size, ov7670::TIMING.signal_time_out());
    let (mut open, mut whole) = (None::<Vec<u8>>, vec![]);
    for _ in 0..2 * CYCLES {
        let dvp = camera.cycle();
        bus.step(dvp.vs, dvp.href, dvp.data);
        if let Some(beat) = receiver.beat() {
            if beat.first {
                open = Some(vec![]);
            }
            if let Some(pixels) = &mut open {
                assert_eq!(beat.pixel & 0xff, 0);
                pixels.push((beat.pixel >> 8) as u8);
                if pixels.len() == size.width * size.height {
                    whole.extend(open.take());
                }
            }
        }
        receiver.step(bus.pins(), true);
    }
    // A frame that came whole but does not fit is marked.
    let measured = receiver.measured();
    if measured.wrong_frames > 0 { vec![] } else { whole }
}

#[test]
fn a_chip_that_is_set_up_sends_red_first_frames_of_the_designs_size() {
    for (width, height) in [(34, 22), (128, 80), (638, 478), (640, 480)] {
        let size = FrameSize { width, height, ..FRAME };
        let mut camera = set_up(program(size)).unwrap();
        assert_eq!(camera.complaints(), &[] as &[String]);
        assert_eq!(camera.exposure(), 256);
        // 25 MHz come in, and the pixel clock is what the board states.
        let khz = 1_000_000_000 / camera.pixel_clock(40_000).unwrap();
        assert_eq!(khz as usize, ov7670::TIMING.pixel_khz);
        // The frame in whose middle the camera starts is none.
        assert!(frames(&mut camera, size) == [seen(size)], "{width}x{height}");
    }
}

#[test]
fn a_window_is_moved_by_as_many_pixels_as_the_module_needs() {
    let window = |corner| {
        let mut camera = set_up(ov7670::program(ov7670::TIMING.around(FRAME), corner)).unwrap();
        frames(&mut camera, FRAME).remove(0)
    };
    let (usual, width) = (window([0, 0]), FRAME.width);
    let at = |frame: &[u8], row: usize, column: usize| frame[row * width + column];
    for [right, down] in [[2, 0], [0, 2], [-2, -4], [8, -8]] {
        let moved = window([right, down]);
        let both = |length: usize, by: i8| {
            (0..length)
                .filter_map(move |i| Some((i, i.checked_add_signed(by.into())?)))
                .filter(move |(_, j)| *j < length)
        };
        for (row, from) in both(FRAME.height, down) {
            for (column, begin) in both(width, right) {
                assert_eq!(at(&moved, row, column), at(&usual, from, begin), "{right}, {down}");
            }
        }
    }
}

fn is_right(program: Vec<Entry>) -> bool {
    set_up(program).is_some_and(|mut camera| {
        camera.pixel_clock(40_000) == Some(80_000)
            && camera.complaints().is_empty()
            && frames(&mut camera, FRAME) == [seen(FRAME)]
    })
}

#[test]
fn a_set_up_without_any_of_its_steps_is_found() {
    let whole = program(FRAME);
    assert!(is_right(whole.clone()));
    for place in (0..whole.len()).filter(|place| whole[*place].action != Action::Done) {
        let mut program = whole.clone();
        let removed = program.remove(place);
        assert!(!is_right(program), "{removed:?} is not needed");
    }
}

#[test]
fn a_window_or_a_format_that_is_off_is_found() {
    // A pixel left, a pixel narrower, a line up, a line less, a processed mosaic, the chip's own window, automatic exposure.
    for (register, wrong) in
        [(0x32, 0x01), (0x32, 0x08), (0x03, 0x01), (0x03, 0x04), (0x12, 0x04), (0x3a, 0x01), (0x13, 0x01)]
    {
        let mut program = program(FRAME);
        // The last write of the register.
        let value = program.iter_mut().rev().find_map(|entry| match &mut entry.action {
            Action::Write { register: at, value, .. } if *at == register => Some(value),
            _ => None,
        });
        *value.unwrap() ^= wrong;
        assert!(!is_right(program), "register {register:02x}");
    }
}
