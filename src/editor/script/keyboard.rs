//! Keys as the window sends them.

use super::super::keys::letter_key;
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
    let key = modifier(last).or_else(|| key(last));
    keys.push(key.ok_or_else(|| {
        format!("{last:?} is no key: A to Z, 0 to 9, F1 to F12, Numpad0 to Numpad9, Enter … are")
    })?);
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

fn key(name: &str) -> Option<KeyCode> {
    match name {
        "/" => return Some(KeyCode::Slash),
        "." => return Some(KeyCode::Period),
        "," => return Some(KeyCode::Comma),
        _ => {}
    }
    let mut letters = name.chars();
    if let (Some(letter), None) = (letters.next(), letters.next()) {
        let digit = letter.to_digit(10).map(|digit| DIGITS[digit as usize]);
        return digit.or_else(|| letter_key(letter));
    }
    let numpad = name.strip_prefix("Num ");
    let numpad = numpad.map(|digit| format!("Numpad{digit}"));
    let name = numpad.as_deref().unwrap_or(name);
    let mut named = NAMED.iter();
    named.find(|(other, _)| *other == name).map(|(_, key)| *key)
}

const DIGITS: [KeyCode; 10] = [
    KeyCode::Digit0,
    KeyCode::Digit1,
    KeyCode::Digit2,
    KeyCode::Digit3,
    KeyCode::Digit4,
    KeyCode::Digit5,
    KeyCode::Digit6,
    KeyCode::Digit7,
    KeyCode::Digit8,
    KeyCode::Digit9,
];

macro_rules! named {
    ($($key:ident)*) => { &[$((stringify!($key), KeyCode::$key)),*] };
}

/// Keys that are called as Bevy calls them.
const NAMED: &[(&str, KeyCode)] = named!(
    Escape Enter Space Tab Backspace Delete Insert Home End PageUp PageDown
    ArrowLeft ArrowRight ArrowUp ArrowDown
    F1 F2 F3 F4 F5 F6 F7 F8 F9 F10 F11 F12
    Numpad0 Numpad1 Numpad2 Numpad3 Numpad4 Numpad5 Numpad6 Numpad7 Numpad8 Numpad9
    Slash Comma Period
);

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
        for entry in super::super::super::action::ACTIONS {
            for keys in entry.keys {
                let text = keys.text();
                let parsed = parse(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
                assert_eq!(parsed.last(), Some(&keys.key), "{text}");
                assert_eq!(parsed.contains(&KeyCode::ControlLeft), keys.ctrl, "{text}");
                assert_eq!(parsed.contains(&KeyCode::ShiftLeft), keys.shift, "{text}");
            }
        }
    }

    #[test]
    fn a_single_modifier_is_a_key() {
        assert_eq!(parse("Alt"), Ok(vec![KeyCode::AltLeft]));
        assert!(parse("").is_err());
        assert!(parse("A+B").is_err());
    }
}
