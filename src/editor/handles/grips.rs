//! Points that can be dragged: the ends of segment lights and the corners of parallelogram lights.

use super::super::edits::scene_entity;
use super::super::extent::{lamp_points, world_from_entity};
use super::super::history::Gesture;
use super::super::keys::Modifiers;
use super::super::pick;
use super::super::pointer::PointerUse;
use super::super::selection::Selection;
use super::super::viewport::Viewport;
use super::surface::{Shaping, Surface, shaped};
use super::{ActiveGrip, Tools};
use crate::scene::{ParallelogramLamp, SceneId, SegmentLamp};
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::name::Name;
use bevy::ecs::world::World;
use bevy::math::{Vec2, Vec3};
use bevy_egui::egui;

/// How near to a point the pointer has to be, in logical pixels.
const REACH: f32 = 7.0;
/// Radius of a drawn point, in logical pixels.
const RADIUS: f32 = 4.5;

/// One point of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Grip {
    pub id: SceneId,
    /// Which end, or which corner: that at `corner`, `corner + edges[0]`, `corner + edges[1]`, and
    /// the one opposite.
    pub index: usize,
}

/// Where the points of the selected lights are in the world.
pub(in super::super) fn grips_of_selection(world: &mut World) -> Vec<(Grip, Vec3)> {
    let ids = world.resource::<Selection>().ids().to_vec();
    let mut grips = Vec::new();
    for id in ids {
        let Some(entity) = scene_entity(world, id) else {
            continue;
        };
        let Some(place) = world_from_entity(world, entity) else {
            continue;
        };
        let points = world.get_entity(entity).map(lamp_points);
        for (index, point) in points.unwrap_or_default().into_iter().enumerate() {
            grips.push((Grip { id, index }, place.transform_point(point)));
        }
    }
    grips
}

/// Where a point is in the world.
pub(super) fn place(world: &mut World, grip: Grip) -> Option<Vec3> {
    let entity = scene_entity(world, grip.id)?;
    let point = *lamp_points(world.get_entity(entity).ok()?).get(grip.index)?;
    Some(world_from_entity(world, entity)?.transform_point(point))
}

/// Puts a point somewhere in the world; the rest of the light follows, a parallelogram as
/// [`Shaping::Sides`] does.
pub(super) fn put(world: &mut World, grip: Grip, to: Vec3) {
    let Some(to) = in_own_space(world, grip, to) else {
        return;
    };
    let Some(entity) = scene_entity(world, grip.id) else {
        return;
    };
    if let Some(mut lamp) = world.get_mut::<SegmentLamp>(entity) {
        if lamp.ends.get(grip.index).is_some_and(|end| *end != to) {
            lamp.ends[grip.index] = to;
        }
    } else if let Some(lamp) = world.get::<ParallelogramLamp>(entity) {
        let surface = (lamp.corner, lamp.edges);
        set_surface(world, grip, shaped(surface, grip.index, to, Shaping::Sides));
    }
}

/// A place in the world as the light's entity has it.
fn in_own_space(world: &World, grip: Grip, to: Vec3) -> Option<Vec3> {
    let place = world_from_entity(world, scene_entity(world, grip.id)?)?;
    let to = place.affine().inverse().transform_point3(to);
    to.is_finite().then_some(to)
}

/// The surface of a parallelogram light, in its entity's space.
fn surface_of(world: &World, grip: Grip) -> Option<Surface> {
    let lamp = world.get::<ParallelogramLamp>(scene_entity(world, grip.id)?)?;
    Some((lamp.corner, lamp.edges))
}

fn set_surface(world: &mut World, grip: Grip, (corner, edges): Surface) {
    let entity = scene_entity(world, grip.id);
    let lamp = entity.and_then(|entity| world.get_mut::<ParallelogramLamp>(entity));
    if let Some(mut lamp) = lamp
        && (lamp.corner, lamp.edges) != (corner, edges)
    {
        (lamp.corner, lamp.edges) = (corner, edges);
    }
}

/// What the step is called that moves this point.
pub(super) fn step_name(world: &mut World, grip: Grip) -> String {
    let entity = scene_entity(world, grip.id);
    let part = match entity {
        Some(entity) if world.get::<SegmentLamp>(entity).is_some() => "an end",
        _ => "a corner",
    };
    match entity.and_then(|entity| world.get::<Name>(entity)) {
        Some(name) => format!("Move {part} of {name}"),
        None => format!("Move {part}"),
    }
}

/// The point of a selected light that is under the pointer.
pub(in super::super) fn grip_at(world: &mut World, at: Vec2) -> Option<Grip> {
    let near = grips_of_selection(world)
        .into_iter()
        .filter_map(|(grip, place)| {
            let distance = pick::to_window(world, place)?.distance(at);
            (distance <= REACH).then_some((distance, grip))
        });
    near.min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, grip)| grip)
}

/// A point that is being dragged: a light's corner in the light's plane, an end in the plane through it that faces the
/// view.
#[derive(Clone, Debug)]
pub(in super::super) struct GripDrag {
    grip: Grip,
    start: Vec3,
    normal: Vec3,
    /// Where in that plane it was taken hold of.
    held_at: Vec3,
    /// Of a parallelogram, as it was.
    surface: Option<Surface>,
    begun: bool,
}

/// Cosine between the view's direction and a light's normal below which its plane is seen from its edge, and a small
/// movement of the pointer would be a large one in it.
const EDGE_ON: f32 = 0.1;

