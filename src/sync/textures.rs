use super::image_sampler::sampler_of;
use super::panorama::{is_cube, trace_cube};
use super::reading::Switched;
use super::texture_data::{Replaced, TextureFault, trace_texture};
use super::traced::Draft;
use crate::scene::{EnvironmentMap, PhongMap, PhongMaps, TextureSource};
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
    by_asset: HashMap<AssetId<Image>, Result<TracedTexture, TextureFault>>,
    cut_outs: HashMap<[AssetId<Image>; 2], CutOut>,
}

/// A picture that could be converted.
pub(super) struct TracedTexture {
    pub texture: Arc<Texture>,
    /// How it is read where no source says so.
    pub sampler: TextureSource,
    /// Texels that could not be taken as they were.
    pub replaced: Replaced,
}

/// A map of colours with an opacity map as its alpha.
struct CutOut {
    /// The two that it was made of.
    of: [Arc<Texture>; 2],
    /// The map of colours itself where that is the alpha that it has.
    texture: Arc<Texture>,
}

impl TracedTextures {
    /// The texture of an asset.
    pub fn get(&self, id: AssetId<Image>) -> Result<&TracedTexture, TextureFault> {
        match self.by_asset.get(&id) {
            Some(Ok(texture)) => Ok(texture),
            Some(Err(fault)) => Err(fault.clone()),
            None => Err(TextureFault::Missing),
        }
    }

    /// A map of colours as an opacity map cuts it out; `None` where one of them is missing.
    pub fn cut_out(
        &self,
        colors: AssetId<Image>,
        opacity: AssetId<Image>,
    ) -> Option<&Arc<Texture>> {
        let cut_out = self.cut_outs.get(&[colors, opacity])?;
        Some(&cut_out.texture)
    }

    /// Makes what is new among pairs of a map of colours and an opacity map, and drops the others.
    fn cut_out_pairs(&mut self, pairs: impl Iterator<Item = [AssetId<Image>; 2]>) {
        let mut known = std::mem::take(&mut self.cut_outs);
        for pair in pairs {
            let [Ok(colors), Ok(opacity)] = pair.map(|id| self.get(id)) else {
                continue;
            };
            let of = [colors.texture.clone(), opacity.texture.clone()];
            let same = |cut_out: &CutOut| (0..2).all(|i| Arc::ptr_eq(&cut_out.of[i], &of[i]));
            if self.cut_outs.get(&pair).is_some_and(same) {
                continue;
            }
            let cut_out = known.remove(&pair).filter(same).unwrap_or_else(|| CutOut {
                texture: match of[0].cut_out_by(&of[1]) {
                    Some(texture) => Arc::new(texture),
                    None => of[0].clone(),
                },
                of,
            });
            self.cut_outs.insert(pair, cut_out);
        }
    }
}

#[cfg(test)]
impl TracedTextures {
    /// How many are kept, and how many of them cut out.
    pub fn kept(&self) -> [usize; 2] {
        [self.by_asset.len(), self.cut_outs.len()]
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
    if environment.is_changed()
        && let Some(map) = &environment.0
        && matches!(
            known.by_asset.get(&map.id()),
            Some(Err(TextureFault::NotFlat))
        )
    {
        // A material has it too, and a cube is none for that.
        known.by_asset.remove(&map.id());
    }
    let used: HashSet<AssetId<Image>> = users
        .iter()
        .flat_map(|maps| PhongMap::ALL.map(|map| map.loaded(maps)))
        .chain([environment.0.as_ref()])
        .flatten()
        .map(|handle| handle.id())
        .collect();
    known.by_asset.retain(|id, _| used.contains(id));
    for id in used {
        if !known.by_asset.contains_key(&id) {
            let image = assets.get(id).ok_or(TextureFault::Missing);
            let is_around = environment.0.as_ref().is_some_and(|map| map.id() == id);
            let texture = image.and_then(|image| {
                let converted = if is_around && is_cube(image) {
                    trace_cube(image)?
                } else {
                    trace_texture(image)?
                };
                Ok(TracedTexture {
                    texture: Arc::new(converted.texture),
                    sampler: sampler_of(image),
                    replaced: converted.replaced,
                })
            });
            known.by_asset.insert(id, texture);
            draft.changes.textures = true;
        }
    }
    let pairs = users.iter().flat_map(|maps| {
        let colors = PhongMap::ALL.into_iter().filter(|map| map.is_of_colors());
        colors.filter_map(|map| Some([map.loaded(maps)?.id(), maps.opacity.as_ref()?.id()]))
    });
    known.cut_out_pairs(pairs);
}
