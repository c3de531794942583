//! How full the board's FIFOs get, ahead of any run; their depths follow from it.
//!
//! Two things fill a FIFO: a word is seen on the other side of a clock domain some cycles later, and a memory is late. The words of a
//! pipeline that ends in a queue are counted where it is made (`edof_hdl::video::queue`).

/// Cycles of the reader's clock until a word that was written into a FIFO between clocks is read, at most: the pointer through two
/// flip-flops, the first of which may see it an edge late, and the register at the output.
const ARRIVES: u64 = 5;
/// Cycles of the writer's clock until it knows of that.
const RETURNS: u64 = 4;
/// Cycles by which an agent knows later than the memory's port: its registers, and the change of turns between two agents.
const TURN: u64 = 8;

/// Words in a FIFO between clocks of these periods, as its writer counts them, that both sides keep busy: those on their way, and those
/// of whose reading the writer does not know. With fewer the slower side would wait.
#[must_use]
pub const fn crossing_words(writer_ps: u64, reader_ps: u64) -> usize {
    let slower = if writer_ps > reader_ps { writer_ps } else { reader_ps };
    ((ARRIVES * reader_ps + RETURNS * writer_ps).div_ceil(slower) + 1) as usize
}

/// Pixels between clock domains, in LUT RAM: for pixel clocks up to the memory's.
pub const CROSSING_PIXELS: usize = crossing_words(1, 1).next_power_of_two();

/// Words that an agent holds: a burst, and what comes meanwhile (a writer) or is taken meanwhile (a reader), a word in N cycles,
/// while the memory takes so long for a burst, from the offer of its address to its last word, and the other agent's burst is before it.
#[must_use]
pub const fn agent_words(burst: usize, memory_late: u64, cycles_a_word: u64) -> usize {
    burst + (2 * memory_late + TURN).div_ceil(cycles_a_word) as usize + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slower_clock_counts() {
        assert_eq!(crossing_words(5_000, 5_000), 10);
        assert_eq!(crossing_words(40_000, 5_000), crossing_words(40_000, 1_000));
        assert!(crossing_words(5_000, 40_000) < 8);
    }

    #[test]
    fn a_memory_that_is_never_late_leaves_a_burst_and_a_word_or_two() {
        assert_eq!(agent_words(64, 0, 32), 66);
        assert_eq!(agent_words(64, 512, 32), 64 + 33 + 1);
    }
}
