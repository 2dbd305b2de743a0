//! Lights as photographers set them up for a thing that has none.

use crate::scene::{DirectionalLamp, Environment, Phong, UsesMaterial};
use bevy::color::LinearRgba;
use bevy::math::{Quat, Vec3};
use bevy::mesh::Mesh3d;
use bevy::prelude::{With, World};
use bevy::transform::components::Transform;
use std::f32::consts::PI;

/// From what is shown to the key light, seen by a level camera in front of it: over its left shoulder.
const KEY_FROM: Vec3 = Vec3::new(-0.5, 1.0, 0.8);
/// To the light that parts what is shown from what is behind it.
const BACK_FROM: Vec3 = Vec3::new(0.3, 0.6, -1.0);
/// Together they leave a white surface that faces the key light a radiance below 1.
const KEY: f32 = 0.6 * PI;
const BACK: f32 = 0.2 * PI;
/// Of the dome, and of a white surface in the open that nothing else reaches. Less than half of the key, so that shapes are
/// told by both, and what the key does not reach can be seen.
const DOME: f32 = 0.25;
/// Shadow rays to the dome at a first hit. Of one, what is half in the open has black speckles in the first picture. (A head at
/// 400 × 300: an RMS of 7.5, 3.6 and 2.3 levels with one, two and four, which take 1, 1.4 and 2.2 times as long.)
const DOME_SAMPLES: u32 = 2;

/// The lamps for what a camera looks at: names, places, lamps.
pub(super) fn studio(eye: Transform) -> [(&'static str, Transform, DirectionalLamp); 2] {
    let turn = heading(eye);
    let lamp = |intensity| DirectionalLamp {
        intensity,
        ..DirectionalLamp::default()
    };
    [
        ("Key light", from(turn * KEY_FROM), lamp(KEY)),
        ("Back light", from(turn * BACK_FROM), lamp(BACK)),
    ]
}

/// The light from all around that fills what the lamps leave dark: neutral as they are, and less in creases. It is itself
/// seen, behind what is shown, where that `is_dark` and would not stand out from black.
pub(super) fn dome(is_dark: bool) -> Environment {
    Environment {
        background: LinearRgba::rgb(DOME, DOME, DOME),
        lights: true,
        samples: DOME_SAMPLES,
        hidden: !is_dark,
        ..Environment::default()
    }
}

/// How a level camera that looks along -Z turns to look where this one does.
fn heading(eye: Transform) -> Quat {
    let back = eye.back();
    match (back.x, back.z) {
        // Straight up or down: its own up says where the front is.
        (x, z) if x.hypot(z) < 1e-3 => Quat::from_rotation_y(-eye.up().x.atan2(-eye.up().z)),
        (x, z) => Quat::from_rotation_y(x.atan2(z)),
    }
}

fn from(direction: Vec3) -> Transform {
    Transform::from_translation(direction).looking_at(Vec3::ZERO, Vec3::Y)
}

/// Whether nothing of what is shown would stand out from black.
pub(super) fn is_dark(world: &mut World) -> bool {
    /// Of the light that falls on it. Charcoal has 0.04.
    const DARK: f32 = 0.05;
    let mut query = world.query_filtered::<(Option<&UsesMaterial>, &Phong), With<Mesh3d>>();
    let mut is_dark = query.iter(world).map(|(shared, own)| {
        let shared = shared.and_then(|UsesMaterial(material)| world.get::<Phong>(*material));
        let phong = shared.unwrap_or(own);
        // Highlights are spots, and a mirror shows what is around it, which is as black.
        let colors = [phong.diffuse, phong.emission];
        let most = colors.map(|color| color.red.max(color.green).max(color.blue));
        most.iter().all(|&most| most < DARK)
    });
    let any = is_dark.next();
    any == Some(true) && is_dark.all(|is_dark| is_dark)
}
