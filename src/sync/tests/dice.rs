//! Random components.

use crate::scene::Phong;
use bevy::color::LinearRgba;
use bevy::math::{Quat, Vec3};
use bevy::transform::components::Transform;

/// SplitMix64 (Steele, Lea, Flood 2014).
pub struct Dice(pub u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// In [-1, 1).
    pub fn number(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    pub fn color(&mut self) -> LinearRgba {
        let v = self.vector().abs();
        LinearRgba::rgb(v.x, v.y, v.z)
    }

    pub fn transform(&mut self) -> Transform {
        let turn = Quat::from_scaled_axis(self.vector() * 3.0);
        // Now and then one that is mirrored, or flat.
        let scale = match self.below(8) {
            0 => Vec3::new(-1.0, 1.0, 0.5),
            1 => Vec3::new(1.0, 0.0, 1.0),
            _ => Vec3::splat(0.5 + self.number().abs()),
        };
        Transform {
            translation: self.vector() * 4.0,
            rotation: turn,
            scale,
        }
    }

    pub fn phong(&mut self) -> Phong {
        let (diffuse, specular) = (self.color(), self.color());
        Phong {
            diffuse,
            specular,
            mirror: specular,
            shininess: 2.0 + self.number(),
            ..Phong::default()
        }
    }
}
