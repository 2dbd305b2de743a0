//! The threads that trace while somebody looks on.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use thread_priority::ThreadPriority;

/// What a render is for, and so which threads it waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Priority {
    /// Somebody looks at it.
    View,
    /// A file: it takes what views leave over.
    File,
}

impl Priority {
    /// Of 0, the least, to 99: niceness 5 and 11 on Linux. A thread begins with 50.
    fn of_threads(self) -> u8 {
        match self {
            Self::View => 35,
            Self::File => 20,
        }
    }
}

/// So long a render keeps the threads while there is another for them: long beside what the change costs, and
/// short beside what an eye takes for a delay.
const TURN: Duration = Duration::from_millis(30);

/// Also in a build that is not optimised, where a packet of rays takes more than the usual 2 MB, and where turns lie on each
/// other ([`SharedPool`]). What is not used takes no memory.
const STACK_BYTES: usize = 16 << 20;

/// Threads that several renders share in turns.
pub(super) struct SharedPool {
    threads: ThreadPool,
    /// How many renders want the threads, or have them. More than one of them may have begun its turn: a thread that waits for
    /// the rest of one takes up whatever else there is, and the first one goes on when that is over.
    renders: AtomicUsize,
}

impl SharedPool {
    fn new(threads: ThreadPool) -> Self {
        let renders = AtomicUsize::new(0);
        Self { threads, renders }
    }

    /// Works on the threads as soon as those who asked before have had their turn.
    pub fn install<R: Send>(&self, work: impl FnOnce(Turn) -> R + Send) -> R {
        /// Also where the work panics.
        struct Leaves<'a>(&'a AtomicUsize);

        impl Drop for Leaves<'_> {
            fn drop(&mut self) {
                self.0.fetch_sub(1, Ordering::Relaxed);
            }
        }

        self.renders.fetch_add(1, Ordering::Relaxed);
        let _leaves = Leaves(&self.renders);
        (self.threads).install(|| work(Turn(Some((&self.renders, Instant::now())))))
    }
}

/// A render's turn at the threads.
#[derive(Clone, Copy)]
pub(super) struct Turn<'a>(Option<(&'a AtomicUsize, Instant)>);

impl Turn<'_> {
    /// Of a render that shares its threads with no other.
    pub const ENDLESS: Self = Self(None);

    /// Whether there are others, and it has lasted long enough: then what is left is left for the next turn.
    pub fn is_over(&self) -> bool {
        self.0.is_some_and(|(renders, start)| {
            renders.load(Ordering::Relaxed) > 1 && start.elapsed() >= TURN
        })
    }
}

/// The pool that all renders of a priority share: a thread for each core.
///
/// They give way to others. Both cores of a small machine are busy with tracing all the time, and who
/// moves a light waits for the frame, and for the thread that develops the picture, not for samples. Nor does
/// a view wait for a file, whose threads are others.
///
/// An error where the system has no more threads; the next call tries again.
pub(super) fn shared_pool(priority: Priority) -> io::Result<Arc<SharedPool>> {
    static POOLS: [Mutex<Option<Arc<SharedPool>>>; 2] = [const { Mutex::new(None) }; 2];
    let mut pool = crate::film::lock(&POOLS[priority as usize]);
    if let Some(pool) = &*pool {
        return Ok(pool.clone());
    }
    let threads = ThreadPoolBuilder::new()
        .num_threads(rayon::current_num_threads())
        .thread_name(|i| format!("trace {i}"))
        .stack_size(STACK_BYTES)
        .start_handler(move |_| give_way(priority.of_threads()))
        .build()
        .map_err(io::Error::other)?;
    Ok(pool.insert(Arc::new(SharedPool::new(threads))).clone())
}

/// A system that does not let a thread do so has it trace as before.
fn give_way(priority: u8) {
    if let Ok(priority) = priority.try_into() {
        let _ =
            thread_priority::set_current_thread_priority(ThreadPriority::Crossplatform(priority));
    }
}
