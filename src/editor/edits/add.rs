//! Adding to the scene.

use super::index::FreeIds;
use super::names::{Names, unique_name};
use crate::editor::action::{Addition, shapes};
use crate::io::{FileError, Imported, import};
use crate::scene::{
    DirectionalLamp, MeshSource, ParallelogramLamp, Phong, PointLamp, SceneCamera, SceneId,
    SegmentLamp,
};
use bevy::camera::visibility::Visibility;
use bevy::ecs::bundle::Bundle;
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::math::{Quat, Vec3};
use bevy::transform::components::Transform;
use std::f32::consts::{FRAC_PI_2, PI};
use std::path::Path;

/// Where the next thing is added, in the world's space, and how large a thing of one metre becomes.
/// Whoever moves the view keeps it where the view looks.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct AddAt {
    /// Its place.
    pub place: Vec3,
    /// Greater than 0.
    pub size: f32,
    /// How the view is turned: a camera looks the same way.
    pub view: Quat,
}

impl Default for AddAt {
    fn default() -> Self {
        Self {
            place: Vec3::ZERO,
            size: 1.0,
            view: Quat::IDENTITY,
        }
    }
}

/// How high above its place a lamp of a size of 1 is added: in the floor, where others stand, it would light nothing of it.
const LAMP_HEIGHT: f32 = 1.5;
/// How far before its place a camera of a size of 1 is added: it sees what stands there, and the view, farther back, sees it.
const CAMERA_DISTANCE: f32 = 2.5;

/// From where it is added to where it stands. `None` for what takes no room there.
pub(super) fn stands_from(what: &Addition, at: AddAt) -> Option<Vec3> {
    match what {
        Addition::Shape(_) | Addition::DirectionalLamp => Some(Vec3::ZERO),
        Addition::PointLamp | Addition::SegmentLamp | Addition::ParallelogramLamp => {
            Some(LAMP_HEIGHT * at.size * Vec3::Y)
        }
        Addition::Camera => Some(CAMERA_DISTANCE * at.size * (at.view * Vec3::Z)),
        Addition::Group | Addition::Material => None,
    }
}

/// Adds a thing at a place, a lamp above it, a camera before it. `None` where no shape is called so.
pub fn add(world: &mut World, what: &Addition, at: AddAt) -> Option<SceneId> {
    let id = FreeIds::new(world).next();
    let place = Transform::from_translation(at.place);
    let scaled = place.with_scale(Vec3::splat(at.size));
    // Lamps shine along their local -Z.
    let downwards = place.with_rotation(Quat::from_rotation_x(-FRAC_PI_2));
    let from = stands_from(what, at).unwrap_or_default();
    let stands = place.with_translation(at.place + from);
    let stands_scaled = stands.with_scale(scaled.scale);
    // As bright on a surface `size` away as one W/sr is at a metre.
    let intensity = at.size * at.size;
    match what {
        Addition::Shape(name) => {
            let shapes = shapes();
            let (name, shape) = shapes.into_iter().find(|(known, _)| known == name)?;
            spawn(world, id, name, (MeshSource::Shape(shape), scaled));
        }
        Addition::Group => spawn(world, id, "Group", (place, Visibility::default())),
        Addition::PointLamp => {
            let lamp = PointLamp {
                intensity: 5.0 * intensity,
                ..PointLamp::default()
            };
            spawn(world, id, "Point light", (lamp, stands));
        }
        Addition::DirectionalLamp => {
            let lamp = DirectionalLamp {
                // A white surface that faces it then has a radiance of 1.
                intensity: PI,
                ..DirectionalLamp::default()
            };
            spawn(world, id, "Directional light", (lamp, downwards));
        }
        Addition::SegmentLamp => {
            let lamp = SegmentLamp {
                intensity: 5.0 * at.size,
                ..SegmentLamp::default()
            };
            spawn(world, id, "Segment light", (lamp, stands_scaled));
        }
        Addition::ParallelogramLamp => {
            let lamp = ParallelogramLamp {
                // Its front, where x × z points, looks down.
                intensity: 5.0,
                ..ParallelogramLamp::default()
            };
            spawn(world, id, "Parallelogram light", (lamp, stands_scaled));
        }
        Addition::Camera => {
            let before = stands.with_rotation(at.view);
            spawn(world, id, "Camera", (SceneCamera::default(), before));
        }
        Addition::Material => spawn(world, id, "Material", Phong::default()),
    }
    Some(id)
}

