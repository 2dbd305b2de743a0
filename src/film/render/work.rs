//! The work of a render: pass after pass, chunk by chunk on all threads, until a rule, a cancel or an edit stops it.

use super::control::Signal;
use super::engine::Engine;
use super::pool::Turn;
use super::status::Ending;
use crate::film::lock;
use crate::film::planes::tile_state::Chunk;
use crate::film::samples::kept::Kept;
use crate::film::samples::sample_chunk::{Scratch, Work, with_scratch};
use crate::film::subject::Subject;
use crate::film::sums::tiles::TILE_PIXELS;
use crate::trace::RayCounts;
use crate::trace::planes::OWN;
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// Why threads stop before the queue is empty.
enum Interruption {
    End(Ending),
    Edit,
}

/// Small chunks are taken as so many samples at once: some tenths of a millisecond in a plain scene.
const SAMPLES_AT_ONCE: u64 = 2048;

impl Engine {
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

    fn run_passes(&self, told: &(dyn Fn(&Self) + Sync)) -> Ending {
        loop {
            if self.begins_coarse.swap(false, Ordering::Relaxed) {
                if let Some(ending) = self.start_coarse() {
                    return ending;
                }
                self.time_samples();
            }
            self.set_begun();
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
        for chunk in &waiting {
            let work = Work {
                subject: &subject,
                batch: &self.batch,
                kept: self.kept_of(&subject, chunk),
                stopped: &|| self.must_stop(),
            };
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
            self.note_samples(samples, rays);
        }
        if done < waiting.len() {
            let mut queue = lock(&self.queue);
            waiting.drain(done..).for_each(|chunk| queue.push(chunk));
        }
        waiting.clear();
        scratch.chunks = waiting;
        done > 0
    }

    /// Where what edits leave true of a chunk's samples is kept, if it is.
    fn kept_of(&self, subject: &Subject, chunk: &Chunk) -> Option<&Kept> {
        let may_be_edited = self.mode.watched && subject.stays_apart;
        let is_first = may_be_edited && chunk.range == (0..1);
        (subject.edit > 0 || is_first).then_some(&self.kept)
    }
}
