//! A running instance.

use super::interface::Instance;
use super::library::Library;
use crate::{Direction, Error, Rows, rows};
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::ptr::NonNull;

/// How an instance starts.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Start {
    /// Seed of the start values of registers and memories (with [`super::Unknowns::Random`]).
    pub seed: u64,
    /// Where relative paths of `$readmemh` start; without it, in the working directory of the process.
    pub memory_dir: Option<PathBuf>,
}

/// A running instance of a compiled design. It may move between threads.
#[derive(Debug)]
pub struct Model {
    instance: NonNull<Instance>,
    library: Library,
}

// SAFETY: an instance has no ties to the thread that made it; the shim names its context to Verilator in every call that
// evaluates, and all methods that change it take `&mut self`.
unsafe impl Send for Model {}

impl Library {
    /// A fresh instance: memories loaded, inputs 0, clocks low.
    ///
    /// # Errors
    /// A memory image is missing or broken.
    pub fn start(&self, start: &Start) -> Result<Model, Error> {
        Model::start(self.clone(), start)
    }
}

impl Model {
    fn start(library: Library, start: &Start) -> Result<Self, Error> {
        let dir = start.memory_dir.as_deref().map_or_else(|| Ok(CString::default()), c_path)?;
        // SAFETY: `dir` is a C string, which the shim forgets before it returns.
        let instance = unsafe { (library.interface.create)(start_seed(start.seed), 1, dir.as_ptr()) };
        match NonNull::new(instance) {
            Some(instance) => Ok(Self { instance, library }),
            None => Err(library.stopped()),
        }
    }

    /// What it is an instance of.
    #[must_use]
    pub const fn library(&self) -> &Library {
        &self.library
    }

    /// Gives an input a value of at most 64 bits; of a wider port, the rest becomes 0.
    ///
    /// # Errors
    /// The port is not an input, or is a clock.
    pub fn poke(&mut self, port: usize, value: u64) -> Result<(), Error> {
        let words = [value as u32, (value >> 32) as u32];
        match self.input(port)? {
            ..=2 => self.poke_raw(port, &words),
            wide => {
                let mut all = vec![0; wide];
                rows::put(&mut all, value, 64);
                self.poke_raw(port, &all);
            }
        }
        Ok(())
    }

    /// Gives an input its value in 32-bit words, the least significant first.
    ///
    /// # Errors
    /// The port is not an input, or is a clock, or has another number of words.
    pub fn poke_words(&mut self, port: usize, words: &[u32]) -> Result<(), Error> {
        self.expect_words(port, self.input(port)?, words.len())?;
        self.poke_raw(port, words);
        Ok(())
    }

    /// The settled value of any port; its low 64 bits if it is wider.
    ///
    /// # Errors
    /// There is no such port, or the simulation stops.
    pub fn peek(&mut self, port: usize) -> Result<u64, Error> {
        match self.any(port)? {
            ..=2 => {
                let mut words = [0; 2];
                self.peek_raw(port, &mut words)?;
                Ok(rows::get(&words))
            }
            wide => {
                let mut words = vec![0; wide];
                self.peek_raw(port, &mut words)?;
                Ok(rows::get(&words))
            }
        }
    }

    /// The value of a port of up to 64 bits while the clocks that rose last are high: before inputs change or anything is read.
    ///
    /// # Errors
    /// There is no such port, or it is wider.
    pub fn peek_high(&self, port: usize) -> Result<u64, Error> {
        self.expect_words(port, self.any(port)?.max(2), 2)?;
        let mut words = [0; 2];
        // SAFETY: the instance lives, and the port has at most as many words as the shim writes.
        unsafe { (self.library.interface.peek)(self.instance.as_ptr(), port as u32, words.as_mut_ptr()) };
        Ok(rows::get(&words))
    }

