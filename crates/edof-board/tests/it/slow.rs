//! A board whose time passes more slowly than its host's, as that of a simulated circuit does.

use crate::common::{board, job, load, network, tiny};
use edof_board::{Line, Simulated};
use std::collections::VecDeque;
use std::io;
use std::time::Duration;

/// How much more slowly.
const TIMES: u32 = 200;

/// The board, and bytes that wait for it.
struct Slow(Simulated, VecDeque<u8>);

impl Line for Slow {
    fn name(&self) -> &str {
        "slow"
    }

    fn baud(&self) -> u32 {
        self.0.baud()
    }

    fn time(&self) -> Duration {
        self.0.time() * TIMES
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.1.extend(bytes);
        Ok(())
    }

    fn receive(&mut self, max: usize, patience: Duration) -> io::Result<Vec<u8>> {
        let until = self.0.time() + patience / TIMES;
        while self.0.time() < until
            && let Some(byte) = self.1.pop_front()
        {
            self.0.byte(byte);
        }
        self.0.receive(max, until.saturating_sub(self.0.time()))
    }
}

#[test]
fn a_host_waits_for_a_board_that_is_slower_than_its_line_as_long_as_it_is_seen_to_need() {
    let design = tiny();
    let [old, new] = [1, 2].map(|seed| network(&design, seed));
    let mut slow = Slow(board(&design, &old), VecDeque::new());
    let loaded = load(&mut slow, &job(&design, &new)).unwrap();
    assert_eq!((loaded.in_use, loaded.rounds, loaded.recovered), ('b', 1, false));
}
