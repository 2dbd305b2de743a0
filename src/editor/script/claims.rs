//! What a script claims of the scene and the panels.

use super::super::edits::name_of;
use super::super::history::History;
use super::super::selection::Selection;
use super::spot::{Texts, named};
use super::step::{Step, Value};
use super::value;
use bevy::ecs::world::World;

/// Checks a claim; otherwise what was found instead.
pub(super) fn check(world: &mut World, claim: Step) -> Result<(), String> {
    match claim {
        Step::Assert {
            of,
            path,
            is,
            within,
        } => {
            let found = value::read(world, of.as_deref(), &path)?;
            if !found.is(&is, within) {
                let subject = subject(of.as_deref(), &path);
                let about = about(&is, within);
                return Err(format!("{subject} is {found}, and should be {about}"));
            }
        }
        Step::AssertNot {
            of,
            path,
            is,
            within,
        } => {
            let found = value::read(world, of.as_deref(), &path)?;
            if found.is(&is, within) {
                let subject = subject(of.as_deref(), &path);
                return Err(format!("{subject} is {found}, and should not be"));
            }
        }
        Step::Selected(names) => {
            let mut wanted = names
                .iter()
                .map(|name| named(world, name))
                .collect::<Result<Vec<_>, _>>()?;
            let mut found = world.resource::<Selection>().ids().to_vec();
            wanted.sort_unstable();
            found.sort_unstable();
            if found != wanted {
                let found: Vec<String> = found.iter().map(|id| name_of(world, *id)).collect();
                return Err(format!("selected is {found:?}, and should be {names:?}"));
            }
        }
        Step::Exists(name) => {
            named(world, &name)?;
        }
        Step::Gone(name) => {
            if named(world, &name).is_ok() {
                return Err(format!("there is an entity {name:?}, and should be none"));
            }
        }
        Step::Undoes(text) => {
            let found = world.resource::<History>().undo_text();
            if found != Some(text.as_str()) {
                return Err(format!("undo takes back {found:?}, and should {text:?}"));
            }
        }
        Step::Shows(text) => {
            if !world.resource::<Texts>().shows(&text) {
                return Err(format!("no panel shows {text:?}"));
            }
        }
        other => return Err(format!("{other:?} is no claim")),
    }
    Ok(())
}

fn subject(of: Option<&str>, path: &str) -> String {
    match of {
        Some(name) => format!("{name}'s {path}"),
        None => path.to_owned(),
    }
}

fn about(is: &Value, within: f64) -> String {
    if within > 0.0 {
        format!("{is} ± {within}")
    } else {
        is.to_string()
    }
}
