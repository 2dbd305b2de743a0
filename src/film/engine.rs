//! A render: what it reads, what it has, and the passes that add samples until a rule ends it.

use super::control::{Control, Signal};
use super::edit::Edit;
use super::kept::Kept;
use super::past_moves::PAST_BYTES;
use super::pool::{SharedPool, Turn};
use super::preview::Preview;
use super::queue::Queue;
use super::sample_chunk::{BatchSize, Scratch, Work, with_scratch};
use super::status::{Ending, State, Status, TrendPoint, seconds_left};
use super::subject::Subject;
use super::tile_planes::{BLEND_BYTES, PLANE_BYTES};
use super::tile_state::TileState;
use super::tiles::{TILE_PIXELS, Tile, TileGrid};
use super::unmet::Unmet;
use super::voids::Voids;
use super::{FilmMemory, lock};
use crate::trace::RayCounts;
use crate::trace::planes::OWN;
use bevy::math::URect;
use glam::{UVec2, Vec2};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError, RwLock};
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
    pub(super) queue: Mutex<Queue>,
    pub(super) batch: BatchSize,
    pub(super) unmet: Unmet,
    pub(super) kept: Kept,
    pub(super) voids: Voids,
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
    /// Seconds of a sample of every pixel, as they were before edits.
    pub(super) pace: OnceLock<f64>,
}

/// Why threads stop before the queue is empty.
enum Interruption {
    End(Ending),
    Edit,
}

/// Another number for each render and each of its edits.
fn next_number() -> u64 {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    COUNT.fetch_add(1, Ordering::Relaxed) + 1
}

/// Small chunks are taken as so many samples at once: some tenths of a millisecond in a plain scene.
const SAMPLES_AT_ONCE: u64 = 2048;

