//! What is at a place of the window: what the tracer sees there, or a light or camera, which it
//! does not see, by its symbol.

use super::extent::lamp_points;
use super::navigation::LookThrough;
use super::viewport::EditorCamera;
use crate::bvh::Ray;
use crate::scene::{
    DirectionalLamp, ParallelogramLamp, PointLamp, SceneCamera, SceneId, SegmentLamp,
};
use crate::sync::Traced;
use crate::view;
use bevy::camera::Camera;
use bevy::camera::visibility::InheritedVisibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::{Or, With};
use bevy::ecs::world::World;
use bevy::math::{Ray3d, Vec2, Vec3};
use bevy::transform::components::GlobalTransform;
use bevy_egui::{EguiContext, PrimaryEguiContext, egui};

/// How near to a symbol the pointer has to be, in logical pixels.
const SYMBOL: f32 = 10.0;
/// How near to a line.
const LINE: f32 = 6.0;

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub id: SceneId,
    /// Where on it, in the world.
    pub point: Vec3,
}

/// The lights and cameras: what a scene's entity is that has no mesh and stands somewhere.
pub(super) type Symbol = Or<(
    With<PointLamp>,
    With<DirectionalLamp>,
    With<SegmentLamp>,
    With<ParallelogramLamp>,
    With<SceneCamera>,
)>;

/// The camera of the window and its place, as they were drawn last.
pub(super) fn camera(world: &mut World) -> Option<(Camera, GlobalTransform)> {
    let mut cameras = world.query_filtered::<(&Camera, &GlobalTransform), With<EditorCamera>>();
    let (camera, place) = cameras.single(world).ok()?;
    Some((camera.clone(), *place))
}

/// The ray through a place of the window, in logical pixels from its top left.
pub(super) fn ray(world: &mut World, at: Vec2) -> Option<Ray3d> {
    let (camera, place) = camera(world)?;
    camera.viewport_to_world(&place, at).ok()
}

/// Where a point of the world is in the window. `None` behind the camera.
pub(super) fn to_window(world: &mut World, point: Vec3) -> Option<Vec2> {
    let (camera, place) = camera(world)?;
    camera.world_to_viewport(&place, point).ok()
}

/// What the tracer meets along a ray.
pub(super) fn along(world: &World, from: Vec3, direction: Vec3) -> Option<Vec3> {
    let traced = world.resource::<Traced>();
    view::pick(&traced.world, &Ray::new(from, direction)).map(|picked| picked.point)
}

/// What is there. Symbols come first: they are small, and drawn over everything.
pub(super) fn at(world: &mut World, place: Vec2) -> Option<Found> {
    if let Some(found) = symbol_at(world, place) {
        return Some(found);
    }
    let ray = ray(world, place)?;
    let (from, direction) = (ray.origin, *ray.direction);
    let traced = world.resource::<Traced>();
    let picked = view::pick(&traced.world, &Ray::new(from, direction));
    let solid = picked.map(|picked| Found {
        id: picked.id,
        point: picked.point,
    });
    let distance = |found: &Found| (found.point - from).dot(direction);
    match (solid, glowing_at(world, from, direction)) {
        (Some(solid), Some(glowing)) if distance(&solid) < distance(&glowing) => Some(solid),
        (solid, glowing) => glowing.or(solid),
    }
}

/// The light or camera whose symbol is nearest.
fn symbol_at(world: &mut World, at: Vec2) -> Option<Found> {
    let (camera, place) = camera(world)?;
    let through = world.resource::<LookThrough>().camera;
    let on_window = |point: Vec3| camera.world_to_viewport(&place, point).ok();
    let mut symbols = world.query_filtered::<(Entity, &SceneId), Symbol>();
    let entities: Vec<(Entity, SceneId)> = symbols.iter(world).map(|(e, id)| (e, *id)).collect();
    let mut nearest: Option<(f32, Found)> = None;
    for (entity, id) in entities {
        if through == Some(id) || !is_shown(world, entity) {
            continue;
        }
        let Ok(entity) = world.get_entity(entity) else {
            continue;
        };
        let Some(own) = entity.get::<GlobalTransform>() else {
            continue;
        };
        let found = if entity.contains::<SegmentLamp>() {
            let ends: Vec<Vec3> = lamp_points(entity)
                .into_iter()
                .map(|end| own.transform_point(end))
                .collect();
            let [Some(a), Some(b)] = [ends[0], ends[1]].map(on_window) else {
                continue;
            };
            let along = part_along(at, a, b);
            let distance = at.distance(a.lerp(b, along)) * SYMBOL / LINE;
            Some((distance, ends[0].lerp(ends[1], along)))
        } else if entity.contains::<ParallelogramLamp>() {
            None
        } else {
            let point = own.translation();
            on_window(point).map(|symbol| (at.distance(symbol), point))
        };
        let Some((distance, point)) = found else {
            continue;
        };
        if distance <= SYMBOL && nearest.is_none_or(|(other, _)| distance < other) {
            nearest = Some((distance, Found { id, point }));
        }
    }
    nearest.map(|(_, found)| found)
}

