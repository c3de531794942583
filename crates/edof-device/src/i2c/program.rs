//! Steps of a set-up, their words in a memory, and how they become a program.

use std::fmt::Write;

/// Bytes that a program keeps of what it found out; the host reads them.
pub const SLOTS: u8 = 12;
/// Slot of the first of four bytes of register `video_setup`.
pub const SETTINGS: u8 = SLOTS;

/// One step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// What is done.
    pub action: Action,
    /// Why.
    pub doc: &'static str,
}

/// What a step does. Device addresses have 7 bits. A program has one byte available, the accumulator: what was read last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Ends the program.
    End,
    /// Writes one byte to a device that has no registers.
    Byte {
        /// Address of the chip.
        device: u8,
        /// The byte.
        value: u8,
    },
    /// Writes a register.
    Write {
        /// Address of the device.
        device: u8,
        /// Which register.
        register: u8,
        /// New value of the register.
        value: u8,
    },
    /// Waits N milliseconds, at least one.
    Wait(u16),
    /// Reads a register into the accumulator and a slot; slots from [`SLOTS`] on keep nothing.
    Read {
        /// Address of the device.
        device: u8,
        /// Which register.
        register: u8,
        /// Where it is kept.
        slot: u8,
    },
    /// Continues where the accumulator, masked, has a value. Else does the step before once more after 10 ms, N times; then the set-up has
    /// failed.
    Until {
        /// N.
        tries: u8,
        /// Bits that count.
        mask: u8,
        /// Expected value of the masked bits.
        value: u8,
    },
    /// Skips the next step unless the accumulator, masked, has a value.
    If {
        /// Bits that count.
        mask: u8,
        /// Expected value of the masked bits.
        value: u8,
    },
    /// Continues at an entry.
    Goto(u16),
    /// Writes a register with what is in a slot.
    Copy {
        /// Address of the device.
        device: u8,
        /// Which register.
        register: u8,
        /// From where.
        slot: u8,
    },
    /// Takes a slot into the accumulator.
    Load(u8),
    /// Puts a value into a slot.
    Store {
        /// The value.
        value: u8,
        /// Where to.
        slot: u8,
    },
    /// From here on the chips are set up.
    Done,
    /// Which register [`Action::ReadNext`] reads.
    Index(u8),
    /// Reads the register of the index into the accumulator, 0 where nobody answers, and counts the index up.
    ReadNext {
        /// Address of the device.
        device: u8,
    },
    /// Skips the next step if the index has come round to 0.
    More,
}

/// Names of the actions, in the order of their numbers in [`Action::word`].
pub const KINDS: [&str; 15] = [
    "end",
    "byte",
    "write",
    "wait",
    "read",
    "until",
    "if",
    "goto",
    "copy",
    "load",
    "store",
    "done",
    "index",
    "read_next",
    "more",
];

impl Action {
    /// The memory's word: kind and three bytes.
    #[must_use]
    pub const fn word(self) -> u32 {
        let bytes = match self {
            Self::End => [0, 0, 0, 0],
            Self::Byte { device, value } => [1, device, 0, value],
            Self::Write { device, register, value } => [2, device, register, value],
            Self::Wait(milliseconds) => [3, 0, (milliseconds >> 8) as u8, milliseconds as u8],
            Self::Read { device, register, slot } => [4, device, register, slot],
            Self::Until { tries, mask, value } => [5, tries, mask, value],
            Self::If { mask, value } => [6, 0, mask, value],
            Self::Goto(target) => [7, 0, (target >> 8) as u8, target as u8],
            Self::Copy { device, register, slot } => [8, device, register, slot],
            Self::Load(slot) => [9, 0, 0, slot],
            Self::Store { value, slot } => [10, 0, value, slot],
            Self::Done => [11, 0, 0, 0],
            Self::Index(index) => [12, 0, 0, index],
            Self::ReadNext { device } => [13, device, 0, 0],
            Self::More => [14, 0, 0, 0],
        };
        u32::from_be_bytes(bytes)
    }

