//! What multiplies the light of single lights besides their own colours: a mix, which changes no light.

use super::faint::faint;
use crate::trace::World;
use glam::Vec3;
use std::sync::Arc;

/// What multiplies what lights add, by the lights' `SceneId`s; 1 for those that are not named.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gains(Arc<[(u64, Vec3)]>);

impl Gains {
    /// The most that a light is multiplied by, so that what it adds stays a number.
    pub const MOST: f32 = 1e12;

    /// Of a light.
    pub fn of(&self, id: u64) -> Vec3 {
        let found = self.0.binary_search_by_key(&id, |(id, _)| *id);
        found.map_or(Vec3::ONE, |at| self.0[at].1)
    }

    /// Whether no light is multiplied.
    pub fn is_neutral(&self) -> bool {
        self.0.is_empty()
    }

    /// The world whose lights shine so by themselves, and of which as many are asked for by chance as of lights so bright.
    pub fn applied(&self, world: &World) -> World {
        if self.is_neutral() {
            return world.clone();
        }
        let mut lights = (*world.lights).clone();
        let gains: Vec<Vec3> = lights.all().map(|light| self.of(light.id())).collect();
        for (colors, gain) in lights.colors_mut().zip(gains) {
            for color in colors {
                *color = times(*color, gain);
            }
        }
        let mut world = World {
            lights: Arc::new(lights),
            ..world.clone()
        };
        world.needs.faint = faint(&world);
        world
    }
}

/// The product, as far as f32 goes.
pub(in crate::trace) fn times(color: Vec3, gain: Vec3) -> Vec3 {
    (color * gain).min(Vec3::MAX)
}

/// Linear RGB by `SceneId`, each brought into 0 to [`Gains::MOST`]; what is not a number counts as 1. Of those with the
/// same number the first counts.
impl FromIterator<(u64, Vec3)> for Gains {
    fn from_iter<I: IntoIterator<Item = (u64, Vec3)>>(gains: I) -> Self {
        let sane = |gain: f32| match gain.is_nan() {
            true => 1.0,
            false => gain.clamp(0.0, Self::MOST),
        };
        let gains = gains.into_iter().map(|(id, gain)| (id, gain.map(sane)));
        let mut gains: Vec<_> = gains.filter(|(_, gain)| *gain != Vec3::ONE).collect();
        gains.sort_by_key(|(id, _)| *id);
        gains.dedup_by_key(|(id, _)| *id);
        Self(gains.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::{Lights, PointLight};

    #[test]
    fn what_is_no_factor_is_brought_to_one_and_a_world_s_lights_shine_by_it() {
        let gains: Gains = [
            (3, Vec3::new(f32::NAN, -1.0, 0.5)),
            (1, Vec3::splat(f32::INFINITY)),
            (2, Vec3::ONE),
        ]
        .into_iter()
        .collect();
        assert_eq!(gains.of(3), Vec3::new(1.0, 0.0, 0.5));
        assert_eq!(gains.of(1), Vec3::splat(Gains::MOST));
        assert_eq!([gains.of(2), gains.of(9)], [Vec3::ONE; 2]);
        let light = |id, color| PointLight {
            id,
            position: Vec3::ZERO,
            color,
            cone: None,
        };
        let lights = Lights {
            points: vec![light(1, Vec3::MAX), light(3, Vec3::splat(4.0))],
            ..Lights::default()
        };
        let world = World {
            lights: Arc::new(lights),
            ..World::default()
        };
        let colors = gains.applied(&world).lights.points.clone();
        assert_eq!(colors[0].color, Vec3::MAX);
        assert_eq!(colors[1].color, Vec3::new(4.0, 0.0, 2.0));
        assert!(Arc::ptr_eq(
            &Gains::default().applied(&world).lights,
            &world.lights
        ));
    }
}
