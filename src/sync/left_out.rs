use super::problem::{Fault, SyncProblem};
use super::reading::Switched;
use super::traced::Draft;
use crate::scene::SceneId;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::{Entity, EntityHashMap, EntityHashSet};
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Changed, Or};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, ResMut, SystemParam};
use std::collections::BTreeMap;

/// What of another program's components, such as Bevy's own, has nothing here that it could become. A
/// mapping notes it, and it is named among the problems.
#[derive(Resource, Default)]
pub struct LeftOut {
    /// Of each entity as what kind of thing.
    notes: EntityHashMap<BTreeMap<&'static str, Vec<String>>>,
    /// Of whom something else is said than when it was named last.
    edited: EntityHashSet,
}

impl LeftOut {
    /// Says what is left out of an entity, in place of what was said of it as this kind of thing
    /// before. Each text follows the entity's name: `its skybox is left out`.
    pub fn note(notes: &mut ResMut<Self>, kind: &'static str, entity: Entity, what: Vec<String>) {
        let known = notes.notes.get(&entity).and_then(|known| known.get(kind));
        if known.map_or(&[][..], Vec::as_slice) == what {
            return;
        }
        let notes = &mut **notes;
        notes.edited.insert(entity);
        let of_entity = notes.notes.entry(entity).or_default();
        if !what.is_empty() {
            of_entity.insert(kind, what);
            return;
        }
        of_entity.remove(kind);
        if of_entity.is_empty() {
            notes.notes.remove(&entity);
        }
    }
}

#[cfg(test)]
impl LeftOut {
    /// Of how many things anything is said.
    pub fn kept(&self) -> usize {
        self.notes.values().map(BTreeMap::len).sum()
    }
}

/// What was named last, in the order in which it is told.
#[derive(Resource, Default)]
pub(super) struct Named {
    problems: BTreeMap<(&'static str, SceneId, Entity), Vec<SyncProblem>>,
    /// As what and under which number each entity is named.
    keys: EntityHashMap<Vec<(&'static str, SceneId)>>,
}

type OtherName = Or<(Changed<SceneId>, Changed<Name>)>;

/// Who may be called otherwise, or be there no more.
#[derive(SystemParam)]
pub(super) struct Renamed<'w, 's> {
    changed: Query<'w, 's, Entity, OtherName>,
    no_id: RemovedComponents<'w, 's, SceneId>,
    no_name: RemovedComponents<'w, 's, Name>,
    switched: Switched<'w, 's>,
}

/// Names what is left out of entities that there are; of what is disabled nothing is said.
pub(super) fn name_left_out(
    mut notes: ResMut<LeftOut>,
    mut renamed: Renamed,
    entities: Query<(Option<&SceneId>, Option<&Name>)>,
    mut named: ResMut<Named>,
    draft: ResMut<Draft>,
) {
    let mut touched = match notes.edited.is_empty() {
        true => EntityHashSet::default(),
        false => std::mem::take(&mut notes.bypass_change_detection().edited),
    };
    let others = (renamed.no_id.read())
        .chain(renamed.no_name.read())
        .chain(renamed.switched.read())
        .chain(&renamed.changed);
    touched.extend(others.filter(|entity| notes.notes.contains_key(entity)));
    let draft = draft.into_inner();
    if draft.anew {
        touched.extend(notes.notes.keys().chain(named.keys.keys()));
    }
    if touched.is_empty() {
        return;
    }
    for entity in touched {
        named.name(entity, entities.get(entity).ok(), &notes);
    }
    draft.problems.left_out = named.problems.values().flatten().cloned().collect();
    draft.reread = true;
}

impl Named {
    /// Names an entity anew, as it is called now.
    fn name(
        &mut self,
        entity: Entity,
        now: Option<(Option<&SceneId>, Option<&Name>)>,
        notes: &LeftOut,
    ) {
        for (kind, id) in self.keys.remove(&entity).into_iter().flatten() {
            self.problems.remove(&(kind, id, entity));
        }
        let (Some((id, name)), Some(notes)) = (now, notes.notes.get(&entity)) else {
            return;
        };
        let id = id.copied().unwrap_or_default();
        for (&kind, what) in notes {
            let problem = |what: &String| {
                let fault = Fault::LeftOut(what.as_str().into());
                let mut problem = SyncProblem::new(kind, id, name, fault);
                if id.is_unassigned() {
                    // A camera of Bevy's, for example.
                    let name = name.map(|name| format!(" \"{name}\"")).unwrap_or_default();
                    problem.subject = format!("{kind}{name}").into();
                }
                problem
            };
            let problems = what.iter().map(problem).collect();
            self.problems.insert((kind, id, entity), problems);
            self.keys.entry(entity).or_default().push((kind, id));
        }
    }
}
