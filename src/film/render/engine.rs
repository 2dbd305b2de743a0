//! A render: what it reads, what it has, and what it says of itself. [`Engine::run`] adds samples to it.

use super::control::{Control, Signal};
use super::edit::Edit;
use super::pool::SharedPool;
use super::preview::Preview;
use super::queue::Queue;
use super::status::{Before, Ending, State, Status, TrendPoint, seconds_left};
use crate::film::errors::error::Decline;
use crate::film::errors::past_moves::PAST_BYTES;
use crate::film::errors::unmet::Unmet;
use crate::film::planes::tile_state::TileState;
use crate::film::samples::kept::Kept;
use crate::film::samples::sample_chunk::BatchSize;
use crate::film::samples::voids::Voids;
use crate::film::subject::Subject;
use crate::film::sums::sum_columns::{BLEND_BYTES, PLANE_BYTES};
use crate::film::sums::tiles::{Tile, TileGrid};
use crate::film::{FilmMemory, lock};
use crate::trace::RayCounts;
use bevy::math::URect;
use glam::{UVec2, Vec2};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, RwLock};
use std::time::Duration;

/// How a render goes about it. The samples are the same.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Mode {
    /// Someone looks on: coarse pictures come first, then one sample of each pixel, then two.
    pub watched: bool,
    /// Which samples of each pixel.
    pub samples: Range<u64>,
    /// Only the tiles that this touches, in pixels.
    pub region: Option<URect>,
}

/// A render. Its methods may be called from any thread while one thread is in [`Self::run`].
pub(super) struct Engine {
    subject: RwLock<Arc<Subject>>,
    pub mode: Mode,
    /// Whose threads trace; without one those of the caller's pool.
    pub pool: Option<Arc<SharedPool>>,
    pub grid: TileGrid,
    pub tiles: Vec<Mutex<TileState>>,
    /// Those that are rendered, and the rectangle that they make.
    pub rendered: Vec<u32>,
    pub area: Tile,
    pub preview: Mutex<Option<Arc<Preview>>>,
    pub(in crate::film) queue: Mutex<Queue>,
    pub(in crate::film) batch: BatchSize,
    pub(in crate::film) unmet: Unmet,
    pub(in crate::film) kept: Kept,
    pub(in crate::film) voids: Voids,
    pub control: Control,
    /// The picture is complete at every such pixel of every such row; 0 before the first picture.
    divider: AtomicU32,
    progress: Mutex<Progress>,
    ended: Condvar,
    /// Samples that have entered pixels.
    done: AtomicU64,
    /// When it ends at the latest, on its clock.
    limit: Option<Duration>,
    /// Tells this render, as it is since its last edit, from all others of the process.
    number: AtomicU64,
    /// What it shall render from now on, as soon as nothing is traced.
    pub(super) edits: Mutex<Option<Edit>>,
    pub(super) edit_waits: AtomicBool,
    /// Its first coarse pictures are behind it.
    begun: AtomicBool,
    /// Others come before its next pass.
    pub(super) begins_coarse: AtomicBool,
    pub(super) speed: Mutex<Speed>,
    /// What the last pass told of errors of single pixels: the light that may be hidden from one, and how errors decline.
    of_pixels: Mutex<(f64, Decline)>,
}

/// How long samples of every pixel take, for those who plan an edit.
#[derive(Default)]
pub(super) struct Speed {
    /// Seconds of one, as measured before the first edit that set the clock back.
    pub seconds_a_sample: Option<f64>,
    /// What the clock told when its coarse pictures were done.
    since: Duration,
    /// Samples of a pixel at that time.
    from: f64,
}

/// Parts of a sample from which on its time is told, and from which on it is told for good: the first tiles say little.
const TOLD_FROM: f64 = 0.05;
const KNOWN_FROM: f64 = 0.5;

/// Another number for each render and each of its edits.
fn next_number() -> u64 {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    COUNT.fetch_add(1, Ordering::Relaxed) + 1
}

/// What the threads report.
#[derive(Clone, Debug, Default)]
struct Progress {
    rays: RayCounts,
    /// What there was when the clock began anew.
    before: Before,
    trend: Vec<TrendPoint>,
    ending: Option<Ending>,
}

