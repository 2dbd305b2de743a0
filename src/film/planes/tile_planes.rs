//! A tile's light kept apart: the sums of each plane, and the picture that they are with their tints.

use super::plane_sums::PlaneSums;
use super::tiled_film::FilmTile;
use crate::film::Sum;
use crate::film::errors::past_moves::{PastMoves, squares};
use crate::film::subject::Subject;
use crate::film::sums::sum_columns::{Blend, CHANNELS, Sums, TileColors};
use crate::film::sums::tiles::{Pixels, TILE_PIXELS, half_of};
use crate::trace::PlaneSet;
use crate::trace::planes::{OWN, Planes};
use glam::{DVec3, Vec3};

/// The planes of a tile: one, where light is not kept apart.
#[derive(Default)]
pub(super) struct TilePlanes {
    planes: Vec<Plane>,
    /// Samples of each pixel of each half, plane by plane. Together and in place, since whoever plans a pass reads them of
    /// every tile.
    counts: [[u32; 2]; Planes::MOST_OF_PICTURE],
    /// How far the picture of all of them moved.
    past: PastMoves,
    /// Whether it is known how far each of them moved.
    keeps_moves: bool,
    /// Their tints are others since then.
    past_is_old: bool,
    /// Which of them are others since the picture was made.
    changed: PlaneSet,
    rest: Option<Rest>,
}

/// What all planes but one are together. While that one is edited, again and again, the others are not read again.
struct Rest {
    edited: usize,
    blend: Box<Blend>,
}

/// What one plane has.
struct Plane {
    sums: PlaneSums,
    /// How far each pixel's mean moved when its samples doubled last; none before they did.
    moved: Option<Box<TileColors>>,
    tint: Vec3,
}

impl Plane {
    fn empty(tint: Vec3) -> Self {
        Self {
            sums: PlaneSums::default(),
            moved: None,
            tint,
        }
    }

    /// Has nothing any more, but for its memory.
    fn forget(&mut self) {
        self.sums.forget();
        self.moved = None;
    }

    /// Adds to these pixels: one sample, and no more for now, where `is_one`.
    fn add(&mut self, pixels: Pixels, sums: Sums, is_one: bool) {
        if self.sums.is_empty() && pixels == Pixels::All {
            return self.sums.begin(sums, is_one);
        }
        let own = self.sums.as_sums();
        for places in pixels.runs() {
            own.merge(places.start, sums.part(places));
        }
    }
}

/// How far the means of these pixels move from those of `own` sums with `count` more samples: as many as they have.
fn moves_with(own: Sums, sums: Sums, pixels: Pixels, count: u32, moved: &mut TileColors) {
    for places in pixels.runs() {
        let lanes = CHANNELS * places.start..CHANNELS * places.end;
        let own = own.part(places.clone());
        own.half_differences(sums.part(places), count, &mut moved[lanes]);
    }
}

impl TilePlanes {
    /// Of a subject, before any sample.
    pub fn of(subject: &Subject) -> Self {
        let tints = &subject.light.tints;
        Self {
            planes: tints.iter().map(|tint| Plane::empty(*tint)).collect(),
            keeps_moves: subject.stays_apart,
            ..Self::default()
        }
    }

    /// Samples of each plane that there is.
    fn counts_of_all(&self) -> impl Iterator<Item = [u32; 2]> {
        self.counts.into_iter().take(self.planes.len())
    }

    /// Whether it has nothing of any subject.
    pub fn is_empty(&self) -> bool {
        self.planes.is_empty()
    }

    /// Samples of each pixel of each half: of what shines by itself.
    pub fn counts(&self) -> [u32; 2] {
        self.counts[OWN]
    }

    /// Adds `count` samples of a pass of so many to these planes of these pixels. The sums are of the planes `of`, those among
    /// them: `TILE_PIXELS` for each.
    pub fn add(
        &mut self,
        pixels: Pixels,
        planes: PlaneSet,
        (of, sums): (PlaneSet, Sums),
        count: u32,
        pass: u64,
    ) {
        let is_one = pass == 1;
        self.update_past();
        let before = self.counts();
        let is_more = planes.has(OWN);
        let mut alone = [0.0; CHANNELS * TILE_PIXELS];
        let every = self.planes.iter_mut().zip(&mut self.counts);
        for (number, (plane, counts)) in every.enumerate() {
            let Some(row) = of.row(number).filter(|_| planes.has(number)) else {
                continue;
            };
            let sums = sums.part(row * TILE_PIXELS..(row + 1) * TILE_PIXELS);
            for half in pixels.halves() {
                if counts[half] == count {
                    let moved = match &mut plane.moved {
                        moved if self.keeps_moves => {
                            moved.get_or_insert_with(|| Box::new([0.0; CHANNELS * TILE_PIXELS]))
                        }
                        _ => &mut alone,
                    };
                    let own = plane.sums.as_sums();
                    moves_with(own.all(), sums, Pixels::Half(half), count, moved);
                }
            }
            plane.add(pixels, sums, is_one);
            pixels.halves().for_each(|half| counts[half] += count);
            self.changed = self.changed.with(number);
        }
        let has_doubled = |half: usize| before[half] == count;
        let may_have_moved = !self.keeps_moves || self.planes.iter().any(|p| p.moved.is_some());
        if may_have_moved && pixels.halves().any(|half| !is_more || has_doubled(half)) {
            let squares = if self.keeps_moves {
                self.squares()
            } else {
                squares(&alone)
            };
            for half in pixels.halves().map(|half| (half, Pixels::Half(half))) {
                match half {
                    (_, pixels) if !is_more => self.past.correct(pixels, &squares),
                    (half, pixels) if has_doubled(half) => self.past.push(pixels, &squares),
                    _ => {}
                }
            }
        }
        for half in pixels.halves() {
            if is_more && before[half] == 0 && count > 1 {
                self.past.forget(Pixels::Half(half));
            }
        }
    }

