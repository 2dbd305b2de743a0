//! Keys as the window sends them.

use super::super::keys::{letter_key, named_key};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyCode, KeyboardInput, NativeKey};
use bevy::window::WindowEvent;

/// A key with the modifiers before it.
pub(super) fn parse(text: &str) -> Result<Vec<KeyCode>, String> {
    let mut names: Vec<&str> = text.split('+').collect();
    let mut last = names.pop().unwrap_or_default();
    if last == "?" {
        names.push("Shift");
        last = "/";
    }
    let mut keys = Vec::with_capacity(names.len() + 1);
    for name in names {
        let modifier = modifier(name)
            .ok_or_else(|| format!("{name:?} is no modifier: Ctrl, Shift and Alt are"))?;
        keys.push(modifier);
    }
    keys.push(match modifier(last) {
        Some(key) => key,
        None => named_key(last)?,
    });
    Ok(keys)
}

fn modifier(name: &str) -> Option<KeyCode> {
    match name {
        "Ctrl" => Some(KeyCode::ControlLeft),
        "Shift" => Some(KeyCode::ShiftLeft),
        "Alt" => Some(KeyCode::AltLeft),
        _ => None,
    }
}

/// What is written on a key.
fn logical(key: KeyCode, shift: bool) -> Key {
    let name = format!("{key:?}");
    let written = match key {
        KeyCode::Slash if shift => "?".to_owned(),
        KeyCode::Slash => "/".to_owned(),
        KeyCode::Comma => ",".to_owned(),
        KeyCode::Period => ".".to_owned(),
        _ => match (name.strip_prefix("Key"), name.strip_prefix("Digit")) {
            (Some(letter), _) if shift => letter.to_owned(),
            (Some(letter), _) => letter.to_lowercase(),
            (_, Some(digit)) => digit.to_owned(),
            _ => String::new(),
        },
    };
    if !written.is_empty() {
        return Key::Character(written.as_str().into());
    }
    match key {
        KeyCode::ControlLeft => Key::Control,
        KeyCode::ShiftLeft => Key::Shift,
        KeyCode::AltLeft => Key::Alt,
        KeyCode::Escape => Key::Escape,
        KeyCode::Enter => Key::Enter,
        KeyCode::Space => Key::Space,
        KeyCode::Tab => Key::Tab,
        KeyCode::Backspace => Key::Backspace,
        KeyCode::Delete => Key::Delete,
        KeyCode::Insert => Key::Insert,
        KeyCode::Home => Key::Home,
        KeyCode::End => Key::End,
        KeyCode::PageUp => Key::PageUp,
        KeyCode::PageDown => Key::PageDown,
        KeyCode::ArrowLeft => Key::ArrowLeft,
        KeyCode::ArrowRight => Key::ArrowRight,
        KeyCode::ArrowUp => Key::ArrowUp,
        KeyCode::ArrowDown => Key::ArrowDown,
        _ => Key::Unidentified(NativeKey::Unidentified),
    }
}

/// Presses or releases a key.
pub(super) fn send_key(
    world: &mut World,
    window: Entity,
    key: KeyCode,
    state: ButtonState,
    shift: bool,
) {
    let input = KeyboardInput {
        key_code: key,
        logical_key: logical(key, shift),
        state,
        text: None,
        repeat: false,
        window,
    };
    send(world, input);
}

/// Types one letter.
pub(super) fn send_letter(world: &mut World, window: Entity, letter: char, state: ButtonState) {
    let text = letter.to_string();
    let input = KeyboardInput {
        key_code: letter_key(letter).unwrap_or(KeyCode::F24),
        logical_key: if letter == ' ' {
            Key::Space
        } else {
            Key::Character(text.as_str().into())
        },
        state,
        text: (state == ButtonState::Pressed).then(|| text.as_str().into()),
        repeat: false,
        window,
    };
    send(world, input);
}

fn send(world: &mut World, input: KeyboardInput) {
    world.write_message(input.clone());
    world.write_message(WindowEvent::KeyboardInput(input));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_written_as_in_menus() {
        let [ctrl, shift] = [KeyCode::ControlLeft, KeyCode::ShiftLeft];
        for (text, keys) in [
            ("Ctrl+Shift+Z", vec![ctrl, shift, KeyCode::KeyZ]),
            ("?", vec![shift, KeyCode::Slash]),
            ("Ctrl+Num 1", vec![ctrl, KeyCode::Numpad1]),
        ] {
            assert_eq!(parse(text), Ok(keys), "{text}");
        }
    }

    #[test]
    fn a_single_modifier_is_a_key() {
        assert_eq!(parse("Alt"), Ok(vec![KeyCode::AltLeft]));
        assert!(parse("").is_err());
        assert!(parse("A+B").is_err());
    }
}
