//! The window's events, event by event, and which modifiers are held by them.

use bevy::ecs::message::{MessageCursor, Messages};
use bevy::input::keyboard::KeyCode;
use bevy::input::{ButtonInput, ButtonState};
use bevy::window::WindowEvent;

/// Which modifier keys are held, by the window's events in their order: a key and its modifier may
/// come and go within one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::editor) struct Modifiers {
    pub ctrl: bool,
    pub shift: bool,
    pub alt: bool,
}

impl Modifiers {
    /// Those of the keys that are held.
    fn of(held: &ButtonInput<KeyCode>) -> Self {
        use KeyCode::{
            AltLeft, AltRight, ControlLeft, ControlRight, ShiftLeft, ShiftRight, SuperLeft,
            SuperRight,
        };
        let is_mac = cfg!(target_os = "macos");
        Self {
            ctrl: held.any_pressed([ControlLeft, ControlRight])
                || is_mac && held.any_pressed([SuperLeft, SuperRight]),
            shift: held.any_pressed([ShiftLeft, ShiftRight]),
            alt: held.any_pressed([AltLeft, AltRight]),
        }
    }

    /// Takes an event into account.
    pub fn read(&mut self, event: &WindowEvent) {
        match event {
            WindowEvent::KeyboardInput(input) => {
                let pressed = input.state == ButtonState::Pressed;
                match input.key_code {
                    KeyCode::ControlLeft | KeyCode::ControlRight => self.ctrl = pressed,
                    KeyCode::SuperLeft | KeyCode::SuperRight if cfg!(target_os = "macos") => {
                        self.ctrl = pressed;
                    }
                    KeyCode::ShiftLeft | KeyCode::ShiftRight => self.shift = pressed,
                    KeyCode::AltLeft | KeyCode::AltRight => self.alt = pressed,
                    _ => {}
                }
            }
            WindowEvent::KeyboardFocusLost(_) => *self = Self::default(),
            WindowEvent::WindowFocused(focus) if !focus.focused => *self = Self::default(),
            _ => {}
        }
    }
}

/// What came of the window, for one who goes through it event by event.
#[derive(Default)]
pub(in crate::editor) struct Inbox {
    cursor: MessageCursor<WindowEvent>,
    /// By the events that were gone through.
    pub modifiers: Modifiers,
}

impl Inbox {
    /// What came since.
    pub fn take(&mut self, messages: &Messages<WindowEvent>) -> Vec<WindowEvent> {
        self.cursor.read(messages).cloned().collect()
    }

    /// What came so far was for others. Which keys are held by now, Bevy knows.
    pub fn skip(&mut self, messages: &Messages<WindowEvent>, held: Option<&ButtonInput<KeyCode>>) {
        self.cursor.clear(messages);
        self.modifiers = held.map_or_else(Modifiers::default, Modifiers::of);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::ecs::entity::Entity;
    use bevy::input::keyboard::{Key, KeyboardFocusLost, KeyboardInput};

    #[test]
    fn modifiers_are_forgotten_with_the_keyboards_focus() {
        let mut modifiers = Modifiers::default();
        let ctrl = KeyboardInput {
            key_code: KeyCode::ControlLeft,
            logical_key: Key::Control,
            state: ButtonState::Pressed,
            text: None,
            repeat: false,
            window: Entity::PLACEHOLDER,
        };
        modifiers.read(&WindowEvent::KeyboardInput(ctrl));
        assert!(modifiers.ctrl);
        modifiers.read(&WindowEvent::KeyboardFocusLost(KeyboardFocusLost));
        assert_eq!(modifiers, Modifiers::default());
    }
}
