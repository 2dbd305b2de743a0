//! The threads that trace while somebody looks on.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::io;
use std::sync::{Arc, Mutex};
use thread_priority::ThreadPriority;

/// Of 0, the least, to 99: niceness 5 on Linux. A thread begins with 50.
const PRIORITY: u8 = 35;

/// The pool that all renders share which somebody looks at: a thread for each core.
///
/// They give way to others. Both cores of a small machine are busy with tracing all the time, and who
/// moves a light waits for the frame, and for the thread that develops the picture, not for samples.
///
/// An error where the system has no more threads; the next call tries again.
pub(super) fn watched_pool() -> io::Result<Arc<ThreadPool>> {
    static POOL: Mutex<Option<Arc<ThreadPool>>> = Mutex::new(None);
    let mut pool = super::lock(&POOL);
    if let Some(pool) = &*pool {
        return Ok(pool.clone());
    }
    let threads = ThreadPoolBuilder::new()
        .num_threads(rayon::current_num_threads())
        .thread_name(|i| format!("trace {i}"))
        .start_handler(|_| give_way())
        .build()
        .map_err(io::Error::other)?;
    Ok(pool.insert(Arc::new(threads)).clone())
}

/// A system that does not let a thread do so has it trace as before.
fn give_way() {
    if let Ok(priority) = PRIORITY.try_into() {
        let _ =
            thread_priority::set_current_thread_priority(ThreadPriority::Crossplatform(priority));
    }
}
