//! Copies: beside the original, or through the clipboard.

use super::index::FreeIds;
use super::names::Names;
use super::parents::{all_below, place_in, roots_of, with_descendants};
use super::{SceneIndex, scene_entity};
use crate::editor::history::Kinds;
use crate::io::place::world_from;
use crate::io::{FileError, Folder, Rebase, SceneContent, SceneFiles, read_scene_text};
use crate::scene::{Phong, SceneId, UsesMaterial};
use bevy::ecs::component::ComponentCloneBehavior;
use bevy::ecs::entity::{Entity, EntityCloner, EntityHashMap};
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::ecs::name::Name;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::{Mut, World};
use bevy::math::Affine3A;
use bevy::reflect::Reflect;
use bevy::transform::components::Transform;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;

/// What was copied, as the text of a scene file.
#[derive(Resource, Clone, Debug, Default)]
pub struct Clipboard {
    /// Empty until something was copied.
    pub text: String,
    /// Where its paths start from.
    folder: Folder,
    /// Materials that were copied because objects use them, by their numbers, and where they came
    /// from: pasted into the same scene the objects go on sharing them.
    shared: Vec<(SceneId, Phong)>,
    /// What the text cannot say: components of an app's own by their entities' numbers and their places.
    foreign: Vec<(SceneId, usize, Arc<dyn Reflect>)>,
}

impl Clipboard {
    /// Text from elsewhere; its paths start from the open scene's folder.
    pub fn of_text(world: &World, text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            folder: scene_folder(world),
            ..Self::default()
        }
    }
}

fn scene_folder(world: &World) -> Folder {
    let files = world.get_resource::<SceneFiles>();
    files.map(|files| files.folder.clone()).unwrap_or_default()
}

/// Copies beside their originals.
pub struct Duplicates {
    /// The new roots.
    pub roots: Vec<SceneId>,
    /// What of an app's own could not be copied, a line for each.
    pub lost: Vec<String>,
}

/// Adds copies of entities and of all that is below them, beside the originals. They share the
/// originals' materials and observers, and have every component that can be cloned or reflected.
pub fn duplicate(world: &mut World, ids: &[SceneId]) -> Duplicates {
    let mut free = FreeIds::new(world);
    let mut names = Names::new(world);
    let mut new = Duplicates {
        roots: Vec::new(),
        lost: Vec::new(),
    };
    for id in roots_of(world, ids) {
        let Some(root) = scene_entity(world, id) else {
            continue;
        };
        let originals = all_below(world, root);
        // Known before anything is copied: what names one of them, as a skin its joints, names the copy.
        let mut twins = EntityHashMap::<Entity>::default();
        for &original in &originals {
            twins.insert(original, world.spawn_empty().id());
        }
        let mut cloner = EntityCloner::build_opt_out(world);
        cloner
            .without_required_by_components(|cloner| {
                cloner.deny::<(SceneId, Name, Children)>();
            })
            .add_observers(true);
        let mut cloner = cloner.finish();
        for original in originals {
            let twin = cloner.clone_entity_mapped(world, original, &mut twins);
            new.lost.extend(lost_of(world, original, twin));
            let is_of_scene = world.get::<SceneId>(original).is_some();
            if let Some(name) = world.get::<Name>(original).cloned() {
                let name = match is_of_scene {
                    true => Name::new(names.unique(&name)),
                    false => name,
                };
                world.entity_mut(twin).insert(name);
            }
            if is_of_scene {
                let id = free.next();
                world.entity_mut(twin).insert(id);
                if original == root {
                    new.roots.push(id);
                }
            }
        }
    }
    new
}

/// What a copy lacks of its original though the app does not say that it shall.
fn lost_of(world: &World, original: Entity, twin: Entity) -> Option<String> {
    let [from, to] = [original, twin].map(|entity| world.entity(entity));
    let names = from.archetype().components().iter().filter_map(|&id| {
        let info = world.components().get_info(id)?;
        let is_wanted = !matches!(info.clone_behavior(), ComponentCloneBehavior::Ignore);
        let name = info.name().to_string();
        let is_of_app = !name.starts_with("bevy");
        (is_wanted && is_of_app && !to.contains_id(id)).then_some(name)
    });
    let mut names: Vec<String> = names.collect();
    names.sort_unstable();
    let whose = match (from.get::<Name>(), from.get::<SceneId>()) {
        (Some(name), _) => name.to_string(),
        (None, Some(id)) => format!("entity {}", id.0),
        (None, None) => format!("entity {original}"),
    };
    let names = (!names.is_empty()).then(|| names.join(", "))?;
    Some(format!(
        "{whose}: {names} not copied; what is to be copied implements Clone, or is registered for reflection"
    ))
}

