//! How much room all takes that hangs below an entity.

use bevy::camera::primitives::Aabb;
use bevy::math::Vec3A;
use bevy::platform::collections::HashMap;
use bevy::prelude::{Children, Entity, Query};
use bevy::transform::components::GlobalTransform;

pub(super) type Below<'w, 's> = Query<'w, 's, &'static Children>;
pub(super) type Measured<'w, 's> = Query<'w, 's, (&'static GlobalTransform, &'static Aabb)>;

/// Least and most corner of a box in the world; `None` where nothing has a size.
pub(super) type Bounds = Option<[Vec3A; 2]>;

fn union(a: Bounds, b: Bounds) -> Bounds {
    match (a, b) {
        (Some([least, most]), Some([lesser, greater])) => {
            Some([least.min(lesser), most.max(greater)])
        }
        (a, b) => a.or(b),
    }
}

fn world_bounds(place: &GlobalTransform, aabb: &Aabb) -> [Vec3A; 2] {
    let place = place.affine();
    let center = place.transform_point3a(aabb.center);
    let axes = place.matrix3;
    let [x, y, z] = aabb.half_extents.to_array();
    let half = axes.x_axis.abs() * x + axes.y_axis.abs() * y + axes.z_axis.abs() * z;
    [center - half, center + half]
}

/// The box in the world around what hangs below an entity; `None` where that has no size. Of groups within groups, all may
/// be asked for: each is looked into once, and `known` remembers it.
pub(super) fn bounds_below(
    entity: Entity,
    below: &Below,
    measured: &Measured,
    known: &mut HashMap<Entity, Bounds>,
) -> Option<Aabb> {
    let own = |entity: Entity| {
        let (place, aabb) = measured.get(entity).ok()?;
        Some(world_bounds(place, aabb))
    };
    let mut waiting = vec![(entity, false)];
    while let Some((entity, are_children_known)) = waiting.pop() {
        if known.contains_key(&entity) {
            continue;
        }
        let children = below.get(entity).map_or(&[][..], |children| children);
        if !are_children_known && !children.is_empty() {
            waiting.push((entity, true));
            waiting.extend(children.iter().map(|&child| (child, false)));
            continue;
        }
        let with_below = |&child: &Entity| union(own(child), known.get(&child).copied().flatten());
        let bounds = children.iter().map(with_below).fold(None, union);
        known.insert(entity, bounds);
    }
    let [least, most] = known.get(&entity).copied().flatten()?;
    Some(Aabb::from_min_max(least.into(), most.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::ecs::system::RunSystemOnce;
    use bevy::math::Vec3;
    use bevy::prelude::{ChildOf, Transform, World};

    #[test]
    fn a_group_has_an_outline_around_all_that_hangs_below_it() {
        let mut world = World::new();
        let root = world.spawn(GlobalTransform::IDENTITY).id();
        let unit = Aabb::from_min_max(Vec3::splat(-1.0), Vec3::splat(1.0));
        let place = Transform::from_xyz(3.0, 0.0, 0.0).with_scale(Vec3::splat(2.0));
        let inner = world.spawn((ChildOf(root), GlobalTransform::IDENTITY)).id();
        world.spawn((ChildOf(inner), GlobalTransform::from(place), unit));
        world.spawn((ChildOf(root), GlobalTransform::IDENTITY, unit));
        let of = |entity: Entity| {
            move |below: Below, measured: Measured| {
                bounds_below(entity, &below, &measured, &mut HashMap::default())
            }
        };
        let bounds = world.run_system_once(of(root)).unwrap().unwrap();
        let found = [bounds.min(), bounds.max()].map(Vec3::from);
        assert_eq!(
            found,
            [Vec3::new(-1.0, -2.0, -2.0), Vec3::new(5.0, 2.0, 2.0)]
        );
        assert!(world.run_system_once(of(inner)).unwrap().is_some());
        world.despawn(inner);
        let none = world.spawn_empty().id();
        assert!(world.run_system_once(of(none)).unwrap().is_none());
    }
}
