use super::*;
use edof_core::{CfaPhase, DisplayMode, RawFrame};
use edof_io::levels::{Black, Levels};
use edof_io::packing::ByteOrder;
use ndarray::Array2;
use std::sync::mpsc;

const SIZE: Size = Size { width: 48, height: 32 };

fn job(format: VideoFormat) -> StreamJob {
    StreamJob {
        layout: Layout {
            size: SIZE,
            packing: Packing::Bits12,
            order: ByteOrder::Little,
            depth: None,
            phase: CfaPhase::Grbg,
            levels: Levels { black: Black::from(64), white: None },
            line_bytes: None,
        },
        sensor: None,
        network: edof_device::random::natural(12, 8, 3),
        balance: Balance::None,
        matrix: None,
        curve: Curve::Srgb,
        format,
        is_live: false,
    }
}

fn bytes(frames: u8) -> Vec<u8> {
    let frame = |seed: u8| (0..48 * 32 * 3 / 2).map(move |i: usize| (i * 37 + i / 97 * 11) as u8 ^ seed);
    (0..frames).flat_map(|seed| frame(seed.wrapping_mul(17))).collect()
}

/// The picture of a frame by the steps of the pipeline, one after the other.
fn expected(job: &StreamJob, bytes: &[u8]) -> Picture {
    let values = Packing::Bits12.values(bytes, ByteOrder::Little).unwrap();
    let values = Array2::from_shape_vec((SIZE.height, SIZE.width), values).unwrap();
    let raw = RawFrame::from_values(values, 12, CfaPhase::Grbg).unwrap();
    let light = job.layout.levels.light(&raw).unwrap();
    let golden = Golden::new(job.network.clone()).unwrap();
    let (frame, _) = golden.frame_of_light(&light).unwrap();
    let values = job.network.origin.values;
    frame.picture(&Display::of_values(values, DisplayMode::Colour, Curve::Srgb)).0
}

/// A writer whose bytes another thread looks at; it is closed after some of them.
struct Pipe {
    sender: mpsc::Sender<Vec<u8>>,
    left: usize,
}

impl Write for Pipe {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        let some = bytes.len().min(self.left);
        self.left -= some;
        self.sender.send(bytes[..some].to_vec()).unwrap();
        Ok(some)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn piped(job: &StreamJob, input: Vec<u8>, left: usize) -> (Result<Streamed, StreamError>, Vec<u8>) {
    let (sender, receiver) = mpsc::channel();
    let (input, output) = (Box::new(io::Cursor::new(input)), Box::new(Pipe { sender, left }));
    let end = job.run(input, output, &|_| (), &|| ControlFlow::Continue(()));
    (end, receiver.into_iter().flatten().collect())
}

#[test]
fn each_frame_becomes_the_picture_of_the_pipeline_in_every_format() {
    let input = bytes(5);
    let one = input.len() / 5;
    let rate = "25".parse().unwrap();
    for format in [VideoFormat::Y4m(rate), VideoFormat::Planar, VideoFormat::Packed] {
        let job = job(format);
        let (end, found) = piped(&job, input.clone(), usize::MAX);
        let end = end.unwrap();
        assert_eq!((end.pace.frames, end.pace.dropped, end.is_closed, end.is_stopped), (5, 0, false, false));
        let mut wanted = vec![];
        if matches!(format, VideoFormat::Y4m(_)) {
            wanted.extend(y4m::header(SIZE, rate).bytes());
        }
        for bytes in input.chunks_exact(one) {
            let picture = expected(&job, bytes);
            let planes = [&picture.luma, &picture.chroma[0], &picture.chroma[1]];
            match format {
                VideoFormat::Y4m(_) => y4m::write_frame(&mut wanted, planes).unwrap(),
                VideoFormat::Planar => y4m::write_planes(&mut wanted, planes).unwrap(),
                VideoFormat::Packed => wanted.extend(picture.yuyv()),
            }
        }
        assert!(found == wanted, "{format:?}");
    }
}

#[test]
fn a_balance_is_that_of_the_display_and_a_matrix_that_of_a_mix() {
    let input = bytes(1);
    let plain = job(VideoFormat::Packed);
    let balanced = StreamJob { balance: Balance::Fixed("2,1,1.5".parse().unwrap()), ..plain.clone() };
    let identity = "1,0,0,0,1,0,0,0,1".parse().unwrap();
    let mixed = StreamJob { matrix: Some(identity), ..balanced.clone() };
    let codes = |job: &StreamJob| piped(job, input.clone(), usize::MAX).1;
    let (plain, balanced, mixed) = (codes(&plain), codes(&balanced), codes(&mixed));
    assert!(plain != balanced && !balanced.is_empty());
    assert!(balanced.iter().zip(&mixed).all(|(a, b)| a.abs_diff(*b) <= 1));
}

#[test]
fn a_cut_frame_ends_the_stream_after_the_pictures_before_it() {
    let (mut input, job) = (bytes(3), job(VideoFormat::Packed));
    input.truncate(input.len() - 1);
    let (end, found) = piped(&job, input, usize::MAX);
    assert_eq!(
        end.unwrap_err().to_string(),
        "frame 3: ends after 2303 of 2304 bytes, expected whole frames of 48x32 packed as 12p; 2 frames before it are whole, and their pictures are kept"
    );
    assert_eq!(found.len(), 2 * 2 * 48 * 32);
}

#[test]
fn a_reader_that_goes_away_ends_the_stream() {
    let picture = 2 * 48 * 32;
    let (end, found) = piped(&job(VideoFormat::Packed), bytes(40), 2 * picture + 5);
    let end = end.unwrap();
    assert!(end.is_closed && end.pace.frames == 2 && found.len() == 2 * picture + 5);
}

/// A reader that gives frames as fast as they are taken, for ever.
struct Endless(usize);

impl Read for Endless {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.0 += 1;
        bytes.fill(self.0 as u8);
        Ok(bytes.len())
    }
}

#[test]
fn a_live_stream_leaves_frames_out_and_ends_when_it_is_told_to() {
    let job = StreamJob { is_live: true, ..job(VideoFormat::Packed) };
    let (sender, receiver) = mpsc::channel();
    let looks = std::cell::Cell::new(0);
    let flow = || {
        looks.set(looks.get() + 1);
        if looks.get() > 20 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let end =
        job.run(Box::new(Endless(0)), Box::new(Pipe { sender, left: usize::MAX }), &|_| (), &flow).unwrap();
    assert!(end.is_stopped && end.pace.dropped > 0 && end.pace.frames > 0, "{end:?}");
    let written: usize = receiver.into_iter().map(|bytes| bytes.len()).sum();
    assert_eq!(written as u64, end.pace.frames * 2 * 48 * 32);
}
