//! Threads of the program's work, as many as the system lets it start: a limit of processes makes work slower, not impossible.

use crate::ui;
use std::io;
use std::sync::mpsc::{Sender, channel};
use std::thread::Builder;

/// Bytes of the stack of a run: what Linux gives a program's first thread where no limit is set.
const STACK: usize = 8 << 20;

/// A thread that waits for its work.
type Waiting = Sender<rayon::ThreadBuilder>;

/// Returns what a run returns, on a thread whose stack no limit of the shell makes smaller (`ulimit -s`); where the system starts no thread, on this one.
pub fn with_stack<T: Send>(run: fn() -> T) -> T {
    let result = std::thread::scope(|scope| {
        let started = Builder::new().name("main".to_owned()).stack_size(STACK).spawn_scoped(scope, run);
        started.map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))).ok()
    });
    result.unwrap_or_else(run)
}

/// Starts the threads that all parallel work shares, with a remark if the system gives fewer than there are cores. Without any, the
/// calling thread does all work. Results do not depend on the number.
pub fn install() {
    let wanted = wanted();
    let (mut waiting, refused) = start(wanted);
    let count = waiting.len();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count.max(1));
    let built = match count {
        0 => pool.use_current_thread().build_global(),
        _ => pool
            .spawn_handler(|thread| {
                let gone = || io::Error::other("a thread ended before its work");
                waiting.pop().and_then(|waiting| waiting.send(thread).ok()).ok_or_else(gone)
            })
            .build_global(),
    };
    // Only a pool that is there already is an error; then it is used.
    let _ = built;
    if let Some(error) = refused {
        let who = match count {
            0 => "the main thread does all work".to_owned(),
            count => format!("{count} of {wanted} threads do all work"),
        };
        ui::note(&format!(
            "cannot start more threads: {}; {who}",
            edof_core::storage::atomic::reason(&error)
        ));
    }
}

/// Whether one more thread can be started now.
pub fn is_one_left() -> bool {
    Builder::new().spawn(|| ()).is_ok_and(|thread| thread.join().is_ok())
}

/// As many as rayon itself takes.
fn wanted() -> usize {
    let set = std::env::var("RAYON_NUM_THREADS").ok().and_then(|count| count.parse().ok());
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    set.filter(|count| *count > 0).unwrap_or_else(cores)
}

/// Threads that wait, and why there are fewer than wanted.
fn start(wanted: usize) -> (Vec<Waiting>, Option<io::Error>) {
    let mut waiting = vec![];
    while waiting.len() < wanted {
        let (sender, receiver) = channel::<rayon::ThreadBuilder>();
        let work = move || {
            if let Ok(thread) = receiver.recv() {
                thread.run();
            }
        };
        match Builder::new().spawn(work) {
            Ok(_) => waiting.push(sender),
            Err(error) => return (waiting, Some(error)),
        }
    }
    (waiting, None)
}