/// What pasting needs to add these entities, what is below them, and the materials that they use.
pub fn copy(world: &mut World, ids: &[SceneId]) -> Result<Clipboard, FileError> {
    let roots: Vec<Entity> = roots_of(world, ids)
        .into_iter()
        .filter_map(|id| scene_entity(world, id))
        .collect();
    let mut entities: Vec<Entity> = Vec::new();
    for &root in &roots {
        entities.extend(with_descendants(world, root));
    }
    let mut shared = Vec::new();
    let mut copied: HashSet<Entity> = entities.iter().copied().collect();
    for entity in entities.clone() {
        let Some(&UsesMaterial(material)) = world.get::<UsesMaterial>(entity) else {
            continue;
        };
        if let (Some(&id), Some(look)) =
            (world.get::<SceneId>(material), world.get::<Phong>(material))
            && copied.insert(material)
        {
            shared.push((id, look.clone()));
            entities.push(material);
        }
    }
    // A root's parent is not copied, so the text says where it stands in the world.
    let placed: Vec<(Entity, Transform)> = roots
        .iter()
        .filter(|&&root| world.get::<ChildOf>(root).is_some())
        .filter_map(|&root| Some((root, place_in(Affine3A::IDENTITY, world_from(world, root))?)))
        .collect();
    let text =
        SceneContent::of_entities(world, &entities, &placed)?.to_text(Path::new("clipboard"))?;
    Ok(Clipboard {
        text,
        folder: scene_folder(world),
        shared,
        foreign: foreign_of(world, &entities),
    })
}

/// What entities carry of an app's own.
fn foreign_of(world: &World, entities: &[Entity]) -> Vec<(SceneId, usize, Arc<dyn Reflect>)> {
    let kinds = world.resource::<Kinds>();
    let mut found = Vec::new();
    for &entity in entities {
        let Some(&id) = world.get::<SceneId>(entity) else {
            continue;
        };
        for (place, value) in kinds.clones(world, entity) {
            if kinds.is_foreign(place) {
                found.push((id, place, Arc::from(value)));
            }
        }
    }
    found
}

/// Adds what was copied; returns the new roots.
pub fn paste(world: &mut World, clipboard: &Clipboard) -> Result<Vec<SceneId>, FileError> {
    if clipboard.text.is_empty() {
        return Ok(Vec::new());
    }
    let (here, limits) = world
        .get_resource::<SceneFiles>()
        .map(|files| (files.folder.clone(), files.limits.clone()))
        .unwrap_or_default();
    let text = clipboard.text.as_bytes();
    let mut content = read_scene_text(world, Path::new("clipboard"), text, &limits)?;
    let mut free = FreeIds::new(world);
    let mut names = Names::new(world);
    let rebase = Rebase::between(clipboard.folder.clone(), here, Path::new("clipboard"));
    let renumbered = content.as_addition(|| free.next(), &rebase);
    let spawned = content
        .spawn(world)
        .map_err(|error| FileError::new("clipboard", crate::io::Problem::Malformed(error)))?;
    world.resource_scope(|world, mut index: Mut<SceneIndex>| {
        // The reader writes numbers in place, which no observer sees.
        for &entity in &spawned {
            if let Some(&id) = world.get::<SceneId>(entity) {
                index.learn(world, id, entity);
            }
        }
    });
    world.resource_scope(|world, kinds: Mut<Kinds>| {
        for (old, place, value) in &clipboard.foreign {
            let copy = renumbered.get(old);
            if let Some(entity) = copy.and_then(|&id| scene_entity(world, id)) {
                // What the text says names the entities that were copied along.
                kinds.insert_missing(&mut world.entity_mut(entity), *place, value.as_ref());
            }
        }
    });
    let mut kept: HashMap<Entity, Entity> = HashMap::new();
    let mut shared: HashSet<Entity> = HashSet::new();
    for (old, look) in &clipboard.shared {
        let Some(new) = renumbered.get(old) else {
            continue;
        };
        let copy = scene_entity(world, *new);
        shared.extend(copy);
        let original =
            scene_entity(world, *old).filter(|&entity| world.get::<Phong>(entity) == Some(look));
        if let (Some(copy), Some(original)) = (copy, original) {
            kept.insert(copy, original);
        }
    }
    let mut roots = Vec::new();
    for &entity in &spawned {
        if kept.contains_key(&entity) {
            world.despawn(entity);
            continue;
        }
        if let Some(uses) = world.get::<UsesMaterial>(entity)
            && let Some(&original) = kept.get(&uses.0)
        {
            world.entity_mut(entity).insert(UsesMaterial(original));
        }
        if let Some(name) = world.get::<Name>(entity).map(ToString::to_string) {
            let name = Name::new(names.unique(&name));
            world.entity_mut(entity).insert(name);
        }
        if !shared.contains(&entity) && world.get::<ChildOf>(entity).is_none() {
            roots.extend(world.get::<SceneId>(entity).copied());
        }
    }
    Ok(roots)
}