impl GripDrag {
    /// Takes hold of a point. The gizmo goes there too.
    pub fn begin(world: &mut World, grip: Grip, at: Vec2) -> Option<Self> {
        let start = place(world, grip)?;
        let (_, view) = pick::camera(world)?;
        let surface = surface_of(world, grip);
        let entity = scene_entity(world, grip.id)?;
        let of_world = world_from_entity(world, entity)?.affine();
        let plane = surface.map(|(_, edges)| {
            let [a, b] = edges.map(|edge| of_world.transform_vector3(edge));
            a.cross(b).normalize_or_zero()
        });
        let forward = *view.forward();
        let seen = plane.filter(|normal| normal.dot(forward).abs() > EDGE_ON);
        let normal = seen.unwrap_or(forward);
        let held_at = in_plane(world, at, start, normal)?;
        world.resource_mut::<ActiveGrip>().0 = Some(grip);
        Some(Self {
            grip,
            start,
            normal,
            held_at,
            surface,
            begun: false,
        })
    }

    /// The pointer went there. For a corner Alt shears, Shift keeps the ratio of the sides, and Ctrl the middle.
    pub fn follow(&mut self, world: &mut World, at: Vec2, modifiers: Modifiers) {
        let Some(now) = in_plane(world, at, self.start, self.normal) else {
            return;
        };
        if !self.begun {
            self.begun = true;
            let name = step_name(world, self.grip);
            world.resource_mut::<Gesture>().begin(name);
        }
        let mut to = self.start + now - self.held_at;
        let tools = world.resource::<Tools>();
        if tools.snap && tools.move_step > 0.0 {
            to = (to / tools.move_step).round() * tools.move_step;
        }
        let Some(surface) = self.surface else {
            return put(world, self.grip, to);
        };
        let how = match modifiers {
            Modifiers { alt: true, .. } => Shaping::Shear,
            Modifiers { shift, ctrl, .. } => match (shift, ctrl) {
                (false, false) => Shaping::Sides,
                (true, false) => Shaping::Ratio,
                (false, true) => Shaping::Middle,
                (true, true) => Shaping::MiddleRatio,
            },
        };
        if let Some(to) = in_own_space(world, self.grip, to) {
            set_surface(world, self.grip, shaped(surface, self.grip.index, to, how));
        }
    }

    /// Lets go.
    pub fn end(self, world: &mut World) {
        if self.begun {
            world.resource_mut::<Gesture>().end();
        }
    }

    /// Puts the point back.
    pub fn cancel(self, world: &mut World) {
        match self.surface {
            Some(surface) => set_surface(world, self.grip, surface),
            None => put(world, self.grip, self.start),
        }
        self.end(world);
    }
}

fn in_plane(world: &mut World, at: Vec2, point: Vec3, normal: Vec3) -> Option<Vec3> {
    let ray = pick::ray(world, at)?;
    let t = (point - ray.origin).dot(normal) / ray.direction.dot(normal);
    (t > 0.0 && t.is_finite()).then(|| ray.origin + t * *ray.direction)
}

/// A point belongs to the selection: with another one it is not meant any more.
pub(super) fn forget_grips(world: &mut World) {
    if !world.resource_ref::<Selection>().is_changed() {
        return;
    }
    let Some(grip) = world.resource::<ActiveGrip>().0 else {
        return;
    };
    if !world.resource::<Selection>().contains(grip.id) {
        world.resource_mut::<ActiveGrip>().0 = None;
    }
}

/// Draws the points over the picture.
pub(super) fn draw_grips(world: &mut World) {
    let grips = grips_of_selection(world);
    if grips.is_empty() {
        return;
    }
    let Some(context) = pick::egui_context(world) else {
        return;
    };
    let viewport = world.resource::<Viewport>().clone();
    let pointer = context.pointer_latest_pos().filter(|_| viewport.hovered);
    let active = world.resource::<ActiveGrip>().0;
    let held = match world.resource::<PointerUse>() {
        PointerUse::Grip(drag) => Some(drag.grip),
        _ => None,
    };
    let [min, max] = [viewport.rect.min, viewport.rect.max].map(|at| pick::to_points(&context, at));
    let clip = egui::Rect::from_min_max(min, max);
    let painter = context
        .layer_painter(egui::LayerId::background())
        .with_clip_rect(clip);
    for (grip, place) in grips {
        let Some(at) = pick::to_window(world, place) else {
            continue;
        };
        let at = pick::to_points(&context, at);
        let hovered = pointer.is_some_and(|pointer| pointer.distance(at) <= REACH);
        let fill = if held == Some(grip) || hovered || active == Some(grip) {
            egui::Color32::from_rgb(255, 190, 60)
        } else {
            egui::Color32::WHITE
        };
        let radius = if hovered { RADIUS + 1.5 } else { RADIUS };
        painter.circle(
            at,
            radius,
            fill,
            egui::Stroke::new(1.5, egui::Color32::BLACK),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_is_put_in_the_world_whatever_the_light_hangs_on() {
        use bevy::transform::components::Transform;
        let mut app = crate::editor::headless_editor();
        let world = app.world_mut();
        let turned = Transform::from_xyz(0.0, 3.0, 0.0)
            .with_rotation(bevy::math::Quat::from_rotation_y(1.0))
            .with_scale(Vec3::splat(2.0));
        world.spawn((SceneId(4), SegmentLamp::default(), turned));
        let grip = Grip {
            id: SceneId(4),
            index: 1,
        };
        let other = Grip { index: 0, ..grip };
        let stays = place(world, other).unwrap();
        let to = Vec3::new(0.4, 1.0, -2.0);
        put(world, grip, to);
        assert!((place(world, grip).unwrap() - to).length() < 1e-5);
        assert_eq!(place(world, other).unwrap(), stays);
        put(world, grip, Vec3::NAN);
        assert!((place(world, grip).unwrap() - to).length() < 1e-5);
    }
}
