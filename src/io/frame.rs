use super::error::Place;
use super::ids::assign_ids;
use super::notes::Notes;
use super::place::world_from;
use crate::scene::{
    DirectionalLamp, ParallelogramLamp, PointLamp, Projection, SceneCamera, SegmentLamp,
};
use bevy::asset::Assets;
use bevy::ecs::name::Name;
use bevy::math::{Vec3, bounding::Aabb3d};
use bevy::mesh::{Mesh, Mesh3d, VertexAttributeValues};
use bevy::prelude::{Entity, Or, With, World};
use bevy::transform::components::Transform;
use std::f32::consts::PI;
use std::path::Path;

/// From the middle of what is shown to the camera: from the front, a little from the right, above.
const VIEW_FROM: Vec3 = Vec3::new(0.55, 0.45, 1.0);

/// From what is shown to the light: over the camera's left shoulder.
const LIGHT_FROM: Vec3 = Vec3::new(-0.5, 1.0, 0.8);

/// Room around what is shown, as a factor of its distance.
const MARGIN: f32 = 1.05;

/// Gives a scene without a camera one that shows all of it, and a scene without a light a
/// directional one. A note says so; `file` is where it came from.
pub(crate) fn frame(world: &mut World, file: &Path, notes: &mut Notes) {
    type Lamp = Or<(
        With<PointLamp>,
        With<DirectionalLamp>,
        With<SegmentLamp>,
        With<ParallelogramLamp>,
    )>;
    let no_camera = count::<With<SceneCamera>>(world) == 0;
    let no_lamp = count::<Lamp>(world) == 0;
    let mut added = Vec::new();
    if no_camera {
        let transform = framing(bounds(world));
        added.push(spawn(world, "Camera", transform, SceneCamera::default()));
        let instead = "one that shows everything was added";
        notes.add(file, Place::Whole, "has no camera", instead);
    }
    if no_lamp {
        let transform = Transform::from_translation(LIGHT_FROM).looking_at(Vec3::ZERO, Vec3::Y);
        // A white surface that faces it then has a radiance of 1.
        let lamp = DirectionalLamp {
            intensity: PI,
            ..DirectionalLamp::default()
        };
        added.push(spawn(world, "Light", transform, lamp));
        notes.add(
            file,
            Place::Whole,
            "has no light",
            "a directional one was added",
        );
    }
    assign_ids(world, &added);
}

fn spawn(
    world: &mut World,
    name: &'static str,
    transform: Transform,
    what: impl bevy::prelude::Bundle,
) -> Entity {
    world.spawn((Name::new(name), transform, what)).id()
}

fn count<F: bevy::ecs::query::QueryFilter>(world: &mut World) -> usize {
    world.query_filtered::<Entity, F>().iter(world).count()
}

/// A camera with the default field of view whose picture holds the whole bounding sphere.
fn framing(bounds: Option<Aabb3d>) -> Transform {
    let (centre, radius) = bounds.map_or((Vec3::ZERO, 1.0), |bounds| {
        let (least, most) = (Vec3::from(bounds.min), Vec3::from(bounds.max));
        let radius = 0.5 * (most - least).length();
        (0.5 * (least + most), radius)
    });
    let radius = if radius > 0.0 && radius.is_finite() {
        radius
    } else {
        1.0
    };
    let fov_y = match Projection::default() {
        Projection::Perspective { fov_y } => fov_y,
        Projection::Orthographic { .. } => PI / 3.0,
    };
    let distance = MARGIN * radius / (0.5 * fov_y).sin();
    let position = centre + VIEW_FROM.normalize() * distance;
    Transform::from_translation(position).looking_at(centre, Vec3::Y)
}

/// The box around all meshes, in the world's space.
fn bounds(world: &mut World) -> Option<Aabb3d> {
    let mut query = world.query::<(Entity, &Mesh3d)>();
    let objects: Vec<(Entity, Mesh3d)> = query.iter(world).map(|(e, m)| (e, m.clone())).collect();
    let meshes = world.get_resource::<Assets<Mesh>>()?;
    let (mut least, mut most) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for (entity, mesh) in objects {
        let positions = meshes
            .get(&mesh.0)
            .and_then(|mesh| mesh.try_attribute(Mesh::ATTRIBUTE_POSITION).ok());
        let Some(VertexAttributeValues::Float32x3(positions)) = positions else {
            continue;
        };
        let world_from_object = world_from(world, entity);
        for &position in positions {
            let position = world_from_object.transform_point3(position.into());
            least = least.min(position);
            most = most.max(position);
        }
    }
    (least.cmple(most).all()).then(|| Aabb3d::from_min_max(least, most))
}
