//! Points that can be dragged: the ends of segment lights, the corners of parallelogram lights, and the tips of the arrows of
//! what moves while the shutter is open.

use super::super::edits::scene_entity;
use super::super::extent::{lamp_points, world_from_entity, world_from_parent};
use super::super::history::Gesture;
use super::super::keys::Modifiers;
use super::super::pick;
use super::super::pointer::PointerUse;
use super::super::selection::Selection;
use super::super::viewport::Viewport;
use super::gizmo::pivot;
use super::snap::{Mover, landing_at};
use super::surface::{Shaping, Surface, shaped};
use super::{ActiveGrip, Tools};
use crate::scene::{Motion, ParallelogramLamp, SceneId, SegmentLamp};
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::world::World;
use bevy::math::{Vec2, Vec3};
use bevy_egui::egui;

/// How near to a point the pointer has to be, in logical pixels.
const REACH: f32 = 7.0;
/// Radius of a drawn point, in logical pixels.
const RADIUS: f32 = 4.5;

/// One point of an entity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Grip {
    pub id: SceneId,
    pub part: Part,
}

/// Which point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Part {
    /// Which end of a light, or which corner: that at `corner`, `corner + edges[0]`, `corner + edges[1]`, and the one
    /// opposite.
    Corner(usize),
    /// Where its middle is at time 1, from where it is at time 0.
    Motion,
}

/// Where the points of what is selected are in the world.
pub(in super::super) fn grips_of_selection(world: &mut World) -> Vec<(Grip, Vec3)> {
    let ids = world.resource::<Selection>().ids().to_vec();
    let mut grips = Vec::new();
    for id in ids {
        let Some(entity) = scene_entity(world, id) else {
            continue;
        };
        let corners = world
            .get_entity(entity)
            .map_or(0, |entity| lamp_points(entity).len());
        let moves = world.get::<Motion>(entity).map(|_| Part::Motion);
        for part in (0..corners).map(Part::Corner).chain(moves) {
            let grip = Grip { id, part };
            grips.extend(place(world, grip).map(|place| (grip, place)));
        }
    }
    grips
}

/// Where a point is in the world.
pub(super) fn place(world: &World, grip: Grip) -> Option<Vec3> {
    let entity = scene_entity(world, grip.id)?;
    let Part::Corner(index) = grip.part else {
        let velocity = world.get::<Motion>(entity)?.velocity;
        let of_parent = world_from_parent(world, entity).affine();
        return Some(pivot(world, entity)? + of_parent.transform_vector3(velocity));
    };
    let point = *lamp_points(world.get_entity(entity).ok()?).get(index)?;
    Some(world_from_entity(world, entity)?.transform_point(point))
}

/// Puts a point somewhere in the world; the rest of the light follows, a parallelogram as
/// [`Shaping::Sides`] does.
pub(super) fn put(world: &mut World, grip: Grip, to: Vec3) {
    let Some(entity) = scene_entity(world, grip.id) else {
        return;
    };
    let Part::Corner(index) = grip.part else {
        return put_motion(world, entity, to);
    };
    let Some(to) = in_own_space(world, grip, to) else {
        return;
    };
    if let Some(mut lamp) = world.get_mut::<SegmentLamp>(entity) {
        if lamp.ends.get(index).is_some_and(|end| *end != to) {
            lamp.ends[index] = to;
        }
    } else if let Some(lamp) = world.get::<ParallelogramLamp>(entity) {
        let surface = (lamp.corner, lamp.edges);
        set_surface(world, grip, shaped(surface, index, to, Shaping::Sides));
    }
}

/// Gives it the velocity that brings its middle there.
fn put_motion(world: &mut World, entity: Entity, to: Vec3) {
    let Some(from) = pivot(world, entity) else {
        return;
    };
    let parent_from_world = world_from_parent(world, entity).affine().inverse();
    let velocity = parent_from_world.transform_vector3(to - from);
    if let Some(mut motion) = world.get_mut::<Motion>(entity)
        && velocity.is_finite()
        && motion.velocity != velocity
    {
        motion.velocity = velocity;
    }
}

/// The velocity of what moves, where the point is its tip.
pub(super) fn velocity_of(world: &World, grip: Grip) -> Option<Vec3> {
    let entity = scene_entity(world, grip.id).filter(|_| grip.part == Part::Motion)?;
    world.get::<Motion>(entity).map(|motion| motion.velocity)
}

/// Gives it a velocity to the last bit: from where the tip is it could only be found with a rounding.
pub(super) fn set_velocity(world: &mut World, grip: Grip, velocity: Vec3) {
    let entity = scene_entity(world, grip.id);
    if let Some(mut motion) = entity.and_then(|entity| world.get_mut::<Motion>(entity))
        && motion.velocity != velocity
    {
        motion.velocity = velocity;
    }
}

/// What is dragged, for snapping to other things.
pub(super) fn mover(world: &World, grip: Grip) -> Mover {
    Mover {
        entities: scene_entity(world, grip.id).into_iter().collect(),
        room: None,
    }
}

