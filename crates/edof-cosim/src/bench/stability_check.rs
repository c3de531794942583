//! The rule of every stream and channel: what is offered stands there, unchanged, until it is taken.

use super::rule_broken;
use crate::Error;
use crate::verilator::Model;

/// What stands on an offered channel, held until it is taken.
#[derive(Debug, Default)]
pub(crate) struct StabilityCheck(Option<Vec<u32>>);

impl StabilityCheck {
    /// Records the channel before an edge; returns the fault if an offer was withdrawn or changed.
    pub fn broken(&mut self, now: Option<&[u32]>, taken: bool) -> Option<&'static str> {
        match (&self.0, now) {
            (Some(_), None) => return Some("what was offered is no longer offered, and was not taken"),
            (Some(before), Some(now)) if before != now => {
                return Some("what is offered changed before it was taken");
            }
            _ => {}
        }
        self.0 = now.filter(|_| !taken).map(<[u32]>::to_vec);
        None
    }

    /// [`StabilityCheck::broken`] as an error.
    pub fn check(
        &mut self,
        model: &Model,
        port: &str,
        now: Option<&[u32]>,
        taken: bool,
    ) -> Result<(), Error> {
        self.broken(now, taken).map_or(Ok(()), |rule| Err(rule_broken(model, port, rule)))
    }

    /// Nothing stands: after a reset.
    pub fn forget(&mut self) {
        self.0 = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offer_that_waits_neither_changes_nor_goes() {
        let mut standing = StabilityCheck::default();
        assert_eq!(standing.broken(Some(&[1, 2]), false), None);
        assert_eq!(standing.broken(Some(&[1, 2]), true), None);
        assert_eq!(standing.broken(Some(&[3, 2]), false), None);
        assert!(standing.broken(Some(&[3, 4]), false).is_some_and(|rule| rule.contains("changed")));
        assert!(standing.broken(None, true).is_some_and(|rule| rule.contains("no longer")));
    }
}
