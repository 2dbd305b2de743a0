//! The scene as it was at the last step, and what is other now.

use super::super::edits::SceneIndex;
use super::state::{EntityState, Kept, Kinds};
use super::step::{Change, Step};
use super::within::OnlyWithin;
use super::{Changes, Removals, ResourceChanges};
use crate::io::AnyKeptChanged;
use crate::scene::{Environment, RenderSettings, SceneId};
use bevy::ecs::change_detection::Tick;
use bevy::ecs::component::ComponentId;
use bevy::ecs::entity::Entity;
use bevy::ecs::lifecycle::Remove;
use bevy::ecs::name::Name;
use bevy::ecs::observer::{Observer, On};
use bevy::ecs::query::{Changed, Or, QueryBuilder, QueryState, With};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, ResMut, SystemState};
use bevy::ecs::world::{EntityRef, Mut, World};
use bevy::mesh::Mesh3d;
use std::collections::{BTreeSet, HashMap};

type ChangedEntities =
    Query<'static, 'static, Entity, (With<SceneId>, Or<(AnyKeptChanged, Changed<Mesh3d>)>)>;

/// Remembers when it last looked.
#[derive(Resource)]
pub(super) struct Watch {
    scene: SystemState<ChangedEntities>,
    foreign: Option<ForeignWatch>,
}

impl Watch {
    pub fn new(world: &mut World) -> Self {
        Self {
            scene: SystemState::new(world),
            foreign: None,
        }
    }
}

/// The same for components of an app's own, whose types are known only to Bevy.
struct ForeignWatch {
    kinds: Vec<ComponentId>,
    carriers: QueryState<EntityRef<'static>, With<SceneId>>,
    last_look: Tick,
}

impl ForeignWatch {
    fn changed(&mut self, world: &mut World) -> Vec<Entity> {
        let now = world.increment_change_tick();
        let last = std::mem::replace(&mut self.last_look, now);
        let has_changed = |entity: &EntityRef| {
            let ticks = |&kind: &ComponentId| entity.get_change_ticks_by_id(kind);
            let mut ticks = self.kinds.iter().filter_map(ticks);
            ticks.any(|ticks| ticks.is_changed(last, now))
        };
        let carriers = self.carriers.iter(world);
        carriers.filter(has_changed).map(|e| e.id()).collect()
    }
}

/// From now on what the app's own components say is watched, too.
pub(super) fn watch_foreign(world: &mut World) {
    let new = world.resource_scope(|world, mut kinds: Mut<Kinds>| kinds.learn(world));
    if new.is_empty() {
        return;
    }
    let note = |gone: On<Remove>, mut removals: ResMut<Removals>| removals.0.push(gone.entity);
    world.spawn(Observer::new(note).with_components(new.iter().copied()));
    let known = world.resource_mut::<Watch>().foreign.take();
    let mut kinds = known.map_or_else(Vec::new, |known| known.kinds);
    kinds.extend(new);
    let carriers = QueryBuilder::<EntityRef, With<SceneId>>::new(world)
        .or(|any| {
            for &kind in &kinds {
                any.with_id(kind);
            }
        })
        .build();
    let last_look = world.change_tick();
    world.resource_mut::<Watch>().foreign = Some(ForeignWatch {
        kinds,
        carriers,
        last_look,
    });
}

/// Entities of which something kept has changed, appeared or gone since this was asked last.
pub(super) fn changed_entities(world: &mut World) -> Vec<Entity> {
    let mut entities = std::mem::take(&mut world.resource_mut::<Removals>().0);
    world.resource_scope(|world, mut watch: Mut<Watch>| {
        // It reads nothing that could be missing.
        if let Ok(changed) = watch.scene.get(world) {
            entities.extend(&changed);
        }
        if let Some(foreign) = &mut watch.foreign {
            entities.extend(foreign.changed(world));
        }
    });
    entities
}

