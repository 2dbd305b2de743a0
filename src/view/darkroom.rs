//! Where the film is developed: on a thread of its own, so that no frame waits for a picture.
//!
//! A print is made as soon as the film shows anything, and then as often as it is worth it: every
//! 50 ms at first, up to twice a second for a render that has been going on for long, as the gain
//! of each pass becomes smaller (Cycles' render scheduler does the same).

use super::darkroom_threads::pool;
use super::surfaces::{Surfaces, SurfacesOf};
use crate::film::views::{Scale, Source, Sources, View, show};
use crate::film::{Ending, FirstHits, Progressive, Snapshot, State, develop_rgba8};
use crate::scene::{Output, RenderSettings};
use crate::trace;
use bevy::math::{URect, UVec2};
use rayon::ThreadPool;
use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};

/// How long the film is looked at between two prints, at the least and at the most.
const INTERVAL: [Duration; 2] = [Duration::from_millis(50), Duration::from_millis(500)];
/// How long until it is looked at again while there is no picture yet, and one is being traced.
const FIRST: Duration = Duration::from_millis(2);
/// Samples a pixel of those views that are made of first hits.
const VIEW_SAMPLES: u32 = 4;

/// How prints are made.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Order {
    pub output: Output,
    pub view: View,
    pub range: Option<[f32; 2]>,
}

/// A picture for the screen.
pub(super) struct Print {
    pub size: UVec2,
    /// RGBA.
    pub bytes: Vec<u8>,
    /// `None` where those of the print before are still true, or come with the next.
    pub surfaces: Option<Surfaces>,
    pub scale: Option<Scale>,
    /// Which render it is of: [`Progressive::number`].
    pub of: u64,
    /// Why that has ended, where this is its last picture.
    pub ending: Option<Ending>,
}

/// What a render is of.
#[derive(Clone)]
pub(super) struct Subject {
    pub world: Arc<trace::World>,
    pub camera: trace::Camera,
    pub settings: RenderSettings,
    /// The part of the picture that is rendered, in pixels; `None` for all.
    pub region: Option<URect>,
}

enum Task {
    Develop(Arc<Progressive>, Box<Subject>, Box<Order>),
    /// Ends a render that was cancelled, which may take a moment.
    Retire(Arc<Progressive>),
}

/// The thread, and the newest print that nobody has taken yet.
pub(super) struct Darkroom {
    tasks: Sender<Task>,
    newest: Arc<Mutex<Option<Print>>>,
}

impl Darkroom {
    /// An error where the system has no more threads.
    pub fn open() -> io::Result<Self> {
        let (tasks, inbox) = channel();
        let newest = Arc::new(Mutex::new(None));
        let pool = pool()?;
        let shelf = newest.clone();
        thread::Builder::new()
            .name("develop".into())
            .spawn(move || Developer::new(shelf).work(&inbox, pool))?;
        Ok(Self { tasks, newest })
    }

    /// From now on prints of this render are made, in this way.
    pub fn develop(&self, render: &Arc<Progressive>, subject: &Subject, order: Order) {
        let task = Task::Develop(render.clone(), Box::new(subject.clone()), Box::new(order));
        // It fails only where the thread is gone, and then nothing shows prints any more.
        let _ = self.tasks.send(task);
    }

    /// Ends a cancelled render without making the caller wait.
    pub fn retire(&self, render: Arc<Progressive>) {
        let _ = self.tasks.send(Task::Retire(render));
    }

    /// The newest print, once.
    pub fn take(&self) -> Option<Print> {
        self.newest
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
    }
}

/// Whether a view becomes another with every pass. First hits are traced once for each render.
fn follows_samples(view: View) -> bool {
    view.source() != Source::FirstHits
}

/// In place of a print that nobody has taken. Its surfaces, which come only when they are others, are
/// the newest still where this one has none.
fn put_on(shelf: &mut Option<Print>, mut print: Print) {
    if let (None, Some(before)) = (&print.surfaces, shelf.take()) {
        print.surfaces = before.surfaces;
    }
    *shelf = Some(print);
}

/// What is being developed.
struct Job {
    render: Arc<Progressive>,
    subject: Box<Subject>,
    order: Box<Order>,
    first_hits: Option<FirstHits>,
    printed: bool,
    ended: bool,
    next: Instant,
    started: Instant,
}

