//! A render on a thread of its own, for those who look on.

use super::control::Signal;
use super::engine::{Engine, Mode};
use super::sample_chunk::Subject;
use super::{Ending, Film, Picture, Status};
use crate::scene::RenderSettings;
use crate::trace::{Camera, World, samples_per_pixel};
use glam::Vec2;
use std::io;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

/// A render that goes on by itself, coarse to fine, while others look on.
///
/// Passes double the samples of each pixel, tiles nearest the focus first. However it is paused,
/// resumed and re-focused, its last picture is that of [`render`](super::render()) bit for bit.
/// Dropping it cancels it.
pub struct Progressive {
    engine: Arc<Engine>,
    worker: Option<JoinHandle<()>>,
}

/// A picture that is kept up to date: only what changed is drawn again.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Linear, scene-referred; coarse where the film has no sample yet.
    pub picture: Picture,
    versions: Vec<u32>,
}

impl Progressive {
    /// Begins to render on rayon's global pool what [`render`](super::render()) renders, from the
    /// picture's middle outwards. The error is that of a system which has no more threads.
    pub fn start(world: World, camera: Camera, settings: RenderSettings) -> io::Result<Self> {
        let samples = 0..u64::from(samples_per_pixel(&world, &camera, &settings));
        let middle = 0.5 * settings.size.as_vec2();
        let subject = Subject {
            world,
            camera,
            settings,
        };
        let mode = Mode {
            watched: true,
            samples,
        };
        let engine = Arc::new(Engine::new(subject, mode));
        engine.set_focus(middle);
        let worker = {
            let engine = engine.clone();
            thread::Builder::new().name("film".into()).spawn(move || {
                engine.run(&|_| {});
            })?
        };
        Ok(Self {
            engine,
            worker: Some(worker),
        })
    }

    /// What is around this place of the picture, in pixels, comes first from now on.
    pub fn set_focus(&self, place: Vec2) {
        self.engine.set_focus(place);
    }

    /// Stops tracing within a batch on each thread, about 2 ms. What has not reached the film is lost.
    pub fn cancel(&self) {
        self.engine.control.tell(Signal::Cancel);
    }

    /// Stops tracing until [`Self::resume`].
    pub fn pause(&self) {
        self.engine.control.tell(Signal::Pause);
    }

    /// Goes on after a pause.
    pub fn resume(&self) {
        self.engine.control.tell(Signal::Go);
    }

    /// Its numbers now.
    pub fn status(&self) -> Status {
        self.engine.status()
    }

    /// The picture as it is now.
    pub fn snapshot(&self) -> Snapshot {
        let mut snapshot = Snapshot {
            picture: Picture::black(self.engine.size()),
            versions: Vec::new(),
        };
        self.engine
            .redraw(&mut snapshot.picture, &mut snapshot.versions);
        snapshot
    }

    /// Brings a snapshot of this render up to date. True where anything in it changed.
    pub fn refresh(&self, snapshot: &mut Snapshot) -> bool {
        if snapshot.picture.size() != self.engine.size() {
            *snapshot = self.snapshot();
            return true;
        }
        self.engine
            .redraw(&mut snapshot.picture, &mut snapshot.versions)
    }

    /// The film as it is now.
    pub fn film(&self) -> Film {
        self.engine.film()
    }

    /// Waits until the render has ended by itself or by [`Self::cancel`], and says why it did.
    pub fn wait(&mut self) -> Ending {
        if let Some(worker) = self.worker.take() {
            // A panic there is a bug that has been reported on its way; here it is an early end.
            let _ = worker.join();
        }
        self.engine.ending().unwrap_or(Ending::Cancelled)
    }
}

