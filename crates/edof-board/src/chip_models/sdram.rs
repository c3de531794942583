//! A single-data-rate SDRAM of 256 Mbit with 16 data lines, as the ULX3S has it: Micron MT48LC16M16A2, in the slowest of its speed grades (-75).
//!
//! Source: Micron 256Mb SDR SDRAM, 256Mb_sdr.pdf Rev. W: commands, power-up, mode register, table 12 of times. Where makers of equal chips ask for
//! more (200 µs of power-up, eight refreshes: ISSI, Winbond), the model asks for theirs.

use std::collections::HashMap;

/// Columns of a row, rows of a bank, banks.
const COLUMNS: usize = 512;
const ROWS: usize = 8192;
const BANKS: usize = 4;

/// Picoseconds of power-up before the first command.
const POWER_UP: u64 = 200_000_000;
/// Refreshes of the set-up.
const FIRST_REFRESHES: u32 = 8;
/// ACTIVE to PRECHARGE at least and at most, ACTIVE to READ or WRITE, PRECHARGE to ACTIVE, ACTIVE to ACTIVE of a bank and of another one,
/// REFRESH to the next command, the last written word to PRECHARGE.
const T_RAS: u64 = 44_000;
const T_RAS_MOST: u64 = 120_000_000;
const T_RCD: u64 = 20_000;
const T_RP: u64 = 20_000;
const T_RC: u64 = 66_000;
const T_RRD: u64 = 15_000;
const T_RFC: u64 = 66_000;
const T_WR: u64 = 15_000;
/// Clocks from LOAD MODE REGISTER to the next command.
const T_MRD: u64 = 2;
/// All rows are refreshed within this time.
const T_REF: u64 = 64_000_000_000;

/// What the pins say at a rising edge of the clock. Active-low pins are as they are on the board.
#[derive(Debug, Clone, Copy)]
pub struct Pins {
    /// Clock enable.
    pub cke: bool,
    /// Chip select.
    pub cs_n: bool,
    /// Row strobe, column strobe and write enable, in bits 2, 1 and 0.
    pub command: u8,
    /// Bank.
    pub bank: u8,
    /// Row, column, or mode.
    pub address: u16,
    /// Bytes that are masked.
    pub mask: u8,
    /// The data lines where the board drives them.
    pub data: Option<u16>,
}

/// A row that is open: which, and since when.
#[derive(Debug, Clone, Copy)]
struct Open {
    row: u16,
    since: u64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Bank {
    open: Option<Open>,
    /// Moments of the last ACTIVE and PRECHARGE, and from which PRECHARGE is legal after a write.
    activated: Option<u64>,
    precharged: Option<u64>,
    written: u64,
}

/// A burst of columns that is written or read.
#[derive(Debug, Clone, Copy)]
struct Burst {
    bank: usize,
    row: u16,
    column: u16,
    beat: u16,
    is_write: bool,
}

/// The chip. Every breach of its rules is an error that names rule and moment.
#[derive(Debug)]
pub struct Sdram {
    period: u64,
    edge: u64,
    banks: [Bank; BANKS],
    words: HashMap<(usize, u16, u16), u16>,
    /// Burst length and CAS latency, once the mode register is loaded.
    mode: Option<(u16, u64)>,
    /// PRECHARGE of all banks came, and refreshes after it.
    is_precharged: bool,
    refreshes: u32,
    /// Moments of the last REFRESH and, a ring, of as many as there are rows.
    refreshed: Option<u64>,
    history: Vec<u64>,
    busy_until: u64,
    burst: Option<Burst>,
    /// Words by the edge from which they are driven, the last of these edges, and the mask of the edge before.
    leaving: HashMap<u64, u16>,
    last_driven: u64,
    mask: u8,
    /// Words whose writes are noted, by bank, row and column, and when they were written.
    watched: Vec<(usize, u16, u16)>,
    moments: Vec<u64>,
}

impl Sdram {
    /// A chip whose clock has a period in picoseconds.
    #[must_use]
    pub fn new(period: u64) -> Self {
        Self {
            period,
            edge: 0,
            banks: [Bank::default(); BANKS],
            words: HashMap::new(),
            mode: None,
            is_precharged: false,
            refreshes: 0,
            refreshed: None,
            history: vec![],
            busy_until: 0,
            burst: None,
            leaving: HashMap::new(),
            last_driven: 0,
            mask: 0,
            watched: vec![],
            moments: vec![],
        }
    }

    /// Notes when these words are written: bank, row and column of each.
    pub fn watch(&mut self, words: impl IntoIterator<Item = (usize, u16, u16)>) {
        self.watched = words.into_iter().collect();
    }

    /// Returns when words that are watched were written, in picoseconds.
    #[must_use]
    pub fn moments(&self) -> &[u64] {
        &self.moments
    }

