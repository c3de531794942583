//! What a board can find out about itself without a source and a screen, part by part.

use crate::board::Board;
use crate::check::{Boundary, Difference};
use crate::clocks::is_clock;
use crate::diagnosis::findings;
use crate::error::Error;
use crate::line::Line;
use crate::load::Progress;
use edof_device::Design;
use edof_device::crc::{Place, single_bit};
use edof_device::pattern::Pattern;
use edof_device::registers::map;
use edof_golden::video::pattern;
use edof_golden::{Display, Golden};
use serde::Serialize;

/// A part of the board, and whether it does what it should.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Item {
    /// What was tried: `bus`, `weights`, `raw memory`, `windows`, `multipliers`, `display`, `picture memory`, `receiver`, `transmitter`,
    /// `clocks`.
    pub part: &'static str,
    /// The part works as specified.
    pub passed: bool,
    /// How it was found out, or what is wrong and where.
    pub detail: String,
}

impl Item {
    fn of(part: &'static str, result: Result<String, String>) -> Self {
        let passed = result.is_ok();
        Self { part, passed, detail: result.unwrap_or_else(|wrong| wrong) }
    }
}

/// What is tried.
#[derive(Clone, Copy)]
pub struct SelfTest<'a> {
    /// The board's design.
    pub design: &'a Design,
    /// The network in use.
    pub golden: &'a Golden,
    /// The display in use.
    pub display: &'a Display,
    /// Whether clocks must be those of the design: those of a simulated circuit are not.
    pub clocks: bool,
}

/// Frames per pattern: each of the three buffers once or more.
const FRAMES: u32 = 4;

/// Steps of progress, about as long as one another: of the bus, of the weights, then of each frame.
const BUS: u64 = 4;
const WEIGHTS: u64 = 8;
const ALL: u64 = BUS + WEIGHTS + Pattern::ALL.len() as u64 * FRAMES as u64;

impl<L: Line> Board<L> {
    /// Tries every part in the order in which data pass, and continues after one that fails. Leaves the source's frames in use. `progress` receives steps.
    ///
    /// # Errors
    /// The line fails, no frame passes, or [`Error::Interrupted`].
    pub fn self_test(&mut self, test: &SelfTest<'_>, progress: Progress<'_>) -> Result<Vec<Item>, Error> {
        let mut items = vec![Item::of("bus", self.try_bus(progress)?)];
        let bank = self.bank()?;
        let mut of_weights = |done, total: u64| progress(BUS + WEIGHTS * done / total.max(1), ALL);
        let differences = self.verify(test.design, test.golden.network(), bank, false, &mut of_weights)?;
        items.push(Item::of(
            "weights",
            match differences.first() {
                None => Ok("every CRC of the bank in use is right".into()),
                Some(first) => Err(format!("{} parts differ, the first is {first}", differences.len())),
            },
        ));
        let found = self.try_patterns(test, progress);
        self.set_pattern(None)?;
        items.extend(found?);
        let look = self.look(test.design.stages.len())?;
        // What comes in, and a camera at pins, may be missing.
        let is_on_board = |about: &str| matches!(about, "receiver" | "transmitter");
        let chips = findings(test.design.board, &look).into_iter().filter(|chip| is_on_board(chip.about));
        items.extend(chips.map(|chip| Item { part: chip.about, passed: chip.is_good, detail: chip.text }));
        items.push(Item::of("clocks", self.try_clocks(test)?));
        Ok(items)
    }

    /// Every bit of a word as 0 and as 1, alone and among others, and each byte at its place.
    fn try_bus(&mut self, progress: Progress<'_>) -> Result<Result<String, String>, Error> {
        let alone = (0..32).flat_map(|bit| [1 << bit, !(1u32 << bit)]);
        let words: Vec<u32> = alone.chain([0, u32::MAX, 0x5555_5555, 0xaaaa_aaaa, 0x0123_4567]).collect();
        for (index, word) in words.iter().enumerate() {
            if progress(BUS * index as u64 / words.len() as u64, ALL).is_break() {
                return Err(Error::Interrupted);
            }
            self.link.write(map::SCRATCH, &[*word])?;
            let [found] = self.link.read(map::SCRATCH, 1)?[..] else { continue };
            if found != *word {
                return Ok(Err(format!("scratch: 0x{word:08x} was written, 0x{found:08x} read")));
            }
        }
        self.link.set(map::SCRATCH, 0)?;
        Ok(Ok(format!("{} words through scratch, each bit alone as 0 and as 1", words.len())))
    }