impl Engine {
    pub fn new(subject: Subject, mode: Mode, pool: Option<Arc<SharedPool>>) -> Self {
        let grid = TileGrid::new(subject.settings.size);
        let (rendered, area) = grid.within(mode.region);
        Self {
            tiles: grid
                .tiles()
                .map(|tile| Mutex::new(TileState::new(tile)))
                .collect(),
            preview: Mutex::default(),
            queue: Mutex::default(),
            batch: BatchSize::new(&subject),
            unmet: Unmet::default(),
            kept: Kept::new(&grid),
            voids: Voids::of(&subject, &grid),
            control: Control::new(),
            divider: AtomicU32::new(0),
            progress: Mutex::default(),
            ended: Condvar::new(),
            done: AtomicU64::new(0),
            limit: subject.time_limit(),
            number: AtomicU64::new(next_number()),
            rendered,
            area,
            subject: RwLock::new(Arc::new(subject)),
            edits: Mutex::default(),
            edit_waits: AtomicBool::new(false),
            begun: AtomicBool::new(false),
            begins_coarse: AtomicBool::new(mode.watched),
            speed: Mutex::default(),
            of_pixels: Mutex::new((0.0, Decline::of([]))),
            mode,
            pool,
            grid,
        }
    }

    /// What is rendered now.
    pub fn subject(&self) -> Arc<Subject> {
        let subject = self.subject.read();
        subject.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Another subject from now on.
    pub(super) fn set_subject(&self, subject: Subject) {
        let mut now = (self.subject.write()).unwrap_or_else(PoisonError::into_inner);
        *now = Arc::new(subject);
        self.number.store(next_number(), Ordering::Relaxed);
        self.unmet.forget_emitters();
    }

    pub fn number(&self) -> u64 {
        self.number.load(Ordering::Relaxed)
    }

    /// A tile with the tints that it has now.
    pub(in crate::film) fn tile(&self, number: usize) -> MutexGuard<'_, TileState> {
        self.tile_of(&self.subject(), number)
    }

