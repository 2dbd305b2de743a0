//! What a render is of, and how its light is kept.

use super::LightMix;
use super::sums::sum_columns::PLANE_BYTES;
use super::sums::tiles::TileGrid;
use crate::scene::RenderSettings;
use crate::trace::planes::Planes;
use crate::trace::{Camera, Gains, Untinted, World};
use glam::UVec2;
use std::time::Duration;

/// What samples depend on.
#[derive(Clone)]
pub(super) struct Subject {
    /// With the gains of the mix.
    pub world: World,
    pub camera: Camera,
    pub settings: RenderSettings,
    /// The same world as it is traced: its lights without the tints that can be changed afterwards.
    pub light: Untinted,
    /// Whether its lights have planes of their own.
    pub stays_apart: bool,
    /// Lights that have a plane of their own before others: those that were edited last, by their `SceneId`s.
    pub first: Vec<u64>,
    /// Counts its edits.
    pub edit: u32,
    /// Counts those that gave planes other lights.
    pub arrangement: u32,
}

/// Lights of a picture that have a plane each, at the most; the others share one.
pub(super) const MOST_APART: usize = 8;
// They, that of the others, and that of what shines by itself.
const _: () = assert!(MOST_APART + 2 <= Planes::MOST_OF_PICTURE);
/// What all planes of a picture may take together, in bytes.
const MOST_BYTES: f64 = 1e9;

/// How many lights of a picture of this size have a plane each, so that all planes, that of the others and that of what
/// shines by itself among them, take no more than [`MOST_BYTES`]. `None` where there is no room for any.
fn lights_apart(size: UVec2) -> Option<usize> {
    let plane = PLANE_BYTES as f64 * TileGrid::new(size).pixels() as f64;
    let planes = (MOST_BYTES / plane.max(1.0)) as usize;
    Some(planes.checked_sub(2)?.min(MOST_APART))
}

impl Subject {
    /// Of a world, seen in some way.
    pub fn new(world: World, camera: Camera, settings: RenderSettings, stays_apart: bool) -> Self {
        let mix = LightMix {
            apart: stays_apart,
            ..LightMix::default()
        };
        Self::mixed(world, camera, settings, Vec::new(), &mix)
    }

    /// The same with a mix. Where its lights are kept apart they have planes of their own, and those in `first` before
    /// others.
    pub fn mixed(
        world: World,
        camera: Camera,
        settings: RenderSettings,
        first: Vec<u64>,
        mix: &LightMix,
    ) -> Self {
        let apart = lights_apart(settings.size).filter(|_| mix.apart);
        Self {
            stays_apart: apart.is_some(),
            light: match apart {
                Some(own) => Untinted::of(&world, own, &first, &mix.gains),
                None => Untinted::together(&world, &mix.gains),
            },
            world: mix.gains.applied(&world),
            first,
            edit: 0,
            arrangement: 0,
            camera,
            settings,
        }
    }

    /// The same of another world, seen in the same way.
    pub fn edited(&self, world: World, first: Vec<u64>, gains: Gains) -> Self {
        let mix = LightMix {
            apart: self.stays_apart,
            gains,
        };
        let (camera, settings) = (self.camera.clone(), self.settings.clone());
        Self {
            edit: self.edit + 1,
            arrangement: self.arrangement,
            ..Self::mixed(world, camera, settings, first, &mix)
        }
    }

    /// How many planes the light has.
    pub fn planes(&self) -> usize {
        self.light.planes.count()
    }

    /// How long its render may take; `None` is for ever.
    pub fn time_limit(&self) -> Option<Duration> {
        let seconds = self.settings.sampling.time;
        (seconds > 0.0).then(|| Duration::try_from_secs_f32(seconds).unwrap_or(Duration::MAX))
    }
}
