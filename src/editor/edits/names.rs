//! What entities are called.

use super::scene_entity;
use crate::scene::SceneId;
use bevy::ecs::name::Name;
use bevy::ecs::world::World;
use std::collections::{HashMap, HashSet};

/// What an entity is called; its number where it has no name.
pub fn name_of(world: &World, id: SceneId) -> String {
    let name = scene_entity(world, id).and_then(|entity| world.get::<Name>(entity));
    name.map_or_else(|| format!("entity {}", id.0), ToString::to_string)
}

/// A name that no entity has: this one, or this one with the next number after it.
pub fn unique_name(world: &mut World, wanted: &str) -> String {
    Names::new(world).unique(wanted)
}

/// Calls an entity by this name, and by none where it is empty. Two may have the same name.
pub fn rename(world: &mut World, id: SceneId, name: &str) {
    let Some(entity) = scene_entity(world, id) else {
        return;
    };
    let name = name.trim();
    if world.get::<Name>(entity).map_or("", Name::as_str) == name {
        return;
    }
    let mut entity = world.entity_mut(entity);
    if name.is_empty() {
        entity.remove::<Name>();
    } else {
        entity.insert(Name::new(name.to_owned()));
    }
}

/// The names of a scene, with those that were just given.
pub(super) struct Names {
    taken: HashSet<String>,
    /// The number to go on with, by the name and the number to begin with: thousands may want the same.
    next: HashMap<(String, u64), u64>,
}

impl Names {
    pub fn new(world: &mut World) -> Self {
        let mut names = world.query::<&Name>();
        Self {
            taken: names.iter(world).map(ToString::to_string).collect(),
            next: HashMap::new(),
        }
    }

    /// Takes the name, or the next one like it.
    pub fn unique(&mut self, wanted: &str) -> String {
        if self.taken.insert(wanted.to_owned()) {
            return wanted.to_owned();
        }
        let stem = wanted.trim_end_matches(|c: char| c.is_ascii_digit());
        let (stem, first) = match wanted[stem.len()..].parse::<u64>() {
            Ok(number) if stem.ends_with(' ') => (stem.trim_end(), number.saturating_add(1)),
            _ => (wanted, 2),
        };
        let number = self.next.entry((stem.to_owned(), first)).or_insert(first);
        loop {
            let name = format!("{stem} {number}");
            *number = number.wrapping_add(1);
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}