/// The parallelogram light that a ray goes through first.
fn glowing_at(world: &mut World, from: Vec3, direction: Vec3) -> Option<Found> {
    let mut lamps = world.query::<(Entity, &SceneId, &ParallelogramLamp, &GlobalTransform)>();
    let found = lamps.iter(world).filter_map(|(entity, id, lamp, own)| {
        let affine = own.affine();
        let corner = affine.transform_point3(lamp.corner);
        let edges = lamp.edges.map(|edge| affine.transform_vector3(edge));
        let point = through_parallelogram(from, direction, corner, edges)?;
        Some((entity, Found { id: *id, point }))
    });
    let found: Vec<(Entity, Found)> = found.collect();
    found
        .into_iter()
        .filter(|(entity, _)| is_shown(world, *entity))
        .map(|(_, found)| found)
        .min_by(|a, b| {
            let distance = |found: &Found| found.point.distance(from);
            distance(a).total_cmp(&distance(b))
        })
}

/// Where a ray goes through `corner + u·edges[0] + v·edges[1]` with u and v in [0, 1].
fn through_parallelogram(
    from: Vec3,
    direction: Vec3,
    corner: Vec3,
    edges: [Vec3; 2],
) -> Option<Vec3> {
    let normal = edges[0].cross(edges[1]);
    let t = (corner - from).dot(normal) / direction.dot(normal);
    if !(t > 0.0 && t.is_finite()) {
        return None;
    }
    let point = from + t * direction;
    let offset = point - corner;
    let area = normal.length_squared();
    let u = offset.cross(edges[1]).dot(normal) / area;
    let v = edges[0].cross(offset).dot(normal) / area;
    let inside = (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
    inside.then_some(point)
}

/// Which part of the way from `a` to `b` is nearest to `point`.
fn part_along(point: Vec2, a: Vec2, b: Vec2) -> f32 {
    let way = b - a;
    let length = way.length_squared();
    if length > 0.0 {
        ((point - a).dot(way) / length).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// A place of the window in egui's points.
pub(super) fn to_points(context: &egui::Context, place: Vec2) -> egui::Pos2 {
    let place = place / context.zoom_factor();
    egui::pos2(place.x, place.y)
}

/// Egui's context of the window. `None` where there are no panels.
pub(super) fn egui_context(world: &mut World) -> Option<egui::Context> {
    let mut contexts = world.query_filtered::<&mut EguiContext, With<PrimaryEguiContext>>();
    let mut context = contexts.single_mut(world).ok()?;
    Some(context.get_mut().clone())
}

/// Whether an entity is neither hidden itself nor through a parent.
pub(super) fn is_shown(world: &World, entity: Entity) -> bool {
    world
        .get::<InheritedVisibility>(entity)
        .is_none_or(|visibility| visibility.get())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_go_through_parallelograms_where_they_are_and_nowhere_else() {
        let corner = Vec3::new(1.0, 2.0, 0.0);
        let edges = [Vec3::new(2.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 0.0)];
        for (u, v, hit) in [
            (0.5, 0.5, true),
            (0.01, 0.99, true),
            (-0.01, 0.5, false),
            (0.5, 1.01, false),
        ] {
            let point = corner + u * edges[0] + v * edges[1];
            for side in [1.0, -1.0] {
                let from = point + Vec3::new(0.3, -0.2, 2.0 * side);
                let direction = (point - from).normalize();
                let found = through_parallelogram(from, direction, corner, edges);
                assert_eq!(found.is_some(), hit, "u {u}, v {v}");
                assert!(found.is_none_or(|found| found.distance(point) < 1e-5));
                assert_eq!(
                    through_parallelogram(from, -direction, corner, edges),
                    None,
                    "it lies behind"
                );
            }
        }
        let beside = through_parallelogram(Vec3::ZERO, Vec3::X, corner, edges);
        assert_eq!(beside, None, "a ray in its plane");
    }

    #[test]
    fn the_nearest_point_of_a_line_is_on_it() {
        let (a, b) = (Vec2::new(1.0, 1.0), Vec2::new(5.0, 1.0));
        assert_eq!(part_along(Vec2::new(3.0, 9.0), a, b), 0.5);
        assert_eq!(part_along(Vec2::new(-3.0, 9.0), a, b), 0.0);
        assert_eq!(part_along(Vec2::new(9.0, 0.0), a, b), 1.0);
        assert_eq!(part_along(Vec2::new(9.0, 0.0), a, a), 0.0);
    }
}
