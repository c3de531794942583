//! A board at a serial port, or one in memory.

use crate::arguments::{name, size};
use crate::design::{PyDesign, design};
use crate::error::{OrRaise, failed};
use crate::json;
use crate::reconstruct::fixed;
use crate::shot;
use edof::presets::{designs, weights};
use edof_board::load::Job;
use edof_board::names::Place;
use edof_board::simulated::Shown;
use edof_board::{Board, Line, Serial, Simulated, link, protocol};
use edof_core::cable;
use edof_device::board::KC705;
use edof_device::design::memory::Set;
use edof_golden::Display;
use edof_network::FixedNetwork;
use ndarray::Array2;
use numpy::{IntoPyArray, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::Duration;

/// The line to a board.
enum Wire {
    Port(Serial),
    Memory(Box<Simulated>),
}

impl Wire {
    fn line(&self) -> &dyn Line {
        match self {
            Self::Port(line) => line,
            Self::Memory(line) => line,
        }
    }

    fn line_mut(&mut self) -> &mut dyn Line {
        match self {
            Self::Port(line) => line,
            Self::Memory(line) => line,
        }
    }
}

impl Line for Wire {
    fn name(&self) -> &str {
        self.line().name()
    }

    fn baud(&self) -> u32 {
        self.line().baud()
    }

    fn time(&self) -> Duration {
        self.line().time()
    }

    fn send(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.line_mut().send(bytes)
    }

    fn receive(&mut self, max: usize, patience: Duration) -> std::io::Result<Vec<u8>> {
        self.line_mut().receive(max, patience)
    }
}

/// A board. See `edof.Board` in the type stubs.
#[pyclass(frozen, name = "Board", module = "edof")]
pub struct PyBoard(Mutex<Option<Board<Wire>>>);

fn set(bank: &str) -> PyResult<Set> {
    match bank {
        "a" => Ok(Set::First),
        "b" => Ok(Set::Second),
        _ => Err(failed(format!("bank '{bank}': must be a or b"))),
    }
}

/// Networks that come with edof and fit a design, and one more.
fn known(design: &edof_device::Design, own: &FixedNetwork) -> Vec<FixedNetwork> {
    let all = weights::names().into_iter().filter_map(|name| weights::fixed(name).ok());
    std::iter::once(own.clone()).chain(all).filter(|network| design.check_network(network).is_ok()).collect()
}

impl PyBoard {
    fn of(line: Wire, patience: Duration) -> PyResult<Self> {
        Ok(Self(Mutex::new(Some(Board::open(line, patience).or_raise()?))))
    }

    /// Runs `work` on the open board without the GIL.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Board<Wire>) -> Result<T, edof_board::Error> + Send,
    ) -> PyResult<T> {
        py.detach(|| {
            let mut board = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            board.as_mut().map(work)
        })
        .ok_or_else(|| failed("board: closed"))?
        .map_err(|error| match error {
            edof_board::Error::Interrupted => pyo3::exceptions::PyKeyboardInterrupt::new_err(()),
            error => failed(error),
        })
    }

    fn design_of(&self, py: Python<'_>, given: Option<&Bound<'_, PyAny>>) -> PyResult<edof_device::Design> {
        let given = given.map(design).transpose()?;
        let known: Vec<_> = given.into_iter().chain(designs::all().or_raise()?).collect();
        self.with(py, |board| board.design(known))
    }
}

/// The bytes that write words from a byte address on, over UARTBone.
#[pyfunction]
pub fn uartbone_write<'py>(
    py: Python<'py>,
    address: &Bound<'py, PyAny>,
    words: Vec<u32>,
) -> PyResult<Bound<'py, PyBytes>> {
    let address = crate::arguments::whole(address, "address", 0, u32::MAX.into())? as u32;
    let (count, max) = (words.len(), protocol::MAX_WORDS);
    if count == 0 || count > max {
        return Err(failed(format!("words: {count} of them, must be 1 to {max}")));
    }
    Ok(PyBytes::new(py, &protocol::write(address, &words)))
}