    /// The step of a word; one of an unknown kind ends the program.
    #[must_use]
    pub const fn of_word(word: u32) -> Self {
        let [kind, first, second, third] = word.to_be_bytes();
        let wide = (second as u16) << 8 | third as u16;
        match kind {
            1 => Self::Byte { device: first, value: third },
            2 => Self::Write { device: first, register: second, value: third },
            3 => Self::Wait(wide),
            4 => Self::Read { device: first, register: second, slot: third },
            5 => Self::Until { tries: first, mask: second, value: third },
            6 => Self::If { mask: second, value: third },
            7 => Self::Goto(wide),
            8 => Self::Copy { device: first, register: second, slot: third },
            9 => Self::Load(third),
            10 => Self::Store { value: second, slot: third },
            11 => Self::Done,
            12 => Self::Index(third),
            13 => Self::ReadNext { device: first },
            14 => Self::More,
            _ => Self::End,
        }
    }

    /// The device of a transfer.
    #[must_use]
    pub const fn device(self) -> Option<u8> {
        match self {
            Self::Byte { device, .. }
            | Self::Write { device, .. }
            | Self::Read { device, .. }
            | Self::Copy { device, .. }
            | Self::ReadNext { device } => Some(device),
            _ => None,
        }
    }
}

/// Entries of a program's memory, at least one [`Action::End`] after it.
#[must_use]
pub const fn depth(program: &[Entry]) -> usize {
    (program.len() + 1).next_power_of_two()
}

/// The memory image of a program: a word a line.
#[must_use]
pub fn image(program: &[Entry]) -> String {
    let words = program.iter().map(|entry| entry.action.word()).chain(std::iter::repeat(0));
    words.take(depth(program)).fold(String::new(), |mut text, word| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{word:08x}");
        text
    })
}

/// An entry that a jump leads to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Label(u16);

/// A jump whose target comes later.
#[must_use]
#[derive(Debug)]
pub(super) struct Jump(usize);

/// A program that grows.
#[derive(Debug, Default)]
pub(super) struct Builder {
    entries: Vec<Entry>,
}

impl Builder {
    /// Adds a step.
    pub(super) fn add(&mut self, action: Action, doc: &'static str) {
        self.entries.push(Entry { action, doc });
    }

    /// Writes registers of a device one after the other.
    pub(super) fn write(&mut self, device: u8, registers: &[(u8, u8, &'static str)]) {
        for (register, value, doc) in registers {
            self.add(Action::Write { device, register: *register, value: *value }, doc);
        }
    }

    /// Reads a register until it has a value under a mask; the second time in vain after N times 10 ms.
    pub(super) fn expect(
        &mut self,
        (device, register): (u8, u8),
        (mask, value): (u8, u8),
        tries: u8,
        doc: &'static str,
    ) {
        self.add(Action::Read { device, register, slot: SLOTS }, doc);
        self.add(Action::Until { tries, mask, value }, doc);
    }

    /// Where the next step will be.
    pub(super) const fn here(&self) -> Label {
        Label(self.entries.len() as u16)
    }

    /// Jumps back.
    pub(super) fn goto(&mut self, label: Label, doc: &'static str) {
        self.add(Action::Goto(label.0), doc);
    }

    /// Jumps to where [`Builder::land`] is called.
    pub(super) fn jump(&mut self, doc: &'static str) -> Jump {
        self.add(Action::Goto(0), doc);
        Jump(self.entries.len() - 1)
    }

    /// Jumps forward if the accumulator has a value under a mask.
    pub(super) fn jump_if(&mut self, mask: u8, value: u8, doc: &'static str) -> Jump {
        self.add(Action::If { mask, value }, doc);
        self.jump(doc)
    }

    /// Jumps back if the accumulator has a value under a mask.
    pub(super) fn goto_if(&mut self, label: Label, mask: u8, value: u8, doc: &'static str) {
        self.add(Action::If { mask, value }, doc);
        self.goto(label, doc);
    }

    /// The target of a jump is the next step.
    pub(super) fn land(&mut self, jump: Jump) {
        self.entries[jump.0].action = Action::Goto(self.here().0);
    }

    /// All steps.
    pub(super) fn finish(self) -> Vec<Entry> {
        self.entries
    }
}
