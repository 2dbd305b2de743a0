//! What stands at a place of the picture: asked of the tracer itself, so it is what is seen there,
//! to the pixel.
//!
//! As a backend of `bevy_picking` it sends what is under the pointer, so that an app can observe
//! `Pointer<Click>` on traced entities.

use super::{TracedRender, TracedView};
use crate::bvh::{Hit, Ray};
use crate::scene::{RenderSettings, SceneId};
use crate::sync::Traced;
use crate::trace;
use bevy::camera::Camera;
use bevy::ecs::entity::Entity;
use bevy::math::Vec3;
use bevy::picking::PickingSystems;
use bevy::picking::backend::{HitData, PointerHits, ray::RayMap};
use bevy::prelude::{App, IntoScheduleConfigs, MessageWriter, Plugin, PreUpdate, Query, Res, With};
use bevy::transform::components::GlobalTransform;

/// Sends what the tracer finds under each pointer. Needs Bevy's `PickingPlugin`.
pub struct TracedPickingPlugin;

impl Plugin for TracedPickingPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreUpdate, send_hits.in_set(PickingSystems::Backend));
    }
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// The object.
    pub id: SceneId,
    /// Where on it, in world space.
    pub point: Vec3,
    /// The triangle's own unit normal, on the side that the ray came from.
    pub normal: Vec3,
    /// Which triangle, how far in lengths of the ray's direction, and where in it.
    pub hit: Hit,
}

/// What is seen along this ray, at shutter time 0: not what is cut out there.
pub fn pick(world: &trace::World, settings: &RenderSettings, ray: &Ray) -> Option<Picked> {
    let hit = world.aggregate.closest_hit(ray)?;
    let hit = trace::first_surface(world, settings, ray, hit)?;
    let (id, normal) = side_of(world, &hit)?;
    let normal = if normal.dot(ray.direction) > 0.0 {
        -normal
    } else {
        normal
    };
    Some(Picked {
        id,
        point: ray.at(hit.t),
        normal,
        hit,
    })
}

/// Whose triangle was met, and its unit normal on the side where its corners go round counter-clockwise.
pub(super) fn side_of(world: &trace::World, hit: &Hit) -> Option<(SceneId, Vec3)> {
    let object = world.objects.get(hit.instance as usize)?;
    let instance = world.aggregate.instances().get(hit.instance as usize)?;
    let corners = instance.mesh.triangles().corners(hit.triangle);
    let [a, b, c] = corners.map(|corner| instance.to_world_point(corner));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    Some((SceneId(object.id), normal))
}

fn send_hits(
    rays: Res<RayMap>,
    (traced, settings): (Res<Traced>, Res<RenderSettings>),
    views: Query<(&Camera, &GlobalTransform), (With<TracedView>, With<TracedRender>)>,
    entities: Query<(Entity, &SceneId)>,
    mut hits: MessageWriter<PointerHits>,
) {
    for (&ray_id, &ray) in rays.iter() {
        let Ok((camera, _)) = views.get(ray_id.camera) else {
            continue;
        };
        let ray = Ray::new(ray.origin, *ray.direction);
        let Some(picked) = pick(&traced.world, &settings, &ray) else {
            continue;
        };
        let Some((entity, _)) = entities.iter().find(|(_, id)| **id == picked.id) else {
            continue;
        };
        let data = HitData::new(
            ray_id.camera,
            picked.hit.t,
            Some(picked.point),
            Some(picked.normal),
        );
        hits.write(PointerHits::new(
            ray_id.pointer,
            vec![(entity, data)],
            camera.order as f32,
        ));
    }
}
