//! Leaf `edof_clear`, which stands inside of the leaves that carry words: model alone.

/// Empties a crossing from either side, in four phases; see `rtl/edof_clear.v`. Each side takes its own reset, in any order and with
/// either clock standing still; closed at power-up.
pub(super) struct Clear {
    clear: bool,
    cleared: [bool; 4],
    from_open: bool,
    asks_seen: [bool; 2],
    answers_seen: [bool; 2],
    asks: bool,
    answers: bool,
    to_open: bool,
    clear_seen: [bool; 2],
}

impl Default for Clear {
    fn default() -> Self {
        Self {
            clear: true,
            cleared: [false; 4],
            from_open: false,
            asks_seen: [false; 2],
            answers_seen: [false; 2],
            asks: true,
            answers: false,
            to_open: false,
            clear_seen: [false; 2],
        }
    }
}

impl Clear {
    /// Words may pass on the sender's side.
    pub const fn sender_open(&self) -> bool {
        self.from_open
    }

    /// The sender's state goes to zero.
    pub const fn sender_clear(&self) -> bool {
        self.cleared[0]
    }

    /// Words may pass on the receiver's side.
    pub const fn receiver_open(&self) -> bool {
        self.to_open
    }

    /// The receiver's state goes to zero.
    pub const fn receiver_clear(&self) -> bool {
        self.answers
    }

    /// An edge of the sender (reset), of the receiver (reset), or of both.
    pub fn step(&mut self, from: Option<bool>, to: Option<bool>) {
        let (clear, asks, answers) = (self.clear, self.asks, self.answers);
        if let Some(reset) = from {
            let (restarts, answered) = (reset || self.asks_seen[1], self.answers_seen[1]);
            if clear {
                self.clear = !self.cleared[3];
                let [first, second, third, _] = self.cleared;
                self.cleared = if restarts || !answered { [false; 4] } else { [true, first, second, third] };
                self.from_open = false;
            } else {
                self.clear = restarts && !answered;
                self.cleared = [false; 4];
                self.from_open = !restarts && !answered;
            }
            self.asks_seen = [asks, self.asks_seen[0]];
            self.answers_seen = [answers, self.answers_seen[0]];
        }
        if let Some(reset) = to {
            let clear_seen = self.clear_seen[1];
            self.asks = reset || (asks && !clear_seen);
            self.answers = clear_seen;
            self.to_open = !reset && !asks && !clear_seen;
            self.clear_seen = [clear, self.clear_seen[0]];
        }
    }
}