    /// Adds `count` samples to these planes of these pixels, of which none sees a light and all are of this colour: to those
    /// that have none, the `first` of them by itself.
    pub fn add_even(
        &mut self,
        pixels: Pixels,
        planes: PlaneSet,
        color: Vec3,
        (first, count): (u32, u32),
    ) {
        self.update_past();
        if planes.has(OWN) {
            for half in pixels.halves() {
                if self.counts()[half] == 0 && first > 1 {
                    self.past.forget(Pixels::Half(half));
                }
            }
            let sum = Sum::of_many(color, u64::from(count));
            self.planes[OWN].sums.add_even(pixels, &sum);
        }
        for number in planes.of(self.planes.len()) {
            pixels
                .halves()
                .for_each(|half| self.counts[number][half] += count);
            self.changed = self.changed.with(number);
        }
    }

    /// The mean of every pixel of each half, where all samples of each were the same.
    pub fn even_means(&mut self) -> Option<[Vec3; 2]> {
        self.update_past();
        let plane = self.only().filter(|_| self.past.are_none())?;
        plane.sums.even_means(self.counts())
    }

    /// How far the picture moved when its samples doubled last, squared.
    fn squares(&self) -> [f32; TILE_PIXELS] {
        let mut all = [0.0; CHANNELS * TILE_PIXELS];
        for plane in &self.planes {
            let Some(moved) = &plane.moved else { continue };
            let tint = plane.tint.to_array();
            for (all, moved) in all
                .chunks_exact_mut(CHANNELS)
                .zip(moved.chunks_exact(CHANNELS))
            {
                for channel in 0..CHANNELS {
                    all[channel] += tint[channel] * moved[channel];
                }
            }
        }
        squares(&all)
    }

    /// Other tints from now on.
    pub fn retint(&mut self, tints: &[Vec3]) {
        for (number, (plane, tint)) in self.planes.iter_mut().zip(tints).enumerate() {
            if plane.tint != *tint {
                plane.tint = *tint;
                self.changed = self.changed.with(number);
            }
        }
        self.past_is_old = self.keeps_moves;
    }

    /// How far the picture moved, with the tints that it has.
    pub fn past(&mut self) -> &PastMoves {
        self.update_past();
        &self.past
    }

    fn update_past(&mut self) {
        if std::mem::take(&mut self.past_is_old) {
            let squares = self.squares();
            self.past.rescale(&squares);
        }
    }

    /// Keeps all planes but the only one that has changed, if they are worth it.
    fn update_rest(&mut self) {
        let changed = std::mem::replace(&mut self.changed, PlaneSet::NONE);
        let is_same =
            |rest: &Rest| changed == PlaneSet::NONE || changed.only() == Some(rest.edited);
        if self.rest.as_ref().is_some_and(is_same) {
            return;
        }
        // How all others are weighed hangs on the samples of what shines by itself.
        let edited = (changed.only()).filter(|edited| *edited != OWN && self.planes.len() > 2);
        let before = self.rest.take();
        self.rest = edited.map(|edited| {
            let mut blend = before.map_or_else(Blend::boxed, |rest| rest.blend);
            blend.clear();
            self.blend_into(|plane| plane != edited, &mut blend);
            Rest { edited, blend }
        });
    }

    /// Adds some of the planes, as if each had the samples of the picture's own light.
    fn blend_into(&self, is_some: impl Fn(usize) -> bool, blend: &mut Blend) {
        for (number, plane) in self.planes.iter().enumerate() {
            if is_some(number) {
                plane.sums.add_to(blend, self.factors(number));
            }
        }
    }

