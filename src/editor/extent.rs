//! How much room things take: for framing them, for pivots and for box selection.

use crate::bvh::REACH;
use crate::editor::edits::{all_below, roots_of, scene_entity};
use crate::io::place::world_from;
use crate::scene::{
    DirectionalLamp, MeshSource, ParallelogramLamp, PointLamp, SceneCamera, SceneId, SegmentLamp,
};
use bevy::asset::Assets;
use bevy::camera::primitives::{Aabb, MeshAabb};
use bevy::ecs::entity::Entity;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::query::With;
use bevy::ecs::world::{EntityRef, World};
use bevy::math::Vec3;
use bevy::mesh::{Mesh, Mesh3d};
use bevy::transform::components::{GlobalTransform, Transform};

/// An axis-parallel box in the world's space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub least: Vec3,
    pub most: Vec3,
}

impl Extent {
    /// That of all points that are finite; `None` where there is none.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        let mut extent: Option<Self> = None;
        for point in points.into_iter().filter(|point| point.is_finite()) {
            // What lies farther is not traced, and its squares would overflow.
            let point = point.clamp(Vec3::splat(-REACH), Vec3::splat(REACH));
            let so_far = extent.unwrap_or(Self {
                least: point,
                most: point,
            });
            extent = Some(Self {
                least: so_far.least.min(point),
                most: so_far.most.max(point),
            });
        }
        extent
    }

    fn and(self, other: Self) -> Self {
        Self {
            least: self.least.min(other.least),
            most: self.most.max(other.most),
        }
    }

    /// The same elsewhere.
    pub fn moved(self, by: Vec3) -> Self {
        Self {
            least: self.least + by,
            most: self.most + by,
        }
    }

    /// Whether the boxes have a point in common.
    pub fn meets(self, other: Self) -> bool {
        self.least.cmple(other.most).all() && other.least.cmple(self.most).all()
    }

    /// Whether a point is in the box.
    pub fn contains(self, point: Vec3) -> bool {
        point.cmpge(self.least).all() && point.cmple(self.most).all()
    }

    /// The middle of the box.
    pub fn centre(self) -> Vec3 {
        0.5 * (self.least + self.most)
    }

    /// Half of the box's diagonal.
    pub fn radius(self) -> f32 {
        0.5 * (self.most - self.least).length()
    }
}

/// The points that the lines of a lamp run between, in its own space; none for what is no area.
pub(super) fn lamp_points(entity: EntityRef) -> Vec<Vec3> {
    if let Some(lamp) = entity.get::<SegmentLamp>() {
        return lamp.ends.to_vec();
    }
    let Some(lamp) = entity.get::<ParallelogramLamp>() else {
        return Vec::new();
    };
    let [along, across] = lamp.edges;
    [Vec3::ZERO, along, across, along + across]
        .map(|offset| lamp.corner + offset)
        .to_vec()
}

fn corners(aabb: &Aabb) -> [Vec3; 8] {
    std::array::from_fn(|corner| {
        let side = |axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let sides = Vec3::new(side(0), side(1), side(2));
        Vec3::from(aabb.center) + sides * Vec3::from(aabb.half_extents)
    })
}

/// The room that the objects at and below an entity take, as places and meshes are now: what was added in this frame is
/// neither propagated nor measured. `None` where there are none.
pub(super) fn extent_now(world: &World, root: Entity) -> Option<Extent> {
    let meshes = world.resource::<Assets<Mesh>>();
    let extent_of_one = |entity| {
        let mesh = meshes.get(&world.get::<Mesh3d>(entity)?.0)?;
        let world_from_own = world_from_entity(world, entity)?.affine();
        let corners = corners(&mesh.compute_aabb()?);
        Extent::of_points(corners.map(|corner| world_from_own.transform_point3(corner)))
    };
    let all = all_below(world, root).into_iter();
    all.filter_map(extent_of_one).reduce(Extent::and)
}

/// The room that an entity itself takes, without its children. `None` for what stands nowhere, and
/// for an object whose mesh is not there yet.
pub(super) fn own_extent(entity: EntityRef) -> Option<Extent> {
    extent_from(entity, entity.get::<GlobalTransform>()?)
}

/// The room that an object, a light or a camera itself takes, as places are now; where an object's mesh is not there yet, or
/// not measured, that of a unit cube, as which most are added. `None` for what takes none, and for what stands nowhere.
pub(super) fn extent_as_placed(world: &World, entity: Entity) -> Option<Extent> {
    let world_from_own = world_from_entity(world, entity)?;
    let entity = world.get_entity(entity).ok()?;
    if entity.contains::<MeshSource>() && !entity.contains::<Aabb>() {
        let corners = corners(&Aabb::from_min_max(Vec3::splat(-0.5), Vec3::splat(0.5)));
        return Extent::of_points(corners.map(|corner| world_from_own.transform_point(corner)));
    }
    let is_seen = entity.contains::<Mesh3d>()
        || entity.contains::<SceneCamera>()
        || entity.contains::<PointLamp>()
        || entity.contains::<DirectionalLamp>()
        || !lamp_points(entity).is_empty();
    is_seen.then(|| extent_from(entity, &world_from_own))?
}