#[derive(Default)]
pub(super) struct Mirror {
    pub entities: HashMap<SceneId, EntityState>,
    settings: Option<RenderSettings>,
    environment: Option<Environment>,
    /// Which number an entity had.
    ids: HashMap<Entity, SceneId>,
}

impl Mirror {
    /// Takes over what is other than it was; returns it.
    pub fn update(&mut self, world: &mut World) -> Changes {
        let mut entities = changed_entities(world);
        entities.extend(OnlyWithin::take(world));
        self.update_these(world, &entities)
    }

    /// The same for all entities of the scene, whether they were changed or not.
    pub fn fill(&mut self, world: &mut World) {
        let mut all = world.query_filtered::<Entity, With<SceneId>>();
        let all: Vec<Entity> = all.iter(world).collect();
        self.update_these(world, &all);
    }

    /// The same for these.
    pub fn update_these(&mut self, world: &mut World, entities: &[Entity]) -> Changes {
        if entities.is_empty() {
            return Vec::new();
        }
        let mut touched: BTreeSet<SceneId> = BTreeSet::new();
        world.resource_scope(|world, mut index: Mut<SceneIndex>| {
            for &entity in entities {
                touched.extend(self.ids.get(&entity));
                if let Some(&id) = world.get::<SceneId>(entity)
                    && !id.is_unassigned()
                {
                    index.learn(world, id, entity);
                    touched.insert(id);
                }
            }
        });
        let (kinds, index) = (world.resource::<Kinds>(), world.resource::<SceneIndex>());
        let mut changes = Vec::new();
        for id in touched {
            let before = self.entities.get(&id);
            let entity = index.find(world, id);
            let after = entity.map(|entity| kinds.capture(world, entity, before));
            if let Some(change) = Change::between(id, before, after.as_ref()) {
                changes.push(change);
            }
            match (entity, after) {
                (Some(entity), Some(after)) => {
                    self.ids.insert(entity, id);
                    self.entities.insert(id, after);
                }
                _ => {
                    self.entities.remove(&id);
                }
            }
        }
        for entity in entities {
            if world.get::<SceneId>(*entity).is_none() {
                self.ids.remove(entity);
            }
        }
        changes
    }

    pub fn update_resources(&mut self, world: &World) -> ResourceChanges {
        let settings = replaced(&mut self.settings, world.get_resource::<RenderSettings>());
        let environment = replaced(&mut self.environment, world.get_resource::<Environment>());
        (settings, environment)
    }

    /// Those that name one of these entities.
    pub fn referring_to(&self, ids: &BTreeSet<SceneId>) -> Vec<SceneId> {
        let names = |state: &EntityState| {
            let mut kept = state.iter().flatten();
            kept.any(|kept| matches!(kept, Kept::Entity(id) if ids.contains(id)))
        };
        let referring = self.entities.iter().filter(|(_, state)| names(state));
        referring.map(|(id, _)| *id).collect()
    }

    /// What an entity is called that the step made, changed or removed.
    pub fn name(&self, kinds: &Kinds, id: SceneId, step: &Step) -> String {
        let place = kinds.place_of::<Name>();
        let of =
            |kept: Option<&Kept>| kept.and_then(|kept| Some(kept.value::<Name>()?.to_string()));
        let change = step.changes.iter().find(|change| change.id == id);
        let in_step = change.and_then(|change| {
            let (_, [before, after]) = change.values.iter().find(|(at, _)| *at == place)?;
            of(before.as_ref()).or_else(|| of(after.as_ref()))
        });
        let now = || of(self.entities.get(&id)?.get(place)?.as_ref());
        in_step
            .or_else(now)
            .unwrap_or_else(|| format!("entity {}", id.0))
    }
}

/// What it was before and after, where it was known before and is another now.
fn replaced<T: Clone + PartialEq>(known: &mut Option<T>, now: Option<&T>) -> Option<(T, T)> {
    let now = now?;
    if known.as_ref() == Some(now) {
        return None;
    }
    known
        .replace(now.clone())
        .map(|before| (before, now.clone()))
}