/// The bytes that ask for words.
#[pyfunction]
pub fn uartbone_read<'py>(
    py: Python<'py>,
    address: &Bound<'py, PyAny>,
    words: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyBytes>> {
    let address = crate::arguments::whole(address, "address", 0, u32::MAX.into())? as u32;
    Ok(PyBytes::new(py, &protocol::read(address, size(words, "words", 1, protocol::MAX_WORDS)?)))
}

/// The words of an answer.
#[pyfunction]
pub fn uartbone_words(answer: &[u8]) -> Vec<u32> {
    protocol::words(answer)
}

/// Whether a signal, Ctrl-C above all, wants the work to end.
fn flow() -> ControlFlow<()> {
    if Python::attach(|py| py.check_signals()).is_ok() {
        ControlFlow::Continue(())
    } else {
        ControlFlow::Break(())
    }
}

#[pymethods]
impl PyBoard {
    #[staticmethod]
    #[pyo3(signature = (port, *, baud = None, timeout = None))]
    fn open(
        py: Python<'_>,
        port: &Bound<'_, PyAny>,
        baud: Option<&Bound<'_, PyAny>>,
        timeout: Option<f64>,
    ) -> PyResult<Self> {
        let port = name(port, "port", "the path of a serial port")?;
        let baud = baud.map_or(Ok(KC705.baud as usize), |value| size(value, "baud", 1, 100_000_000))? as u32;
        let patience = timeout.map_or(Ok(link::PATIENCE), |seconds| {
            let fine = seconds > 0.0 && seconds <= 3600.0;
            let refused = || failed(format!("timeout {seconds}: must be above 0, at most 3600 seconds"));
            if fine { Ok(Duration::from_secs_f64(seconds)) } else { Err(refused()) }
        })?;
        py.detach(|| Self::of(Wire::Port(Serial::open(&port, baud).or_raise()?), patience))
    }

    #[staticmethod]
    #[pyo3(signature = (design, network, raw, *, bit_depth = None, phase = None, baud = None))]
    fn simulated(
        py: Python<'_>,
        design: &Bound<'_, PyAny>,
        network: &Bound<'_, PyAny>,
        raw: &Bound<'_, PyAny>,
        bit_depth: Option<&Bound<'_, PyAny>>,
        phase: Option<&str>,
        baud: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (design, golden) = (self::design(design)?, fixed(network)?);
        let raw = shot::frame(raw, bit_depth, phase, None, None, None)?;
        let raw = cable::carried(&raw.encoded(golden.network().origin.values));
        let (found, frame) = (raw.size(), design.frame);
        if found != (frame.height, frame.width) {
            let (rows, columns) = (frame.height, frame.width);
            return Err(failed(format!(
                "raw: shape {found:?}, expected ({rows}, {columns}) as the design's frame"
            )));
        }
        let baud = baud.map_or(Ok(KC705.baud as usize), |value| size(value, "baud", 1, 100_000_000))? as u32;
        py.detach(|| {
            let sets = [golden.network(), golden.network()];
            let board = Simulated::new(&design, sets, &Display::of_network(golden.network()), raw, baud)
                .or_raise()?;
            Self::of(Wire::Memory(Box::new(board)), link::PATIENCE)
        })
    }

    /// Serial ports of this machine.
    #[staticmethod]
    fn ports() -> Vec<String> {
        edof_board::line::ports().into_iter().map(|port| port.name).collect()
    }

    fn get(&self, py: Python<'_>, register: &str) -> PyResult<u32> {
        let place: Place = register.parse().or_raise()?;
        self.with(py, |board| board.get(place))
    }

    fn set(&self, py: Python<'_>, register: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let place: Place = register.parse().or_raise()?;
        let value = crate::arguments::whole(value, "value", 0, u32::MAX.into())? as u32;
        self.with(py, |board| board.set(place, value))
    }

    fn registers(&self, py: Python<'_>) -> PyResult<std::collections::BTreeMap<String, u32>> {
        let all = self.with(py, Board::registers)?;
        Ok(all.into_iter().map(|(place, word)| (place.to_string(), word)).collect())
    }

