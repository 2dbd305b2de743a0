//! The threads that trace while somebody looks on.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::io;
use std::sync::{Arc, Mutex};
use thread_priority::ThreadPriority;

/// What a render is for, and so who waits for its threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Somebody looks at it.
    View,
    /// A file: it takes what views leave over.
    File,
}

impl Purpose {
    /// Of 0, the least, to 99: niceness 5 and 11 on Linux. A thread begins with 50.
    fn priority(self) -> u8 {
        match self {
            Self::View => 35,
            Self::File => 20,
        }
    }
}

/// The pool that all renders for a purpose share: a thread for each core.
///
/// They give way to others. Both cores of a small machine are busy with tracing all the time, and who
/// moves a light waits for the frame, and for the thread that develops the picture, not for samples. Nor does
/// a view wait for a file: a pass over that may take minutes, and a pool goes from one render to the next only
/// where a pass ends.
///
/// An error where the system has no more threads; the next call tries again.
pub(super) fn shared_pool(purpose: Purpose) -> io::Result<Arc<ThreadPool>> {
    static POOLS: [Mutex<Option<Arc<ThreadPool>>>; 2] = [const { Mutex::new(None) }; 2];
    let mut pool = super::lock(&POOLS[purpose as usize]);
    if let Some(pool) = &*pool {
        return Ok(pool.clone());
    }
    let threads = ThreadPoolBuilder::new()
        .num_threads(rayon::current_num_threads())
        .thread_name(|i| format!("trace {i}"))
        .start_handler(move |_| give_way(purpose.priority()))
        .build()
        .map_err(io::Error::other)?;
    Ok(pool.insert(Arc::new(threads)).clone())
}

/// A system that does not let a thread do so has it trace as before.
fn give_way(priority: u8) {
    if let Ok(priority) = priority.try_into() {
        let _ =
            thread_priority::set_current_thread_priority(ThreadPriority::Crossplatform(priority));
    }
}
