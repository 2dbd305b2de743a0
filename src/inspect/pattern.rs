//! Where the samples of a pixel lie, as points of a square: the pixel itself, the lens, a light, or
//! any two of a sample's numbers.

use super::line_set::Thinned;
use super::settings::{Dimension, PatternSettings};
use crate::scene::{PixelSampling, RenderSettings};
use crate::trace::{Purpose, Sampler, World};
use glam::{UVec2, Vec2};
use serde::Serialize;

/// Points of the unit square, x to the right, y downwards, one for each sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pattern {
    /// What x is.
    pub x: Dimension,
    /// What y is.
    pub y: Dimension,
    /// The samples' points, sample 0 first.
    pub points: Vec<Vec2>,
    /// Of how many, where there are more than were wanted.
    pub thinned: Option<Thinned>,
}

/// The most points of a pattern that a file holds or a picture shows.
pub const MOST_POINTS: u64 = 1 << 16;

/// The numbers that `count` samples of a pixel use, two of each: those of the camera ray and of the
/// first hit.
///
/// At a first hit a sample may use several numbers of a kind, one for each ray to the light or each
/// ray of the blurred reflection. Where x and y are of one such kind there is a point for each of
/// them; else one for each sample, with the first of them. Of more than `most` there are the first.
pub fn pattern(
    world: &World,
    settings: &RenderSettings,
    choice: &PatternSettings,
    pixel: UVec2,
    count: u64,
    most: u64,
) -> Pattern {
    let sampler =
        Sampler::new(pixel.x, pixel.y, settings.seed, settings.sequence).on_grid(settings.jitter);
    let number = |dimension, index| number(settings, sampler, choice.light, dimension, index);
    let [x_rays, y_rays] =
        [choice.x, choice.y].map(|dimension| rays_of(world, settings, choice.light, dimension));
    let same = kind(choice.x) == kind(choice.y);
    let point = |index| {
        let [x, y] = if same {
            [index; 2]
        } else {
            [index * x_rays, index * y_rays]
        };
        Vec2::new(number(choice.x, x), number(choice.y, y))
    };
    let all = count.saturating_mul(if same { x_rays } else { 1 });
    let drawn = all.min(most);
    Pattern {
        x: choice.x,
        y: choice.y,
        points: (0..drawn).map(point).collect(),
        thinned: (drawn < all).then_some(Thinned {
            what: "points of samples",
            drawn: drawn as usize,
            of: all as usize,
            rule: "the first",
        }),
    }
}

/// Dimensions of one kind stand in the same block of random numbers.
fn kind(dimension: Dimension) -> u32 {
    use Dimension::*;
    match dimension {
        PixelX | PixelY | LensU | LensV => 0,
        Time => 1,
        LightU | LightV => 2,
        GlossU | GlossV => 3,
    }
}

/// How many numbers of a kind a sample uses at its first hit.
fn rays_of(world: &World, settings: &RenderSettings, light: u64, dimension: Dimension) -> u64 {
    match kind(dimension) {
        2 => {
            let lamp = world.lamps(settings).find(|lamp| lamp.id() == light);
            let samples = lamp.and_then(|lamp| lamp.samples(settings));
            u64::from(samples.unwrap_or(1))
        }
        3 if settings.features.glossy => u64::from(settings.gloss_samples.clamp(1, 1000)),
        _ => 1,
    }
}

fn number(
    settings: &RenderSettings,
    sampler: Sampler,
    light: u64,
    dimension: Dimension,
    index: u64,
) -> f32 {
    use Dimension::*;
    let (purpose, component) = match dimension {
        PixelX => (Purpose::Camera, 0),
        PixelY => (Purpose::Camera, 1),
        LensU => (Purpose::Camera, 2),
        LensV => (Purpose::Camera, 3),
        Time => (Purpose::Time, 0),
        LightU => (Purpose::Light(light), 0),
        LightV => (Purpose::Light(light), 1),
        GlossU => (Purpose::Gloss, 0),
        GlossV => (Purpose::Gloss, 1),
    };
    match (settings.pixel, dimension) {
        (PixelSampling::Center, PixelX | PixelY) => 0.5,
        (PixelSampling::Corner, PixelX) => 0.0,
        (PixelSampling::Corner, PixelY) => 1.0,
        _ => sampler.block(index, purpose, 0)[component],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Sequence;

    #[test]
    fn jittered_samples_have_a_cell_of_the_pixel_each() {
        let settings = RenderSettings {
            sequence: Sequence::Jittered,
            jitter: 4,
            ..RenderSettings::default()
        };
        let choice = PatternSettings::default();
        let found = pattern(
            &World::default(),
            &settings,
            &choice,
            UVec2::new(7, 9),
            16,
            MOST_POINTS,
        );
        assert_eq!(found.thinned, None);
        let cell = |point: &Vec2| (*point * 4.0).as_uvec2();
        let mut cells: Vec<_> = found.points.iter().map(cell).map(|c| (c.x, c.y)).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), 16, "{:?}", found.points);
    }

    #[test]
    fn more_points_than_are_wanted_are_not_made_and_that_is_said() {
        let mut settings = RenderSettings {
            gloss_samples: 1000,
            ..RenderSettings::default()
        };
        settings.features.glossy = true;
        let choice = PatternSettings {
            x: Dimension::GlossU,
            y: Dimension::GlossV,
            ..PatternSettings::default()
        };
        let pixel = UVec2::new(7, 9);
        let found = |count, most| {
            let world = World::default();
            pattern(&world, &settings, &choice, pixel, count, most)
        };
        let (few, many) = (found(1, 1000), found(u64::from(u32::MAX), 100));
        assert_eq!((few.points.len(), few.thinned), (1000, None));
        assert_eq!(many.points, few.points[..100]);
        let text = many.thinned.unwrap().to_string();
        assert_eq!(
            text,
            "100 of 4294967295000 points of samples are drawn: the first"
        );
    }
}