    #[pyo3(signature = (network, *, bank = None, full = false, read_back = false, design = None))]
    fn load<'py>(
        &self,
        py: Python<'py>,
        network: &Bound<'py, PyAny>,
        bank: Option<&str>,
        full: bool,
        read_back: bool,
        design: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (golden, bank) = (fixed(network)?, bank.map(set).transpose()?);
        let design = self.design_of(py, design)?;
        let loaded = self.with(py, |board| {
            let (network, known) = (golden.network(), known(&design, golden.network()));
            let job = Job { design: &design, network, bank, full, read_back, known: &known };
            board.load(&job, &mut |_, _| flow())
        })?;
        json::plain(py, &loaded)
    }

    #[pyo3(signature = (network, *, bank = None, read_back = false, design = None))]
    fn verify<'py>(
        &self,
        py: Python<'py>,
        network: &Bound<'py, PyAny>,
        bank: Option<&str>,
        read_back: bool,
        design: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (golden, bank) = (fixed(network)?, bank.map(set).transpose()?);
        let design = self.design_of(py, design)?;
        let differences = self.with(py, |board| {
            let bank = bank.map_or_else(|| board.bank(), Ok)?;
            board.verify(&design, golden.network(), bank, read_back, &mut |_, _| flow())
        })?;
        json::plain(py, &differences)
    }

    /// The bank in use, `a` or `b`.
    #[getter]
    fn bank(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(if self.with(py, Board::bank)? == Set::First { "a" } else { "b" })
    }

    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        let design = self.design_of(py, None)?;
        self.with(py, |board| board.reset(&design))
    }

    /// Lets a simulated board run for N seconds of its time.
    fn run(&self, py: Python<'_>, seconds: f64) -> PyResult<()> {
        let seconds = crate::arguments::positive(seconds, "seconds")?;
        if seconds > 60.0 {
            return Err(failed(format!("seconds {seconds}: must be at most 60")));
        }
        let ran = self.with(py, |board| {
            Ok(match board.line() {
                Wire::Memory(line) => {
                    let until = line.now() + (seconds * 1e9) as u64;
                    line.pass_to(until);
                    true
                }
                Wire::Port(_) => false,
            })
        })?;
        if ran { Ok(()) } else { Err(failed("board: at a port, where time passes by itself")) }
    }

    /// The last whole picture of a simulated board: Y and the C between Cb and Cr in turn, rows × columns each; none yet.
    #[allow(clippy::type_complexity, reason = "two arrays or none")]
    fn screen<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<(Bound<'py, PyArray2<u8>>, Bound<'py, PyArray2<u8>>)>> {
        let (rows, columns) = self.shape(py)?;
        let words = self.with(py, |board| {
            Ok(match board.line() {
                Wire::Memory(line) => {
                    let whole = |shown: &Shown| match shown {
                        Shown::Whole(words) => Some(words.clone()),
                        Shown::Mixed => None,
                    };
                    line.shown().iter().rev().find_map(whole)
                }
                Wire::Port(_) => None,
            })
        })?;
        let Some(words) = words else { return Ok(None) };
        let bytes = |part: usize| {
            let all = words.iter().map(|word| word.to_le_bytes()[part]).collect();
            Array2::from_shape_vec((rows, columns), all).or_raise()
        };
        Ok(Some((bytes(0)?.into_pyarray(py), bytes(1)?.into_pyarray(py))))
    }

    /// Rows and columns of its frames.
    #[getter]
    fn shape(&self, py: Python<'_>) -> PyResult<(usize, usize)> {
        self.with(py, |board| Ok((board.identity.height as usize, board.identity.width as usize)))
    }

    #[getter]
    fn design(&self, py: Python<'_>) -> PyResult<PyDesign> {
        Ok(PyDesign::of(self.design_of(py, None)?))
    }

    #[getter]
    fn closed(&self, py: Python<'_>) -> bool {
        py.detach(|| self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner).is_none())
    }

    fn close(&self, py: Python<'_>) {
        py.detach(|| *self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = None);
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    fn __exit__(
        &self,
        py: Python<'_>,
        _type: &Bound<'_, PyAny>,
        _value: &Bound<'_, PyAny>,
        _traceback: &Bound<'_, PyAny>,
    ) {
        self.close(py);
    }
}