impl Drop for Progressive {
    fn drop(&mut self) {
        self.cancel();
        self.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_scene::{camera, settings, world};
    use super::super::{State, render, render_samples};
    use super::*;
    use glam::UVec2;
    use std::collections::BTreeMap;
    use std::time::{Duration, Instant};

    const SIZE: UVec2 = UVec2::new(70, 45);

    fn start(spp: u32) -> Progressive {
        Progressive::start(world(), camera(), settings(SIZE, spp)).unwrap()
    }

    fn rendered(spp: u32) -> Picture {
        render(&world(), &camera(), &settings(SIZE, spp), &|_, _| {}).picture
    }

    fn wait_for(render: &Progressive, what: impl Fn(&Status) -> bool) {
        let start = Instant::now();
        while !what(&render.status()) {
            assert!(start.elapsed().as_secs() < 60, "{:?}", render.status());
            thread::sleep(Duration::from_micros(200));
        }
    }

    #[test]
    fn the_last_picture_is_the_same_however_it_was_paused_and_refocused() {
        for spp in [1, 3, 16, 100] {
            let expected = rendered(spp);
            let mut quiet = start(spp);
            assert_eq!(quiet.wait(), Ending::Samples);
            assert_eq!(quiet.snapshot().picture, expected, "{spp} spp at one go");
            let mut busy = start(spp);
            for i in 0..40 {
                busy.pause();
                busy.set_focus(Vec2::new((i * 37 % 70) as f32, (i * 11 % 45) as f32));
                thread::sleep(Duration::from_micros(300));
                busy.resume();
                thread::sleep(Duration::from_micros(500));
            }
            assert_eq!(busy.wait(), Ending::Samples);
            assert_eq!(
                busy.snapshot().picture,
                expected,
                "{spp} spp with interruptions"
            );
            assert_eq!(busy.status().rays, quiet.status().rays, "{spp} spp");
            assert_eq!(busy.status().samples, f64::from(spp));
        }
    }

    #[test]
    fn a_cancelled_render_keeps_whole_passes_of_tiles_only() {
        let mut passes = BTreeMap::new();
        let mut cancelled = start(1 << 12);
        wait_for(&cancelled, |status| status.samples > 5.0);
        cancelled.cancel();
        assert_eq!(cancelled.wait(), Ending::Cancelled);
        assert_eq!(cancelled.status().state, State::Ended(Ending::Cancelled));
        let film = cancelled.film();
        let picture = cancelled.snapshot().picture;
        for y in 0..SIZE.y {
            for x in 0..SIZE.x {
                let count = film.count(x, y);
                assert!(count.is_power_of_two(), "{count} samples at {x}, {y}");
                let expected = passes.entry(count).or_insert_with(|| rendered(count));
                assert_eq!(
                    picture.pixel(x, y),
                    expected.pixel(x, y),
                    "{count} samples at {x}, {y}"
                );
            }
        }
    }

    #[test]
    fn a_paused_render_stands_still_and_its_clock_too() {
        let mut render = start(1 << 12);
        wait_for(&render, |status| status.samples >= 2.0);
        render.pause();
        // What is under way ends within a batch; nothing comes after.
        let start = Instant::now();
        let mut status = render.status();
        loop {
            thread::sleep(Duration::from_millis(100));
            let now = render.status();
            if now.samples == status.samples && now.seconds == status.seconds {
                break;
            }
            assert!(start.elapsed().as_secs() < 60, "still going: {now:?}");
            status = now;
        }
        assert_eq!(status.state, State::Paused);
        let mut snapshot = render.snapshot();
        assert!(
            !render.refresh(&mut snapshot),
            "a picture that stands changed"
        );
        render.cancel();
        assert_eq!(render.wait(), Ending::Cancelled);
    }

    #[test]
    fn a_snapshot_that_is_refreshed_equals_a_new_one() {
        let mut render = start(64);
        let mut snapshot = render.snapshot();
        while render.status().state == State::Running {
            render.refresh(&mut snapshot);
        }
        render.wait();
        render.refresh(&mut snapshot);
        assert_eq!(snapshot.picture, render.snapshot().picture);
        assert_eq!(snapshot.picture, rendered(64));
    }

    #[test]
    fn samples_in_two_parts_are_the_samples_in_one() {
        let part = |samples| {
            let settings = settings(SIZE, 1);
            render_samples(&world(), &camera(), &settings, samples, &|_| {}).film
        };
        let mut film = part(37..41);
        assert!(film.merge(&part(0..37)));
        assert_eq!(film.picture(), rendered(41));
        assert!(!film.merge(&Film::new(UVec2::ONE)));
    }

    #[test]
    fn the_picture_does_not_depend_on_the_number_of_threads() {
        let expected = rendered(20);
        for threads in [1, 2, 7] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            assert_eq!(pool.install(|| rendered(20)), expected, "{threads} threads");
        }
    }
}
