//! Moving the view by hand: drags, the wheel, and flying.

use super::super::pick;
use super::super::pointer::PointerUse;
use super::super::viewport::Viewport;
use super::{Eye, LookThrough, aspect, move_view};
use crate::editor::edits;
use crate::editor::history::Gesture;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::input::ButtonInput;
use bevy::input::keyboard::KeyCode;
use bevy::math::{Vec2, Vec3};
use bevy::time::Time;

/// How much nearer one notch of the wheel goes.
const NOTCH: f32 = 0.85;
/// How much faster Shift flies.
const FAST: f32 = 4.0;

/// How fast flying is, as a factor: the wheel changes it while flying.
#[derive(Resource)]
pub(super) struct FlySpeed(f32);

impl Default for FlySpeed {
    fn default() -> Self {
        Self(1.0)
    }
}

/// What is done with the view when it is dragged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::editor) enum ViewDrag {
    /// Around the pivot.
    Orbit,
    /// Sideways.
    Pan,
    /// Nearer and further.
    Dolly,
    /// Looking around; keys fly.
    Fly,
}

/// A drag of the view begins.
pub(in crate::editor) fn begin_drag(world: &mut World) {
    begin_gesture(world);
    // The view turns around what is in its middle.
    let ahead = {
        let eye = world.resource::<Eye>();
        (eye.position(), eye.forward(), eye.orthographic)
    };
    let free = world.resource::<LookThrough>().camera.is_none();
    if let (true, (from, forward, false)) = (free, ahead)
        && let Some(hit) = pick::along(world, from, forward)
    {
        let distance = (hit - from).dot(forward);
        let mut eye = world.resource_mut::<Eye>();
        if distance > 1e-3 * eye.distance && distance < 1e3 * eye.distance {
            eye.pivot = from + forward * distance;
            eye.distance = distance;
        }
    }
}

/// A locked camera's drag is one step.
pub(super) fn begin_gesture(world: &mut World) {
    let through = world.resource::<LookThrough>();
    let (Some(id), false) = (through.camera.filter(|_| through.locked), through.drags) else {
        return;
    };
    if world.resource::<Gesture>().active() {
        return;
    }
    let name = edits::name_of(world, id);
    world
        .resource_mut::<Gesture>()
        .begin(format!("Move {name}"));
    world.resource_mut::<LookThrough>().drags = true;
}

/// The drag is over.
pub(in crate::editor) fn end_gesture(world: &mut World) {
    if world.resource::<LookThrough>().drags {
        world.resource_mut::<LookThrough>().drags = false;
        world.resource_mut::<Gesture>().end();
    }
}

/// The pointer went on by `delta`, in logical pixels.
pub(in crate::editor) fn drag(world: &mut World, kind: ViewDrag, delta: Vec2) {
    let height = world.resource::<Viewport>().rect.height().max(1.0);
    let delta = delta / height;
    move_view(world, |eye| match kind {
        ViewDrag::Orbit => eye.orbit(delta),
        ViewDrag::Pan => eye.pan(delta),
        ViewDrag::Dolly => {
            let pivot = eye.pivot;
            eye.zoom((2.0 * delta.y).exp(), pivot);
        }
        ViewDrag::Fly => eye.look(delta),
    });
}

/// The wheel was turned by so many notches over this place of the window.
pub(in crate::editor) fn wheel(world: &mut World, at: Vec2, notches: f32) {
    if matches!(
        world.resource::<PointerUse>(),
        PointerUse::View(ViewDrag::Fly)
    ) {
        let mut speed = world.resource_mut::<FlySpeed>();
        speed.0 = (speed.0 * NOTCH.powf(-notches)).clamp(0.01, 100.0);
        return;
    }
    let place = world.resource::<Viewport>().place(at);
    let ndc = Vec2::new(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y);
    let aspect = aspect(world);
    let hit = pick::at(world, at).map(|picked| picked.point);
    let dragging = world.resource::<LookThrough>().drags;
    begin_gesture(world);
    move_view(world, |eye| {
        let toward = hit.unwrap_or_else(|| eye.on_pivot_plane(ndc, aspect));
        eye.zoom(NOTCH.powf(notches), toward);
    });
    if !dragging {
        end_gesture(world);
    }
}

/// Flies while the right button is held.
pub(super) fn fly(world: &mut World) {
    if !matches!(
        world.resource::<PointerUse>(),
        PointerUse::View(ViewDrag::Fly)
    ) {
        return;
    }
    let keys = world.resource::<ButtonInput<KeyCode>>();
    let pressed = |key| f32::from(u8::from(keys.pressed(key)));
    let direction = Vec3::new(
        pressed(KeyCode::KeyD) - pressed(KeyCode::KeyA),
        pressed(KeyCode::KeyE) - pressed(KeyCode::KeyQ),
        pressed(KeyCode::KeyS) - pressed(KeyCode::KeyW),
    );
    if direction == Vec3::ZERO {
        return;
    }
    let fast = keys.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight]);
    let seconds = world.resource::<Time>().delta_secs().min(0.1);
    let factor = world.resource::<FlySpeed>().0 * if fast { FAST } else { 1.0 };
    move_view(world, |eye| {
        let step = direction.normalize() * eye.distance * factor * seconds;
        eye.fly(step);
    });
}
