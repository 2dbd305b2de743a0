//! Going back and forth through the steps.

use super::super::edits::SceneIndex;
use super::super::selection::Selection;
use super::state::{EntityState, Kinds};
use super::step::{Side, Step};
use super::{Gesture, History, aside, commit};
use crate::scene::SceneId;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::world::{Mut, World};
use std::collections::BTreeSet;

/// Takes the last step back. A gesture that is under way is ended first, and is that step. Returns what the step is
/// called; `None` where there is none.
pub fn undo(world: &mut World) -> Option<String> {
    settle(world);
    travel(world, Side::Before)
}

/// Does the step again that was undone last. Returns what it is called; `None` where there is none.
pub fn redo(world: &mut World) -> Option<String> {
    settle(world);
    travel(world, Side::After)
}

/// Undoes or redoes until this many steps are done, or as many as there are.
pub fn go_to(world: &mut World, position: usize) {
    settle(world);
    loop {
        let now = world.resource::<History>().done;
        let moved = match now.cmp(&position) {
            std::cmp::Ordering::Less => travel(world, Side::After),
            std::cmp::Ordering::Greater => travel(world, Side::Before),
            std::cmp::Ordering::Equal => None,
        };
        if moved.is_none() {
            return;
        }
    }
}

/// What has been changed until now is a step.
fn settle(world: &mut World) {
    world.resource_mut::<Gesture>().end();
    commit(world);
}

/// What the step is called that was undone or done again.
fn travel(world: &mut World, side: Side) -> Option<String> {
    world.resource_scope(|world, mut history: Mut<History>| {
        let index = match side {
            Side::Before => history.done.checked_sub(1),
            Side::After => Some(history.done),
        };
        let step = history.steps.get(index?).cloned()?;
        match side {
            Side::Before => history.done -= 1,
            Side::After => history.done += 1,
        }
        apply(world, &mut history, &step, side);
        Some(step.name.clone())
    })
}

/// Makes the scene what it was on one side of a step.
fn apply(world: &mut World, history: &mut History, step: &Step, side: Side) {
    world.resource_scope(|world, kinds: Mut<Kinds>| {
        let targets = apply_entities(world, history, step, side, &kinds);
        for (id, target) in targets {
            match target {
                Some(state) => history.mirror.entities.insert(id, state),
                None => history.mirror.entities.remove(&id),
            };
        }
    });
    if let Some((before, after)) = &step.settings {
        set_resource(world, [before, after][side as usize].clone());
    }
    if let Some((before, after)) = &step.environment {
        set_resource(world, [before, after][side as usize].clone());
    }
    history.mirror.update_resources(world);
    // The mirror knows all of it: looking again finds nothing, and learns which entity is which.
    let left = history.mirror.update(world);
    debug_assert!(left.is_empty(), "{} left {left:?}", step.name);
    let mut selection = step.selection[side as usize].clone();
    let index = world.resource::<SceneIndex>();
    selection.retain(|id| index.find(world, *id).is_some());
    history.selection.clone_from(&selection);
    let mut selected = world.resource_mut::<Selection>();
    if selected.ids() != selection {
        selected.set(selection);
    }
}

fn set_resource<
    T: bevy::ecs::resource::Resource<Mutability = bevy::ecs::component::Mutable> + PartialEq,
>(
    world: &mut World,
    value: T,
) {
    match world.get_resource_mut::<T>() {
        Some(mut resource) => {
            resource.set_if_neq(value);
        }
        None => world.insert_resource(value),
    }
}

fn apply_entities(
    world: &mut World,
    history: &History,
    step: &Step,
    side: Side,
    kinds: &Kinds,
) -> Vec<(SceneId, Option<EntityState>)> {
    let mirror = &history.mirror;
    let targets: Vec<(SceneId, Option<EntityState>)> = step
        .changes
        .iter()
        .map(|change| {
            let other = mirror.entities.get(&change.id);
            (change.id, change.state(other, side, kinds))
        })
        .collect();
    let find = |world: &World, id: SceneId| world.resource::<SceneIndex>().find(world, id);
    let mut made = BTreeSet::new();
    for (id, target) in &targets {
        if target.is_some() && find(world, *id).is_none() {
            if !aside::give_back(world, *id) {
                world.spawn(*id);
            }
            made.insert(*id);
        }
    }
    // Parents last, and away from the old ones first: on the way from one tree to another nobody
    // is to be among its own ancestors.
    let parent = kinds.place_of::<ChildOf>();
    for (change, (id, target)) in step.changes.iter().zip(&targets) {
        let moves = change.values.iter().any(|(place, _)| *place == parent);
        if let (Some(_), true, Some(entity)) = (target, moves, find(world, *id)) {
            world.entity_mut(entity).remove::<ChildOf>();
        }
    }
    let enforce = |world: &mut World, id: SceneId, state: &EntityState| {
        if let Some(entity) = find(world, id) {
            kinds.enforce(world, entity, state);
        }
    };
    for (id, target) in &targets {
        if let Some(state) = target {
            enforce(world, *id, state);
        }
    }
    if !made.is_empty() {
        let changed: BTreeSet<SceneId> = targets.iter().map(|(id, _)| *id).collect();
        for id in mirror.referring_to(&made) {
            if let Some(state) = mirror.entities.get(&id)
                && !changed.contains(&id)
            {
                enforce(world, id, state);
            }
        }
    }
    let gone: Vec<Entity> = targets
        .iter()
        .filter(|(_, target)| target.is_none())
        .filter_map(|(id, _)| find(world, *id))
        .collect();
    for entity in gone {
        aside::remove(world, entity);
    }
    targets
}