fn spawn(world: &mut World, id: SceneId, name: &str, bundle: impl Bundle) {
    let name = Name::new(unique_name(world, name));
    world.spawn((id, name)).insert(bundle);
}

/// Adds what a model file holds, where it stands in the file. On an error the scene is as it was.
/// The number is that of the entity that places all of it; none where the file holds materials alone.
pub fn add_model(world: &mut World, file: &Path) -> Result<(Option<SceneId>, Imported), FileError> {
    let mut ids = FreeIds::new(world);
    let mut names = Names::new(world);
    let imported = import(world, file, || ids.next())?;
    let new: Vec<Entity> = imported
        .root
        .into_iter()
        .chain(imported.materials.iter().copied())
        .collect();
    for entity in new {
        if let Some(name) = world.get::<Name>(entity).map(ToString::to_string) {
            let unique = names.unique(&name);
            if unique != name {
                world.entity_mut(entity).insert(Name::new(unique));
            }
        }
    }
    let id = imported
        .root
        .and_then(|root| world.get::<SceneId>(root).copied());
    Ok((id, imported))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;
    use bevy::math::Vec3Swizzles;

    #[test]
    fn a_lamp_hangs_above_where_it_is_added_and_does_not_wash_out_what_is_white_there() {
        for size in [0.2, 1.0, 50.0] {
            let place = Vec3::new(3.0, 0.7, -2.0);
            let mut app = headless_editor();
            let world = app.world_mut();
            let at = AddAt {
                place,
                size,
                ..AddAt::default()
            };
            let mut added = |what: Addition| {
                let id = add(world, &what, at).unwrap();
                let entity = crate::editor::edits::scene_entity(world, id).unwrap();
                let own = *world.get::<Transform>(entity).unwrap();
                assert!(own.translation.y > place.y, "{what:?}");
                assert_eq!(own.translation.xz(), place.xz());
                let height = own.translation.y - place.y;
                // As if all of it came from the lamp's middle.
                let lamp = world.entity(entity);
                let intensity = lamp.get::<PointLamp>().map(|lamp| lamp.intensity);
                let line = lamp.get::<SegmentLamp>().map(|lamp| lamp.intensity * size);
                let area = lamp.get::<ParallelogramLamp>();
                let area = area.map(|lamp| lamp.intensity * size * size);
                let intensity = intensity.or(line).or(area).unwrap();
                intensity / (height * height) / PI
            };
            for what in [
                Addition::PointLamp,
                Addition::SegmentLamp,
                Addition::ParallelogramLamp,
            ] {
                let radiance = added(what.clone());
                assert!((0.3..1.0).contains(&radiance), "{what:?}: {radiance}");
            }
        }
    }
    #[test]
    fn a_camera_looks_at_where_it_is_added_as_the_view_does() {
        let mut app = headless_editor();
        let world = app.world_mut();
        let at = AddAt {
            place: Vec3::new(3.0, 0.7, -2.0),
            size: 0.2,
            view: Quat::from_rotation_y(2.0) * Quat::from_rotation_x(-0.4),
        };
        let id = add(world, &Addition::Camera, at).unwrap();
        let entity = crate::editor::edits::scene_entity(world, id).unwrap();
        let own = world.get::<Transform>(entity).unwrap();
        let to_place = at.place - own.translation;
        assert!((to_place.length() - 0.5).abs() < 1e-5, "{own:?}");
        let looks = own.rotation * Vec3::NEG_Z;
        assert!(looks.dot(to_place.normalize()) > 0.999_99, "{own:?}");
        assert!(looks.dot(at.view * Vec3::NEG_Z) > 0.999_99, "{own:?}");
    }
}
