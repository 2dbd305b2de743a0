//! The pointer over the scene: what a press takes hold of, selecting by clicks and by boxes, and
//! the drags that move the view.
//!
//! The window's events are read one after the other, as they came, so that a press, a movement and
//! a release within one frame mean what they meant.

mod clicks;
mod drawn;

pub(super) use clicks::ask_pixel;

use super::action::Action;
use super::command::Over;
use super::document::SceneOpened;
use super::embed::Switched;
use super::handles::{self, GripDrag, grip_at};
use super::keys::Inbox;
use super::navigation::{self, Eye, ViewDrag};
use super::pick;
use super::schedule::{Dispatch, EditorUpdate};
use super::viewport::{RegionDrag, Viewport};
use crate::inspect::Question;
use bevy::app::{App, Plugin};
use bevy::ecs::event::Event;
use bevy::ecs::message::Messages;
use bevy::ecs::observer::On;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::{Commands, Query, Res, ResMut};
use bevy::ecs::world::{Mut, World};
use bevy::input::keyboard::KeyCode;
use bevy::input::mouse::{MouseButton, MouseScrollUnit};
use bevy::input::{ButtonInput, ButtonState};
use bevy::math::{Vec2, Vec3};
use bevy::window::{PrimaryWindow, Window, WindowEvent};
use bevy_egui::{EguiPrimaryContextPass, egui};
use clicks::{answer_target, click, right_click, select_box};
use drawn::{draw_box, outline_selection};
use std::time::{Duration, Instant};

/// How far a click may move, in logical pixels.
const STILL: f32 = 4.0;
/// How far a view that stays may have come from where it stood, in its distances from what it looks at: rounding.
const STAYS: f32 = 1e-4;
/// How long after a click another one makes it a double click.
const DOUBLE: Duration = Duration::from_millis(400);
/// Pixels of a touch pad's scrolling that are one notch of a wheel.
const PIXELS_PER_NOTCH: f32 = 50.0;

/// Reads the pointer.
pub(super) struct PointerPlugin;

impl Plugin for PointerPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PointerUse>()
            .init_resource::<Armed>()
            .add_observer(disarm)
            .init_resource::<Pointer>()
            .add_observer(take_over)
            .add_systems(
                EditorUpdate,
                (
                    use_pointer.before(Dispatch),
                    outline_selection.after(Dispatch),
                ),
            )
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
    /// A click on what a command waits for.
    Target { at: Vec2 },
    /// A box is drawn around what shall be selected.
    Box { from: Vec2, to: Vec2 },
}

/// A command waits for a click in the view. Escape ends that.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Armed {
    #[default]
    No,
    /// Of which pixel this is asked.
    Why(Question),
    /// What the selected lights and cameras shall look at.
    Aim,
    /// What the selected cameras shall see sharp.
    Focus,
}

/// From now on the next click in the view is for this, and for nothing that was waited for before.
pub(super) fn arm(world: &mut World, armed: Armed) {
    if let Some(mut region) = world.get_resource_mut::<RegionDrag>() {
        region.cancel();
    }
    if let Some(mut now) = world.get_resource_mut::<Armed>() {
        *now = armed;
    }
}

/// Nobody clicks in another scene what was asked about this one.
fn disarm(_: On<SceneOpened>, mut commands: Commands) {
    commands.queue(|world: &mut World| arm(world, Armed::No));
}

/// Something was asked of the pixel there; its rays are being traced.
#[derive(Event, Clone, Copy, Debug)]
pub(super) struct PixelAsked {
    pub question: Question,
    /// Logical pixels of the window.
    pub at: Vec2,
}

/// The right button was clicked over the scene, which otherwise flies the view.
#[derive(Event, Clone, Copy, Debug)]
pub(super) struct RightClicked {
    /// Logical pixels of the window.
    pub at: Vec2,
    pub over: Over,
}

/// A press that may become a click.
#[derive(Clone, Copy, Debug)]
struct Press {
    at: Vec2,
    /// Where the view stood; a hand that trembles turns it a little, keys fly it away.
    eye: Option<Vec3>,
}

impl Press {
    fn of(world: &World, at: Vec2) -> Self {
        let eye = world.get_resource::<Eye>().map(Eye::position);
        Self { at, eye }
    }

    /// Whether the view stands where it stood. How long that was says nothing: where frames are slow, the shortest press
    /// takes a second.
    fn has_stayed(&self, world: &World) -> bool {
        let moved = |eye: &Eye| Some(eye.position().distance(self.eye?) > STAYS * eye.distance);
        !world.get_resource::<Eye>().and_then(moved).unwrap_or(false)
    }
}

#[derive(Resource, Default)]
struct Pointer {
    /// In logical pixels of the window; over the second of two views, where the first one shows the same.
    at: Option<Vec2>,
    /// From there to where it is. It stays from a press to its release.
    offset: Vec2,
    held: Option<MouseButton>,
    /// How it was pressed, while nothing was done with it since.
    pressed: Option<Press>,
    inbox: Inbox,
    last_click: Option<(Instant, Vec2)>,
}