    /// The settled value of any port in 32-bit words, the least significant first.
    ///
    /// # Errors
    /// There is no such port, or it has another number of words, or the simulation stops.
    pub fn peek_words(&mut self, port: usize, words: &mut [u32]) -> Result<(), Error> {
        self.expect_words(port, self.any(port)?, words.len())?;
        self.peek_raw(port, words)
    }

    /// Gives all inputs their values: a row of [`Library::inputs`].
    ///
    /// # Errors
    /// The row has another width.
    pub fn apply(&mut self, row: &[u32]) -> Result<(), Error> {
        expect_width(row.len(), self.library.inputs().words())?;
        // SAFETY: the instance lives, and the row has as many words as the shim reads.
        unsafe { (self.library.interface.apply)(self.instance.as_ptr(), row.as_ptr()) };
        Ok(())
    }

    /// The settled values of all outputs: a row of [`Library::outputs`].
    ///
    /// # Errors
    /// The row has another width, or the simulation stops.
    pub fn sample(&mut self, row: &mut [u32]) -> Result<(), Error> {
        expect_width(row.len(), self.library.outputs().words())?;
        self.eval()?;
        // SAFETY: the instance lives, and the row has as many words as the shim writes.
        unsafe { (self.library.interface.sample)(self.instance.as_ptr(), row.as_mut_ptr()) };
        Ok(())
    }

    /// Lets the outputs follow the inputs. Reading does so by itself.
    ///
    /// # Errors
    /// The simulation stops.
    pub fn eval(&mut self) -> Result<(), Error> {
        // SAFETY: the instance lives.
        let status = unsafe { (self.library.interface.settle)(self.instance.as_ptr()) };
        self.check(status)
    }

    /// Ends the cycle: outputs settle, then all clocks rise together.
    ///
    /// # Errors
    /// The simulation stops.
    pub fn tick(&mut self) -> Result<(), Error> {
        // SAFETY: the instance lives.
        let status = unsafe { (self.library.interface.tick)(self.instance.as_ptr()) };
        self.check(status)
    }

    /// Ends the cycle of some clocks, by their ports: outputs settle, then these rise together and the others do nothing.
    ///
    /// # Errors
    /// One of the ports is not a clock, or the simulation stops.
    pub fn rise(&mut self, clocks: &[usize]) -> Result<(), Error> {
        let ports = &self.library.source().ports;
        if let Some(port) = clocks.iter().find(|port| !ports.get(**port).is_some_and(|port| port.is_clock)) {
            return Err(Error::Port(format!("port {port} is not a clock")));
        }
        let numbers: Vec<u32> = clocks.iter().map(|port| *port as u32).collect();
        // SAFETY: the instance lives, and the shim reads as many numbers as there are.
        let status =
            unsafe { (self.library.interface.rise)(self.instance.as_ptr(), numbers.as_ptr(), numbers.len()) };
        self.check(status)
    }

    /// For each row of inputs: apply, sample, tick. Gives the rows of outputs.
    ///
    /// # Errors
    /// The rows have another width, or the simulation stops.
    pub fn run(&mut self, stimulus: &Rows) -> Result<Rows, Error> {
        expect_width(stimulus.width(), self.library.inputs().words())?;
        let mut outputs = Rows::zeros(self.library.outputs().words(), stimulus.len());
        let (from, to) = (stimulus.words().as_ptr(), outputs.words_mut().as_mut_ptr());
        // SAFETY: the instance lives, and both tables have a row of the right width for each cycle.
        let status =
            unsafe { (self.library.interface.run)(self.instance.as_ptr(), stimulus.len(), from, to) };
        self.check(status).map(|()| outputs)
    }

    /// Number of the current cycle, that is, how many times clocks rose.
    #[must_use]
    pub fn cycle(&self) -> u64 {
        // SAFETY: the instance lives.
        unsafe { (self.library.interface.cycle)(self.instance.as_ptr()) }
    }

