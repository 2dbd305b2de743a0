//! The pointer over the scene: what a press takes hold of, selecting by clicks and by boxes, and
//! the drags that move the view.
//!
//! The window's events are read one after the other, as they came, so that a press, a movement and
//! a release within one frame mean what they meant.

use super::action::Action;
use super::extent::own_extent;
use super::handles::{self, GripDrag, grip_at};
use super::inspection::Inspected;
use super::inspection::hover::line_at;
use super::keys::Modifiers;
use super::navigation::{self, LookThrough, ViewDrag};
use super::pick;
use super::schedule::EditorUpdate;
use super::selection::Selection;
use super::viewport::Viewport;
use crate::scene::SceneId;
use crate::sync::Traced;
use crate::view::{Outlined, Symbols};
use bevy::app::{App, Plugin};
use bevy::ecs::entity::Entity;
use bevy::ecs::message::{MessageCursor, Messages};
use bevy::ecs::query::{Or, With};
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::{Local, Res, ResMut};
use bevy::ecs::world::World;
use bevy::gizmos::transform_gizmo::TransformGizmoState;
use bevy::input::ButtonState;
use bevy::input::mouse::{MouseButton, MouseScrollUnit};
use bevy::math::{Rect, Vec2};
use bevy::mesh::Mesh3d;
use bevy::window::WindowEvent;
use bevy_egui::{EguiPrimaryContextPass, egui};
use std::time::{Duration, Instant};

/// How far a click may move, in logical pixels.
const STILL: f32 = 4.0;
/// How long after a click another one makes it a double click.
const DOUBLE: Duration = Duration::from_millis(400);
/// Pixels of a touch pad's scrolling that are one notch of a wheel.
const PIXELS_PER_NOTCH: f32 = 50.0;

/// Reads the pointer.
pub(super) struct PointerPlugin;

impl Plugin for PointerPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PointerUse>()
            .init_resource::<Pointer>()
            .add_systems(EditorUpdate, (use_pointer, outline_selection).chain())
            .add_systems(EguiPrimaryContextPass, draw_box);
    }
}

/// What the pointer is being used for, from a press to its release.
#[derive(Resource, Debug, Default)]
pub(super) enum PointerUse {
    #[default]
    Free,
    /// The view is moved.
    View(ViewDrag),
    /// Bevy's gizmo is dragged.
    Gizmo,
    /// A point of a light is dragged.
    Grip(GripDrag),
    /// A click, as long as it does not move.
    Click { at: Vec2 },
    /// With Alt: as long as it does not move it is a debug ray, and then turns the view.
    Ray { at: Vec2 },
    /// A box is drawn around what shall be selected.
    Box { from: Vec2, to: Vec2 },
}

#[derive(Resource, Default)]
struct Pointer {
    at: Option<Vec2>,
    held: Option<MouseButton>,
    modifiers: Modifiers,
    last_click: Option<(Instant, Vec2)>,
}

/// Goes through what happened in the window since the last frame.
pub(super) fn use_pointer(world: &mut World, mut cursor: Local<MessageCursor<WindowEvent>>) {
    let messages = world.resource::<Messages<WindowEvent>>();
    let events: Vec<WindowEvent> = cursor.read(messages).cloned().collect();
    for event in events {
        world.resource_mut::<Pointer>().modifiers.read(&event);
        match event {
            WindowEvent::CursorMoved(moved) => go(world, moved.position),
            WindowEvent::MouseButtonInput(input) => match input.state {
                ButtonState::Pressed => press(world, input.button),
                ButtonState::Released => release(world, input.button),
            },
            WindowEvent::MouseWheel(wheel) => {
                let notches = match wheel.unit {
                    MouseScrollUnit::Line => wheel.y,
                    MouseScrollUnit::Pixel => wheel.y / PIXELS_PER_NOTCH,
                };
                turn_wheel(world, notches);
            }
            WindowEvent::WindowFocused(focus) if !focus.focused => let_go(world),
            _ => {}
        }
    }
}

fn take_use(world: &mut World) -> PointerUse {
    std::mem::take(&mut *world.resource_mut::<PointerUse>())
}