/// Goes through what happened in the window since the last frame.
pub(super) fn use_pointer(world: &mut World) {
    let events = world
        .resource_scope(|world, mut pointer: Mut<Pointer>| pointer.inbox.take(world.resource()));
    for event in events {
        let mut pointer = world.resource_mut::<Pointer>();
        pointer.inbox.modifiers.read(&event);
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

/// The pointer was not heard while the editor was off: what it held then is let go, and where it is, the window knows.
fn take_over(
    switched: On<Switched>,
    messages: Res<Messages<WindowEvent>>,
    held: Option<Res<ButtonInput<KeyCode>>>,
    windows: Query<&Window, With<PrimaryWindow>>,
    mut pointer: ResMut<Pointer>,
    mut commands: Commands,
) {
    pointer.inbox.skip(&messages, held.as_deref());
    if !switched.on {
        commands.queue(let_go);
        return;
    }
    pointer.at = None;
    let at = windows.single().ok().and_then(Window::cursor_position);
    if let Some(at) = at {
        commands.queue(move |world: &mut World| go(world, at));
    }
}

fn take_use(world: &mut World) -> PointerUse {
    std::mem::take(&mut *world.resource_mut::<PointerUse>())
}

fn go(world: &mut World, to: Vec2) {
    let here = world.resource::<Viewport>().offset(to);
    let mut pointer = world.resource_mut::<Pointer>();
    if pointer.held.is_none() {
        pointer.offset = here;
    }
    let to = to - pointer.offset;
    pointer.pressed = pointer
        .pressed
        .filter(|press| press.at.distance(to) <= STILL);
    let Some(from) = pointer.at.replace(to) else {
        return;
    };
    let next = match take_use(world) {
        PointerUse::View(kind) => {
            navigation::drag(world, kind, to - from);
            PointerUse::View(kind)
        }
        PointerUse::Grip(mut drag) => {
            let modifiers = world.resource::<Pointer>().inbox.modifiers;
            drag.follow(world, to, modifiers);
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
    handles::forget_keyed(world);
    let (at, modifiers) = {
        let pointer = world.resource::<Pointer>();
        (pointer.at, pointer.inbox.modifiers)
    };
    let Some(at) = at else {
        return;
    };
    if !matches!(world.resource::<PointerUse>(), PointerUse::Free) || !is_over_scene(world, at) {
        return;
    }
    // Alt is also a way of dragging a light's corner.
    let alt = modifiers.alt && grip_at(world, at).is_none();
    let drag = match button {
        MouseButton::Right => Some(ViewDrag::Fly),
        MouseButton::Middle | MouseButton::Left if button == MouseButton::Middle || alt => {
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
    let press = Press::of(world, at);
    let mut pointer = world.resource_mut::<Pointer>();
    pointer.held = Some(button);
    pointer.pressed = Some(press);
    *world.resource_mut::<PointerUse>() = next;
}

/// What the left button takes hold of there.
fn take_hold(world: &mut World, at: Vec2) -> PointerUse {
    if *world.resource::<Armed>() != Armed::No {
        return PointerUse::Target { at };
    }
    if world.resource::<Pointer>().offset != Vec2::ZERO {
        // Handles are drawn over the first view alone.
        return PointerUse::Click { at };
    }
    if let Some(grip) = grip_at(world, at)
        && let Some(drag) = GripDrag::begin(world, grip, at)
    {
        return PointerUse::Grip(drag);
    }
    if handles::take_hold(world, at) {
        return PointerUse::Gizmo;
    }
    PointerUse::Click { at }
}

fn release(world: &mut World, button: MouseButton) {
    if world.resource::<Pointer>().held != Some(button) {
        return;
    }
    let mut pointer = world.resource_mut::<Pointer>();
    pointer.held = None;
    let pressed = pointer.pressed.take();
    match take_use(world) {
        PointerUse::Free | PointerUse::Gizmo => {}
        PointerUse::View(kind) => {
            navigation::end_gesture(world);
            // A press that moved nothing is a click.
            if let (ViewDrag::Fly, Some(press)) = (kind, pressed)
                && press.has_stayed(world)
            {
                right_click(world, press.at);
            }
        }
        PointerUse::Grip(drag) => drag.end(world),
        PointerUse::Click { at } => click(world, at),
        PointerUse::Target { at } => answer_target(world, at),
        PointerUse::Ray { .. } => {
            world.write_message(Action::run("rays.shoot"));
        }
        PointerUse::Box { from, to } => select_box(world, from, to),
    }
}

/// Ends what is going on, as where the window loses the keyboard and with it the release: none was a click.
fn let_go(world: &mut World) {
    world.resource_mut::<Pointer>().pressed = None;
    if let Some(button) = world.resource::<Pointer>().held {
        let is_click = matches!(
            world.resource::<PointerUse>(),
            PointerUse::Click { .. } | PointerUse::Ray { .. } | PointerUse::Target { .. }
        );
        if is_click {
            take_use(world);
        }
        release(world, button);
    }
}

/// Takes back what is being dragged. `false` where nothing is.
pub(super) fn cancel(world: &mut World) -> bool {
    if world.resource_mut::<RegionDrag>().cancel() {
        return true;
    }
    if std::mem::take(&mut *world.resource_mut::<Armed>()) != Armed::No {
        take_use(world);
        return true;
    }
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
        PointerUse::Free
        | PointerUse::Click { .. }
        | PointerUse::Ray { .. }
        | PointerUse::Target { .. } => false,
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
        world.resource_mut::<Pointer>().pressed = None;
        if world.resource::<Pointer>().inbox.modifiers.ctrl && !flying {
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
    let offset = world.resource::<Pointer>().offset;
    let place = pick::to_points(&context, at + offset);
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

#[cfg(test)]
mod tests;
