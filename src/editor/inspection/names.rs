//! What objects, lights and materials are called.

use crate::scene::{SceneId, UsesMaterial};
use crate::sync::Traced;
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::entity::Entity;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Changed, Or};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::platform::collections::HashMap;
use std::collections::BTreeMap;

/// Names by number; learnt again when one changes.
#[derive(Resource, Default)]
pub(in crate::editor) struct Names {
    /// Of entities, by their `SceneId`.
    pub things: BTreeMap<u64, String>,
    /// Of materials that objects share, by their index in the traced world.
    materials: HashMap<u32, String>,
    /// Counts how often they were learnt.
    pub version: u64,
}

impl Names {
    /// A thing's name, or what to call it by its number.
    pub fn of(&self, id: u64) -> String {
        match self.things.get(&id) {
            Some(name) if !name.is_empty() => name.clone(),
            _ => format!("#{id}"),
        }
    }

    /// A material's name; an object's own has its number alone.
    pub fn of_material(&self, index: u32) -> String {
        match self.materials.get(&index) {
            Some(name) => format!("{index} {name}"),
            None => index.to_string(),
        }
    }
}

type Renamed = Or<(Changed<Name>, Changed<SceneId>, Changed<UsesMaterial>)>;

/// Learns them where any changed.
pub(super) fn learn(
    renamed: Query<(), Renamed>,
    mut removed: RemovedComponents<UsesMaterial>,
    traced: Res<Traced>,
    named: Query<(&SceneId, &Name)>,
    users: Query<(&SceneId, &UsesMaterial)>,
    materials: Query<&Name>,
    mut names: ResMut<Names>,
) {
    let removed = removed.read().count() > 0;
    if renamed.is_empty() && !removed && !traced.is_changed() {
        return;
    }
    let things: BTreeMap<u64, String> = named
        .iter()
        .map(|(id, name)| (id.0, name.to_string()))
        .collect();
    let shared: HashMap<u64, Entity> = users.iter().map(|(id, user)| (id.0, user.0)).collect();
    let materials = traced
        .world
        .objects
        .iter()
        .filter_map(|object| {
            let name = materials.get(*shared.get(&object.id)?).ok()?;
            Some((object.material, name.to_string()))
        })
        .collect();
    if names.things != things || names.materials != materials {
        let version = names.version + 1;
        *names = Names {
            things,
            materials,
            version,
        };
    }
}
