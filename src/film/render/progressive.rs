//! A render on a thread of its own, for those who look on.

use super::control::Signal;
use super::engine::{Engine, Mode};
use super::light_pictures::LightPictures;
use super::pool::{Priority, shared_pool};
use super::snapshot::Snapshot;
use super::status::{Ending, Status};
use crate::film::subject::Subject;
use crate::film::{Film, FilmMemory, LightMix, PixelError, Sum};
use crate::scene::RenderSettings;
use crate::trace::{Camera, Gains, World, samples_per_pixel};
use bevy::math::URect;
use glam::{UVec2, Vec2};
use std::io;
use std::ops::Range;
use std::sync::Arc;
use std::sync::mpsc::{Sender, channel};
use std::thread;

/// A render that goes on by itself, coarse to fine, while others look on.
///
/// Passes double the samples of each pixel, tiles nearest the focus first. However it is paused,
/// resumed and re-focused, its last picture is the same bit for bit: that of [`render`](super::at_once::render()), but for the
/// rounding of f32 where lights are kept apart.
///
/// Neither starting nor dropping it makes the caller wait: dropping it cancels it, and what is under
/// way ends, and gives back its memory, by itself.
pub struct Progressive {
    // Dropped in this order, so that it is the worker that lets go of the film last.
    engine: Arc<Engine>,
    edited: Sender<()>,
}

impl Progressive {
    /// Begins to render what [`render`](super::at_once::render()) renders, from the picture's middle outwards, on
    /// threads that all such renders share and that give way to others. The error is that of a system
    /// which has no more threads.
    pub fn start(world: World, camera: Camera, settings: RenderSettings) -> io::Result<Self> {
        Self::start_region(world, camera, settings, None, &LightMix::default())
    }

    /// The same, of a region of the picture alone, in pixels: of the [`TILE`](crate::film::TILE)s that it
    /// touches. They get the samples that they have in the whole picture; status and error are theirs,
    /// and the rest of a snapshot stays as it is. Lights are mixed as `mix` says.
    pub fn start_region(
        world: World,
        camera: Camera,
        settings: RenderSettings,
        region: Option<URect>,
        mix: &LightMix,
    ) -> io::Result<Self> {
        let samples = 0..u64::from(samples_per_pixel(&world, &camera, &settings));
        let subject = Subject::mixed(world, camera, settings, Vec::new(), mix);
        Self::start_for(Priority::View, subject, samples, region)
    }

    /// [`start`](Self::start) for a file that is written in the end: on threads of its own, which give way to
    /// those of renders that somebody looks at.
    pub fn start_for_file(
        world: World,
        camera: Camera,
        settings: RenderSettings,
    ) -> io::Result<Self> {
        let samples = 0..u64::from(samples_per_pixel(&world, &camera, &settings));
        let subject = Subject::new(world, camera, settings, false);
        Self::start_for(Priority::File, subject, samples, None)
    }

    fn start_for(
        priority: Priority,
        subject: Subject,
        samples: Range<u64>,
        region: Option<URect>,
    ) -> io::Result<Self> {
        let mode = Mode {
            watched: true,
            samples,
            region,
        };
        let engine = Arc::new(Engine::new(subject, mode, Some(shared_pool(priority)?)));
        engine.set_focus(engine.area.center());
        let (edited, edits) = channel::<()>();
        let worker = Worker(engine.clone());
        thread::Builder::new().name("film".into()).spawn(move || {
            worker.0.run(&|_| {});
            // Until the other end is dropped.
            while edits.recv().is_ok() {
                // Edits that came meanwhile are one.
                while edits.try_recv().is_ok() {}
                worker.0.run(&|_| {});
            }
        })?;
        Ok(Self { engine, edited })
    }

    /// Renders another world from now on, which differs in lights and materials alone, and its lights' `gains`: the colour or
    /// the gain of a light costs no ray, one that moved its own, and a material those of the tiles where it was met, unless it
    /// lets light through. Only of lights that share a plane, since there are many, another colour costs rays too; one that is
    /// edited has its own from then on. Samples and error are those that there are; the last picture is that of a render of
    /// this world, but for the rounding of f32. False, and nothing done, where another render would show its first picture
    /// sooner.
    pub fn edit(&self, world: World, gains: &Gains) -> bool {
        let edited = self.engine.edit(world, gains);
        if edited {
            // It fails only where the thread is gone by a bug that has been reported.
            let _ = self.edited.send(());
        }
        edited
    }

    /// Tells this render, as it is since its last edit, from all others of the process.
    pub fn number(&self) -> u64 {
        self.engine.number()
    }

    /// What is around this place of the picture, in pixels, comes first from now on.
    pub fn set_focus(&self, place: Vec2) {
        self.engine.set_focus(place);
    }

    /// Stops tracing within a batch on each thread, about 1 ms. What has not reached the film is lost.
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
        let mut snapshot = Snapshot::black(self.engine.size());
        self.engine.redraw(&mut snapshot);
        snapshot
    }

    /// Brings a snapshot up to date, of this render or of another. True where anything in it changed.
    ///
    /// What this render has no picture of yet, or does not render, stays as the snapshot has it, so
    /// that a scene being edited does not turn black in between. One of another size starts black.
    ///
    /// Drawn on the current rayon pool.
    pub fn refresh(&self, snapshot: &mut Snapshot) -> bool {
        self.engine.redraw(snapshot)
    }

    /// Of what shines by itself and of each light that is kept apart a picture of this size, some pixels of the film: with
    /// the lights' colours, and only where several share a picture with their gains. `None` where light is not kept apart,
    /// and while some of it is missing.
    pub fn light_sketches(&self, size: UVec2) -> Option<LightPictures> {
        self.engine.light_sketches(size)
    }

    /// Pixels of the picture.
    pub fn size(&self) -> UVec2 {
        self.engine.size()
    }

    /// What the film takes when every pixel has samples.
    pub fn memory(&self) -> FilmMemory {
        self.engine.memory()
    }

    /// The film as it is now.
    pub fn film(&self) -> Film {
        self.engine.film()
    }

    /// Samples of one pixel so far, and its estimated relative error, as far as the last pass told how errors decline; `None`
    /// outside the picture. Cheap: for what is under a pointer.
    pub fn pixel(&self, pixel: UVec2) -> Option<(u32, PixelError)> {
        let (hidden, decline) = self.engine.told_of_pixels();
        let (film, place) = self.engine.tile_film(pixel, hidden)?;
        let errors = film.errors_in(&decline);
        let error = errors[(place.y * film.size().x + place.x) as usize];
        Some((film.count(place.x, place.y), error))
    }

    /// The exact sum of one pixel's samples so far, and their number; `None` outside the picture.
    pub fn pixel_sum(&self, pixel: UVec2) -> Option<(Sum, u32)> {
        let (film, place) = self.engine.tile_film(pixel, 0.0)?;
        Some((film.sum(place.x, place.y), film.count(place.x, place.y)))
    }

    /// Waits until the render has ended by itself or by [`Self::cancel`], and says why it did.
    pub fn wait(&self) -> Ending {
        self.engine.wait()
    }
}

impl Drop for Progressive {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// Has the render ended when it goes, even by a panic: that is a bug which has been reported on its
/// way, and nobody shall wait for what does not come.
struct Worker(Arc<Engine>);

impl Drop for Worker {
    fn drop(&mut self) {
        self.0.end(Ending::Cancelled);
    }
}

#[cfg(test)]
mod tests;