    /// Refreshes so far.
    #[must_use]
    pub fn refreshes(&self) -> usize {
        self.history.len()
    }

    /// A rising edge of the clock; returns the word that the chip drives until the next one.
    ///
    /// # Errors
    /// A rule that was broken.
    pub fn edge(&mut self, pins: Pins) -> Result<Option<u16>, String> {
        self.edge += 1;
        let now = self.edge * self.period;
        let result = self.step(now, pins).map_err(|what| format!("{} ns: {what}", now / 1000));
        self.mask = pins.mask;
        result
    }

    fn step(&mut self, now: u64, pins: Pins) -> Result<Option<u16>, String> {
        if let Some(burst) = self.burst.filter(|burst| burst.is_write) {
            self.write(now, burst, pins)?;
        }
        let is_command = pins.cke && !pins.cs_n && pins.command != 0b111;
        if is_command {
            self.command(now, pins)?;
        }
        if self.mode.is_some() {
            self.is_refreshed_in_time(now)?;
        }
        for (number, bank) in self.banks.iter().enumerate() {
            if bank.open.is_some_and(|open| now - open.since > T_RAS_MOST) {
                return Err(format!("bank {number} is open for more than tRAS"));
            }
        }
        self.advance();
        // A word is taken at the next edge, two clocks after its mask.
        let word = self.leaving.remove(&self.edge).filter(|_| self.mask == 0);
        if word.is_some() && pins.data.is_some() {
            return Err("the board drives the data lines while the chip does".into());
        }
        Ok(word)
    }

    /// A word of a burst of writes, at and after its command.
    fn write(&mut self, now: u64, burst: Burst, pins: Pins) -> Result<(), String> {
        let Burst { bank, row, column, beat, .. } = burst;
        let (length, _) = self.mode.unwrap();
        if beat >= length {
            return Ok(());
        }
        let data = pins.data.ok_or("nobody drives the data lines of a write")?;
        let place = (bank, row, wrapped(column, beat, length));
        let kept = self.words.get(&place).copied().unwrap_or(0);
        let bytes = [0x00ff, 0xff00].into_iter().enumerate();
        let lines: u16 = bytes.filter(|(byte, _)| pins.mask >> byte & 1 == 0).map(|(_, lines)| lines).sum();
        self.words.insert(place, data & lines | kept & !lines);
        self.banks[bank].written = now + T_WR;
        if self.watched.contains(&place) {
            self.moments.push(now);
        }
        Ok(())
    }

    /// The burst goes on by a beat; words that are read get their edges.
    fn advance(&mut self) {
        let Some(burst) = &mut self.burst else { return };
        let (length, latency) = self.mode.unwrap();
        if burst.beat >= length {
            self.burst = None;
            return;
        }
        if !burst.is_write {
            let place = (burst.bank, burst.row, wrapped(burst.column, burst.beat, length));
            let word = self.words.get(&place).copied().unwrap_or(0xdead);
            // Driven from one edge before the one at which it is to be taken.
            self.last_driven = self.edge + latency - 1;
            self.leaving.insert(self.last_driven, word);
        }
        burst.beat += 1;
    }

    fn command(&mut self, now: u64, pins: Pins) -> Result<(), String> {
        if now < POWER_UP {
            return Err("a command in the power-up time".into());
        }
        if now < self.busy_until {
            return Err("a command while the chip refreshes or sets its mode".into());
        }
        let bank = usize::from(pins.bank);
        match pins.command {
            0b000 => self.load_mode(now, pins),
            0b001 => self.refresh(now),
            0b010 if pins.address >> 10 & 1 == 1 => {
                self.is_precharged = true;
                (0..BANKS).try_for_each(|bank| self.precharge(now, bank))
            }
            0b010 => self.precharge(now, bank),
            0b011 => self.activate(now, bank, pins.address),
            0b100 | 0b101 => self.column(now, bank, pins),
            other => Err(format!("a command {other:03b} that nobody needs")),
        }
    }

    fn load_mode(&mut self, now: u64, pins: Pins) -> Result<(), String> {
        if self.refreshes < FIRST_REFRESHES {
            return Err(format!("the mode is loaded after {} refreshes", self.refreshes));
        }
        self.all_closed(now)?;
        let length = match pins.address & 7 {
            0..=3 => 1 << (pins.address & 7),
            other => return Err(format!("burst length {other}")),
        };
        let latency = u64::from(pins.address >> 4 & 7);
        let least = match latency {
            3 => 7_500,
            2 => 10_000,
            other => return Err(format!("CAS latency {other}")),
        };
        if pins.address & !0x77 != 0 || pins.bank != 0 {
            return Err(format!(
                "mode {:04x}: bits that are reserved or ask for another burst",
                pins.address
            ));
        }
        if self.period < least {
            return Err(format!("CAS latency {latency} at {} ps", self.period));
        }
        self.mode = Some((length, latency));
        self.busy_until = now + T_MRD * self.period;
        Ok(())
    }