/// What the threads report.
#[derive(Clone, Debug, Default)]
struct Progress {
    rays: RayCounts,
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
            pace: OnceLock::new(),
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
    pub(super) fn tile(&self, number: usize) -> MutexGuard<'_, TileState> {
        self.tile_of(&self.subject(), number)
    }

    /// A tile with the tints of the subject, which the caller has asked for.
    pub(super) fn tile_of(&self, subject: &Subject, number: usize) -> MutexGuard<'_, TileState> {
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

    /// Renders until a rule, or a cancel, ends it. `told` hears of progress, from any thread.
    pub fn run(&self, told: &(dyn Fn(&Self) + Sync)) -> Ending {
        self.reopen();
        self.take_edit();
        if self.has_begun() {
            self.update_moves();
            self.note_error();
        }
        self.control.start_watch();
        let ending = self.run_passes(told);
        self.end(ending);
        ending
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

    fn run_passes(&self, told: &(dyn Fn(&Self) + Sync)) -> Ending {
        loop {
            if self.begins_coarse.swap(false, Ordering::Relaxed)
                && let Some(ending) = self.start_coarse()
            {
                return ending;
            }
            self.begun.store(true, Ordering::Release);
            let chunks = match self.next_pass() {
                Ok(chunks) => chunks,
                Err(ending) => return ending,
            };
            {
                let mut queue = lock(&self.queue);
                queue.clear();
                chunks.into_iter().for_each(|chunk| queue.push(chunk));
            }
            match self.run_queue(told) {
                Some(Interruption::End(ending)) => return ending,
                // What comes next is another question now.
                Some(Interruption::Edit) => continue,
                None => {}
            }
            self.set_divider(1);
            *lock(&self.preview) = None;
            self.note_error();
            told(self);
        }
    }

    /// Works on the threads that trace. What waits does so outside, lest a paused render keeps a thread
    /// from others.
    pub(super) fn on_threads<R: Send>(&self, work: impl FnOnce(Turn) -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(Turn::ENDLESS),
        }
    }

    /// Works on what is queued until nothing is left, or something else ends the render.
    fn run_queue(&self, told: &(dyn Fn(&Self) + Sync)) -> Option<Interruption> {
        loop {
            let waiting = lock(&self.queue).len();
            let go_on = |turn: Turn| {
                if !turn.is_over() && !self.must_stop() && with_scratch(|s| self.run_some(s)) {
                    told(self);
                }
            };
            self.on_threads(|turn| {
                let turns = (0..waiting).into_par_iter().with_max_len(1);
                turns.for_each(|_| go_on(turn));
            });
            if let Some(ending) = self.interrupted() {
                return Some(Interruption::End(ending));
            }
            if self.edit_waits.load(Ordering::Relaxed) {
                self.take_edit();
                return Some(Interruption::Edit);
            }
            if lock(&self.queue).len() == 0 {
                return None;
            }
        }
    }

    /// Whether work has to stop, for good or for a while.
    pub(super) fn must_stop(&self) -> bool {
        self.control.signal() != Signal::Go
            || self.edit_waits.load(Ordering::Relaxed)
            || self.time_is_up()
    }

    fn time_is_up(&self) -> bool {
        self.limit.is_some_and(|limit| {
            self.divider.load(Ordering::Relaxed) == 1 && self.control.elapsed() >= limit
        })
    }

    /// Waits out a pause; says what ends the render.
    pub(super) fn interrupted(&self) -> Option<Ending> {
        if self.control.signal() == Signal::Pause {
            self.control.stop_watch();
            self.control.wait_while_paused();
            self.control.start_watch();
        }
        match self.control.signal() {
            Signal::Cancel => Some(Ending::Cancelled),
            _ if self.time_is_up() => Some(Ending::Time),
            _ => None,
        }
    }

    /// Works on what waits in front: on several chunks where they are small, so that threads do not get in each other's way
    /// more often than they have to. False where nothing was done.
    fn run_some(&self, scratch: &mut Scratch) -> bool {
        let mut waiting = std::mem::take(&mut scratch.chunks);
        {
            let mut queue = lock(&self.queue);
            // Of a few, some are left for every thread.
            let share = queue.len() * TILE_PIXELS / (2 * rayon::current_num_threads());
            queue.pop(&self.grid, SAMPLES_AT_ONCE.min(share as u64), &mut waiting);
        }
        if waiting.is_empty() {
            scratch.chunks = waiting;
            return false;
        }
        let (number, subject) = (self.number(), self.subject());
        scratch.octaves.fill(0);
        let (mut rays, mut samples, mut done) = (RayCounts::default(), 0, 0);
        let work = Work {
            subject: &subject,
            batch: &self.batch,
            kept: (subject.edit > 0).then_some(&self.kept),
            stopped: &|| self.must_stop(),
        };
        for chunk in &waiting {
            let tile = self.grid.tile(chunk.tile);
            let color = self.voids.color_of(chunk.tile);
            let taken = match color {
                Some(color) => Some(scratch.see_nothing(color, tile, chunk)),
                None => scratch.sum_chunk(&work, tile, chunk),
            };
            let Some(taken) = taken else { break };
            rays += taken;
            done += 1;
            let is_complete = {
                // Its tints may be others by now.
                let edited = (self.number() != number).then(|| self.subject());
                let subject = edited.as_ref().unwrap_or(&subject);
                let mut state = self.tile_of(subject, chunk.tile as usize);
                if let Some(color) = color {
                    state.absorb_even(subject, chunk, color, taken.total())
                } else {
                    state.meet(scratch.met);
                    state.absorb(subject, chunk, scratch.sums.all(), taken.total())
                }
            };
            // Pieces of a pass that an edit throws away have not been samples of the picture.
            if is_complete && chunk.planes.has(OWN) {
                samples += tile.count(chunk.pixels) * chunk.of;
            }
        }
        if done > 0 {
            self.unmet.met(&scratch.octaves);
            self.done.fetch_add(samples, Ordering::Relaxed);
            self.note_rays(rays);
        }
        if done < waiting.len() {
            let mut queue = lock(&self.queue);
            waiting.drain(done..).for_each(|chunk| queue.push(chunk));
        }
        waiting.clear();
        scratch.chunks = waiting;
        done > 0
    }

    fn note_error(&self) {
        let Some(error) = self.error() else { return };
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

    /// Samples of a pixel, on average.
    pub(super) fn samples(&self) -> f64 {
        let pixels = self.pixels();
        self.done.load(Ordering::Relaxed) as f64 / pixels.max(1.0)
    }

    /// So many samples are no more.
    pub(super) fn forget_samples(&self, samples: u64) {
        self.done.fetch_sub(samples, Ordering::Relaxed);
    }

    /// Whether its coarse pictures are behind it, and what it has can be edited.
    pub(super) fn has_begun(&self) -> bool {
        self.begun.load(Ordering::Acquire)
    }

    /// How long a sample of every pixel took before the first edit that sets the clock back.
    pub(super) fn seconds_a_sample(&self) -> f64 {
        let now = || self.control.elapsed().as_secs_f64() / self.samples().max(f64::MIN_POSITIVE);
        self.pace.get().copied().unwrap_or_else(now)
    }

    /// An edit has work for it: its clock begins anew, and what was told of its errors is of another picture.
    pub(super) fn start_over(&self) {
        let _ = self.pace.set(self.seconds_a_sample());
        self.control.restart_watch();
        lock(&self.progress).trend.clear();
    }

    /// It goes on.
    pub(super) fn reopen(&self) {
        lock(&self.progress).ending = None;
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
            seconds,
            trend: progress.trend,
            seconds_left: None,
            divider: Some(self.divider.load(Ordering::Relaxed)).filter(|divider| *divider > 0),
        };
        status.seconds_left = seconds_left(&status, &self.subject().settings.sampling);
        status
    }
}
