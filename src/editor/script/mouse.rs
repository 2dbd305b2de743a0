//! What the window would send of a mouse.

use super::step::Button;
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::input::ButtonState;
use bevy::input::mouse::{MouseButton, MouseButtonInput, MouseScrollUnit, MouseWheel};
use bevy::input::touch::TouchPhase;
use bevy::math::Vec2;
use bevy::window::{CursorMoved, Window, WindowEvent};

/// Moves the pointer from one place of the window to another, in logical pixels.
pub(super) fn move_pointer(world: &mut World, window: Entity, from: Vec2, to: Vec2) {
    if let Some(mut window) = world.get_mut::<Window>(window) {
        let physical = (to * window.scale_factor()).as_dvec2();
        window.set_physical_cursor_position(Some(physical));
    }
    let moved = CursorMoved {
        window,
        position: to,
        delta: Some(to - from),
    };
    world.write_message(moved.clone());
    world.write_message(WindowEvent::CursorMoved(moved));
}

/// Presses or releases a button where the pointer is.
pub(super) fn press(world: &mut World, window: Entity, button: Button, state: ButtonState) {
    let button = match button {
        Button::Left => MouseButton::Left,
        Button::Middle => MouseButton::Middle,
        Button::Right => MouseButton::Right,
    };
    let input = MouseButtonInput {
        button,
        state,
        window,
    };
    world.write_message(input);
    world.write_message(WindowEvent::MouseButtonInput(input));
}

/// Turns the wheel; up is positive.
pub(super) fn turn_wheel(world: &mut World, window: Entity, notches: f32) {
    let wheel = MouseWheel {
        unit: MouseScrollUnit::Line,
        x: 0.0,
        y: notches,
        window,
        phase: TouchPhase::Moved,
    };
    world.write_message(wheel);
    world.write_message(WindowEvent::MouseWheel(wheel));
}