    fn refresh(&mut self, now: u64) -> Result<(), String> {
        if !self.is_precharged {
            return Err("a refresh before the banks were precharged".into());
        }
        self.all_closed(now)?;
        self.refreshes += 1;
        self.refreshed = Some(now);
        self.history.push(now);
        self.busy_until = now + T_RFC;
        Ok(())
    }

    /// As many refreshes as there are rows lie within tREF; before there were so many, their rate is enough for it.
    fn is_refreshed_in_time(&self, now: u64) -> Result<(), String> {
        let count = self.history.len();
        let oldest = count.checked_sub(ROWS).map_or_else(|| self.history.first(), |at| self.history.get(at));
        let Some(&oldest) = oldest else { return Ok(()) };
        let rows = count.min(ROWS) as u64;
        // A few may be late together.
        let allowed = T_REF / ROWS as u64 * (rows + 1);
        if now - oldest > allowed.min(T_REF) {
            return Err(format!("{rows} refreshes in {} ns", (now - oldest) / 1000));
        }
        Ok(())
    }

    fn all_closed(&self, now: u64) -> Result<(), String> {
        let late = |bank: &Bank| bank.precharged.is_some_and(|at| now < at + T_RP);
        if self.banks.iter().any(|bank| bank.open.is_some() || late(bank)) {
            return Err("a bank is open, or within tRP".into());
        }
        if self.burst.is_some_and(|burst| burst.is_write && burst.beat < self.mode.unwrap().0) {
            return Err("a burst is written".into());
        }
        Ok(())
    }

    fn precharge(&mut self, now: u64, number: usize) -> Result<(), String> {
        let bank = &mut self.banks[number];
        if let Some(open) = bank.open {
            if now < open.since + T_RAS {
                return Err(format!("bank {number}: PRECHARGE within tRAS"));
            }
            if now < bank.written {
                return Err(format!("bank {number}: PRECHARGE within tWR"));
            }
            if let Some(burst) = self.burst.filter(|burst| burst.bank == number)
                && burst.beat < self.mode.unwrap().0
            {
                return Err(format!("bank {number}: PRECHARGE cuts a burst after {} words", burst.beat));
            }
        }
        (bank.open, bank.precharged) = (None, Some(now));
        Ok(())
    }

    fn activate(&mut self, now: u64, number: usize, row: u16) -> Result<(), String> {
        if self.mode.is_none() {
            return Err("ACTIVE before the mode is loaded".into());
        }
        let others = self.banks.iter().enumerate().filter(|(other, _)| *other != number);
        if others.filter_map(|(_, bank)| bank.activated).any(|at| now < at + T_RRD) {
            return Err(format!("bank {number}: ACTIVE within tRRD"));
        }
        let bank = &mut self.banks[number];
        if bank.open.is_some() {
            return Err(format!("bank {number} is open already"));
        }
        if bank.precharged.is_some_and(|at| now < at + T_RP) {
            return Err(format!("bank {number}: ACTIVE within tRP"));
        }
        if bank.activated.is_some_and(|at| now < at + T_RC) {
            return Err(format!("bank {number}: ACTIVE within tRC"));
        }
        (bank.open, bank.activated) = (Some(Open { row, since: now }), Some(now));
        Ok(())
    }

    fn column(&mut self, now: u64, number: usize, pins: Pins) -> Result<(), String> {
        let Some(Open { row, since }) = self.banks[number].open else {
            return Err(format!("bank {number}: READ or WRITE of no open row"));
        };
        if now < since + T_RCD {
            return Err(format!("bank {number}: READ or WRITE within tRCD"));
        }
        if pins.address >= COLUMNS as u16 {
            return Err(format!("column {:04x}, or a precharge of the chip's own", pins.address));
        }
        let is_write = pins.command == 0b100;
        if self.burst.is_some_and(|burst| burst.beat < self.mode.unwrap().0) {
            return Err("a burst is cut".into());
        }
        // A clock between, in which nobody drives the lines.
        if is_write && self.edge < self.last_driven + 2 {
            return Err("WRITE while words are read".into());
        }
        self.burst = Some(Burst { bank: number, row, column: pins.address, beat: 0, is_write });
        if is_write {
            self.write(now, self.burst.unwrap(), pins)?;
        }
        Ok(())
    }
}

/// A column of a burst, which stays in its block.
const fn wrapped(column: u16, beat: u16, length: u16) -> u16 {
    column & !(length - 1) | (column + beat) & (length - 1)
}
