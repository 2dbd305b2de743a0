//! What rays hit and what hides lights from there, kept while lights and materials are edited: those are in no ray's way.
//! Of camera rays, and of those that leave first hits where one of each sample does: in a mirror.
//!
//! Of first samples from the start, since every edit begins with them, and of later ones from the first edit on: a render that
//! nobody edits has no use for it. What hides lights is kept from the first edit on alone: to name what it is known of takes a
//! tenth of a sample, and who turns the view waits for that.

use super::per_sample::{BatchPlaces, PerSample};
use crate::bvh::Hit;
use crate::film::sums::tiles::TileGrid;
use crate::trace::{Known, RayCounts, SecondHit, Visibility};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// What edits leave true of a picture's samples.
pub(in crate::film) struct Kept {
    /// None where a camera ray has not been traced yet.
    hits: PerSample<Option<Option<Hit>>>,
    second_hits: PerSample<SecondHit>,
    /// From first hits and from second ones.
    visibilities: [PerSample<Visibility>; 2],
    /// Points of lights that have moved since somebody needed to know what hides them, a bit for each.
    moved: AtomicU64,
    /// Something was edited. Before that nothing is told: a piece of a pass that is begun again takes the rays that it took.
    is_edited: AtomicBool,
    /// The last edit was of materials alone, so that the next one may be: else nobody needs to know what hid the lights.
    edits_materials: AtomicBool,
}

impl Kept {
    pub fn new(grid: &TileGrid) -> Self {
        Self {
            hits: PerSample::new(grid),
            second_hits: PerSample::new(grid),
            visibilities: [0, 1].map(|_| PerSample::new(grid)),
            moved: AtomicU64::new(0),
            is_edited: AtomicBool::new(false),
            edits_materials: AtomicBool::new(false),
        }
    }

    /// What it takes now, in bytes.
    pub fn bytes(&self) -> u64 {
        let [first, second] = &self.visibilities;
        self.hits.bytes() + self.second_hits.bytes() + first.bytes() + second.bytes()
    }

    /// Something is edited: materials alone, or lights too. Of those the points `moved` that have a bit there; all of them
    /// where there is none. On the current rayon pool.
    pub fn edit(&self, materials_alone: bool, moved: Option<u64>) {
        self.is_edited.store(true, Ordering::Relaxed);
        self.edits_materials
            .store(materials_alone, Ordering::Relaxed);
        let Some(moved) = moved else {
            self.visibilities.iter().for_each(PerSample::clear);
            self.moved.store(0, Ordering::Relaxed);
            return;
        };
        let moved = moved | self.moved.load(Ordering::Relaxed);
        let rest = if materials_alone && moved != 0 {
            for visibilities in &self.visibilities {
                visibilities.change(|known| known.forget(moved));
            }
            0
        } else {
            moved
        };
        self.moved.store(rest, Ordering::Relaxed);
    }

    /// Tells what is known of samples that are evaluated next.
    pub fn tell(&self, of: &BatchPlaces, samples: &mut Known) {
        let is_edited = self.is_edited.load(Ordering::Relaxed);
        samples.know_camera_hits(|hits| {
            let mut all = is_edited;
            if is_edited {
                self.hits.read(of, |hit| {
                    all &= hit.is_some();
                    hits.push(hit.flatten());
                });
            }
            all
        });
        tell(&self.second_hits, of, is_edited, samples.second_hits());
        if self.edits_materials.load(Ordering::Relaxed) {
            for (all, of_batch) in self.visibilities.iter().zip(samples.visibilities()) {
                tell(all, of, is_edited, of_batch);
            }
        }
    }

    /// Keeps what was found out about them.
    pub fn learn(&self, of: &BatchPlaces, rays: RayCounts, samples: &mut Known) {
        if rays.camera > 0 {
            let hits = samples.camera_hits().iter();
            self.hits.write(of, hits.map(|hit| Some(*hit)));
        }
        let second_hits = samples.second_hits();
        if !second_hits.is_empty() {
            self.second_hits.write(of, second_hits.drain(..));
        }
        for (all, of_batch) in self.visibilities.iter().zip(samples.visibilities()) {
            if !of_batch.is_empty() {
                all.write(of, of_batch.drain(..));
            }
        }
    }
}

/// What is known of each sample of a batch: nothing where nothing may be told.
fn tell<T: Copy + Default>(
    all: &PerSample<T>,
    of: &BatchPlaces,
    may_tell: bool,
    batch: &mut Vec<T>,
) {
    batch.clear();
    if may_tell {
        all.read(of, |known| batch.push(known));
    } else {
        batch.resize(of.count(), T::default());
    }
}
