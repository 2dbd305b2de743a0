//! What objects, lights and materials are called.

use super::document::named;
use bevy::ecs::resource::Resource;
use bevy::platform::collections::HashMap;
use std::collections::BTreeMap;

/// Names by number; learnt again when one changes.
#[derive(Resource, Default)]
pub struct Names {
    /// Of entities, by their `SceneId`.
    pub things: BTreeMap<u64, String>,
    /// Of materials that objects share, by their index in the traced world.
    pub materials: HashMap<u32, String>,
    /// Counts how often they were learnt.
    pub version: u64,
}

impl Names {
    /// A thing's name, or what to call it by its number.
    pub fn of(&self, id: u64) -> String {
        named(&self.things, id)
    }

    /// A material's name; an object's own has its number alone.
    pub fn of_material(&self, index: u32) -> String {
        match self.materials.get(&index) {
            Some(name) => format!("{index} {name}"),
            None => index.to_string(),
        }
    }
}
