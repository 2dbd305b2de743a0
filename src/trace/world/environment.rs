use crate::trace::Texture;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// What a ray carries that meets nothing: a colour, or an equirectangular map.
#[derive(Clone, Debug, Default)]
pub struct Environment {
    /// Used where there is no map.
    pub background: Vec3,
    /// Its middle column lies at -Z, its top row at +Y.
    pub map: Option<Arc<Texture>>,
    /// Turns the map about the y axis, in radians, counter-clockwise seen from above.
    pub rotation: f32,
    /// Multiplies the map.
    pub intensity: f32,
    /// Whether it is a light, too: a [`Dome`](crate::trace::Dome).
    pub lights: bool,
    /// Shadow rays at the first hit, where it lights.
    pub samples: u32,
    /// What is seen of it from the camera, also through what lets light pass, in its place; `None` of one that is seen
    /// itself. Mirrors show it all the same.
    pub backdrop: Option<Vec3>,
}

impl Environment {
    /// Radiance from `direction`, of any length.
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let Some(map) = &self.map else {
            return self.background;
        };
        self.intensity * map.sample_sphere(equirectangular(direction, self.rotation))
    }

    /// What every camera ray carries that meets nothing, where they all carry the same; with the map in use or not.
    pub fn even(&self, map_in_use: bool) -> Option<Vec3> {
        let is_even = self.map.is_none() || !map_in_use;
        self.backdrop.or(is_even.then_some(self.background))
    }

    /// Whether both are the same: of the same map, not of one that is alike.
    pub fn is_same(&self, other: &Self) -> bool {
        let maps = match (&self.map, &other.map) {
            (Some(map), Some(other)) => Arc::ptr_eq(map, other),
            (None, None) => true,
            _ => false,
        };
        let of = |environment: &Self| {
            let Self {
                background,
                rotation,
                intensity,
                lights,
                samples,
                backdrop,
                ..
            } = *environment;
            let light = (lights, samples);
            (background, rotation, intensity, light, backdrop)
        };
        maps && of(self) == of(other)
    }

    /// The largest radiance of any direction, channel by channel; of the background alone where the map
    /// is not in use.
    pub(in crate::trace) fn brightest(&self, map_in_use: bool) -> Vec3 {
        match &self.map {
            Some(map) if map_in_use => self.intensity * map.brightest(),
            _ => self.background,
        }
    }
}

/// Place of a direction in an equirectangular picture: u in [0, 1] around the y axis, v in [0, 1]
/// from +Y to -Y.
pub fn equirectangular(direction: Vec3, rotation: f32) -> Vec2 {
    let around = direction.x.atan2(-direction.z) + rotation;
    // The angle from +Y by atan2: acos loses half of its digits near the poles.
    let across = direction.x.hypot(direction.z).atan2(direction.y);
    Vec2::new((around / TAU + 0.5).rem_euclid(1.0), across / PI)
}

/// The direction, a unit vector, of a place in an equirectangular picture.
pub fn direction_at(place: Vec2, rotation: f32) -> Vec3 {
    let (sin_around, cos_around) = ((place.x - 0.5) * TAU - rotation).sin_cos();
    let (sin_across, cos_across) = (place.y * PI).sin_cos();
    Vec3::new(
        sin_across * sin_around,
        cos_across,
        -sin_across * cos_around,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::Texels;

    #[test]
    fn the_middle_of_the_map_is_at_minus_z_and_the_top_at_plus_y() {
        assert!((equirectangular(Vec3::NEG_Z, 0.0) - Vec2::new(0.5, 0.5)).length() < 1e-6);
        assert!((equirectangular(Vec3::X, 0.0) - Vec2::new(0.75, 0.5)).length() < 1e-6);
        assert_eq!(equirectangular(Vec3::Y, 0.0).y, 0.0);
        assert_eq!(equirectangular(Vec3::NEG_Y, 0.0).y, 1.0);
    }

    #[test]
    fn a_direction_comes_back_from_its_place() {
        for rotation in [0.0, 0.7, -9.0] {
            for i in 1..1000 {
                let place = Vec2::new((i as f32 * 0.618).fract(), i as f32 / 1000.0);
                let direction = direction_at(place, rotation);
                assert!((direction.length() - 1.0).abs() < 1e-6);
                let back = direction_at(equirectangular(direction, rotation), rotation);
                // Angles of up to 9 + 2π radians in f32.
                assert!(
                    (back - direction).length() < 4e-6,
                    "{place}: {direction} {back}"
                );
            }
        }
    }

    /// A map without a jump of its own at the seam, and with one at every texel elsewhere.
    fn environment() -> Environment {
        let (width, height) = (16, 8);
        let texels = (0..width * height)
            .map(|i| {
                let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
                let around = (x / width as f32 * TAU).sin();
                [around + 2.0, y, around * y]
            })
            .collect();
        Environment {
            map: Some(Arc::new(
                Texture::new(width, height, Texels::Linear32(texels)).unwrap(),
            )),
            intensity: 1.0,
            ..Environment::default()
        }
    }

    #[test]
    fn nothing_jumps_across_the_seam_or_over_the_poles() {
        let environment = environment();
        let step = 1e-4_f32;
        let mut largest = 0.0_f32;
        // Across the seam at +Z, at every height; and over both poles, along every meridian.
        for i in 1..200 {
            let angle = i as f32 / 200.0 * PI;
            let (y, r) = (angle.cos(), angle.sin());
            let left = environment.radiance(Vec3::new(-step * r, y, r));
            let right = environment.radiance(Vec3::new(step * r, y, r));
            largest = largest.max((left - right).abs().max_element());
            let around = i as f32 / 200.0 * TAU;
            for pole in [1.0, -1.0] {
                let side = Vec3::new(around.cos(), 0.0, around.sin()) * step;
                let here = environment.radiance(side + pole * Vec3::Y);
                let there = environment.radiance(-side + pole * Vec3::Y);
                largest = largest.max((here - there).abs().max_element());
            }
        }
        // The map changes by at most 8 over a texel of π/8; bilinear slopes times 2e-4 radians.
        assert!(largest < 0.01, "largest jump {largest}");
    }

    #[test]
    fn turning_the_map_by_a_quarter_moves_what_was_ahead_to_the_left() {
        let still = environment();
        let turned = Environment {
            rotation: PI / 2.0,
            ..still.clone()
        };
        let ahead = still.radiance(Vec3::NEG_Z);
        let left = turned.radiance(Vec3::NEG_X);
        assert!((ahead - left).length() < 1e-4, "{ahead} and {left}");
    }
}
