//! What keys are called.

use bevy::input::keyboard::KeyCode;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// A key with modifiers. `Ctrl` is the command key on a Mac.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
#[expect(missing_docs, reason = "plain")]
pub struct Keys {
    pub ctrl: bool,
    pub shift: bool,
    pub key: KeyCode,
}

impl Keys {
    /// As menus show it: `Ctrl+Shift+S`.
    pub fn text(&self) -> String {
        let ctrl = if self.ctrl { "Ctrl+" } else { "" };
        let shift = if self.shift { "Shift+" } else { "" };
        let name = format!("{:?}", self.key);
        let name = match self.key {
            // Shift is in the character.
            KeyCode::Slash if self.shift => return format!("{ctrl}?"),
            KeyCode::Slash => "/",
            KeyCode::Period => ".",
            KeyCode::Comma => ",",
            _ => ["Key", "Digit"]
                .iter()
                .find_map(|prefix| name.strip_prefix(prefix))
                .unwrap_or(&name),
        };
        match name.strip_prefix("Numpad") {
            Some(number) => format!("{ctrl}{shift}Num {number}"),
            None => format!("{ctrl}{shift}{name}"),
        }
    }
}

impl FromStr for Keys {
    type Err = String;

    /// What [`Keys::text`] writes.
    fn from_str(text: &str) -> Result<Self, String> {
        let text = match text.strip_suffix('?') {
            Some(before) => format!("{before}Shift+/"),
            None => text.to_owned(),
        };
        let (mut ctrl, mut shift) = (false, false);
        let mut names: Vec<&str> = text.split('+').collect();
        let last = names.pop().unwrap_or_default();
        for name in names {
            match name {
                "Ctrl" => ctrl = true,
                "Shift" => shift = true,
                _ => return Err(format!("{name:?} is no modifier: Ctrl and Shift are")),
            }
        }
        Ok(Self {
            ctrl,
            shift,
            key: named_key(last)?,
        })
    }
}

impl TryFrom<String> for Keys {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Keys> for String {
    fn from(keys: Keys) -> Self {
        keys.text()
    }
}

/// The key that is called so, as menus and scripts write it.
pub(in crate::editor) fn named_key(name: &str) -> Result<KeyCode, String> {
    let mut letters = name.chars();
    if let (Some(letter), None) = (letters.next(), letters.next()) {
        let key = match letter {
            '/' => Some(KeyCode::Slash),
            '.' => Some(KeyCode::Period),
            ',' => Some(KeyCode::Comma),
            _ => match letter.to_digit(10) {
                Some(digit) => Some(DIGITS[digit as usize]),
                None => letter_key(letter),
            },
        };
        return key.ok_or_else(|| no_key(name));
    }
    let numpad = name.strip_prefix("Num ");
    let numpad = numpad.map(|digit| format!("Numpad{digit}"));
    let wanted = numpad.as_deref().unwrap_or(name);
    let mut named = NAMED.iter();
    let found = named.find(|(other, _)| *other == wanted);
    found.map(|(_, key)| *key).ok_or_else(|| no_key(name))
}

fn no_key(name: &str) -> String {
    format!("{name:?} is no key: A to Z, 0 to 9, F1 to F12, Num 0 to Num 9, Enter … are")
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
    NumpadAdd NumpadSubtract NumpadMultiply NumpadDivide NumpadDecimal NumpadEnter
    Minus Equal BracketLeft BracketRight Semicolon Quote Backquote Backslash
);

/// The key of a letter of the Latin alphabet.
pub(in crate::editor) fn letter_key(letter: char) -> Option<KeyCode> {
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

    #[test]
    fn keys_are_read_as_they_are_written() {
        for text in [
            "Ctrl+Shift+S",
            "F12",
            "1",
            "?",
            ".",
            "Ctrl+Num 1",
            "Ctrl+?",
            "Shift+BracketLeft",
        ] {
            let keys: Keys = text.parse().unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(keys.text(), text);
        }
        for text in ["", "Ctrl+", "Alt+A", "Ctrl+Blue", "A+B"] {
            assert!(text.parse::<Keys>().is_err(), "{text}");
        }
    }
}
