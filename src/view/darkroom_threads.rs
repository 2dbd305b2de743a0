//! The threads that pictures are developed on.

use rayon::ThreadPool;
use std::io;
use std::sync::OnceLock;

/// At most: the work is small.
const THREADS: usize = 4;

/// What all darkrooms share, however many views there are. The tracer's own threads are busy for a
/// whole pass, and give way to these.
pub(super) fn pool() -> io::Result<&'static ThreadPool> {
    static POOL: OnceLock<ThreadPool> = OnceLock::new();
    if let Some(pool) = POOL.get() {
        return Ok(pool);
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(rayon::current_num_threads().min(THREADS))
        .thread_name(|_| "darkroom".into())
        .build()
        .map_err(io::Error::other)?;
    Ok(POOL.get_or_init(|| pool))
}
