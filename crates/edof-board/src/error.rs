//! What can go wrong between a host and a board.

use crate::status::NO_PICTURE;
use edof_device::design::DesignError;
use edof_device::i2c::Cause;
use edof_device::registers::map::{ID, VERSION};
use edof_golden::video::greys::GreyError;
use edof_network::fixed_network::FixedNetworkError;

/// What became of a line, where the system's own words do not say what to do.
fn of_line(source: &std::io::Error) -> String {
    use std::io::ErrorKind::{
        BrokenPipe, ConnectionReset, NotConnected, PermissionDenied, ResourceBusy, UnexpectedEof,
    };
    // Input/output error, no such device or address, no such device: a port that was unplugged, a terminal that nobody serves any more.
    const GONE: [i32; 3] = [5, 6, 19];
    let gone = source.raw_os_error().is_some_and(|code| GONE.contains(&code));
    let text = source.to_string();
    match source.kind() {
        _ if text.contains("exclusive lock") || text.contains("busy") => has_the_port(&text),
        ResourceBusy => has_the_port(&text),
        PermissionDenied => format!("{text}: the user must be in the group of the port, on Debian dialout"),
        _ if ["I/O error", "No such device"].iter().any(|told| text.contains(told)) => went_away(&text),
        BrokenPipe | ConnectionReset | NotConnected | UnexpectedEof => went_away(&text),
        _ if gone => went_away(&text),
        _ => text,
    }
}

fn has_the_port(text: &str) -> String {
    format!("another program has the port ({text}); end that program, or name another port by --port")
}

fn went_away(text: &str) -> String {
    format!(
        "the board went away ({text}): cable, power, or a simulated board that ended; once it answers again, 'edof board info' prints what it holds"
    )
}

