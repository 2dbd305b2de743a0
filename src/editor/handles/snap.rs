//! Snapping to other objects: what is moved lands on what is under the pointer.

use super::super::edits::{ancestors, scene_entity};
use super::super::extent::Extent;
use super::super::pick;
use super::Tools;
use crate::scene::SceneId;
use crate::sync::Traced;
use crate::view::Picked;
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::math::{Ray3d, Vec3};

/// What moves go by while snapping is on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SnapTo {
    /// Steps of a length.
    #[default]
    Steps,
    /// The face under the pointer: what is moved touches it.
    Faces,
    /// That face's nearest vertex: the pivot of what is moved goes there.
    Vertices,
}

impl Tools {
    /// The length that moves are multiples of. `None` where they are not.
    pub(super) fn step(&self) -> Option<f32> {
        (self.snap && self.snap_to == SnapTo::Steps).then_some(self.move_step)
    }
}

/// What is moved: the entities, and the room that they take around their pivot.
#[derive(Clone, Default)]
pub(super) struct Mover {
    pub entities: Vec<Entity>,
    pub room: Option<Extent>,
}

/// Where the pivot goes while the pointer is at this place of the window. `None` where moves do not snap to other objects,
/// or there is none.
pub(super) fn landing_at(world: &mut World, mover: &Mover) -> Option<Vec3> {
    let tools = world.resource::<Tools>();
    let to = tools.snap_to;
    if !tools.snap || to == SnapTo::Steps {
        return None;
    }
    let at = pick::cursor(world)?;
    let ray = pick::ray(world, at)?;
    landing(world, ray, to, mover)
}

fn landing(world: &World, ray: Ray3d, to: SnapTo, mover: &Mover) -> Option<Vec3> {
    let is_moved = |id| hangs_on(world, id, |entity| mover.entities.contains(&entity));
    let met = pick::past(world, ray.origin, ray.direction, is_moved)?;
    match to {
        SnapTo::Steps => None,
        SnapTo::Faces => {
            // How far it reaches behind its pivot.
            let reach = mover.room.map_or(0.0, |room| {
                (room.least * met.normal)
                    .min(room.most * met.normal)
                    .element_sum()
            });
            Some(met.point - reach * met.normal)
        }
        SnapTo::Vertices => {
            let distance = |corner: &Vec3| corner.distance(met.point);
            let corners = corners(world, &met)?.into_iter();
            corners.min_by(|a, b| distance(a).total_cmp(&distance(b)))
        }
    }
}

/// Those of the triangle that was met, in the world.
fn corners(world: &World, met: &Picked) -> Option<[Vec3; 3]> {
    let instances = world.resource::<Traced>().world.aggregate.instances();
    let instance = instances.get(met.hit.instance as usize)?;
    let corners = instance.mesh.triangles().corners(met.hit.triangle);
    Some(corners.map(|corner| instance.to_world_point(corner)))
}

/// Whether it is one of the roots, or hangs on one.
pub(super) fn hangs_on(world: &World, id: SceneId, is_root: impl Fn(Entity) -> bool) -> bool {
    scene_entity(world, id)
        .is_some_and(|entity| is_root(entity) || ancestors(world, entity).any(is_root))
}

#[cfg(test)]
mod tests {
    use super::super::super::extent::extent_of;
    use super::*;
    use crate::editor::headless_editor;
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use bevy::app::App;
    use bevy::ecs::name::Name;
    use bevy::math::Dir3;
    use bevy::transform::components::Transform;

    fn named(app: &mut App, name: &str) -> (Entity, SceneId) {
        let mut all = app.world_mut().query::<(Entity, &SceneId, &Name)>();
        let found = all
            .iter(app.world())
            .find(|(_, _, other)| other.as_str() == name);
        found.map(|(entity, id, _)| (entity, *id)).unwrap()
    }

    #[test]
    fn a_block_lands_on_faces_and_on_vertices_of_others_and_never_on_itself() {
        let mut app = headless_editor();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        app.update();
        let (block, id) = named(&mut app, "Short block");
        let (_, tall) = named(&mut app, "Mirror block");
        let tall = extent_of(app.world(), &[tall]).unwrap();
        let room = extent_of(app.world(), &[id]).unwrap();
        let pivot = app.world().get::<Transform>(block).unwrap().translation;
        let mover = Mover {
            entities: vec![block],
            room: Some(room.moved(-pivot)),
        };
        let down = |above: Vec3| Ray3d::new(above.with_y(tall.most.y + 0.1), Dir3::NEG_Y);
        let land = |app: &App, ray, to| landing(app.world(), ray, to, &mover).unwrap();
        let place = land(&app, down(tall.centre()), SnapTo::Faces);
        app.world_mut()
            .get_mut::<Transform>(block)
            .unwrap()
            .translation = place;
        app.update();
        app.update();
        let now = extent_of(app.world(), &[id]).unwrap();
        let gap = now.least.y - tall.most.y;
        assert!(gap.abs() < 1e-4, "{gap} m above the tall block");
        // It stands there now, and is passed over.
        assert_eq!(land(&app, down(tall.centre()), SnapTo::Faces), place);
        let corner = land(&app, down(tall.centre()), SnapTo::Vertices);
        assert!((corner.y - tall.most.y).abs() < 1e-5, "{corner}");
        let at_the_rim = [
            corner.x - tall.least.x,
            corner.x - tall.most.x,
            corner.z - tall.least.z,
            corner.z - tall.most.z,
        ];
        let nearest = at_the_rim
            .into_iter()
            .map(f32::abs)
            .fold(f32::INFINITY, f32::min);
        assert!(
            nearest < 1e-4,
            "{corner} is {nearest} m off the rim of {tall:?}"
        );
        let away = Ray3d::new(Vec3::Y * 100.0, Dir3::Y);
        assert_eq!(landing(app.world(), away, SnapTo::Faces, &mover), None);
    }
}
