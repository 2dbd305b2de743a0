//! Keys: the table of actions says what each does.

use super::action::{ACTIONS, Action, Keys};
use super::pointer::{self, PointerUse};
use super::schedule::EditorUpdate;
use super::viewport::Viewport;
use bevy::app::{App, Plugin};
use bevy::ecs::message::{MessageCursor, Messages};
use bevy::ecs::system::Local;
use bevy::ecs::world::World;
use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyCode, KeyboardInput};
use bevy::prelude::IntoScheduleConfigs;
use bevy::window::WindowEvent;

/// Turns keys into actions.
pub(super) struct KeysPlugin;

impl Plugin for KeysPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(EditorUpdate, press_keys.before(pointer::use_pointer));
    }
}

/// Which modifier keys are held, by the window's events in their order: a key and its modifier may
/// come and go within one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Modifiers {
    pub ctrl: bool,
    pub shift: bool,
    pub alt: bool,
}

impl Modifiers {
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

fn press_keys(
    world: &mut World,
    mut cursor: Local<MessageCursor<WindowEvent>>,
    mut modifiers: Local<Modifiers>,
) {
    let messages = world.resource::<Messages<WindowEvent>>();
    let events: Vec<WindowEvent> = cursor.read(messages).cloned().collect();
    for event in events {
        modifiers.read(&event);
        let WindowEvent::KeyboardInput(input) = event else {
            continue;
        };
        if input.state != ButtonState::Pressed
            || modifiers.alt
            || !world.resource::<Viewport>().takes_keys
        {
            continue;
        }
        let keys = Keys {
            ctrl: modifiers.ctrl,
            shift: modifiers.shift,
            key: meant_key(&input),
        };
        press(world, keys, input.repeat);
    }
}

fn press(world: &mut World, keys: Keys, repeats: bool) {
    if keys.key == KeyCode::Escape && pointer::cancel(world) {
        return;
    }
    // In the middle of a drag keys belong to it: they fly, or do nothing.
    if !matches!(world.resource::<PointerUse>(), PointerUse::Free) {
        return;
    }
    let Some(action) = action_of(keys) else {
        return;
    };
    let may_repeat = matches!(
        action,
        Action::Undo | Action::Redo | Action::StepForward | Action::StepBack
    );
    if !repeats || may_repeat {
        world.write_message(action);
    }
}

/// What the table says about a key.
fn action_of(keys: Keys) -> Option<Action> {
    let entry = ACTIONS.iter().find(|entry| entry.keys.contains(&keys))?;
    Some(entry.action.clone())
}

/// The key by what is written on it, for letters: Ctrl+Z is where the Z is, whatever the layout.
/// All others by where they are.
fn meant_key(input: &KeyboardInput) -> KeyCode {
    let Key::Character(text) = &input.logical_key else {
        return input.key_code;
    };
    let mut letters = text.chars();
    match (letters.next(), letters.next()) {
        (Some(letter), None) => letter_key(letter).unwrap_or(input.key_code),
        _ => input.key_code,
    }
}

/// The key of a letter of the Latin alphabet.
pub(super) fn letter_key(letter: char) -> Option<KeyCode> {
    use KeyCode::*;
    const LETTERS: [KeyCode; 26] = [
        KeyA, KeyB, KeyC, KeyD, KeyE, KeyF, KeyG, KeyH, KeyI, KeyJ, KeyK, KeyL, KeyM, KeyN, KeyO,
        KeyP, KeyQ, KeyR, KeyS, KeyT, KeyU, KeyV, KeyW, KeyX, KeyY, KeyZ,
    ];
    let letter = letter.to_ascii_lowercase();
    letter
        .is_ascii_lowercase()
        .then(|| LETTERS[usize::from(letter as u8 - b'a')])
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::ecs::entity::Entity;

    fn input(key_code: KeyCode, logical: &str) -> KeyboardInput {
        KeyboardInput {
            key_code,
            logical_key: Key::Character(logical.into()),
            state: ButtonState::Pressed,
            text: None,
            repeat: false,
            window: Entity::PLACEHOLDER,
        }
    }

    #[test]
    fn letters_are_meant_by_what_is_written_on_them() {
        // The key right of T says Z on a German keyboard.
        assert_eq!(meant_key(&input(KeyCode::KeyY, "z")), KeyCode::KeyZ);
        assert_eq!(meant_key(&input(KeyCode::KeyY, "Z")), KeyCode::KeyZ);
        // A Cyrillic one is meant by its place, and so is a digit with Shift.
        assert_eq!(meant_key(&input(KeyCode::KeyZ, "я")), KeyCode::KeyZ);
        assert_eq!(meant_key(&input(KeyCode::Digit1, "!")), KeyCode::Digit1);
    }

    #[test]
    fn every_key_of_the_table_sends_its_action() {
        for entry in ACTIONS {
            for keys in entry.keys {
                assert_eq!(action_of(*keys), Some(entry.action.clone()));
            }
        }
        let none = Keys {
            ctrl: true,
            shift: true,
            key: KeyCode::F9,
        };
        assert_eq!(action_of(none), None);
    }

    #[test]
    fn modifiers_are_forgotten_with_the_keyboards_focus() {
        let mut modifiers = Modifiers::default();
        let ctrl = input(KeyCode::ControlLeft, "");
        modifiers.read(&WindowEvent::KeyboardInput(ctrl));
        assert!(modifiers.ctrl);
        modifiers.read(&WindowEvent::KeyboardFocusLost(
            bevy::input::keyboard::KeyboardFocusLost,
        ));
        assert_eq!(modifiers, Modifiers::default());
    }
}
