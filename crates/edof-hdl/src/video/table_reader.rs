//! The display's tables, read back.

use crate::blocks::delay::Delay;
use crate::blocks::reader::Reader;
use crate::describe::{Circuit, kernel};
use edof_device::design::memory::TABLES;
use edof_device::design::reading::READ_REGISTER;
use rust_hdl::prelude::*;

/// Stands before the tables of the display: what the host writes passes in a cycle, and in the cycles between, rows are read back as those of
/// a stage's weights are (`edof_device::design::reading`), and go through a CRC. A row is four entries, the lowest first, each in 16
/// bits. Its bank is {table (2 bits), whether it lies in the second half of a table of luma}.
#[derive(Circuit)]
#[circuit(default(Reader, Delay), registers(clock, reset))]
pub struct TableReader {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Stops and forgets.
    pub reset: Signal<In, Bit>,
    /// The host writes an entry.
    pub host_write: Signal<In, Bit>,
    /// Table: 0 luma, 1 red, 2 green, 3 blue.
    pub host_select: Signal<In, Bits<2>>,
    /// Entry.
    pub host_address: Signal<In, Bits<15>>,
    /// Word to write.
    pub host_data: Signal<In, Bits<12>>,
    /// Write enable of a table, one cycle later; or an entry to read.
    pub table_write: Signal<Out, Bit>,
    /// Table of the entry.
    pub table_select: Signal<Out, Bits<2>>,
    /// Number of the entry.
    pub table_address: Signal<Out, Bits<15>>,
    /// What is written.
    pub table_data: Signal<Out, Bits<12>>,
    /// What lay there, two cycles after it was asked for.
    pub table_word: Signal<In, Bits<12>>,
    /// A word of the calculator is to be written; commands to read are among them.
    pub write_valid: Signal<In, Bit>,
    /// Where (`edof_device::design::memory::address`).
    pub write_address: Signal<In, Bits<25>>,
    /// Word to write.
    pub write_data: Signal<In, Bits<32>>,
    /// What to show: bit 6 what was read back, stage (4 bits), which (2 bits).
    pub status_address: Signal<In, Bits<7>>,
    /// Entry that was read, one cycle after its address; 0 if something else is selected.
    pub status: Signal<Out, Bits<32>>,
    of_tables: Constant<Bits<4>>,
    shown_at: Constant<Bits<5>>,
    read_register: Constant<Bits<12>>,
    reader: Reader,
    #[reset(false)]
    starts: DFF<Bit>,
    command: DFF<Bits<32>>,
    #[reset(false)]
    active: DFF<Bit>,
    entry: DFF<Bits<2>>,
    #[reset(false)]
    write_q: DFF<Bit>,
    select_q: DFF<Bits<2>>,
    address_q: DFF<Bits<15>>,
    data_q: DFF<Bits<12>>,
    read_tag: Delay<3, 3>,
    row: DFF<Bits<64>>,
    status_q: DFF<Bits<32>>,
    lookup: Signal<Local, Bit>,
    read_word: Signal<Local, Bits<64>>,
}

impl TableReader {
    /// The reader of any display.
    #[must_use]
    pub fn new() -> Self {
        Self::from_parts(TableReaderParts {
            of_tables: Constant::new((TABLES as u64).into()),
            shown_at: Constant::new((16 + TABLES as u64).into()),
            read_register: Constant::new((READ_REGISTER as u64).into()),
        })
    }
}

impl Default for TableReader {
    fn default() -> Self {
        Self::new()
    }
}

impl Logic for TableReader {
    #[kernel]
    fn update(&mut self) {
        self.reader.clock.next = self.clock.val();
        self.reader.reset.next = self.reset.val();
        self.read_tag.clock.next = self.clock.val();

        // A command.
        self.starts.d.next = self.write_valid.val()
            && (self.write_address.val().get_bits::<4>(21) == self.of_tables.val())
            && (self.write_address.val().get_bits::<2>(19) == 3)
            && (self.write_address.val().get_bits::<12>(1) == self.read_register.val());
        self.command.d.next = self.write_data.val();
        self.reader.starts.next = self.starts.q.val();
        self.reader.command.next = self.command.q.val();

        // The four entries of a row, one after the other, in cycles in which the host writes none.
        self.reader.grant.next = self.reader.request_weights.val() && !self.active.q.val();
        self.lookup.next = self.active.q.val() && !self.host_write.val();
        if self.reader.request_weights.val() && !self.active.q.val() {
            self.active.d.next = true;
            self.entry.d.next = 0.into();
        } else if self.lookup.val() {
            self.entry.d.next = self.entry.q.val() + 1;
            if self.entry.q.val() == 3 {
                self.active.d.next = false;
            }
        }
        self.write_q.d.next = self.host_write.val();
        self.data_q.d.next = self.host_data.val();
        self.select_q.d.next = self.reader.bank.val().get_bits::<2>(1);
        self.address_q.d.next = (bit_cast::<15, 12>(self.reader.row.val()) << 2)
            | bit_cast::<15, 2>(self.entry.q.val())
            | (bit_cast::<15, 1>(self.reader.bank.val().get_bits::<1>(0)) << 14);
        if self.host_write.val() {
            self.select_q.d.next = self.host_select.val();
            self.address_q.d.next = self.host_address.val();
        }
        // What stands in a register at power-up is no write.
        self.table_write.next = self.write_q.q.val() && !self.reset.val();
        self.table_select.next = self.select_q.q.val();
        self.table_address.next = self.address_q.q.val();
        self.table_data.next = self.data_q.q.val();

        // What comes, to its place in the row.
        self.read_tag.data.next = bit_cast::<3, 2>(self.entry.q.val());
        if self.lookup.val() {
            self.read_tag.data.next = bit_cast::<3, 2>(self.entry.q.val()) | 4;
        }
        self.read_word.next = 0.into();
        if self.read_tag.delayed.val() == 4 {
            self.read_word.next = bit_cast::<64, 12>(self.table_word.val());
        } else if self.read_tag.delayed.val() == 5 {
            self.read_word.next = bit_cast::<64, 12>(self.table_word.val()) << 16;
        } else if self.read_tag.delayed.val() == 6 {
            self.read_word.next = bit_cast::<64, 12>(self.table_word.val()) << 32;
        } else if self.read_tag.delayed.val() == 7 {
            self.read_word.next = bit_cast::<64, 12>(self.table_word.val()) << 48;
        }
        self.row.d.next = self.read_word.val();
        self.reader.weights.next = self.row.q.val();
        // There is nothing else to read here.
        self.reader.thresholds_valid.next = true;
        self.reader.thresholds.next = 0.into();
        self.reader.previous.next = 0.into();
        self.reader.register.next = 0.into();

        self.reader.select.next = self.status_address.val().get_bits::<2>(0);
        self.status_q.d.next = 0.into();
        if self.status_address.val().get_bits::<5>(2) == self.shown_at.val() {
            self.status_q.d.next = self.reader.value.val();
        }
        self.status.next = self.status_q.q.val();
    }
}
