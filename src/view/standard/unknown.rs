//! Materials that nobody has said how to trace.

use crate::scene::{NotTraced, Phong, UsesMaterial};
use crate::sync::LeftOut;
use bevy::ecs::archetype::Archetypes;
use bevy::ecs::component::{ComponentId, Components};
use bevy::ecs::reflect::AppTypeRegistry;
use bevy::mesh::Mesh3d;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::{Component, DetectChanges, Entity, Local, Res, ResMut, Resource};
use std::any::TypeId;

/// The kinds of `MeshMaterial3d` that are mapped.
#[derive(Resource, Default)]
pub(super) struct KnownMaterials(HashSet<TypeId>);

impl KnownMaterials {
    pub fn insert<C: Component>(&mut self) {
        self.0.insert(TypeId::of::<C>());
    }
}

/// What Bevy's materials on objects are called.
const WRAPPER: &str = "bevy_pbr::mesh_material::MeshMaterial3d<";

/// Names objects whose material is of no kind that is mapped.
pub(super) fn name_unknown(
    known: Res<KnownMaterials>,
    registry: Option<Res<AppTypeRegistry>>,
    archetypes: &Archetypes,
    components: &Components,
    mut met: Local<usize>,
    mut unknown: Local<Vec<(ComponentId, String)>>,
    mut named: Local<HashMap<Entity, ComponentId>>,
    mut left_out: ResMut<LeftOut>,
) {
    // Kinds of components join, and never leave.
    if *met != components.len() || known.is_changed() {
        *met = components.len();
        unknown.clear();
        if let Some(registry) = registry {
            let registry = registry.read();
            let kinds = registry.iter().filter_map(|kind| {
                let path = kind.type_info().type_path();
                let of = path.strip_prefix(WRAPPER)?.strip_suffix('>')?;
                let id = components.get_id(kind.type_id())?;
                (!known.0.contains(&kind.type_id())).then(|| (id, of.to_owned()))
            });
            unknown.extend(kinds);
        }
    }
    if unknown.is_empty() && named.is_empty() {
        return;
    }
    let mesh = components.component_id::<Mesh3d>();
    let others = [
        components.component_id::<NotTraced>(),
        components.component_id::<Phong>(),
        components.component_id::<UsesMaterial>(),
    ];
    let mut now: HashMap<Entity, ComponentId> = HashMap::default();
    for archetype in archetypes.iter() {
        let has = |id: ComponentId| archetype.contains(id);
        if !mesh.is_some_and(has) || others.into_iter().flatten().any(has) {
            continue;
        }
        if let Some((id, _)) = unknown.iter().find(|(id, _)| has(*id)) {
            let entities = archetype.entities().iter();
            now.extend(entities.map(|entity| (entity.id(), *id)));
        }
    }
    if now == *named {
        return;
    }
    for entity in named.keys().filter(|entity| !now.contains_key(*entity)) {
        LeftOut::note(&mut left_out, "mesh", *entity, Vec::new());
    }
    // Of thousands, mostly some come and go.
    let news = now
        .iter()
        .filter(|(entity, id)| named.get(*entity) != Some(*id));
    for (entity, id) in news {
        let of = unknown.iter().find(|(other, _)| other == id);
        let note = of.map(|(_, of)| {
            format!(
                "its {of} is unknown, and it is traced as plain grey; say how to trace it with `app.add_traced_material(|material: &{of}| …)`"
            )
        });
        LeftOut::note(&mut left_out, "mesh", *entity, note.into_iter().collect());
    }
    *named = now;
}
