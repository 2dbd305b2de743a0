//! Cases of what surrounds a scene: its map's seam and poles, and its background.

use super::{Effort, Outcome};
use crate::film::render;
use crate::report::table::digits;
use crate::scene::RenderSettings;
use crate::trace::{Camera, Environment, Texels, Texture, World};
use glam::{UVec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// A map without a jump of its own at the seam, and with one at every texel elsewhere.
pub(super) fn map() -> Environment {
    let (width, height) = (16, 8);
    let texels = (0..width * height).map(|i| {
        let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        let around = (x / width as f32 * TAU).sin();
        [around + 2.0, y, around * y]
    });
    let texture = Texture::new(width, height, Texels::Linear32(texels.collect()));
    Environment {
        map: texture.ok().map(Arc::new),
        intensity: 1.0,
        ..Environment::default()
    }
}

pub(super) fn environment(effort: &Effort) -> Outcome {
    let environment = map();
    let count = (effort.rays / 100).clamp(200, 50_000);
    // The largest change over a step across the seam, and over the poles.
    let changes = |step: f32| {
        let (mut seam, mut poles) = (0.0_f32, 0.0_f32);
        for i in 1..count {
            let part = i as f32 / count as f32;
            let (r, y) = (part * PI).sin_cos();
            let left = environment.radiance(Vec3::new(-step * r, y, r));
            let right = environment.radiance(Vec3::new(step * r, y, r));
            seam = seam.max((left - right).abs().max_element());
            let (sin, cos) = (part * TAU).sin_cos();
            let side = Vec3::new(cos, 0.0, sin) * step;
            for pole in [Vec3::Y, -Vec3::Y] {
                let (here, there) = (
                    environment.radiance(side + pole),
                    environment.radiance(pole - side),
                );
                poles = poles.max((here - there).abs().max_element());
            }
        }
        [seam, poles]
    };
    // Where there is no jump a tenth of the step makes a tenth of the change, and rounding.
    let (steps, tenths) = (changes(1e-2), changes(1e-3));
    let [seam, poles] = [0, 1].map(|i| tenths[i] / steps[i].max(1e-3));
    let figures = format!(
        "a tenth of the step: {} of the change across the seam, {} over the poles",
        digits(f64::from(seam), 2),
        digits(f64::from(poles), 2)
    );
    Outcome::new(6 * count, figures)
        .require(
            seam < 0.2,
            format!("{seam} of the change is left at the seam"),
        )
        .require(
            poles < 0.2,
            format!("{poles} of the change is left at the poles"),
        )
}

/// Whether the picture of nothing is its background.
pub(super) fn empty_world_is_clean() -> bool {
    let background = Vec3::new(0.25, 0.5, 1.0);
    let scene = World {
        environment: Environment {
            background,
            ..Environment::default()
        },
        ..World::default()
    };
    let settings = RenderSettings {
        size: UVec2::new(5, 3),
        spp: 2,
        ..RenderSettings::default()
    };
    let camera = Camera::looking_at(Vec3::ZERO, Vec3::X, Vec3::Y, 1.0);
    let picture = render(&scene, &camera, &settings, &|_, _| {}).picture;
    picture.pixels.iter().all(|pixel| *pixel == background)
}
