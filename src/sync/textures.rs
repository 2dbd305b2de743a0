use super::reading::Switched;
use super::texture_data::{TextureFault, trace_texture};
use super::traced::Draft;
use crate::scene::{EnvironmentMap, PhongMaps};
use crate::trace::Texture;
use bevy::asset::{AssetEvent, AssetId, Assets};
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::message::MessageReader;
use bevy::ecs::query::Changed;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::image::Image;
use bevy::platform::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The pictures that materials and the environment use.
#[derive(Resource, Default)]
pub(super) struct TracedTextures {
    by_asset: HashMap<AssetId<Image>, Result<Arc<Texture>, TextureFault>>,
}

impl TracedTextures {
    /// The texture of an asset.
    pub fn get(&self, id: AssetId<Image>) -> Result<&Arc<Texture>, TextureFault> {
        match self.by_asset.get(&id) {
            Some(Ok(texture)) => Ok(texture),
            Some(Err(fault)) => Err(fault.clone()),
            None => Err(TextureFault::Missing),
        }
    }
}

/// Converts pictures that are new or were edited, and drops those that nothing uses any more.
pub(super) fn sync_textures(
    mut events: MessageReader<AssetEvent<Image>>,
    mut removed: RemovedComponents<PhongMaps>,
    mut switched: Switched,
    changed: Query<(), Changed<PhongMaps>>,
    users: Query<&PhongMaps>,
    environment: Res<EnvironmentMap>,
    assets: Res<Assets<Image>>,
    known: ResMut<TracedTextures>,
    mut draft: ResMut<Draft>,
) {
    let known = known.into_inner();
    // Not `||`: every reader has to be emptied.
    let mut stale = (removed.read().count() > 0)
        | switched.any()
        | !changed.is_empty()
        | environment.is_changed();
    for event in events.read() {
        let (AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id }) =
            event
        else {
            continue;
        };
        known.by_asset.remove(id);
        stale = true;
    }
    if !stale {
        return;
    }
    let used: HashSet<AssetId<Image>> = users
        .iter()
        .flat_map(|maps| [&maps.diffuse, &maps.opacity])
        .chain([&environment.0])
        .flatten()
        .map(|handle| handle.id())
        .collect();
    known.by_asset.retain(|id, _| used.contains(id));
    for id in used {
        if !known.by_asset.contains_key(&id) {
            let image = assets.get(id).ok_or(TextureFault::Missing);
            let texture = image.and_then(|image| trace_texture(image).map(Arc::new));
            known.by_asset.insert(id, texture);
            draft.changes.textures = true;
        }
    }
}
