//! What camera rays hit and what hides lights from there, kept while lights and materials are edited: those are in no ray's
//! way.
//!
//! Kept from the first edit on, since a render that nobody edits has no use for it.

use super::per_sample::{BatchPlaces, PerSample};
use super::tiles::TileGrid;
use crate::bvh::Hit;
use crate::trace::{RayCounts, Visibility, Workspace};
use std::sync::atomic::{AtomicBool, Ordering};

/// What edits leave true of a picture's samples.
pub(super) struct Kept {
    /// None where a camera ray has not been traced yet.
    hits: PerSample<Option<Option<Hit>>>,
    visibilities: PerSample<Visibility>,
    /// The last edit was of materials alone, so that the next one may be: else nobody needs to know what hid the lights.
    edits_materials: AtomicBool,
}

impl Kept {
    pub fn new(grid: &TileGrid) -> Self {
        Self {
            hits: PerSample::new(grid),
            visibilities: PerSample::new(grid),
            edits_materials: AtomicBool::new(false),
        }
    }

    /// What it takes now, in bytes.
    pub fn bytes(&self) -> u64 {
        self.hits.bytes() + self.visibilities.bytes()
    }

    /// Something is edited: materials alone, or lights too.
    pub fn edit(&self, materials_alone: bool) {
        self.edits_materials
            .store(materials_alone, Ordering::Relaxed);
        if !materials_alone {
            self.visibilities.clear();
        }
    }

    /// Tells what is known of samples that are evaluated next.
    pub fn tell(&self, of: BatchPlaces, workspace: &mut Workspace) {
        workspace.know_camera_hits(|hits| {
            let mut all = true;
            self.hits.read(of, |hit| {
                all &= hit.is_some();
                hits.push(hit.flatten());
            });
            all
        });
        if self.edits_materials.load(Ordering::Relaxed) {
            let visibilities = workspace.visibilities();
            visibilities.clear();
            self.visibilities.read(of, |known| visibilities.push(known));
        }
    }

    /// Keeps what was found out about them.
    pub fn learn(&self, of: BatchPlaces, rays: RayCounts, workspace: &mut Workspace) {
        if rays.camera > 0 {
            let hits = workspace.camera_hits().iter();
            self.hits.write(of, hits.map(|hit| Some(*hit)));
        }
        let visibilities = workspace.visibilities();
        if !visibilities.is_empty() {
            self.visibilities.write(of, visibilities.drain(..));
        }
    }
}
