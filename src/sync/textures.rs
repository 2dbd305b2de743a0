use super::ahead::{Ahead, Wanted};
use super::conversions::{AT_ONCE, Conversions, TextureResult, convert, cost};
use super::cut_outs::{self, CutOuts, Pair};
use super::panorama::is_cube;
use super::reading::Switched;
use super::texture_data::{Replaced, TextureFault};
use super::traced::Draft;
use super::tree_building::TreeBuilding;
use super::uses::Uses;
use crate::scene::{
    Environment, EnvironmentMap, PhongMap, PhongMaps, RenderSettings, TextureSource,
};
use crate::trace::Texture;
use bevy::asset::{AssetEvent, AssetId, Assets, RenderAssetUsages};
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::entity::Entity;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::message::MessageReader;
use bevy::ecs::query::Changed;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut, SystemParam};
use bevy::image::Image;
use bevy::platform::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The pictures that materials and the environment use.
#[derive(Resource, Default)]
pub(super) struct TracedTextures {
    by_asset: HashMap<AssetId<Image>, TextureResult>,
    conversions: Conversions,
    cut_outs: CutOuts,
    ahead: Ahead,
    /// What rays are going to ask of them for.
    wanted: Wanted,
    /// The pictures of each material.
    uses: Uses<AssetId<Image>>,
    /// And which of them stands as alpha in which.
    pairs: Uses<Pair>,
    /// The one that is all around.
    around: Option<AssetId<Image>>,
    /// What was converted or cut out in this frame, or found to be missing.
    news: HashSet<AssetId<Image>>,
}

/// A picture that could be converted.
pub(super) struct TracedTexture {
    pub texture: Arc<Texture>,
    /// How it is read where no source says so.
    pub sampler: TextureSource,
    /// Texels that could not be taken as they were.
    pub replaced: Replaced,
}

impl TracedTextures {
    /// The texture of an asset; `None` while it is converted for the first time.
    pub fn get(&self, id: AssetId<Image>) -> Option<Result<&TracedTexture, TextureFault>> {
        let texture = self.by_asset.get(&id)?;
        Some(texture.as_ref().map_err(TextureFault::clone))
    }

    /// Whether something is being made of a picture that was not wanted of it before.
    pub fn is_being_prepared(&self, id: AssetId<Image>) -> bool {
        self.ahead.is_awaited(id)
    }

    /// Begins with what is wanted of them and was not made where they were converted.
    fn make_ahead(&mut self, wanted: Wanted) {
        let is_new = std::mem::replace(&mut self.wanted, wanted) != wanted;
        if is_new {
            self.cut_outs.make_ahead(wanted);
        }
        for (id, texture) in &self.by_asset {
            if let Ok(texture) = texture
                && (is_new || self.news.contains(id))
            {
                let is_around = self.around == Some(*id);
                self.ahead.begin(*id, &texture.texture, is_around, wanted);
            }
        }
    }

    /// Takes a texture, or why there is none.
    fn take(&mut self, id: AssetId<Image>, texture: TextureResult) {
        self.ahead.forget(id);
        self.by_asset.insert(id, texture);
        self.news.insert(id);
    }

    /// A map of colours as an opacity map cuts it out; `None` where one of them is missing, and while it is cut out for the
    /// first time.
    pub fn cut_out(&self, pair: Pair) -> Option<&Arc<Texture>> {
        self.cut_outs.get(pair)
    }

    /// Whether it is cut out for the first time.
    pub fn is_being_cut_out(&self, pair: Pair) -> bool {
        self.cut_outs.is_awaited(pair)
    }

    /// Whose pictures this frame converted or cut out.
    pub fn users_of_news(&self) -> impl Iterator<Item = Entity> + '_ {
        self.uses.users_of(&self.news)
    }

    fn is_used(&self, id: AssetId<Image>) -> bool {
        self.uses.is_used(id) || self.around == Some(id)
    }

    /// Makes the cut-out of a map of colours and an opacity map where it is another than it was, and drops it
    /// where nobody uses it; `left` is what may still be cut out in this frame.
    fn cut_out_pair(&mut self, pair: Pair, left: &mut u64) {
        let both = pair.map(|id| Some(self.by_asset.get(&id)?.as_ref().ok()?.texture.clone()));
        match both {
            [Some(colors), Some(opacity)] if self.pairs.is_used(pair) => {
                self.cut_outs
                    .make(pair, [colors, opacity], self.wanted, left);
            }
            _ => self.cut_outs.forget(pair),
        }
    }
}

#[cfg(test)]
impl TracedTextures {
    /// How many are kept, and how many of them cut out.
    pub fn kept(&self) -> [usize; 2] {
        [
            self.by_asset.len() + self.conversions.len(),
            self.cut_outs.kept(),
        ]
    }
}

/// Whose pictures may be others than before.
#[derive(SystemParam)]
pub(super) struct Edited<'w, 's> {
    changed: Query<'w, 's, Entity, Changed<PhongMaps>>,
    removed: RemovedComponents<'w, 's, PhongMaps>,
    switched: Switched<'w, 's>,
}