    /// What a plane of each half has to be multiplied by: its tint, and how many more samples the picture has.
    fn factors(&self, plane: usize) -> [DVec3; 2] {
        let (goals, counts) = (self.counts(), self.counts[plane]);
        let tint = self.planes[plane].tint.as_dvec3();
        [0, 1].map(|half| tint * (f64::from(goals[half]) / f64::from(counts[half].max(1))))
    }

    /// The only plane that has anything, where it is the picture.
    fn only(&self) -> Option<&Plane> {
        let (only, others) = self.planes.split_first()?;
        let is_all = others.iter().all(|plane| plane.sums.is_empty());
        (is_all && only.tint == Vec3::ONE && !only.sums.is_empty()).then_some(only)
    }

    /// The means of the picture's pixels.
    pub fn means(&mut self) -> TileColors {
        if let Some(plane) = self.only() {
            return plane.sums.means(self.counts());
        }
        self.update_rest();
        if let Some(rest) = &self.rest {
            let others = rest.blend.sums();
            let plane = &self.planes[rest.edited].sums;
            return plane.means_with(others, self.factors(rest.edited), self.counts());
        }
        let mut blend = Blend::new();
        self.blend_into(|_| true, &mut blend);
        blend.sums().means(self.counts())
    }

    /// The picture.
    pub fn film_tile(&mut self) -> FilmTile {
        if self.counts() == [0; 2] {
            return FilmTile::default();
        }
        self.update_past();
        FilmTile {
            sums: match self.only() {
                Some(plane) => plane.sums.clone(),
                None => {
                    let mut blend = Blend::new();
                    self.blend_into(|_| true, &mut blend);
                    blend.sums().to_columns().into()
                }
            },
            past: self.past.clone(),
            counts: self.counts(),
        }
    }

    /// The same without a copy, where that can be.
    pub fn into_film_tile(mut self) -> FilmTile {
        if self.only().is_none() {
            return self.film_tile();
        }
        FilmTile {
            counts: self.counts(),
            sums: std::mem::take(&mut self.planes[OWN].sums),
            past: self.past,
        }
    }

    /// The mean of a pixel's samples in one plane, without its tint; black where there is no such plane.
    pub fn mean(&self, number: usize, at: usize) -> Vec3 {
        match self.planes.get(number) {
            Some(plane) if !plane.sums.is_empty() => {
                plane.sums.get(at).mean(self.counts[number][half_of(at)])
            }
            _ => Vec3::ZERO,
        }
    }

    /// The planes of an edited scene: of each the one of this number before, or none yet.
    pub fn rearrange(&mut self, from: &[Option<usize>]) {
        let stays = |(plane, from): (usize, &Option<usize>)| from.is_none_or(|from| from == plane);
        if from.len() == self.planes.len() && from.iter().enumerate().all(stays) {
            for (number, plane) in self.planes.iter_mut().enumerate() {
                if from[number].is_none() {
                    plane.forget();
                    self.counts[number] = [0; 2];
                    self.changed = self.changed.with(number);
                }
            }
            return;
        }
        self.changed = PlaneSet::ALL;
        let mut before: Vec<Option<Plane>> = self.planes.drain(..).map(Some).collect();
        let counts = std::mem::take(&mut self.counts);
        for (now, plane) in self.counts.iter_mut().zip(from) {
            *now = plane.map_or([0; 2], |plane| counts[plane]);
        }
        let planes = from.iter().map(|plane| before[(*plane)?].take());
        self.planes = planes
            .map(|plane| plane.unwrap_or_else(|| Plane::empty(Vec3::ONE)))
            .collect();
    }

    /// Has no sample any more, but for its memory.
    pub fn empty(&mut self) {
        self.planes.iter_mut().for_each(Plane::forget);
        self.counts = Default::default();
        self.past = PastMoves::default();
        self.past_is_old = false;
        self.changed = PlaneSet::ALL;
        self.rest = None;
    }

    /// Whether it has no sample, or some plane has none yet of pixels of which its own light has.
    pub fn lacks_light(&self) -> bool {
        let own = self.counts();
        let lacks = |half| own[half] > 0 && self.counts_of_all().any(|counts| counts[half] == 0);
        own == [0; 2] || (0..2).any(lacks)
    }

    /// Planes of a half that have fewer samples than its own light: those that have fewest, and how many, and how many they
    /// should have.
    pub fn behind(&self, half: usize) -> Option<(PlaneSet, u32, u32)> {
        let goal = self.counts()[half];
        let fewest = self.counts_of_all().map(|counts| counts[half]).min()?;
        if fewest == goal {
            return None;
        }
        let planes = self.counts_of_all().enumerate();
        let last = planes.filter(|(_, counts)| counts[half] == fewest);
        let set = last.fold(PlaneSet::NONE, |set, (number, _)| set.with(number));
        Some((set, fewest, goal))
    }
}

#[cfg(test)]
mod tests;
