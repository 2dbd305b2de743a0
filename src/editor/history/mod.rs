//! Undo and redo of everything, however it was changed.
//!
//! [`History`] holds a mirror of the scene: the components that scene files keep and those that an app has registered of
//! its own, of every entity with a [`SceneId`], and the scene's two resources. At the end of a frame, when no [`Gesture`] is
//! under way, what Bevy's change detection names is compared with the mirror, and the differences
//! become one step. So whoever edits just changes components; a drag is one step because the
//! gesture holds the comparison back.
//!
//! Undo and redo find entities by their numbers, and make those anew that are gone. What is derived
//! from the kept components (meshes, textures, places in the world) is not stored: the systems that
//! derive it do so again.

mod apply;
mod aside;
mod gesture;
mod mirror;
mod state;
mod step;
mod within;

pub use apply::{go_to, redo, undo};
pub(in crate::editor) use aside::{LaidAside, remove};
pub use gesture::Gesture;
pub(in crate::editor) use state::Kinds;
pub(in crate::editor) use within::{OnlyWithin, within};

use super::edits::SceneIndex;
use super::schedule;
use super::selection::Selection;
use crate::io::KeptComponents;
use crate::scene::{Environment, RenderSettings, SceneId};
use bevy::app::{App, Last, Plugin};
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::Entity;
use bevy::ecs::lifecycle::Remove;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::{Mut, World};
use mirror::{Mirror, Watch, watch_foreign};
use std::collections::VecDeque;
use std::sync::Arc;
use step::{Change, Step};

/// Steps are forgotten, the oldest first, when they take more memory than this. Moving an object
/// takes about 400 bytes, deleting one about 2 kB.
const MOST_BYTES: usize = 64 << 20;

/// The steps that were done, and those that were undone.
#[derive(Resource, Default)]
pub struct History {
    steps: VecDeque<Arc<Step>>,
    /// How many of the steps are done; those after it were undone.
    done: usize,
    /// The state of the scene before the first step that is kept.
    base: u64,
    last_serial: u64,
    bytes: usize,
    next_name: Option<String>,
    /// As it was when the scene was last found unchanged.
    selection: Vec<SceneId>,
    mirror: Mirror,
    started: bool,
}

impl History {
    /// How the next step is to be called. It is forgotten if nothing changes in this frame.
    pub fn name_next(&mut self, name: impl Into<String>) {
        self.next_name = Some(name.into());
    }

    /// The name of the step that undo takes back.
    pub fn undo_text(&self) -> Option<&str> {
        let last = self.done.checked_sub(1)?;
        self.steps.get(last).map(|step| step.name.as_str())
    }

    /// The name of the step that redo does again.
    pub fn redo_text(&self) -> Option<&str> {
        self.steps.get(self.done).map(|step| step.name.as_str())
    }

    /// The names of all steps, those that were undone last.
    pub fn steps(&self) -> impl ExactSizeIterator<Item = &str> {
        self.steps.iter().map(|step| step.name.as_str())
    }

    /// How many of [`Self::steps`] are done.
    pub fn position(&self) -> usize {
        self.done
    }

    /// Tells states of the scene apart: it is the same number again when undo or redo lead back, and a step leads to a
    /// greater one than there ever was.
    pub fn state(&self) -> u64 {
        match self
            .done
            .checked_sub(1)
            .and_then(|last| self.steps.get(last))
        {
            Some(step) => step.serial,
            None => self.base,
        }
    }

    /// Whether the step that led to this [state](Self::state) is done, and has not been undone since.
    pub(super) fn is_done(&self, state: u64) -> bool {
        let found = self.steps.binary_search_by_key(&state, |step| step.serial);
        state <= self.base || found.is_ok_and(|at| at < self.done)
    }

