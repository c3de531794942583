//! A queue of bounded length between two threads.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Items on their way from one thread to another.
pub(super) struct Queue<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
    length: usize,
}

struct State<T> {
    items: VecDeque<T>,
    is_closed: bool,
}

/// The result of a look at a queue.
pub(super) enum Popped<T> {
    /// The oldest item.
    Item(T),
    /// Nothing within the time.
    Nothing,
    /// Nothing, and nothing will come.
    Closed,
}

impl<T> Queue<T> {
    /// A queue of at most `length` items.
    pub(super) fn new(length: usize) -> Self {
        let state = State { items: VecDeque::with_capacity(length), is_closed: false };
        Self { state: Mutex::new(state), changed: Condvar::new(), length }
    }

    fn state(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds an item as soon as there is room. Gives it back if the queue is closed.
    pub(super) fn push(&self, item: T) -> Result<(), T> {
        let full = |state: &mut State<T>| state.items.len() >= self.length && !state.is_closed;
        let mut state = self.changed.wait_while(self.state(), full).unwrap_or_else(PoisonError::into_inner);
        if state.is_closed {
            return Err(item);
        }
        state.items.push_back(item);
        self.changed.notify_all();
        Ok(())
    }

    /// Adds an item at once, in the place of the oldest one where there is no room. Gives back what is not in the queue.
    pub(super) fn push_newest(&self, item: T) -> Option<T> {
        let mut state = self.state();
        if state.is_closed {
            return Some(item);
        }
        let dropped = if state.items.len() >= self.length { state.items.pop_front() } else { None };
        state.items.push_back(item);
        self.changed.notify_all();
        dropped
    }

    /// Takes the oldest item, and waits for one for at most `time`.
    pub(super) fn pop(&self, time: Duration) -> Popped<T> {
        let empty = |state: &mut State<T>| state.items.is_empty() && !state.is_closed;
        let (mut state, _) = self
            .changed
            .wait_timeout_while(self.state(), time, empty)
            .unwrap_or_else(PoisonError::into_inner);
        match state.items.pop_front() {
            Some(item) => {
                self.changed.notify_all();
                Popped::Item(item)
            }
            None if state.is_closed => Popped::Closed,
            None => Popped::Nothing,
        }
    }

    /// Takes the oldest item if there is one.
    pub(super) fn try_pop(&self) -> Option<T> {
        let item = self.state().items.pop_front();
        self.changed.notify_all();
        item
    }

    /// Accepts nothing more; what is in the queue can still be taken.
    pub(super) fn close(&self) {
        self.state().is_closed = true;
        self.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOON: Duration = Duration::from_millis(5);

    #[test]
    fn items_come_in_their_order_and_wait_for_room() {
        let queue = Queue::new(2);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                (0..100).for_each(|item| queue.push(item).unwrap());
                queue.close();
            });
            let mut expected = 0;
            loop {
                match queue.pop(Duration::from_secs(10)) {
                    Popped::Item(item) => {
                        assert_eq!((item, queue.state().items.len() <= 2), (expected, true))
                    }
                    Popped::Nothing => panic!("nothing came"),
                    Popped::Closed => break,
                }
                expected += 1;
            }
            assert_eq!(expected, 100);
        });
        assert_eq!(queue.push(7), Err(7));
    }

    #[test]
    fn the_newest_take_the_place_of_the_oldest() {
        let queue = Queue::new(2);
        let dropped: Vec<Option<i32>> = (0..4).map(|item| queue.push_newest(item)).collect();
        assert_eq!(dropped, [None, None, Some(0), Some(1)]);
        queue.close();
        assert_eq!(queue.push_newest(4), Some(4));
        assert_eq!([queue.try_pop(), queue.try_pop(), queue.try_pop()], [Some(2), Some(3), None]);
        assert!(matches!(queue.pop(SOON), Popped::Closed));
        assert!(matches!(Queue::<i32>::new(1).pop(SOON), Popped::Nothing));
    }
}