    /// Frames of every pattern through the memory, the calculator and the memory again.
    fn try_patterns(&mut self, test: &SelfTest<'_>, progress: Progress<'_>) -> Result<Vec<Item>, Error> {
        let mut found: Vec<(Pattern, Difference)> = vec![];
        for (index, pattern) in Pattern::ALL.into_iter().enumerate() {
            let Ok(raw) = pattern::frame(pattern, test.design.frame) else { continue };
            let Ok(golden) = test.golden.checks(test.display, &raw) else { continue };
            self.set_pattern(Some(pattern))?;
            let before = BUS + WEIGHTS + index as u64 * u64::from(FRAMES);
            let mut of_all = |done: u32, _| progress(before + u64::from(done), ALL);
            let checked = self.check_frames(&golden, FRAMES, &mut of_all)?;
            found.extend(checked.difference.map(|difference| (pattern, difference)));
        }
        let pixels = test.design.frame.width * test.design.frame.height;
        let row = test.design.frame.width;
        let told = |(pattern, difference): &(Pattern, Difference)| {
            let Difference { boundary, expected, found } = difference;
            let place = match boundary {
                Boundary::Raw | Boundary::Sent => single_bit(expected ^ found, pixels),
                _ => None,
            };
            let place = place.map_or(String::new(), |Place { word, bit }| {
                format!("; one bit is wrong: bit {bit} of row {}, column {}", word / row, word % row)
            });
            format!(
                "pattern {pattern}: {boundary} differ first, CRC {found:08x}, expected {expected:08x}{place}"
            )
        };
        let of = |part, works: &str, is_here: fn(&Boundary) -> bool| {
            let mut here = found.iter().filter(|(_, difference)| is_here(&difference.boundary));
            let result = here.next().map_or_else(|| Ok(works.to_owned()), |first| Err(told(first)));
            Item::of(part, result)
        };
        let count = Pattern::ALL.len();
        Ok(vec![
            of(
                "raw memory",
                &format!("frames of {count} patterns came back, each bit as 0 and as 1"),
                |at| *at == Boundary::Raw,
            ),
            of("windows", "as the golden model's", |at| *at == Boundary::Windows),
            of("multipliers", "every stage sends what the golden model says", |at| {
                matches!(at, Boundary::Stage(..))
            }),
            of("display", "codes as the golden model's", |at| *at == Boundary::Codes),
            of("picture memory", "pictures came back", |at| *at == Boundary::Sent),
        ])
    }

    /// Clocks of screen and input in cycles of the core's.
    fn try_clocks(&mut self, test: &SelfTest<'_>) -> Result<Result<String, String>, Error> {
        let board = test.design.board;
        // Frames of no video mode have the board's slowest clock; small ones stand for others and have their own.
        let made = test.design.check_video().is_err().then(|| test.design.clocks()).transpose()?;
        let made = made.and_then(|clocks| clocks.screen).map(|clock| clock.khz as f64);
        let expected = made.unwrap_or(test.design.screen().pixel_khz as f64) / 1e3;
        let core = f64::from(board.core_khz) / 1e3;
        let Some(clocks) = self.pixel_clocks(board)? else {
            return Ok(Err("the core's clock stands still".into()));
        };
        let rates = format!(
            "at {core} MHz of the core: screen {:.2} MHz, input {:.2} MHz",
            clocks.screen, clocks.input
        );
        let is_right = is_clock(clocks.screen, expected) || !test.clocks;
        Ok(if clocks.screen > 0.0 && is_right {
            Ok(rates)
        } else {
            Err(format!("{rates}; the screen's must be {expected:.2} MHz"))
        })
    }
}