    /// About how much memory the steps take, in bytes.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    fn push(&mut self, step: Step) {
        for undone in self.steps.drain(self.done..) {
            self.bytes -= undone.bytes();
        }
        self.bytes += step.bytes();
        self.steps.push_back(Arc::new(step));
        while self.bytes > MOST_BYTES && self.steps.len() > 1 {
            if let Some(forgotten) = self.steps.pop_front() {
                self.bytes -= forgotten.bytes();
                self.base = forgotten.serial;
            }
        }
        self.done = self.steps.len();
    }
}

/// Keeps [`History`] in step with the scene.
pub struct HistoryPlugin;

impl Plugin for HistoryPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<History>()
            .init_resource::<Gesture>()
            .init_resource::<Selection>()
            .init_resource::<Kinds>()
            .init_resource::<SceneIndex>()
            .init_resource::<Removals>()
            .init_resource::<aside::Aside>()
            .add_observer(note_removal)
            .add_systems(Last, |world: &mut World| {
                let started = world.resource::<History>().started;
                if !(started && world.contains_resource::<OnlyWithin>()) {
                    commit(world);
                }
            });
        schedule::add_to(app);
        SceneIndex::watch(app);
        let watch = Watch::new(app.world_mut());
        app.insert_resource(watch);
    }
}

/// Entities that lost a kept component, or all: change detection does not see what is gone.
#[derive(Resource, Default)]
struct Removals(Vec<Entity>);

fn note_removal(gone: On<Remove, KeptComponents>, mut removals: ResMut<Removals>) {
    removals.0.push(gone.entity);
}

/// Makes a step of what changed since the last one. True where anything did. Nothing happens while
/// a gesture is under way.
pub fn commit(world: &mut World) -> bool {
    if world.resource::<Gesture>().active() {
        return false;
    }
    if !world.resource::<History>().started {
        reset(world);
        return false;
    }
    world.resource_scope(|world, mut history: Mut<History>| {
        // Looking every frame is no change: panels redraw their list when there is one.
        let changed = commit_to(world, history.bypass_change_detection());
        if changed {
            history.set_changed();
        }
        changed
    })
}

fn commit_to(world: &mut World, history: &mut History) -> bool {
    let gesture = world.resource_mut::<Gesture>().take_name();
    let name = history.next_name.take().or(gesture);
    let changes = history.mirror.update(world);
    let (settings, environment) = history.mirror.update_resources(world);
    let selection = world.resource::<Selection>().ids().to_vec();
    if changes.is_empty() && settings.is_none() && environment.is_none() {
        history.selection = selection;
        return false;
    }
    let mut selection = selection;
    if changes.iter().any(|change| !change.exists[1]) {
        let index = world.resource::<SceneIndex>();
        selection.retain(|id| index.find(world, *id).is_some());
        let mut selected = world.resource_mut::<Selection>();
        if selected.ids() != selection {
            selected.set(selection.iter().copied());
        }
    }
    history.last_serial += 1;
    let before = std::mem::replace(&mut history.selection, selection.clone());
    let mut step = Step {
        name: String::new(),
        serial: history.last_serial,
        changes,
        settings,
        environment,
        selection: [before, selection],
    };
    step.name = name.unwrap_or_else(|| {
        let kinds = world.resource::<Kinds>();
        step.describe(kinds, |id| history.mirror.name(kinds, id, &step))
    });
    history.push(step);
    true
}

/// Forgets all steps: the scene as it is now is the first state. For after opening a scene.
pub fn reset(world: &mut World) {
    watch_foreign(world);
    world.resource_scope(|world, mut history: Mut<History>| {
        let last_serial = history.last_serial + 1;
        *history = History {
            base: last_serial,
            last_serial,
            started: true,
            selection: world.resource::<Selection>().ids().to_vec(),
            ..History::default()
        };
        world.resource_mut::<Gesture>().take_name();
        aside::forget(world);
        history.mirror.update(world);
        history.mirror.fill(world);
        history.mirror.update_resources(world);
    });
}

/// The scene's resources, before and after, where one changed.
type ResourceChanges = (
    Option<(RenderSettings, RenderSettings)>,
    Option<(Environment, Environment)>,
);

/// Changes of entities, in the order of their numbers.
type Changes = Vec<Change>;