/// A place in the world as the light's entity has it.
fn in_own_space(world: &World, grip: Grip, to: Vec3) -> Option<Vec3> {
    let place = world_from_entity(world, scene_entity(world, grip.id)?)?;
    let to = place.affine().inverse().transform_point3(to);
    to.is_finite().then_some(to)
}

/// The surface of a parallelogram light, in its entity's space.
fn surface_of(world: &World, grip: Grip) -> Option<(usize, Surface)> {
    let Part::Corner(index) = grip.part else {
        return None;
    };
    let lamp = world.get::<ParallelogramLamp>(scene_entity(world, grip.id)?)?;
    Some((index, (lamp.corner, lamp.edges)))
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
    let part = match (grip.part, entity) {
        (Part::Motion, _) => "the motion",
        (_, Some(entity)) if world.get::<SegmentLamp>(entity).is_some() => "an end",
        _ => "a corner",
    };
    match entity.and_then(|entity| world.get::<Name>(entity)) {
        Some(name) => format!("Move {part} of {name}"),
        None => format!("Move {part}"),
    }
}

/// The point of what is selected that is under the pointer.
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
    /// Of a parallelogram: which corner, and all of it as it was.
    surface: Option<(usize, Surface)>,
    /// Of the tip of a motion: the velocity as it was.
    velocity: Option<Vec3>,
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
        let plane = surface.map(|(_, (_, edges))| {
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
            velocity: velocity_of(world, grip),
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
        let mover = mover(world, self.grip);
        if let Some(step) = world.resource::<Tools>().step() {
            to = (to / step).round() * step;
        } else if let Some(landing) = landing_at(world, &mover) {
            to = landing;
        }
        let Some((index, surface)) = self.surface else {
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
            set_surface(world, self.grip, shaped(surface, index, to, how));
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
        if !self.begun {
            return;
        }
        match (self.surface, self.velocity) {
            (Some((_, surface)), _) => set_surface(world, self.grip, surface),
            (_, Some(velocity)) => set_velocity(world, self.grip, velocity),
            _ => put(world, self.grip, self.start),
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
        let entity = scene_entity(world, grip.id).filter(|_| grip.part == Part::Motion);
        let from = entity.and_then(|entity| pivot(world, entity));
        if let Some(from) = from.and_then(|from| pick::to_window(world, from)) {
            let line = [pick::to_points(&context, from), at];
            painter.line_segment(line, egui::Stroke::new(3.0, egui::Color32::BLACK));
            painter.line_segment(line, egui::Stroke::new(1.5, egui::Color32::WHITE));
        }
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
        let of = |index| Grip {
            id: SceneId(4),
            part: Part::Corner(index),
        };
        let (grip, other) = (of(1), of(0));
        let stays = place(world, other).unwrap();
        let to = Vec3::new(0.4, 1.0, -2.0);
        put(world, grip, to);
        assert!((place(world, grip).unwrap() - to).length() < 1e-5);
        assert_eq!(place(world, other).unwrap(), stays);
        put(world, grip, Vec3::NAN);
        assert!((place(world, grip).unwrap() - to).length() < 1e-5);
    }

    #[test]
    fn the_tip_of_a_motion_is_where_the_middle_will_be_whatever_it_hangs_on() {
        use bevy::ecs::hierarchy::ChildOf;
        use bevy::transform::components::{GlobalTransform, Transform};
        let mut app = crate::editor::headless_editor();
        let world = app.world_mut();
        let turned = Transform::from_xyz(0.0, 3.0, 0.0)
            .with_rotation(bevy::math::Quat::from_rotation_y(1.0))
            .with_scale(Vec3::splat(2.0));
        let parent = world.spawn((SceneId(3), turned)).id();
        let own = Transform::from_xyz(1.0, 0.0, 0.0);
        let lamp = crate::scene::PointLamp::default();
        let motion = Motion {
            velocity: Vec3::ZERO,
            ..Motion::default()
        };
        let moved = world
            .spawn((SceneId(4), lamp, motion, own, ChildOf(parent)))
            .id();
        app.update();
        let world = app.world_mut();
        world.resource_mut::<Selection>().set([SceneId(4)]);
        let [(grip, tip)] = grips_of_selection(world)[..] else {
            panic!("a lamp without corners has one point, that of its motion");
        };
        let middle = world.get::<GlobalTransform>(moved).unwrap().translation();
        assert!(tip.distance(middle) < 1e-5, "{tip}, {middle}");
        let to = Vec3::new(0.4, 1.0, -2.0);
        put(world, grip, to);
        assert!(place(world, grip).unwrap().distance(to) < 1e-5);
        // Half of it, turned back: its parent scales by two.
        let length = world.get::<Motion>(moved).unwrap().velocity.length();
        let expected = 0.5 * to.distance(middle);
        assert!((length - expected).abs() < 1e-5, "{length} of {expected} m");
        put(world, grip, Vec3::NAN);
        assert!(place(world, grip).unwrap().distance(to) < 1e-5);
    }
}