fn go(world: &mut World, to: Vec2) {
    let Some(from) = world.resource_mut::<Pointer>().at.replace(to) else {
        return;
    };
    let next = match take_use(world) {
        PointerUse::View(kind) => {
            navigation::drag(world, kind, to - from);
            PointerUse::View(kind)
        }
        PointerUse::Grip(mut drag) => {
            drag.follow(world, to);
            PointerUse::Grip(drag)
        }
        PointerUse::Click { at } if at.distance(to) > STILL => PointerUse::Box { from: at, to },
        PointerUse::Ray { at } if at.distance(to) > STILL => {
            navigation::begin_drag(world);
            navigation::drag(world, ViewDrag::Orbit, to - at);
            PointerUse::View(ViewDrag::Orbit)
        }
        PointerUse::Box { from, .. } => PointerUse::Box { from, to },
        other => other,
    };
    *world.resource_mut::<PointerUse>() = next;
}

fn press(world: &mut World, button: MouseButton) {
    let (at, modifiers) = {
        let pointer = world.resource::<Pointer>();
        (pointer.at, pointer.modifiers)
    };
    let Some(at) = at else {
        return;
    };
    if !matches!(world.resource::<PointerUse>(), PointerUse::Free) || !is_over_scene(world, at) {
        return;
    }
    let drag = match button {
        MouseButton::Right => Some(ViewDrag::Fly),
        MouseButton::Middle | MouseButton::Left
            if button == MouseButton::Middle || modifiers.alt =>
        {
            Some(match (modifiers.shift, modifiers.ctrl) {
                (true, _) => ViewDrag::Pan,
                (false, true) => ViewDrag::Dolly,
                (false, false) => ViewDrag::Orbit,
            })
        }
        _ => None,
    };
    let next = if button == MouseButton::Left && drag == Some(ViewDrag::Orbit) {
        PointerUse::Ray { at }
    } else if let Some(drag) = drag {
        navigation::begin_drag(world);
        PointerUse::View(drag)
    } else if button == MouseButton::Left {
        take_hold(world, at)
    } else {
        return;
    };
    world.resource_mut::<Pointer>().held = Some(button);
    *world.resource_mut::<PointerUse>() = next;
}

/// What the left button takes hold of there.
fn take_hold(world: &mut World, at: Vec2) -> PointerUse {
    if let Some(grip) = grip_at(world, at)
        && let Some(drag) = GripDrag::begin(world, grip, at)
    {
        return PointerUse::Grip(drag);
    }
    let gizmo = world.resource::<TransformGizmoState>();
    if gizmo.active || gizmo.hovered_axis.is_some() {
        return PointerUse::Gizmo;
    }
    PointerUse::Click { at }
}

fn release(world: &mut World, button: MouseButton) {
    if world.resource::<Pointer>().held != Some(button) {
        return;
    }
    world.resource_mut::<Pointer>().held = None;
    match take_use(world) {
        PointerUse::Free | PointerUse::Gizmo => {}
        PointerUse::View(_) => navigation::end_drag(world),
        PointerUse::Grip(drag) => drag.end(world),
        PointerUse::Click { at } => click(world, at),
        PointerUse::Ray { .. } => {
            world.write_message(Action::ShootRay);
        }
        PointerUse::Box { from, to } => select_box(world, from, to),
    }
}

/// Ends what is going on, as where the window loses the keyboard and with it the release.
fn let_go(world: &mut World) {
    if let Some(button) = world.resource::<Pointer>().held {
        let is_click = matches!(
            world.resource::<PointerUse>(),
            PointerUse::Click { .. } | PointerUse::Ray { .. }
        );
        if is_click {
            take_use(world);
        }
        release(world, button);
    }
}

/// Takes back what is being dragged. `false` where nothing is.
pub(super) fn cancel(world: &mut World) -> bool {
    match take_use(world) {
        PointerUse::Grip(drag) => {
            drag.cancel(world);
            true
        }
        PointerUse::Gizmo => handles::cancel(world),
        PointerUse::Box { .. } => true,
        PointerUse::View(kind) => {
            *world.resource_mut::<PointerUse>() = PointerUse::View(kind);
            false
        }
        PointerUse::Free | PointerUse::Click { .. } | PointerUse::Ray { .. } => false,
    }
}

