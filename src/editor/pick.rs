//! What is at a place of the window: what the tracer sees there, or a light or camera, which it
//! does not see, by its symbol.

use super::edits::scene_entity;
use super::extent::own_extent;
use super::viewport::{EditorCamera, Viewport};
use crate::bvh::Ray;
use crate::scene::{AnyLamp, ParallelogramLamp, SceneCamera, SceneId};
use crate::sync::Traced;
use crate::view::{self, DrawnLines, Picked, SymbolOf, nearest_symbol};
use bevy::camera::Camera;
use bevy::camera::visibility::InheritedVisibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::{Or, With};
use bevy::ecs::world::World;
use bevy::math::{Dir3, Ray3d, Vec2, Vec3};
use bevy::transform::components::{GlobalTransform, Transform};
use bevy::window::{PrimaryWindow, Window};
use bevy_egui::{EguiContext, PrimaryEguiContext, egui};

/// How near to the lines of a symbol the pointer has to be, in logical pixels.
const SYMBOL: f32 = 8.0;
/// Surfaces that a ray passes over at most.
const MOST_PASSED: usize = 256;

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub id: SceneId,
    /// Where on it, in the world.
    pub point: Vec3,
}

/// The lights and cameras: what a scene's entity is that has no mesh and stands somewhere.
pub(super) type Symbol = Or<(AnyLamp, With<SceneCamera>)>;

/// The camera of the window and its place: as they were drawn last, and in the panels' pass as they are drawn next.
pub(super) fn camera(world: &mut World) -> Option<(Camera, GlobalTransform)> {
    let mut cameras = world.query_filtered::<(&Camera, &Transform), With<EditorCamera>>();
    let (camera, place) = cameras.single(world).ok()?;
    // It hangs on nothing, and what is propagated of it is that of the frame before.
    Some((camera.clone(), GlobalTransform::from(*place)))
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

/// What is seen along a ray.
pub(super) fn seen(world: &World, from: Vec3, direction: Vec3) -> Option<Picked> {
    let (traced, settings) = (world.resource::<Traced>(), world.resource());
    view::pick(&traced.world, settings, &Ray::new(from, direction))
}

/// Where that is.
pub(super) fn along(world: &World, from: Vec3, direction: Vec3) -> Option<Vec3> {
    seen(world, from, direction).map(|picked| picked.point)
}

/// The same without what is to be passed over.
pub(super) fn past(
    world: &World,
    from: Vec3,
    direction: Dir3,
    passes: impl Fn(SceneId) -> bool,
) -> Option<Picked> {
    let mut from = from;
    for _ in 0..MOST_PASSED {
        let met = seen(world, from, *direction)?;
        if !passes(met.id) {
            return Some(met);
        }
        // Instances may share a surface's place: none of them is met twice.
        let step = 1e-6 * (1.0 + met.point.abs().max_element().max(from.abs().max_element()));
        from += direction * ((met.point - from).dot(*direction).max(0.0) + step);
    }
    None
}

/// Where the pointer is in the window, in logical pixels; over the second of two views, where the first one shows the same.
pub(super) fn cursor(world: &mut World) -> Option<Vec2> {
    let mut windows = world.query_filtered::<&Window, With<PrimaryWindow>>();
    let at = windows.single(world).ok()?.cursor_position()?;
    let viewport = world.get_resource::<Viewport>();
    Some(at - viewport.map_or(Vec2::ZERO, |viewport| viewport.offset(at)))
}

/// What is there. Symbols come first: they are small, and drawn over everything.
pub(super) fn at(world: &mut World, place: Vec2) -> Option<Found> {
    if let Some(found) = symbol_at(world, place) {
        return Some(found);
    }
    let ray = ray(world, place)?;
    let (from, direction) = (ray.origin, *ray.direction);
    let solid = seen(world, from, direction).map(|picked| Found {
        id: picked.id,
        point: picked.point,
    });
    let distance = |found: &Found| (found.point - from).dot(direction);
    match (solid, glowing_at(world, from, direction)) {
        (Some(solid), Some(glowing)) if distance(&solid) < distance(&glowing) => Some(solid),
        (solid, glowing) => glowing.or(solid),
    }
}

/// The light or camera whose symbol is nearest, and near enough.
fn symbol_at(world: &mut World, at: Vec2) -> Option<Found> {
    let (camera, place) = camera(world)?;
    let in_view = at - world.resource::<Viewport>().rect.min;
    let mut symbols = world.query::<(&SymbolOf, &DrawnLines)>();
    let nearest = nearest_symbol(in_view, &camera, &place, symbols.iter(world));
    let (id, _) = nearest.filter(|(_, distance)| *distance <= SYMBOL)?;
    let entity = scene_entity(world, id)?;
    let point = own_extent(world.get_entity(entity).ok()?)?.centre();
    Some(Found { id, point })
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
}
