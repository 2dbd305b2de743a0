//! Scripts: what a person would do, played from a file, so that the editor can be tested and its
//! pictures made without one.
//!
//! A script is a list of steps in RON:
//!
//! ```ron
//! [
//!     Wait(Samples(4)),
//!     Click(On("Lamp")),
//!     Drag(Handle(Y), By(Handle(Y), 0, -60)),
//!     AssertNot(of: Some("Lamp"), path: "Transform.translation.y", is: 0.5, within: 0.01),
//!     Key("Ctrl+Z"),
//!     Screenshot("undone.png"),
//!     Quit,
//! ]
//! ```
//!
//! Pointer and keys go in as the window's own events, so that panels and view get them as from a
//! person. A step that is not known, or a claim that is wrong, is named with its file and line.

mod claims;
mod keyboard;
mod mouse;
mod player;
mod screen;
mod spot;
mod step;
mod value;

use crate::io::{FileError, TEXT_BYTES, read_text};
use bevy::app::App;
use bevy::ecs::world::World;
use player::Player;
use ron::value::RawValue;
use std::path::{Path, PathBuf};
use step::Step;

/// Why a script cannot be played.
#[derive(Debug, thiserror::Error)]
pub enum ScriptError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A step is not known or not written as it should be.
    #[error("{}:{line}: {text}", .path.display())]
    Step {
        /// Of the script.
        path: PathBuf,
        /// From 1 on.
        line: usize,
        /// What is wrong.
        text: String,
    },
}

/// A script that was read and understood.
#[derive(Clone, Debug)]
pub struct Script {
    path: PathBuf,
    /// With their lines, from 1 on.
    steps: Vec<(usize, Step)>,
}

impl Script {
    /// Reads a script, and all of its steps.
    pub fn read(path: &Path) -> Result<Self, ScriptError> {
        let text = read_text(path, TEXT_BYTES)?;
        Self::parse(path, &text)
    }

    fn parse(path: &Path, text: &str) -> Result<Self, ScriptError> {
        let fault = |line: usize, text: String| ScriptError::Step {
            path: path.to_path_buf(),
            line,
            text,
        };
        let raw: Vec<&RawValue> = ron::from_str(text)
            .map_err(|error| fault(error.span.start.line, error.code.to_string()))?;
        let mut steps = Vec::with_capacity(raw.len());
        for raw in raw {
            let step = raw.get_ron();
            // It is a part of `text`, white space and comments before it included.
            let before = step.as_ptr() as usize - text.as_ptr() as usize;
            let blank = step.len() - without_comments(step).len();
            let line = 1 + text[..before + blank].matches('\n').count();
            let parsed = ron::from_str::<Step>(step).map_err(|error| {
                let further = step[..]
                    .lines()
                    .take(error.span.start.line)
                    .count()
                    .saturating_sub(1);
                let from = 1 + text[..before].matches('\n').count();
                fault((from + further).max(line), error.code.to_string())
            })?;
            match &parsed {
                Step::Key(keys) | Step::Hold(keys) | Step::LetGo(keys) => {
                    keyboard::parse(keys).map_err(|text| fault(line, text))?;
                }
                Step::Size(width, height) => {
                    check_size(*width, *height).map_err(|text| fault(line, text))?;
                }
                _ => {}
            }
            steps.push((line, parsed));
        }
        Ok(Self {
            path: path.to_path_buf(),
            steps,
        })
    }

    /// Plays it in this app from its first frame on.
    pub(super) fn play_in(self, app: &mut App) {
        player::add(app, Player::new(self));
    }
}

/// Pixels on a side of a window; every graphics driver draws so many.
const WINDOW_SIDE: u32 = 8192;

fn check_size(width: u32, height: u32) -> Result<(), String> {
    match [width, height]
        .iter()
        .all(|side| (1..=WINDOW_SIDE).contains(side))
    {
        true => Ok(()),
        false => Err(format!(
            "Size({width}, {height}): a window has 1 to {WINDOW_SIDE} pixels on a side"
        )),
    }
}

/// The text from its first step on: without the white space and the line comments before it.
fn without_comments(text: &str) -> &str {
    let mut rest = text.trim_start();
    while rest.starts_with("//") {
        rest = rest
            .split_once('\n')
            .map_or("", |(_, below)| below)
            .trim_start();
    }
    rest
}

/// Whether a script is being played.
pub(super) fn is_playing(world: &World) -> bool {
    let player = world.get_resource::<Player>();
    player.is_some_and(Player::is_playing)
}

#[cfg(test)]
mod tests {
    use super::step::{Along, Spot, Until, Value};
    use super::*;

    fn parse(text: &str) -> Result<Vec<(usize, Step)>, String> {
        Script::parse(Path::new("story.ron"), text)
            .map(|script| script.steps)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn steps_know_their_lines() {
        let text = "// A comment.\n[\n  Wait(Samples(4)),\n\n  // Another.\n  Key(\"Ctrl+Z\"), Quit,\n  \
                    Drag(\n    On(\"Lamp\"),\n    By(Handle(X), 10, -2.5),\n  ),\n]\n";
        let drag = Step::Drag(
            Spot::On("Lamp".into()),
            Spot::By(Box::new(Spot::Handle(Along::X)), 10.0, -2.5),
        );
        let wanted = vec![
            (3, Step::Wait(Until::Samples(4.0))),
            (6, Step::Key("Ctrl+Z".into())),
            (6, Step::Quit),
            (7, drag),
        ];
        assert_eq!(parse(text).unwrap(), wanted);
    }

    #[test]
    fn values_are_switches_numbers_texts_and_lists() {
        let text = r#"[
            Set(of: Some("Ball"), path: "Phong.specular.red", to: 0.9),
            Set(path: "RenderSettings.features.shadows", to: false),
            Assert(path: "RenderSettings.lighting", is: "Physical"),
            Assert(of: Some("Ball"), path: "Transform.translation", is: [1, 2, 3], within: 0.1),
        ]"#;
        let values: Vec<Value> = parse(text)
            .unwrap()
            .into_iter()
            .map(|(_, step)| match step {
                Step::Set { to, .. } => to,
                Step::Assert { is, .. } => is,
                other => panic!("{other:?}"),
            })
            .collect();
        let wanted = [
            Value::Number(0.9),
            Value::Switch(false),
            Value::Text("Physical".into()),
            Value::Numbers(vec![1.0, 2.0, 3.0]),
        ];
        assert_eq!(values, wanted);
    }

    #[test]
    fn what_is_not_known_is_named_with_its_line() {
        for (text, line, named) in [
            ("[\n  Quit,\n  Jump(3),\n]", 3, "Jump"),
            (
                "[\n  Wait(Samples(1)),\n  Wait(\n    Moons(3)),\n]",
                4,
                "Moons",
            ),
            ("[\n  Key(\"Ctrl+Blue\"),\n]", 2, "Blue"),
            ("[\n  Set(path: \"a\", too: 1),\n]", 2, "too"),
            ("[\n  Quit,\n  Size(65000, 65000),\n]", 3, "1 to 8192"),
            ("[\n  Size(0, 600),\n]", 2, "Size(0, 600)"),
            ("[\n  Quit,\n  Click(On(\"a\"),\n]", 4, ""),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.starts_with(&format!("story.ron:{line}: ")), "{error}");
            assert!(error.contains(named), "{error}");
        }
    }

    #[test]
    fn a_script_that_is_not_there_is_named() {
        let error = Script::read(Path::new("/no/such/story.ron")).unwrap_err();
        assert!(error.to_string().starts_with("/no/such/story.ron: "));
    }
}