    /// A tile with the tints of the subject, which the caller has asked for.
    pub(in crate::film) fn tile_of(
        &self,
        subject: &Subject,
        number: usize,
    ) -> MutexGuard<'_, TileState> {
        let mut state = lock(&self.tiles[number]);
        state.retint(subject);
        state
    }

    pub fn size(&self) -> UVec2 {
        self.grid.size
    }

    pub fn memory(&self) -> FilmMemory {
        let subject = self.subject();
        let pixels = self.grid.pixels();
        let planes = subject.planes();
        let plane = pixels * PLANE_BYTES as u64;
        let rest = if planes > 2 { BLEND_BYTES } else { 0 };
        FilmMemory {
            planes: if subject.stays_apart { planes } else { 0 },
            plane,
            hits: self.kept.bytes(),
            total: pixels * (PAST_BYTES + rest) as u64 + planes as u64 * plane + self.kept.bytes(),
        }
    }

    /// Whether a tile is one of those that are rendered.
    pub fn renders(&self, tile: Tile) -> bool {
        let end = self.area.origin + self.area.extent;
        tile.origin.cmpge(self.area.origin).all() && tile.origin.cmplt(end).all()
    }

    /// How many pixels are rendered.
    pub fn pixels(&self) -> f64 {
        self.area.extent.as_dvec2().element_product()
    }

    pub fn set_focus(&self, focus: Vec2) {
        lock(&self.queue).set_focus(focus);
    }

    /// The render has ended. What was said first counts.
    pub fn end(&self, ending: Ending) {
        self.control.stop_watch();
        lock(&self.progress).ending.get_or_insert(ending);
        self.ended.notify_all();
    }

    /// Waits until the render has ended, and says why.
    pub fn wait(&self) -> Ending {
        let mut progress = lock(&self.progress);
        loop {
            if let Some(ending) = progress.ending
                && !self.edit_waits.load(Ordering::Relaxed)
            {
                return ending;
            }
            progress = (self.ended.wait(progress)).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Notes the error of the picture as it is now.
    pub(super) fn note_error(&self) {
        let moves = self.moves();
        let error = self.error_of(&moves);
        *lock(&self.of_pixels) = (self.hidden_with(error), Decline::of(&moves));
        let Some(error) = error else { return };
        let point = TrendPoint {
            samples: self.samples(),
            seconds: self.control.elapsed().as_secs_f64(),
            error,
        };
        let trend = &mut lock(&self.progress).trend;
        // The same samples in other tints.
        trend.pop_if(|last| last.samples == point.samples);
        trend.push(point);
    }

    /// See [`Self::of_pixels`].
    pub fn told_of_pixels(&self) -> (f64, Decline) {
        *lock(&self.of_pixels)
    }

    /// Samples of a pixel, on average.
    pub(in crate::film) fn samples(&self) -> f64 {
        let pixels = self.pixels();
        self.done.load(Ordering::Relaxed) as f64 / pixels.max(1.0)
    }

    /// So many samples have entered pixels, which took these rays.
    pub(super) fn note_samples(&self, samples: u64, rays: RayCounts) {
        self.done.fetch_add(samples, Ordering::Relaxed);
        self.note_rays(rays);
    }

    /// Whether its coarse pictures are behind it, and what it has can be edited.
    pub(super) fn has_begun(&self) -> bool {
        self.begun.load(Ordering::Acquire)
    }

    /// They are.
    pub(super) fn set_begun(&self) {
        self.begun.store(true, Ordering::Release);
    }

    /// What the clock tells from here on is how long samples take.
    pub(super) fn time_samples(&self) {
        let mut speed = lock(&self.speed);
        speed.since = self.control.elapsed();
        speed.from = self.samples();
    }

    /// Seconds that a sample of every pixel takes, or took before the first edit; `None` while nobody knows.
    pub(super) fn seconds_a_sample(&self) -> Option<f64> {
        let speed = lock(&self.speed);
        let now = || self.measured(&speed, TOLD_FROM);
        speed.seconds_a_sample.or_else(now)
    }

    /// The same as measured now, from so many samples on.
    fn measured(&self, speed: &Speed, least: f64) -> Option<f64> {
        let samples = self.samples() - speed.from;
        let took = self.control.elapsed().saturating_sub(speed.since);
        (samples >= least).then(|| took.as_secs_f64() / samples)
    }

    /// So many samples are no more, by an edit. Where it has work its clock begins anew, and what was told of its errors is
    /// of another picture.
    pub(super) fn start_over(&self, forgotten: u64, has_work: bool) {
        let mut speed = lock(&self.speed);
        if has_work && speed.seconds_a_sample.is_none() {
            speed.seconds_a_sample = self.measured(&speed, KNOWN_FROM);
        }
        drop(speed);
        self.done.fetch_sub(forgotten, Ordering::Relaxed);
        if has_work {
            self.control.restart_watch();
            self.time_samples();
            let samples = self.samples();
            let mut progress = lock(&self.progress);
            progress.trend.clear();
            progress.before = Before {
                rays: progress.rays.total(),
                samples,
            };
        }
    }

    /// It goes on.
    pub(super) fn reopen(&self) {
        lock(&self.progress).ending = None;
    }

    /// Whether it may take no longer, and has a picture.
    pub(super) fn time_is_up(&self) -> bool {
        let is_over = |limit| self.control.elapsed() >= limit;
        self.limit
            .is_some_and(|limit| self.divider.load(Ordering::Relaxed) == 1 && is_over(limit))
    }

    /// The picture is complete at every such pixel of every such row.
    pub(super) fn set_divider(&self, divider: u32) {
        self.divider.store(divider, Ordering::Relaxed);
    }

    pub(super) fn note_rays(&self, rays: RayCounts) {
        lock(&self.progress).rays += rays;
    }

    pub fn status(&self) -> Status {
        let progress = lock(&self.progress).clone();
        let seconds = self.control.elapsed().as_secs_f64();
        let state = match (progress.ending, self.control.signal()) {
            (Some(ending), _) if !self.edit_waits.load(Ordering::Relaxed) => State::Ended(ending),
            (_, Signal::Pause) => State::Paused,
            _ => State::Running,
        };
        let mut status = Status {
            state,
            samples: self.samples(),
            samples_wanted: (self.mode.samples.end - self.mode.samples.start) as f64,
            rays: progress.rays,
            before: progress.before,
            seconds,
            trend: progress.trend,
            seconds_left: None,
            divider: Some(self.divider.load(Ordering::Relaxed)).filter(|divider| *divider > 0),
        };
        status.seconds_left = seconds_left(&status, &self.subject().settings.sampling);
        status
    }
}
