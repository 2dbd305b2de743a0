//! What a running render is told: to stop, to wait, to go on; and its stopwatch, which stands while
//! it waits.

use crate::film::lock;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What a render shall do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Signal {
    Go,
    Pause,
    Cancel,
}

/// Read by every thread between two batches.
pub(super) struct Control {
    signal: AtomicU8,
    watch: Mutex<Watch>,
    changed: Condvar,
}

struct Watch {
    /// While it ran before.
    before: Duration,
    /// Since when it runs.
    since: Option<Instant>,
}

impl Control {
    pub fn new() -> Self {
        Self {
            signal: AtomicU8::new(Signal::Go as u8),
            watch: Mutex::new(Watch {
                before: Duration::ZERO,
                since: None,
            }),
            changed: Condvar::new(),
        }
    }

    pub fn signal(&self) -> Signal {
        match self.signal.load(Ordering::Relaxed) {
            0 => Signal::Go,
            1 => Signal::Pause,
            _ => Signal::Cancel,
        }
    }

    /// Says what to do from now on. After `Cancel` nothing else is heard.
    pub fn tell(&self, signal: Signal) {
        // Under the lock, so that `wait_while_paused` misses no change.
        let _watch = lock(&self.watch);
        if self.signal() != Signal::Cancel {
            self.signal.store(signal as u8, Ordering::Relaxed);
        }
        self.changed.notify_all();
    }

    /// Returns when the signal is not `Pause`.
    pub fn wait_while_paused(&self) {
        let mut watch = lock(&self.watch);
        while self.signal() == Signal::Pause {
            watch = self
                .changed
                .wait(watch)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Starts the stopwatch.
    pub fn start_watch(&self) {
        lock(&self.watch).since.get_or_insert_with(Instant::now);
    }

    /// Sets it to zero; it goes on if it ran.
    pub fn restart_watch(&self) {
        let mut watch = lock(&self.watch);
        watch.before = Duration::ZERO;
        watch.since = watch.since.map(|_| Instant::now());
    }

    /// Stops it.
    pub fn stop_watch(&self) {
        let mut watch = lock(&self.watch);
        if let Some(since) = watch.since.take() {
            watch.before += since.elapsed();
        }
    }

    /// How long it has run.
    pub fn elapsed(&self) -> Duration {
        let watch = lock(&self.watch);
        watch.before + watch.since.map_or(Duration::ZERO, |since| since.elapsed())
    }
}