fn turn_wheel(world: &mut World, notches: f32) {
    let Some(at) = world.resource::<Pointer>().at else {
        return;
    };
    let flying = matches!(
        world.resource::<PointerUse>(),
        PointerUse::View(ViewDrag::Fly)
    );
    if notches != 0.0 && (flying || is_over_scene(world, at)) {
        if world.resource::<Pointer>().modifiers.ctrl && !flying {
            navigation::widen(world, notches);
        } else {
            navigation::wheel(world, at, notches);
        }
    }
}

/// Whether a place of the window shows the scene: no panel, menu or popup lies over it, and egui is
/// not using the pointer.
fn is_over_scene(world: &mut World, at: Vec2) -> bool {
    let viewport = world.resource::<Viewport>();
    let (rect, hovered) = (viewport.rect, viewport.hovered);
    if !rect.contains(at) {
        return false;
    }
    let Some(context) = pick::egui_context(world) else {
        return true;
    };
    let place = pick::to_points(&context, at);
    // The panels' answer is that of the last frame, and of where the pointer was then.
    let last = context.pointer_latest_pos();
    let asked_there = last.is_some_and(|last| last.distance(place) < 1.0);
    if asked_there && !hovered {
        return false;
    }
    let layer = context.layer_id_at(place);
    layer.is_none_or(|layer| layer.order == egui::Order::Background)
        && !context.egui_is_using_pointer()
}

fn click(world: &mut World, at: Vec2) {
    if click_line(world, at) {
        // Two clicks on two things are no double click.
        world.resource_mut::<Pointer>().last_click = None;
        return;
    }
    let found = pick::at(world, at).map(|found| found.id);
    let pointer = world.resource::<Pointer>();
    let adds = pointer.modifiers.ctrl;
    let now = Instant::now();
    let again = pointer.last_click.is_some_and(|(when, place)| {
        now.duration_since(when) <= DOUBLE && place.distance(at) <= STILL
    });
    world.resource_mut::<Pointer>().last_click = (!again).then_some((now, at));
    if again && !adds {
        if found.is_some() {
            world.write_message(Action::FrameSelected);
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
    select(world, wanted);
}

/// Whether the click is for a line that shows what the tracer did.
fn click_line(world: &mut World, at: Vec2) -> bool {
    let Some((stands, _)) = line_at(world, at) else {
        return false;
    };
    let traced = world.resource::<Traced>().world.clone();
    world.resource_mut::<Inspected>().click(stands, &traced)
}

fn select(world: &mut World, wanted: Selection) {
    if *world.resource::<Selection>() != wanted {
        *world.resource_mut::<Selection>() = wanted;
    }
}

/// Selects the objects, lights and cameras whose middle is seen in the box.
fn select_box(world: &mut World, from: Vec2, to: Vec2) {
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
    if world.resource::<Pointer>().modifiers.ctrl {
        for id in inside {
            wanted.add(id);
        }
    } else {
        wanted.set(inside);
    }
    select(world, wanted);
}

/// What is selected is outlined; a camera that is looked through is not drawn.
fn outline_selection(
    selection: Res<Selection>,
    through: Res<LookThrough>,
    mut outlined: ResMut<Outlined>,
    mut symbols: ResMut<Symbols>,
) {
    if outlined.0 != selection.ids() {
        outlined.0 = selection.ids().to_vec();
    }
    if symbols.hidden_camera != through.camera {
        symbols.hidden_camera = through.camera;
    }
}

fn draw_box(world: &mut World) {
    let PointerUse::Box { from, to } = *world.resource::<PointerUse>() else {
        return;
    };
    let Some(context) = pick::egui_context(world) else {
        return;
    };
    let viewport = world.resource::<Viewport>().rect;
    let rect = |rect: Rect| {
        let [min, max] = [rect.min, rect.max].map(|place| pick::to_points(&context, place));
        egui::Rect::from_min_max(min, max)
    };
    let color = egui::Color32::from_rgb(255, 190, 60);
    context
        .layer_painter(egui::LayerId::background())
        .with_clip_rect(rect(viewport))
        .rect(
            rect(Rect::from_corners(from, to)),
            0.0,
            color.gamma_multiply(0.12),
            egui::Stroke::new(1.0, color),
            egui::StrokeKind::Inside,
        );
}