impl Edited<'_, '_> {
    fn read(&mut self) -> Vec<Entity> {
        let gone = self.removed.read().chain(self.switched.read());
        gone.chain(&self.changed).collect()
    }
}

/// Converts pictures that are new or were edited, and drops those that nothing uses any more.
pub(super) fn sync_textures(
    mut events: MessageReader<AssetEvent<Image>>,
    mut edited: Edited,
    users: Query<(Entity, &PhongMaps)>,
    environment: (Res<EnvironmentMap>, Res<Environment>),
    settings: Res<RenderSettings>,
    building: Res<TreeBuilding>,
    assets: Res<Assets<Image>>,
    known: ResMut<TracedTextures>,
    mut draft: ResMut<Draft>,
) {
    let known = known.into_inner();
    known.news.clear();
    let (environment, sky) = environment;
    let wanted = Wanted::of(&settings, &sky);
    let mut edited = edited.read();
    let mut touched = HashSet::new();
    let mut stale = HashSet::new();
    let mut pairs = HashSet::new();
    if draft.anew {
        edited.extend(known.uses.entities().chain(users.iter().map(|(e, _)| e)));
        // What was edited meanwhile may have left no word.
        if assets.is_changed() {
            stale.extend(known.by_asset.keys().copied());
            stale.extend(known.conversions.pictures());
        }
    }
    for event in events.read() {
        if let AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id } =
            event
        {
            stale.insert(*id);
        }
    }
    let around = environment.0.as_ref().map(|map| map.id());
    if known.around != around {
        // A cube that materials have too is a panorama all around, and no picture anywhere else.
        for id in [known.around, around].into_iter().flatten() {
            if assets.get(id).is_some_and(is_cube) {
                stale.insert(id);
                known.by_asset.remove(&id);
                known.conversions.forget(id);
            }
            touched.insert(id);
        }
        known.around = around;
    }
    for entity in edited {
        let maps = users.get(entity).ok().map(|(_, maps)| maps);
        let loaded = |map: PhongMap| maps.and_then(|maps| Some(map.loaded(maps)?.id()));
        let pictures = PhongMap::ALL.into_iter().filter_map(loaded).collect();
        known.uses.set(entity, pictures, &mut touched);
        let opacity = maps.and_then(|maps| Some(maps.opacity.as_ref()?.id()));
        let colors = PhongMap::ALL.into_iter().filter(|map| map.is_of_colors());
        let cut_out = colors.filter_map(|map| Some([loaded(map)?, opacity?]));
        known.pairs.set(entity, cut_out.collect(), &mut pairs);
    }
    let at_once = *building == TreeBuilding::AtOnce;
    if at_once {
        // Nothing is waited for: what is under way is made here.
        stale.extend(known.conversions.pictures());
        known.ahead.stop();
        let under_way = known.cut_outs.stop();
        known.news.extend(under_way.iter().map(|pair| pair[0]));
    } else {
        for pair in known.cut_outs.finished() {
            known.news.insert(pair[0]);
        }
        for (id, texture, edited) in known.conversions.finished() {
            if known.is_used(id) {
                known.take(id, texture);
            }
            stale.extend(edited.then_some(id));
        }
    }
    let ready = known.ahead.finished();
    touched.extend(&stale);
    let mut left = if at_once { usize::MAX } else { AT_ONCE };
    for id in touched {
        if !known.is_used(id) {
            known.by_asset.remove(&id);
            known.conversions.forget(id);
            known.ahead.forget(id);
            continue;
        }
        if known.by_asset.contains_key(&id) && !stale.contains(&id) {
            continue;
        }
        let Some(image) = assets.get(id) else {
            known.conversions.forget(id);
            known.take(id, Err(TextureFault::Missing));
            continue;
        };
        let is_around = around == Some(id);
        let cost = cost(image, is_around);
        // Bevy's renderer takes the pixels of these away at the end of the frame, and says nothing.
        let goes = image.asset_usage == RenderAssetUsages::RENDER_WORLD;
        if cost <= left || goes {
            left = left.saturating_sub(cost);
            known.conversions.forget(id);
            known.take(id, convert(image, is_around));
        } else {
            known.conversions.begin(id, is_around);
        }
    }
    known.conversions.go_on(&assets, wanted);
    if !at_once {
        known.make_ahead(wanted);
    }
    // The environment waits for it.
    (known.news).extend(ready.into_iter().filter(|id| known.around == Some(*id)));
    if !known.news.is_empty() {
        draft.changes.textures = true;
        let is_new = |pair: &[AssetId<Image>; 2]| pair.iter().any(|id| known.news.contains(id));
        pairs.extend(known.pairs.things().filter(is_new));
    }
    let mut left = if at_once { u64::MAX } else { cut_outs::AT_ONCE };
    for pair in pairs {
        known.cut_out_pair(pair, &mut left);
    }
    draft.pending_textures = known.conversions.len() + known.cut_outs.len() + known.ahead.len();
}
