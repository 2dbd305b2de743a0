use super::problem::{Fault, SyncProblem};
use super::reading::Switched;
use super::traced::Draft;
use crate::scene::SceneId;
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::platform::collections::HashMap;

/// What of another program's components, such as Bevy's own, has nothing here that it could become. A
/// mapping notes it, and it is named among the problems.
#[derive(Resource, Default)]
pub struct LeftOut(HashMap<(&'static str, Entity), Vec<String>>);

impl LeftOut {
    /// Says what is left out of an entity, in place of what was said of it as this kind of thing
    /// before. Each text follows the entity's name: `its skybox is left out`.
    pub fn note(notes: &mut ResMut<Self>, kind: &'static str, entity: Entity, what: Vec<String>) {
        let known = notes.0.get(&(kind, entity));
        if known.map_or(&[][..], Vec::as_slice) == what {
            return;
        }
        if what.is_empty() {
            notes.0.remove(&(kind, entity));
        } else {
            notes.0.insert((kind, entity), what);
        }
    }
}

#[cfg(test)]
impl LeftOut {
    /// Of how many things anything is said.
    pub fn kept(&self) -> usize {
        self.0.len()
    }
}

/// Names what is left out of entities that there are.
pub(super) fn name_left_out(
    notes: Res<LeftOut>,
    entities: Query<(Option<&SceneId>, Option<&Name>)>,
    mut switched: Switched,
    draft: ResMut<Draft>,
) {
    // Of what is disabled nothing is said.
    if !(switched.any() | notes.is_changed()) {
        return;
    }
    let draft = draft.into_inner();
    let mut sorted: Vec<_> = (notes.0.iter())
        .filter_map(|(&(kind, entity), what)| {
            let (id, name) = entities.get(entity).ok()?;
            Some((kind, id.copied().unwrap_or_default(), entity, name, what))
        })
        .collect();
    sorted.sort_unstable_by_key(|&(kind, id, entity, ..)| (kind, id, entity));
    draft.problems.left_out = sorted
        .into_iter()
        .flat_map(|(kind, id, _, name, what)| {
            let faults = what.iter().cloned().map(Fault::LeftOut);
            faults.map(move |fault| {
                let mut problem = SyncProblem::new(kind, id, name, fault);
                if id.is_unassigned() {
                    // A camera of Bevy's, for example.
                    let name = name.map(|name| format!(" \"{name}\"")).unwrap_or_default();
                    problem.subject = format!("{kind}{name}");
                }
                problem
            })
        })
        .collect();
    draft.reread = true;
}
