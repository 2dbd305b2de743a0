//! Whether a file's own lights are enough to see anything by, and what is done where they are not.

use super::super::place::world_from;
use super::surface::Surface;
use crate::scene::{
    DirectionalLamp, ParallelogramLamp, Phong, PointLamp, RenderSettings, SegmentLamp,
};
use bevy::color::LinearRgba;
use bevy::math::{Affine3A, Vec3};
use bevy::prelude::{Entity, World};
use std::f32::consts::PI;

/// Radiance of what is brightest below which a picture is nearly black: most of it faces its lights less, or not at
/// all.
const NEARLY_BLACK: f32 = 0.05;
/// What it is exposed to.
const WANTED: f32 = 0.5;
/// A surface of middle grey, of which nothing is known.
const ALBEDO: f32 = 0.5;
/// Places that are looked at.
const PLACES: usize = 1000;
/// Lamps that are looked at: there may be thousands, and then it is not dark.
const LAMPS: usize = 1000;

/// Stops that are missing where all lamps together leave what is shown nearly black; `None` where they do not, or
/// where there is no light at all.
///
/// Shadows and materials are not looked into: in truth there is less light still.
pub(super) fn missing(world: &mut World, surface: &Surface) -> Option<f32> {
    let settings = world.get_resource::<RenderSettings>()?;
    if settings.output.exposure != 0.0 {
        return None;
    }
    // Of areas and lines nothing needs to be known: no model file has any.
    let mut others = world.query::<(Option<&SegmentLamp>, Option<&ParallelogramLamp>)>();
    if others.iter(world).any(|(a, b)| a.is_some() || b.is_some()) {
        return None;
    }
    let mut even = 0.0;
    let mut suns = world.query::<&DirectionalLamp>();
    for sun in suns.iter(world) {
        even += sun.intensity * brightest(sun.color);
    }
    let mut query = world.query::<(Entity, &PointLamp)>();
    let points: Vec<(Entity, PointLamp)> = query
        .iter(world)
        .take(LAMPS)
        .map(|(entity, lamp)| (entity, lamp.clone()))
        .collect();
    let points = points
        .into_iter()
        .map(|(e, lamp)| (world_from(world, e), lamp));
    let points: Vec<(Affine3A, PointLamp)> = points.collect();
    let every = surface.triangles.len().div_ceil(PLACES).max(1);
    let at = surface.triangles.iter().step_by(every);
    let irradiance = at.map(|&[a, b, c]| {
        let place = (a + b + c) / 3.0;
        even + points
            .iter()
            .map(|(lamp_place, lamp)| from_point(place, lamp_place, lamp))
            .sum::<f32>()
    });
    let radiance = ALBEDO / PI * irradiance.fold(0.0, f32::max);
    if !(radiance > 0.0 && radiance < NEARLY_BLACK) {
        return None;
    }
    Some((WANTED / radiance).log2().clamp(0.0, 64.0).round())
}

/// Whether something can be seen without light: exposure would wash it out.
pub(super) fn glows(world: &mut World) -> bool {
    let mut materials = world.query::<&Phong>();
    let mut glow = materials.iter(world).map(|phong| brightest(phong.emission));
    glow.any(|glow| glow > NEARLY_BLACK)
}

/// Has all lamps of a model shine by so many stops more.
pub(super) fn brighten(world: &mut World, stops: f32) {
    let more = |intensity: &mut f32| *intensity = (*intensity * stops.exp2()).min(f32::MAX);
    let mut suns = world.query::<&mut DirectionalLamp>();
    for mut sun in suns.iter_mut(world) {
        more(&mut sun.intensity);
    }
    let mut points = world.query::<&mut PointLamp>();
    for mut point in points.iter_mut(world) {
        more(&mut point.intensity);
    }
}

/// What a surface gets that faces a lamp.
fn from_point(place: Vec3, world_from_lamp: &Affine3A, lamp: &PointLamp) -> f32 {
    let way = place - Vec3::from(world_from_lamp.translation);
    let axis = world_from_lamp.transform_vector3(-Vec3::Z);
    let is_outside = lamp
        .cone
        .is_some_and(|cone| axis.angle_between(way) > cone.outer);
    match is_outside {
        true => 0.0,
        false => lamp.intensity * brightest(lamp.color) / way.length_squared(),
    }
}

fn brightest(color: LinearRgba) -> f32 {
    color.red.max(color.green).max(color.blue)
}
