//! The results that were computed last.

use std::collections::VecDeque;
use std::sync::Arc;

/// Values by key, the latest first; the oldest is dropped where there is no place left.
#[derive(Debug)]
pub struct Recent<K, V> {
    kept: VecDeque<(K, Arc<V>)>,
    places: usize,
}

impl<K: PartialEq, V> Recent<K, V> {
    /// Has that many places, one at least.
    #[must_use]
    pub const fn new(places: usize) -> Self {
        Self { kept: VecDeque::new(), places }
    }

    /// Returns the value of a key, if it is kept.
    pub fn find(&mut self, key: &K) -> Option<Arc<V>> {
        let at = self.kept.iter().position(|(kept, _)| kept == key)?;
        let entry = self.kept.remove(at)?;
        let value = Arc::clone(&entry.1);
        self.kept.push_front(entry);
        Some(value)
    }

    /// Keeps the value of a key.
    pub fn keep(&mut self, key: K, value: V) -> Arc<V> {
        let value = Arc::new(value);
        self.kept.truncate(self.places.saturating_sub(1));
        self.kept.push_front((key, Arc::clone(&value)));
        value
    }

    /// Returns the value of a key, and makes it where it is not kept.
    ///
    /// # Errors
    /// Those of `make`; then nothing is kept.
    pub fn get<E>(&mut self, key: K, make: impl FnOnce(&K) -> Result<V, E>) -> Result<Arc<V>, E> {
        match self.find(&key) {
            Some(value) => Ok(value),
            None => make(&key).map(|value| self.keep(key, value)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_used_last_is_not_made_again_and_the_oldest_is() {
        let mut made = vec![];
        let mut recent = Recent::new(2);
        for key in [1, 2, 1, 3, 1, 2] {
            let value = recent.get(key, |key| {
                made.push(*key);
                Ok::<_, ()>(10 * key)
            });
            assert_eq!(value.map(|value| *value), Ok(10 * key));
        }
        assert_eq!(made, [1, 2, 3, 2]);
        assert_eq!(recent.get(4, |_| Err("none")), Err("none"));
        assert_eq!(recent.kept.len(), 2);
    }
}
