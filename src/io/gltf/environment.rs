//! The environment, for which glTF has no words: in the document's `extras`, in ours.

use super::json::Json;
use super::material::{at_least_0, color};
use crate::scene::Environment;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// The name under `extras`.
const EXTRAS: &str = "glassbox_environment";

/// An environment without a picture.
#[derive(Serialize, Deserialize)]
struct Numbers {
    background: [f32; 3],
    lights: bool,
    samples: u32,
    hidden: bool,
}

/// What a document says of it in our words.
pub(super) fn environment_of(document: Json) -> Option<Environment> {
    let extras = document.get("extras")?.get(EXTRAS)?;
    let numbers: Numbers = serde_json::from_value(extras.value().clone()).ok()?;
    Some(Environment {
        background: color(numbers.background.map(at_least_0)),
        lights: numbers.lights,
        samples: numbers.samples.clamp(1, 1000),
        hidden: numbers.hidden,
        ..Environment::default()
    })
}

/// It in the document's `extras`; `None` of one with a picture.
pub(super) fn environment_json(environment: &Environment) -> Option<Value> {
    let Environment {
        background,
        map: None,
        lights,
        samples,
        hidden,
        ..
    } = *environment
    else {
        return None;
    };
    let numbers = Numbers {
        background: [background.red, background.green, background.blue],
        lights,
        samples,
        hidden,
    };
    Some(json!({ EXTRAS: numbers }))
}