struct Developer {
    newest: Arc<Mutex<Option<Print>>>,
    job: Option<Job>,
    /// Outlives a job: what a new render has no picture of yet shows the one before.
    snapshot: Snapshot,
    /// Of what the newest surfaces are.
    surfaces_of: Option<SurfacesOf>,
    /// Of what the snapshot is.
    seen: Option<Seen>,
}

/// What stays true of a picture where a region of it is rendered anew.
struct Seen {
    /// Its address is not used again while this is kept.
    world: Weak<trace::World>,
    camera: trace::Camera,
}

impl Seen {
    fn is_of(&self, subject: &Subject) -> bool {
        std::ptr::eq(self.world.as_ptr(), Arc::as_ptr(&subject.world))
            && self.camera == subject.camera
    }
}

impl Developer {
    fn new(newest: Arc<Mutex<Option<Print>>>) -> Self {
        Self {
            newest,
            job: None,
            snapshot: Snapshot::black(UVec2::ZERO),
            surfaces_of: None,
            seen: None,
        }
    }

    /// Until the darkroom is closed.
    fn work(mut self, inbox: &Receiver<Task>, pool: &ThreadPool) {
        loop {
            let wait = self.job.as_ref().map_or(Duration::from_secs(3600), |job| {
                if job.ended {
                    Duration::from_secs(3600)
                } else {
                    job.next.saturating_duration_since(Instant::now())
                }
            });
            match inbox.recv_timeout(wait) {
                Ok(task) => {
                    self.take_on(task);
                    // Only the newest of what has gathered matters.
                    while let Ok(task) = inbox.try_recv() {
                        self.take_on(task);
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            let Self {
                job: Some(job),
                snapshot,
                surfaces_of,
                ..
            } = &mut self
            else {
                continue;
            };
            if Instant::now() >= job.next
                && !job.ended
                && let Some(print) = pool.install(|| job.print(snapshot, surfaces_of))
            {
                let mut shelf = self.newest.lock().unwrap_or_else(PoisonError::into_inner);
                put_on(&mut shelf, print);
            }
        }
    }

    fn take_on(&mut self, task: Task) {
        match task {
            Task::Retire(render) => {
                if self
                    .job
                    .as_ref()
                    .is_some_and(|job| Arc::ptr_eq(&job.render, &render))
                {
                    self.job = None;
                }
            }
            Task::Develop(render, subject, order) => {
                let now = Instant::now();
                let seen = Seen {
                    world: Arc::downgrade(&subject.world),
                    camera: subject.camera.clone(),
                };
                let same = self
                    .job
                    .as_mut()
                    .filter(|job| Arc::ptr_eq(&job.render, &render));
                if let Some(job) = same {
                    if !Arc::ptr_eq(&job.subject.world, &subject.world) {
                        // What an edit changes is shown as soon as a new render is.
                        job.started = now;
                        self.seen = Some(seen);
                        // A material may be another.
                        job.first_hits = None;
                    }
                    job.subject = subject;
                    job.order = order;
                    job.ended = false;
                    job.printed = false;
                    job.next = now;
                } else {
                    let before = self.seen.take().filter(|seen| seen.is_of(&subject));
                    if subject.region.is_some() && before.is_none() {
                        // Around the region there would be another scene, or another view of it.
                        self.snapshot = Snapshot::black(subject.settings.size);
                    }
                    self.seen = Some(seen);
                    self.job = Some(Job {
                        render,
                        subject,
                        order,
                        first_hits: None,
                        printed: false,
                        ended: false,
                        next: now,
                        started: now,
                    });
                }
            }
        }
    }
}

impl Job {
    /// A print where there is anything new.
    fn print(
        &mut self,
        snapshot: &mut Snapshot,
        surfaces_of: &mut Option<SurfacesOf>,
    ) -> Option<Print> {
        let status = self.render.status();
        let ended = matches!(status.state, State::Ended(_));
        let paused = status.state == State::Paused;
        if status.divider.is_none() && !ended {
            let wait = if paused { INTERVAL[0] } else { FIRST };
            self.next = Instant::now() + wait;
            return None;
        }
        let of = self.render.number();
        let changed = self.render.refresh(snapshot);
        let wanted = SurfacesOf::new(&self.subject);
        // The first picture does not wait for them, but the last shows them.
        let are_new = surfaces_of.as_ref() != Some(&wanted);
        let surfaces = are_new && (self.printed || ended);
        let surfaces = surfaces.then(|| Surfaces::of(&self.subject));
        if surfaces.is_some() {
            *surfaces_of = Some(wanted);
        }
        let age = self.started.elapsed();
        self.next = Instant::now()
            + match are_new && surfaces.is_none() {
                true => FIRST,
                false => (age / 10).clamp(INTERVAL[0], INTERVAL[1]),
            };
        let stands = self.printed && !(changed && follows_samples(self.order.view));
        if stands && surfaces.is_none() && !ended {
            return None;
        }
        self.ended = ended;
        let (shown, scale) = self.shown(snapshot)?;
        self.printed = true;
        Some(Print {
            size: self.subject.settings.size,
            bytes: shown,
            surfaces,
            scale,
            of,
            ending: match status.state {
                State::Ended(ending) => Some(ending),
                _ => None,
            },
        })
    }

    fn shown(&mut self, snapshot: &Snapshot) -> Option<(Vec<u8>, Option<Scale>)> {
        if self.order.view == View::Shaded {
            let bytes = develop_rgba8(&snapshot.picture, &self.order.output);
            return Some((bytes, None));
        }
        let Subject {
            world,
            camera,
            settings,
            ..
        } = &*self.subject;
        let source = self.order.view.source();
        let film = matches!(source, Source::Samples | Source::Errors).then(|| self.render.film());
        if source == Source::FirstHits && self.first_hits.is_none() {
            let few = RenderSettings {
                spp: VIEW_SAMPLES,
                jitter: 1,
                ..settings.clone()
            };
            self.first_hits = Some(FirstHits::trace(world, camera, &few));
        }
        let counts = film.as_ref().map(|film| film.counts());
        let errors = film.as_ref().map(|film| film.relative_errors());
        let sources = Sources {
            picture: Some(&snapshot.picture),
            first_hits: self.first_hits.as_ref(),
            samples: counts.as_deref().map(|counts| (settings.size, counts)),
            errors: errors.as_deref().map(|errors| (settings.size, errors)),
        };
        let shown = show(
            self.order.view,
            &sources,
            &self.order.output,
            self.order.range,
        )
        .ok()?;
        let byte = |x: f32| (x * 255.0 + 0.5) as u8;
        let bytes = shown
            .pixels
            .iter()
            .flat_map(|&[r, g, b]| [byte(r), byte(g), byte(b), 255])
            .collect();
        Some((bytes, shown.scale))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn print(of: u64, depths: Option<f32>) -> Print {
        Print {
            size: UVec2::ONE,
            bytes: vec![0; 4],
            surfaces: depths.map(|depth| Surfaces {
                size: UVec2::ONE,
                depths: vec![depth],
                backs: Vec::new(),
            }),
            scale: None,
            of,
            ending: None,
        }
    }

    #[test]
    fn only_views_of_first_hits_stand_while_samples_come() {
        let standing = View::ALL.into_iter().filter(|view| !follows_samples(*view));
        let standing: Vec<View> = standing.collect();
        let of_first_hits = [
            View::Albedo,
            View::Normal,
            View::Depth,
            View::Object,
            View::Nodes,
            View::Triangles,
        ];
        assert_eq!(standing, of_first_hits);
    }

    #[test]
    fn depths_outlive_a_print_that_nobody_took_until_there_are_others() {
        let mut shelf = None;
        put_on(&mut shelf, print(1, Some(3.0)));
        put_on(&mut shelf, print(1, None));
        put_on(&mut shelf, print(1, None));
        let depths = |shelf: &Option<Print>| {
            let print = shelf.as_ref().unwrap();
            print.surfaces.as_ref().map(|surfaces| surfaces.depths[0])
        };
        assert_eq!(depths(&shelf), Some(3.0));
        put_on(&mut shelf, print(2, None));
        assert_eq!(depths(&shelf), Some(3.0));
        put_on(&mut shelf, print(2, Some(5.0)));
        assert_eq!(depths(&shelf), Some(5.0));
    }
}