    /// From now on, writes the cycles `from..=to` to a waveform file, one cycle 10 ns. A window that lies in the past needs a
    /// second instance with the same seed and stimulus. One file at a time; an earlier one ends.
    ///
    /// # Errors
    /// The model was built without waveforms, or the file cannot be written.
    pub fn trace_window(&mut self, path: &Path, from: u64, to: u64) -> Result<(), Error> {
        let path = c_path(&std::path::absolute(path).map_err(crate::error::at(path))?)?;
        // SAFETY: the instance lives, and `path` is a C string, which the shim forgets before it returns.
        let status =
            unsafe { (self.library.interface.trace)(self.instance.as_ptr(), path.as_ptr(), from, to) };
        self.check(status)
    }

    /// Writes every cycle from the current one on.
    ///
    /// # Errors
    /// As [`Model::trace_window`].
    pub fn start_trace(&mut self, path: &Path) -> Result<(), Error> {
        self.trace_window(path, self.cycle(), u64::MAX)
    }

    /// Completes the waveform file; it does so by itself at the end of the window and of the instance.
    pub fn stop_trace(&mut self) {
        // SAFETY: the instance lives.
        unsafe { (self.library.interface.end_trace)(self.instance.as_ptr()) };
    }

    fn poke_raw(&mut self, port: usize, words: &[u32]) {
        // SAFETY: the instance lives, the port is an input, and its callers give as many words as it has, or more.
        unsafe { (self.library.interface.poke)(self.instance.as_ptr(), port as u32, words.as_ptr()) };
    }

    fn peek_raw(&mut self, port: usize, words: &mut [u32]) -> Result<(), Error> {
        self.eval()?;
        // SAFETY: the instance lives, the port is there, and its callers have room for as many words as it has, or more.
        unsafe { (self.library.interface.peek)(self.instance.as_ptr(), port as u32, words.as_mut_ptr()) };
        Ok(())
    }

    fn check(&self, status: i32) -> Result<(), Error> {
        if status == 0 { Ok(()) } else { Err(self.library.stopped()) }
    }

    /// Words of a port that can be poked.
    fn input(&self, port: usize) -> Result<usize, Error> {
        let words = self.any(port)?;
        let found = &self.library.source().ports[port];
        match (found.direction, found.is_clock) {
            (Direction::Out, _) => Err(Error::Port(format!("{}: is an output", found.name))),
            (_, true) => Err(Error::Port(format!("{}: is a clock, which tick moves", found.name))),
            _ => Ok(words),
        }
    }

    /// Words of a port.
    fn any(&self, port: usize) -> Result<usize, Error> {
        let ports = &self.library.source().ports;
        let missing = || Error::Port(format!("there is no port {port}: there are {}", ports.len()));
        ports.get(port).map(crate::Port::words).ok_or_else(missing)
    }

    fn expect_words(&self, port: usize, expected: usize, found: usize) -> Result<(), Error> {
        let name = &self.library.source().ports[port].name;
        let wrong = || Error::Port(format!("{name}: {found} words given, where the port has {expected}"));
        (found == expected).then_some(()).ok_or_else(wrong)
    }
}

impl Drop for Model {
    fn drop(&mut self) {
        // SAFETY: the instance lives, nobody else has it, and it is not used again.
        unsafe { (self.library.interface.destroy)(self.instance.as_ptr()) };
    }
}

fn expect_width(found: usize, expected: usize) -> Result<(), Error> {
    let wrong = || Error::Port(format!("a row of {found} words, where the design has {expected}"));
    (found == expected).then_some(()).ok_or_else(wrong)
}

fn c_path(path: &Path) -> Result<CString, Error> {
    let invalid = |_| Error::Port(format!("{}: a zero byte in a path", path.display()));
    CString::new(path.as_os_str().as_encoded_bytes()).map_err(invalid)
}

/// Verilator gives similar values for similar seeds, and random ones for 0: the seed is mixed and never 0.
const fn start_seed(seed: u64) -> i32 {
    let stirred = (seed ^ (seed >> 31)).wrapping_add(1).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let folded = (stirred ^ (stirred >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (folded >> 33) as i32 | 1
}
