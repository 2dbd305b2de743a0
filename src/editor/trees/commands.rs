//! The commands about lines and boxes.

use super::pair::TreePair;
use crate::editor::command::{Command, Over, State, commands};
use crate::editor::document::SceneOpened;
use crate::editor::notice::Notices;
use crate::inspect::{BoxChoice, BoxRange, BoxSettings, InspectSettings, TreeChoice, TreeForm};
use crate::sync::Traced;
use crate::trace;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::{Mut, World};
use std::sync::Arc;

/// What of the trees there is to choose from, looked at once for each world and choice of trees.
#[derive(Resource, Default)]
pub(in crate::editor) struct BoxRanges {
    of: Option<(Arc<trace::World>, Chosen)>,
    range: BoxRange,
}

/// What of the settings it depends on.
type Chosen = (u64, TreeChoice, TreeForm, BoxChoice);

impl BoxRanges {
    /// Of the trees that the settings ask for.
    pub fn of(&mut self, world: &Arc<trace::World>, boxes: &BoxSettings) -> BoxRange {
        let chosen = (boxes.object, boxes.trees, boxes.form, boxes.choice);
        let known = self.of.as_ref().is_some_and(|(of, then)| {
            *then == chosen
                && Arc::ptr_eq(&of.aggregate, &world.aggregate)
                && Arc::ptr_eq(&of.objects, &world.objects)
        });
        if !known {
            self.range = BoxRange::of(world, boxes);
            self.of = Some((world.clone(), chosen));
        }
        self.range
    }
}

/// The trees are those of another scene, whose world is large.
pub(super) fn forget_scene(_: On<SceneOpened>, mut ranges: ResMut<BoxRanges>) {
    *ranges = BoxRanges::default();
}

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "lines.show" "Show the tracer's lines" ["G"] "All that is drawn of rays and trees, off and on again as it was"
            => toggle_lines; menu("View/Rays and trees", 0); over(&[Over::Ray, Over::Box]); state(|world| State::switch(world.resource::<InspectSettings>().on)),
        "lines.pair" "Two trees side by side" [] "Two views from one place: over the left one the boxes of one builder's trees, over the right one another's, with their counts (tab BVH)"
            => toggle_pair; menu("View/Rays and trees", 2); state(is_pair_shown),
        "boxes.previous-leaf" "Previous leaf" ["A"] "One leaf back, while one leaf of the trees is drawn"
            => |world| step_leaf(world, |leaf| leaf.saturating_sub(1)); over(&[Over::Box]); repeats(); state(draws_a_leaf),
        "boxes.next-leaf" "Next leaf" ["S"] "One leaf on, while one leaf of the trees is drawn"
            => |world| step_leaf(world, |leaf| leaf.saturating_add(1)); over(&[Over::Box]); repeats(); state(draws_a_leaf),
    }
}

fn toggle_lines(world: &mut World) {
    let mut inspect = world.resource_mut::<InspectSettings>();
    inspect.on = !inspect.on;
    let text = match inspect.on {
        true => "The tracer's lines are shown again.",
        false => "The tracer's lines are hidden.",
    };
    world.resource_mut::<Notices>().tell(text);
}

fn toggle_pair(world: &mut World) {
    world.resource_scope(|world, mut pair: Mut<TreePair>| {
        let mut inspect = world.resource_mut::<InspectSettings>();
        let on = !(inspect.pair.on && inspect.on);
        pair.switch(&mut inspect, on);
    });
}

fn is_pair_shown(world: &World) -> State {
    let inspect = world.resource::<InspectSettings>();
    State::switch(inspect.pair.on && inspect.on)
}

fn draws_a_leaf(world: &World) -> State {
    let inspect = world.resource::<InspectSettings>();
    let boxes = &inspect.boxes;
    let shown = inspect.on && boxes.on && boxes.form == TreeForm::Binary;
    State::when(
        shown && boxes.choice == BoxChoice::Leaf,
        "A and S step through the leaves of the trees: draw one leaf (Debug, Trees) first.",
    )
}

fn step_leaf(world: &mut World, step: impl Fn(u32) -> u32) {
    let traced = world.resource::<Traced>().world.clone();
    let boxes = world.resource::<InspectSettings>().boxes.clone();
    let range = world.resource_mut::<BoxRanges>().of(&traced, &boxes);
    let last = (range.leaves as u32).saturating_sub(1);
    let leaf = step(boxes.leaf).min(last);
    if boxes.leaf != leaf {
        world.resource_mut::<InspectSettings>().boxes.leaf = leaf;
    }
}
