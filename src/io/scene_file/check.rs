//! The ranges that the scene's schema states, checked where a file is read, so that no other room meets a value that
//! cannot be meant.

use super::super::error::Problem;
use crate::scene::{RangeProblem, RenderSettings, range_problems};
use bevy::reflect::PartialReflect;

/// Checks a component or a resource: every number finite, and those with a range inside it.
pub(super) fn check_value(value: &dyn PartialReflect) -> Result<(), Problem> {
    let Some(problem) = range_problems(value).into_iter().next() else {
        return Ok(());
    };
    if value.try_downcast_ref::<RenderSettings>().is_some() {
        return Err(Problem::Setting(Box::new(problem)));
    }
    let RangeProblem {
        path,
        value: is,
        range,
    } = problem;
    let dot = if path.is_empty() { "" } else { "." };
    Err(Problem::OutOfRange {
        what: format!("{}{dot}{path}", value.reflect_short_type_path()).into(),
        value: is.into(),
        range: range.into(),
    })
}
