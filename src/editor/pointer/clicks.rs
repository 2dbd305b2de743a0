//! What a click means: choosing, selecting, a menu, an answer.

use super::super::action::Action;
use super::super::command::Over;
use super::super::extent::own_extent;
use super::super::inspection::debug_ray::shoot_at;
use super::super::inspection::hover::line_at;
use super::super::inspection::{DebugRay, Inspected, Which};
use super::super::selection::Selection;
use super::super::trees::pair::TreePair;
use super::super::viewport::Viewport;
use super::super::{handles, pick};
use super::{Armed, DOUBLE, PixelAsked, Pointer, RightClicked, STILL};
use crate::inspect::{Question, Stands};
use crate::scene::SceneId;
use crate::sync::Traced;
use crate::trace;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::{Or, With};
use bevy::ecs::world::World;
use bevy::math::{Rect, Vec2};
use bevy::mesh::Mesh3d;
use std::sync::Arc;
use std::time::Instant;

pub(super) fn click(world: &mut World, at: Vec2) {
    if click_line(world, at) {
        // Two clicks on two things are no double click.
        world.resource_mut::<Pointer>().last_click = None;
        return;
    }
    let found = pick::at(world, at).map(|found| found.id);
    let pointer = world.resource::<Pointer>();
    let adds = pointer.inbox.modifiers.ctrl;
    let now = Instant::now();
    let again = pointer.last_click.is_some_and(|(when, place)| {
        now.duration_since(when) <= DOUBLE && place.distance(at) <= STILL
    });
    world.resource_mut::<Pointer>().last_click = (!again).then_some((now, at));
    if again && !adds {
        if found.is_some() {
            world.write_message(Action::run("view.frame-selected"));
        }
        return;
    }
    let mut wanted = world.resource::<Selection>().clone();
    match (found, adds) {
        (Some(id), true) => wanted.toggle(id),
        (Some(id), false) => wanted.set([id]),
        (None, true) => {}
        (None, false) => wanted.set([]),
    }
    world.resource_mut::<Selection>().set_if_neq(wanted);
}

/// The click that a command waited for.
pub(super) fn answer_target(world: &mut World, at: Vec2) {
    match std::mem::take(&mut *world.resource_mut::<Armed>()) {
        Armed::No => {}
        Armed::Why(question) => {
            let offset = world.resource::<Pointer>().offset;
            ask_pixel(world, question, at + offset);
        }
        Armed::Aim => handles::aim(world, at),
        Armed::Focus => handles::focus(world, at),
    }
}

/// Asks this of the pixel there, in either of two views.
pub(in super::super) fn ask_pixel(world: &mut World, question: Question, in_window: Vec2) {
    let offset = world.resource::<Viewport>().offset(in_window);
    if !shoot_at(world, in_window - offset) {
        return;
    }
    if question != Question::Black {
        world.resource_mut::<DebugRay>().which = Which::All;
    }
    let at = in_window;
    world.trigger(PixelAsked { question, at });
}

/// Chooses what is there, as a click does, and has its menu opened.
pub(super) fn right_click(world: &mut World, at: Vec2) {
    let over = match line_under(world, at) {
        Some((stands @ (Stands::Ray(_) | Stands::Node { .. }), of)) => {
            world.resource_mut::<Inspected>().click(stands, &of);
            match stands {
                Stands::Ray(_) => Over::Ray,
                _ => Over::Box,
            }
        }
        _ => match pick::at(world, at) {
            Some(found) => {
                if !world.resource::<Selection>().contains(found.id) {
                    world.resource_mut::<Selection>().set([found.id]);
                }
                Over::Entity
            }
            None => Over::Nothing,
        },
    };
    let at = at + world.resource::<Pointer>().offset;
    world.trigger(RightClicked { at, over });
}

/// Whether the click is for a line that shows what the tracer did.
fn click_line(world: &mut World, at: Vec2) -> bool {
    let Some((stands, of)) = line_under(world, at) else {
        return false;
    };
    world.resource_mut::<Inspected>().click(stands, &of)
}

/// The line there, in the view that the pointer is in, and the world that it is about.
fn line_under(world: &mut World, at: Vec2) -> Option<(Stands, Arc<trace::World>)> {
    let side = usize::from(world.resource::<Pointer>().offset != Vec2::ZERO);
    let (stands, system) = line_at(world, at, side)?;
    let traced = &world.resource::<Traced>().world;
    let pair = world.get_resource::<TreePair>();
    let of = pair.map_or(traced, |pair| pair.meant(side, system, traced));
    Some((stands, of.clone()))
}

/// Selects the objects, lights and cameras whose middle is seen in the box.
pub(super) fn select_box(world: &mut World, from: Vec2, to: Vec2) {
    let area = Rect::from_corners(from, to);
    let mut all = world.query_filtered::<(Entity, &SceneId), Or<(With<Mesh3d>, pick::Symbol)>>();
    let all: Vec<(Entity, SceneId)> = all.iter(world).map(|(e, id)| (e, *id)).collect();
    let Some((camera, view)) = pick::camera(world) else {
        return;
    };
    let seen = |entity: Entity| {
        let middle = own_extent(world.get_entity(entity).ok()?)?.centre();
        camera.world_to_viewport(&view, middle).ok()
    };
    let mut inside: Vec<SceneId> = all
        .iter()
        .filter(|(entity, _)| pick::is_shown(world, *entity))
        .filter(|(entity, _)| seen(*entity).is_some_and(|at| area.contains(at)))
        .map(|(_, id)| *id)
        .collect();
    inside.sort_unstable();
    let mut wanted = world.resource::<Selection>().clone();
    if world.resource::<Pointer>().inbox.modifiers.ctrl {
        wanted.add(inside);
    } else {
        wanted.set(inside);
    }
    world.resource_mut::<Selection>().set_if_neq(wanted);
}
