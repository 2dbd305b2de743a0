//! Work on a thread of its own: what a person asks for and no frame waits for.

use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

/// Work that is under way. Dropping it tells it to end, and waits for nothing.
pub(in crate::editor) struct Background<T> {
    watch: Watch,
    /// One system asks it; the lock lets it be part of a resource.
    result: Mutex<Receiver<T>>,
}

/// What has come of the work.
#[derive(Debug, PartialEq)]
pub(in crate::editor) enum Outcome<T> {
    /// It goes on.
    Pending,
    /// It has ended with this.
    Done(T),
    /// It ended by a bug, which was reported on its way.
    Lost,
}

/// How far the work is, and whether it shall go on.
#[derive(Clone, Default)]
pub(in crate::editor) struct Watch(Arc<Shared>);

#[derive(Default)]
struct Shared {
    stop: AtomicBool,
    progress: Mutex<(String, f32)>,
}

impl<T: Send + 'static> Background<T> {
    /// Begins it. The error is that of a system which has no more threads.
    pub fn start(name: &str, work: impl FnOnce(&Watch) -> T + Send + 'static) -> io::Result<Self> {
        let (sender, begun) = Self::sent();
        let watch = begun.watch.clone();
        thread::Builder::new().name(name.into()).spawn(move || {
            // Nobody receives it where it was dropped meanwhile.
            let _ = sender.send(work(&watch));
        })?;
        Ok(begun)
    }

    /// Work whose result somebody sends.
    pub fn sent() -> (Sender<T>, Self) {
        let (sender, receiver) = channel();
        let result = Mutex::new(receiver);
        let watch = Watch::default();
        (sender, Self { watch, result })
    }

    /// What it does now, and which part is done, 0 to 1.
    pub fn progress(&self) -> (String, f32) {
        self.watch.progress().clone()
    }

    /// Its result, once.
    pub fn take(&self) -> Outcome<T> {
        let receiver = self.result.lock().unwrap_or_else(PoisonError::into_inner);
        match receiver.try_recv() {
            Ok(result) => Outcome::Done(result),
            Err(TryRecvError::Empty) => Outcome::Pending,
            Err(TryRecvError::Disconnected) => Outcome::Lost,
        }
    }
}

impl<T> Drop for Background<T> {
    fn drop(&mut self) {
        self.watch.0.stop.store(true, Ordering::Relaxed);
    }
}

impl Watch {
    /// Says what is begun, and which part of the whole is done by then; breaks where the work shall
    /// end.
    pub fn tell(&self, what: &str, part: f32) -> ControlFlow<()> {
        let mut progress = self.progress();
        if progress.0 != what {
            what.clone_into(&mut progress.0);
        }
        progress.1 = part;
        match self.0.stop.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    fn progress(&self) -> MutexGuard<'_, (String, f32)> {
        let progress = &self.0.progress;
        progress.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    /// Waits for something that a thread does, and says how long at most.
    fn soon<R>(mut look: impl FnMut() -> Option<R>) -> R {
        let start = Instant::now();
        loop {
            if let Some(found) = look() {
                return found;
            }
            assert!(start.elapsed() < Duration::from_secs(60), "nothing came");
            thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn work_tells_how_far_it_is_and_hands_its_result_over_once() {
        let (go, waits) = channel::<()>();
        let work = Background::start("test", move |watch| {
            let told = watch.tell("half", 0.5);
            waits.recv().map(|()| told)
        })
        .unwrap();
        soon(|| (work.progress() == ("half".into(), 0.5)).then_some(()));
        assert_eq!(work.take(), Outcome::Pending);
        go.send(()).unwrap();
        let result = soon(|| match work.take() {
            Outcome::Done(result) => Some(result),
            _ => None,
        });
        assert_eq!(result, Ok(ControlFlow::Continue(())));
        soon(|| (work.take() == Outcome::Lost).then_some(()));
    }

    #[test]
    fn what_is_dropped_is_told_to_end() {
        let (sender, told) = channel();
        let work = Background::start("test", move |watch| {
            while watch.tell("on and on", 0.0).is_continue() {
                thread::sleep(Duration::from_millis(1));
            }
            sender.send(())
        })
        .unwrap();
        drop(work);
        told.recv_timeout(Duration::from_secs(60)).unwrap();
    }
}