fn extent_from(entity: EntityRef, world_from_own: &GlobalTransform) -> Option<Extent> {
    if let Some(aabb) = entity.get::<Aabb>().filter(|_| entity.contains::<Mesh3d>()) {
        let corners = corners(aabb).map(|corner| world_from_own.transform_point(corner));
        return Extent::of_points(corners);
    }
    let points = lamp_points(entity);
    if points.is_empty() {
        return Extent::of_points([world_from_own.translation()]);
    }
    let points = points.into_iter();
    Extent::of_points(points.map(|point| world_from_own.transform_point(point)))
}

/// The room that these entities take with all that hangs on them. `None` where that is nothing.
pub(super) fn extent_of(world: &World, ids: &[SceneId]) -> Option<Extent> {
    let roots = roots_of(world, ids).into_iter();
    let roots = roots.filter_map(|id| scene_entity(world, id));
    let extents = roots.filter_map(|root| extent_below(world, root));
    extents.reduce(Extent::and)
}

/// The room that an entity takes with all that hangs on it.
pub(super) fn extent_below(world: &World, root: Entity) -> Option<Extent> {
    let all = all_below(world, root).into_iter();
    let all = all.filter_map(|entity| world.get_entity(entity).ok());
    // What the app has disabled is not seen.
    let there = all.filter(|entity| entity.contains::<SceneId>() && !entity.contains::<Disabled>());
    there.filter_map(own_extent).reduce(Extent::and)
}

/// The room that the scene's objects and area lights take; where there are none, that of the other
/// lights and the cameras.
pub(super) fn scene_extent(world: &mut World) -> Option<Extent> {
    solid_extent(world).or_else(|| {
        extent_of_all(world, |entity| {
            entity.contains::<PointLamp>()
                || entity.contains::<DirectionalLamp>()
                || entity.contains::<SceneCamera>()
        })
    })
}

/// The room that the scene's objects and area lights take.
pub(super) fn solid_extent(world: &mut World) -> Option<Extent> {
    extent_of_all(world, |entity| {
        entity.contains::<Mesh3d>()
            || entity.contains::<SegmentLamp>()
            || entity.contains::<ParallelogramLamp>()
    })
}

/// The room that all entities of a kind take.
fn extent_of_all(world: &mut World, is_meant: impl Fn(&EntityRef) -> bool) -> Option<Extent> {
    let mut all = world.query_filtered::<EntityRef, With<SceneId>>();
    let meant = all.iter(world).filter(is_meant);
    meant.filter_map(own_extent).reduce(Extent::and)
}

/// From the space of an entity's parent to the world's, as the transforms are now.
pub(super) fn world_from_parent(world: &World, entity: Entity) -> GlobalTransform {
    let parent = world.get::<ChildOf>(entity).map(ChildOf::parent);
    parent.map_or(GlobalTransform::IDENTITY, |parent| {
        world_from(world, parent).into()
    })
}

/// From an entity's space to the world's, as the transforms are now, not as they were when they
/// were last propagated.
pub(super) fn world_from_entity(world: &World, entity: Entity) -> Option<GlobalTransform> {
    let own = *world.get::<Transform>(entity)?;
    Some(world_from_parent(world, entity) * own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;

    #[test]
    fn what_hangs_on_an_entity_counts_as_it() {
        let mut app = headless_editor();
        let world = app.world_mut();
        let at = |x: f32| {
            let transform = Transform::from_xyz(x, 0.0, 0.0);
            (transform, GlobalTransform::from(transform))
        };
        let parent = world
            .spawn((SceneId(1), PointLamp::default(), at(1.0)))
            .id();
        world.spawn((SceneId(2), PointLamp::default(), at(5.0), ChildOf(parent)));
        world.spawn((SceneId(3), PointLamp::default(), at(-9.0)));
        let extent = extent_of(world, &[SceneId(1)]).unwrap();
        assert_eq!((extent.least.x, extent.most.x), (1.0, 5.0));
        assert_eq!(extent_of(world, &[SceneId(7)]), None);
        let all = scene_extent(world).unwrap();
        assert_eq!((all.least.x, all.most.x), (-9.0, 5.0));
    }

    #[test]
    fn a_segment_takes_the_room_between_its_ends() {
        let mut world = World::new();
        let transform = Transform::from_xyz(0.0, 2.0, 0.0).with_scale(Vec3::splat(4.0));
        let lamp = world
            .spawn((
                SegmentLamp::default(),
                transform,
                GlobalTransform::from(transform),
            ))
            .id();
        let extent = own_extent(world.entity(lamp)).unwrap();
        assert_eq!(extent.centre(), Vec3::new(0.0, 2.0, 0.0));
        assert_eq!(extent.radius(), 2.0);
    }

    #[test]
    fn places_are_those_of_now_and_not_of_the_last_frame() {
        let mut world = World::new();
        let parent = world.spawn(Transform::from_xyz(1.0, 0.0, 0.0)).id();
        let child = world
            .spawn((Transform::from_xyz(0.0, 2.0, 0.0), ChildOf(parent)))
            .id();
        let place = world_from_entity(&world, child).unwrap().translation();
        assert_eq!(place, Vec3::new(1.0, 2.0, 0.0));
    }
}
