//! From a stream of raw frames to a stream of pictures, in memory that is kept.
//!
//! | what | module |
//! |---|---|
//! | bytes, sensor values and words of a frame | [`input`] |
//! | white balance, fixed or followed | [`balance`] |
//! | frames on their way between threads | [`queue`] |
//! | rates and latencies | [`tally`] |
//!
//! One thread reads, one computes (with the threads of the pool), one writes. Frames stay in their order. The queues between them are short, so that
//! a slow reader of the pictures slows the stream down, or, live, has frames left out.

mod balance;
mod input;
mod queue;
mod tally;

pub use balance::Balance;
pub use input::Layout;
pub use tally::{FirstFrame, Pace};

use balance::Follower;
use edof_core::Tone;
use edof_core::frame::FrameError;
use edof_core::geometry::GeometryError;
use edof_golden::{Curve, Display, Golden, Mix, Picture};
use edof_io::levels::LevelsError;
use edof_io::packing::{LineError, Packing};
use edof_io::raw::Size;
use edof_io::rendering::ColourMatrix;
use edof_io::sensor::{Correction, OtherSensor, OtherValues};
use edof_io::y4m::{self, Rate};
use edof_network::FixedNetwork;
use edof_network::fixed_network::FixedNetworkError;
use input::Words;
use queue::{Popped, Queue};
use std::io::{self, Read, Write};
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tally::Tally;

/// Frames that wait for a thread.
const WAITING: usize = 2;
/// How long a thread waits before it looks whether the stream is to end.
const LOOK: Duration = Duration::from_millis(100);
/// Gains that differ by less share their tables.
const SAME_GAIN: f64 = 0.002;

/// A stream: what comes in, how it becomes pictures, what goes out.
#[derive(Debug, Clone)]
pub struct StreamJob {
    /// How the frames lie in bytes.
    pub layout: Layout,
    /// Correction of the sensor, in place of levels.
    pub sensor: Option<Arc<Correction>>,
    /// The network, whose integers are computed.
    pub network: FixedNetwork,
    /// White balance.
    pub balance: Balance,
    /// From balanced colours to linear sRGB.
    pub matrix: Option<ColourMatrix>,
    /// Transfer curve of the pictures.
    pub curve: Curve,
    /// Format of the pictures.
    pub format: VideoFormat,
    /// Whether frames that come too fast are left out; otherwise they wait.
    pub is_live: bool,
}

/// A form of 8-bit Y′CbCr 4:2:2, BT.709 in studio range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VideoFormat {
    /// YUV4MPEG2, which states size and rate.
    Y4m(Rate),
    /// Planes of luma, Cb and Cr without a header, ffmpeg's `yuv422p`.
    Planar,
    /// Bytes Y Cb Y Cr without a header, ffmpeg's `yuyv422`.
    Packed,
}

