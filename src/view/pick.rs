//! What stands at a place of the picture: asked of the tracer itself, so it is what is seen there,
//! to the pixel.
//!
//! As a backend of `bevy_picking` it sends what is under the pointer, so that an app can observe
//! `Pointer<Click>` on traced entities.

use super::{TracedRender, TracedView};
use crate::bvh::{Hit, Ray};
use crate::scene::{RenderSettings, SceneId};
use crate::sync::{IdOwners, Traced};
use crate::trace;
use bevy::camera::Camera;
use bevy::math::Vec3;
use bevy::picking::backend::{HitData, PointerHits, ray::RayMap};
use bevy::picking::{PickingSettings, PickingSystems};
use bevy::prelude::{App, IntoScheduleConfigs, MessageWriter, Plugin, PreUpdate, Query, Res, With};
use bevy::transform::components::GlobalTransform;

/// Sends what the tracer finds under each pointer. Needs Bevy's `PickingPlugin` and
/// [`SyncPlugin`](crate::sync::SyncPlugin).
pub struct TracedPickingPlugin;

impl Plugin for TracedPickingPlugin {
    fn build(&self, app: &mut App) {
        // Where nobody hears of what is hovered, no ray is traced for it.
        app.add_systems(
            PreUpdate,
            send_hits
                .in_set(PickingSystems::Backend)
                .run_if(PickingSettings::hover_should_run),
        );
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
    owners: Res<IdOwners>,
    entities: Query<&SceneId>,
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
        // It may be gone since the scene was taken over.
        let owner = owners.owner(picked.id);
        let Some(entity) = owner.filter(|&owner| entities.get(owner) == Ok(&picked.id)) else {
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

#[cfg(test)]
mod tests {
    use super::super::{StandardMappingPlugin, TracedViewPlugin};
    use super::*;
    use crate::app::headless_app_with;
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use bevy::ecs::message::Messages;
    use bevy::math::Ray3d;
    use bevy::picking::backend::ray::RayId;
    use bevy::picking::pointer::PointerId;

    #[test]
    fn what_the_tracer_meets_under_a_pointer_is_sent_while_somebody_hears_of_it() {
        let mut app =
            headless_app_with((StandardMappingPlugin, TracedViewPlugin, TracedPickingPlugin));
        app.add_message::<PointerHits>()
            .init_resource::<RayMap>()
            .init_resource::<PickingSettings>();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        let view = app.world_mut().spawn(TracedView::default()).id();
        app.update();
        let down = Ray3d::new(Vec3::new(0.0, 0.3, 0.2), bevy::math::Dir3::NEG_Y);
        let ray = RayId::new(view, PointerId::Mouse);
        app.world_mut()
            .resource_mut::<RayMap>()
            .map
            .insert(ray, down);
        let world = app.world();
        let (traced, settings) = (&world.resource::<Traced>().world, world.resource());
        let met = pick(traced, settings, &Ray::new(down.origin, *down.direction)).unwrap();
        let sent = |app: &mut App, heard: bool| {
            let mut settings = app.world_mut().resource_mut::<PickingSettings>();
            settings.is_hover_enabled = heard;
            app.world_mut()
                .resource_mut::<Messages<PointerHits>>()
                .clear();
            app.update();
            let mut sent = app.world_mut().resource_mut::<Messages<PointerHits>>();
            let sent: Vec<PointerHits> = sent.drain().collect();
            sent
        };
        let hits = sent(&mut app, true);
        let [PointerHits { picks, .. }] = &hits[..] else {
            panic!("one pointer: {hits:?}");
        };
        let [(entity, data)] = &picks[..] else {
            panic!("one thing is met: {picks:?}");
        };
        assert_eq!(app.world().get::<SceneId>(*entity), Some(&met.id));
        assert_eq!(data.position, Some(met.point));
        let entity = *entity;
        assert_eq!(sent(&mut app, false).len(), 0);
        // Gone since the scene was taken over.
        app.world_mut().despawn(entity);
        assert_eq!(sent(&mut app, true).len(), 0);
    }
}