/// Why nothing, or not all, came of what was asked.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum Error {
    /// The line cannot be opened or used.
    #[error("{port}: {}", of_line(source))]
    Port { port: String, source: std::io::Error },
    /// Nothing comes back.
    #[error(
        "{port}: no answer at {baud} bits per second, asked {asked} times: check cable, power and --baud, and that a bitstream of edof is loaded"
    )]
    Silent { port: String, baud: u32, asked: u32 },
    /// What comes back is not the same twice, or what is sent does not arrive.
    #[error(
        "{port}: {what} failed in {tried} attempts: the line is noisy, another sender uses it, or --baud is not the board's speed"
    )]
    Noisy { port: String, what: String, tried: u32 },
    /// Words that the board's protection keeps out.
    #[error(
        "{port}: words for 0x{address:x} are rejected: they belong to the bank or the tables in use, or to a bank in a check (protection)"
    )]
    Refused { port: String, address: u32 },
    /// No serial port.
    #[error("{port}: {problem}; expected a serial port, as in /dev/ttyUSB0, or the link of 'edof board sim'")]
    NoPort { port: String, problem: String },
    /// No board of ours.
    #[error(
        "{port}: reads 0x{found:08x} as id, expected 0x{ID:08x} (EDOF): no board of edof, or another speed"
    )]
    Stranger { port: String, found: u32 },
    /// A board of another time.
    #[error(
        "{port}: has version {}.{} of the register map, expected {}.{} or a later {}.x: load the bitstream of this program's design",
        found >> 16, found & 0xffff, VERSION >> 16, VERSION & 0xffff, VERSION >> 16
    )]
    Version { port: String, found: u32 },
    /// A name that stands for nothing.
    #[error("register '{name}': there is none; edof board dump lists all")]
    NoRegister { name: String },
    /// A field that a register does not have.
    #[error("register '{register}.{field}': {register} has {}", if fields.is_empty() { "no fields".into() } else { format!("the fields {fields}") })]
    NoField { register: String, field: String, fields: String },
    /// A word outside of a window.
    #[error("register '{window}[{index}]': must be a word from 0 to {max}")]
    NoWord { window: String, index: String, max: u32 },
    /// What can only be read, or only written.
    #[error("register '{name}': can only be {only}")]
    OneWay { name: String, only: &'static str },
    /// A value that does not fit.
    #[error("register '{name}', value {value}: must be {expected}")]
    Value { name: String, value: String, expected: String },
    /// A design whose memories are unknown.
    #[error(
        "{port}: the board's design {hash:08x}, {width}x{height}, is none that this program knows: name its file by --design"
    )]
    UnknownDesign { port: String, hash: u32, width: u32, height: u32 },
    /// Another design than the one that was named.
    #[error("{port}: the board's design is {found:08x}, that of --design {name} is {expected:08x}")]
    OtherDesign { port: String, name: String, found: u32, expected: u32 },
    /// A network that does not fit the design.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// A network that cannot run exactly.
    #[error(transparent)]
    Network(#[from] FixedNetworkError),
    /// What the board holds is not what it should.
    #[error(
        "{port}: bank {bank} does not hold {weights}: {wrong} of {pieces} parts differ, the first is {first}"
    )]
    Differs { port: String, bank: char, weights: String, wrong: usize, pieces: usize, first: String },
    /// The tables of the display are not what they should be.
    #[error(
        "{port}: the display's tables are not those of {curve}: {wrong} parts differ, the first is {first}"
    )]
    TablesDiffer { port: String, curve: String, wrong: usize, first: String },
    /// The tables of the display are unknown.
    #[error(
        "{port}: the display's tables are those of no curve that this program has: load them with a network by --curve"
    )]
    UnknownTables { port: String },
    /// The load did not come to its end.
    #[error(
        "{port}: {wrong} parts of bank {bank} still differ after {rounds} rounds; bank {active} is in use as before"
    )]
    NotLoaded { port: String, bank: char, active: char, wrong: usize, rounds: u32 },
    /// The tables of the display did not come through.
    #[error(
        "{port}: tables of the display still differ after {rounds} rounds; the picture is frozen until they are loaded"
    )]
    TablesNotLoaded { port: String, rounds: u32 },
    /// No pseudo-terminal.
    #[error("pseudo-terminal: {0}")]
    Terminal(String),
    /// A line that the circuit's clock cannot make.
    #[error("{baud} bits per second: must be {min} to {max}, of the clock of the circuit")]
    Speed { baud: u32, min: u32, max: u32 },
    /// A simulation that stopped.
    #[error("the simulated board stopped: {0}")]
    Simulation(#[source] Box<dyn std::error::Error + Send + Sync>),
    /// A chip around the board that does not do what it should.
    #[error("{port}: chip 0x{device:02x}: {cause}; 'edof board status' says how the chips are")]
    Chip { port: String, device: u8, cause: Cause },
    /// The engine of an I2C bus never answered.
    #[error("{port}: the set-up of the video chips does not answer: the board is held in reset, or has none")]
    NoSetUp { port: String },
    /// The receiver is not set up.
    #[error(
        "{port}: the receiver is not set up, so that there is nothing to align; 'edof board status' says why"
    )]
    NoReceiver { port: String },
    /// The receiver has the clock of another mode.
    #[error(
        "{port}: the receiver's clock is {found:.2} MHz, the design's {expected:.2} MHz: a setting for one clock says nothing of another; \
         let the source send {mode}, or unplug it: the receiver then sends a picture of its own at the design's clock"
    )]
    OtherClock { port: String, found: f64, expected: f64, mode: String },
    /// Nothing came from the receiver.
    #[error(
        "{port}: no sync codes came at any setting of the receiver's clock: it does not run, or its pins are wired otherwise; the settings \
         are as before"
    )]
    NoCodes { port: String },
    /// No setting works.
    #[error(
        "{port}: no setting of the receiver's clock gives undamaged sync codes, the best of 64 damaged {min} of {of} words; the \
         settings are as before: look at the input's timing"
    )]
    NoWindow { port: String, min: u32, of: u32 },
    /// No frame passes the calculator.
    #[error("{port}: no whole frame passes the calculator; 'edof board status' says what comes and goes")]
    NoFrame { port: String },
    /// No picture was made since the last reset.
    #[error("{port}: no picture yet, {NO_PICTURE}")]
    NoPicture { port: String },
    /// A chart that carries no words.
    #[error("{port}: {source}")]
    Grey { port: String, source: GreyError },
    /// The frame has no room for the chart.
    #[error(
        "{port}: frames of {width}x{height} pixels have no room for the chart of greys, expected 64x64 or more"
    )]
    NoRoom { port: String, width: u32, height: u32 },
    /// A raw frame of another size than the board's.
    #[error("{port}: a raw frame of {}x{} pixels, expected {}x{}, the board's", found.0, found.1, expected.0, expected.1)]
    FrameSize { port: String, found: (usize, usize), expected: (usize, usize) },
    /// A block of a raw frame did not come through.
    #[error(
        "{port}: block {block} of {blocks} of the raw frame was not accepted in {tried} attempts: the line is noisy, or another sender uses it"
    )]
    BlockLost { port: String, block: usize, blocks: usize, tried: u32 },
    /// What the calculator reads is not the raw frame that was put.
    #[error(
        "{port}: the raw frame in the memory has CRC {found:08x}, expected {expected:08x}: 'edof board selftest' tests the memory"
    )]
    FrameDiffers { port: String, found: u32, expected: u32 },
    /// The user asked to stop.
    #[error("interrupted")]
    Interrupted,
}