/// A stream that cannot go on.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum StreamError {
    /// Bytes end inside of a frame.
    #[error(
        "frame {number}: ends after {found} of {expected} bytes, expected whole frames of {size} packed as {}; {} before it are whole, and their pictures are kept",
        packing.name(), edof_core::words::count((*number - 1) as usize, "frame")
    )]
    Cut { number: u64, found: usize, expected: usize, size: Size, packing: Packing },
    /// Bytes that cannot be read.
    #[error("frame {number}: cannot be read: {source}")]
    Read { number: u64, source: io::Error },
    /// Bytes that cannot be written.
    #[error("frame {number}: cannot be written: {source}")]
    Write { number: u64, source: io::Error },
    /// A sensor value of too many bits.
    #[error(
        "frame {number}: pixel at row {row}, column {column} is {value}, more than {depth} bits can hold"
    )]
    Value { number: u64, row: usize, column: usize, value: u16, depth: u32 },
    /// A byte of video that carries no part of a word.
    #[error(
        "frame {number}: pixel at row {row}, column {column}: byte {code} carries no part of a word, expected 64 to 191"
    )]
    Code { number: u64, row: usize, column: usize, code: u8 },
    /// Lines that cannot be padded so.
    #[error(transparent)]
    LineBytes(#[from] LineError),
    /// Frames that cannot be raw frames.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// Levels that frames cannot have.
    #[error(transparent)]
    Levels(#[from] LevelsError),
    /// A correction of another sensor.
    #[error(transparent)]
    Sensor(#[from] OtherSensor),
    /// A correction of frames of other values.
    #[error(transparent)]
    SensorValues(#[from] OtherValues),
    /// Frames too small for a window.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A network that could not run exactly.
    #[error(transparent)]
    Network(#[from] FixedNetworkError),
    /// No thread is left.
    #[error(
        "a thread cannot be started: {0}; the limit of processes and threads is reached (ulimit -u, or that of a container)"
    )]
    Thread(io::Error),
}

/// How a stream ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Streamed {
    /// Frames, rate and latency of the whole stream.
    pub pace: Pace,
    /// Whether the reader of the pictures went away.
    pub is_closed: bool,
    /// Whether the caller stopped it.
    pub is_stopped: bool,
}

/// The bytes of a frame, and when the last one came.
struct Arrived {
    number: u64,
    bytes: Vec<u8>,
    at: Instant,
}

/// A picture on its way out.
struct Made {
    number: u64,
    picture: Picture,
    at: Instant,
}

/// Queues, counts and the first failure: shared by all threads.
struct Shared {
    arrived: Queue<Arrived>,
    /// Memory of frames that were computed.
    free: Queue<Vec<u8>>,
    made: Queue<Made>,
    /// Memory of pictures that were written.
    written: Queue<Picture>,
    tally: Mutex<Tally>,
    failure: Mutex<Option<StreamError>>,
}

impl Shared {
    fn new() -> Self {
        Self {
            arrived: Queue::new(WAITING),
            free: Queue::new(WAITING + 1),
            made: Queue::new(1),
            written: Queue::new(2),
            tally: Mutex::new(Tally::new(Instant::now())),
            failure: Mutex::new(None),
        }
    }

    fn tally(&self) -> MutexGuard<'_, Tally> {
        self.tally.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps the first failure.
    fn fail(&self, error: StreamError) {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }

    fn failure(&self) -> Option<StreamError> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl StreamJob {
    /// Checks what can be checked before the first frame.
    ///
    /// # Errors
    /// Levels, a size or a network that no frame can have.
    pub fn check(&self) -> Result<(), StreamError> {
        self.prepare().map(drop)
    }

    fn prepare(&self) -> Result<(Golden, Words), StreamError> {
        let golden = Golden::new(self.network.clone())?;
        let Size { width, height } = self.layout.size;
        golden.geometry().check_frame((height, width))?;
        let words = Words::new(self.layout, self.sensor.clone(), golden.network().origin.values)?;
        Ok((golden, words))
    }

    /// Reads frames until the input ends or `flow` says so, and writes a picture for each. Calls `tell` about once a second.
    ///
    /// # Errors
    /// [`StreamError`]; all pictures before it have been written.
    pub fn run(
        &self,
        input: Box<dyn Read + Send>,
        output: Box<dyn Write + Send>,
        tell: &dyn Fn(&Pace),
        flow: &dyn Fn() -> ControlFlow<()>,
    ) -> Result<Streamed, StreamError> {
        let (golden, words) = self.prepare()?;
        let shared = Arc::new(Shared::new());
        self.start_reader(input, Arc::clone(&shared))?;
        let writer = self.start_writer(output, Arc::clone(&shared))?;
        let end = self.compute(&golden, words, &shared, tell, flow);
        shared.arrived.close();
        // What was made is still written.
        shared.made.close();
        let is_closed = writer.join().unwrap_or(false);
        match end.err().or_else(|| shared.failure()) {
            Some(error) => Err(error),
            None => Ok(Streamed {
                pace: shared.tally().all(Instant::now()),
                is_closed,
                is_stopped: flow().is_break(),
            }),
        }
    }

    /// Starts the thread that reads. Nobody waits for it: an input may never end.
    fn start_reader(&self, mut input: Box<dyn Read + Send>, shared: Arc<Shared>) -> Result<(), StreamError> {
        let (layout, is_live) = (self.layout, self.is_live);
        let read = move || {
            for number in 1.. {
                let mut bytes = shared.free.try_pop().unwrap_or_default();
                match layout.read(number, &mut *input, &mut bytes) {
                    Ok(true) => {}
                    Ok(false) => break,
                    Err(error) => {
                        shared.fail(error);
                        break;
                    }
                }
                let arrived = Arrived { number, bytes, at: Instant::now() };
                if !is_live {
                    if shared.arrived.push(arrived).is_err() {
                        break;
                    }
                } else if let Some(dropped) = shared.arrived.push_newest(arrived) {
                    shared.tally().dropped();
                    drop(shared.free.push_newest(dropped.bytes));
                }
            }
            shared.arrived.close();
        };
        std::thread::Builder::new().name("frames".into()).spawn(read).map(drop).map_err(StreamError::Thread)
    }

    /// Starts the thread that writes; it returns whether the reader of the pictures went away.
    fn start_writer(
        &self,
        mut output: Box<dyn Write + Send>,
        shared: Arc<Shared>,
    ) -> Result<std::thread::JoinHandle<bool>, StreamError> {
        let (format, size) = (self.format, self.layout.size);
        let write = move || {
            let end = write_all(format, size, &mut *output, &shared);
            shared.made.close();
            match end {
                Err((_, source)) if source.kind() == io::ErrorKind::BrokenPipe => true,
                Err((number, source)) => {
                    shared.fail(StreamError::Write { number, source });
                    false
                }
                Ok(()) => false,
            }
        };
        std::thread::Builder::new().name("pictures".into()).spawn(write).map_err(StreamError::Thread)
    }

    fn compute(
        &self,
        golden: &Golden,
        mut words: Words,
        shared: &Shared,
        tell: &dyn Fn(&Pace),
        flow: &dyn Fn() -> ControlFlow<()>,
    ) -> Result<(), StreamError> {
        let mut stream = golden.stream();
        let mut screen = Screen::new(self, golden.network().origin.values);
        let tick = || {
            // The lock is not held while somebody else's function runs.
            let second = shared.tally().second(Instant::now());
            second.iter().for_each(tell);
        };
        while flow().is_continue() {
            tick();
            let Arrived { number, bytes, at } = match shared.arrived.pop(LOOK) {
                Popped::Item(arrived) => arrived,
                Popped::Nothing => continue,
                Popped::Closed => break,
            };
            let raw = words.frame(number, &bytes)?;
            words.first().into_iter().for_each(|first| shared.tally().began(first));
            drop(shared.free.push_newest(bytes));
            let mut picture = shared.written.try_pop().unwrap_or_else(Picture::empty);
            let frame = stream.frame(&raw)?;
            screen.show(frame, &raw, &mut picture);
            words.keep(raw);
            if shared.made.push(Made { number, picture, at }).is_err() {
                break;
            }
        }
        Ok(())
    }
}

/// Writes pictures until none comes. An error has the number of its frame.
fn write_all(
    format: VideoFormat,
    size: Size,
    output: &mut dyn Write,
    shared: &Shared,
) -> Result<(), (u64, io::Error)> {
    if let VideoFormat::Y4m(rate) = format {
        output.write_all(y4m::header(size, rate).as_bytes()).map_err(|error| (1, error))?;
    }
    loop {
        let Made { number, picture, at } = match shared.made.pop(LOOK) {
            Popped::Item(made) => made,
            Popped::Nothing => continue,
            Popped::Closed => return output.flush().map_err(|error| (0, error)),
        };
        let planes = [&picture.luma, &picture.chroma[0], &picture.chroma[1]];
        let written = match format {
            VideoFormat::Y4m(_) => y4m::write_frame(output, planes),
            VideoFormat::Planar => y4m::write_planes(output, planes),
            VideoFormat::Packed => output.write_all(&picture.yuyv()),
        };
        written.and_then(|()| output.flush()).map_err(|error| (number, error))?;
        shared.tally().written(at, Instant::now());
        drop(shared.written.push_newest(picture));
    }
}

/// The display step of a stream; its tables follow the white balance.
struct Screen {
    values: Tone,
    curve: Curve,
    matrix: Option<[[f64; 3]; 3]>,
    follower: Follower,
    /// Gains that the tables have.
    gains: [f64; 3],
    tables: Tables,
}

enum Tables {
    Plain(Box<Display>),
    Mixed(Box<Mix>),
}

impl Screen {
    fn new(job: &StreamJob, values: Tone) -> Self {
        let (curve, matrix) = (job.curve, job.matrix.map(Into::into));
        let gains = [1.0; 3];
        let tables = Tables::new(values, curve, gains, matrix);
        Self { values, curve, matrix, follower: Follower::new(job.balance), gains, tables }
    }

    /// Makes the picture of a frame, whose raw words the white balance looks at.
    fn show(&mut self, frame: &edof_golden::GoldenFrame, raw: &edof_core::RawFrame, picture: &mut Picture) {
        let gains = self.follower.gains(raw, self.values);
        if gains.iter().zip(self.gains).any(|(new, old)| (new / old - 1.0).abs() > SAME_GAIN) {
            self.gains = gains;
            self.tables = Tables::new(self.values, self.curve, gains, self.matrix);
        }
        match &self.tables {
            Tables::Plain(display) => frame.picture_into(display, picture),
            Tables::Mixed(mix) => mix.picture_into(frame, picture),
        };
    }
}

impl Tables {
    fn new(values: Tone, curve: Curve, gains: [f64; 3], matrix: Option<[[f64; 3]; 3]>) -> Self {
        match matrix {
            None if gains == [1.0; 3] => {
                Self::Plain(Box::new(Display::of_values(values, edof_core::DisplayMode::Colour, curve)))
            }
            None => Self::Plain(Box::new(Display::balanced(values, curve, gains))),
            Some(rows) => Self::Mixed(Box::new(Mix::new(values, curve, gains, rows))),
        }
    }
}

#[cfg(test)]
mod tests;
