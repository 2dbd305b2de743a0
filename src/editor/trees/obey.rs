//! What the actions about lines and boxes do.

use crate::editor::action::Action;
use crate::editor::notice::Notices;
use crate::inspect::{BoxChoice, BoxRange, BoxSettings, InspectSettings, TreeChoice, TreeForm};
use crate::sync::Traced;
use crate::trace;
use bevy::ecs::message::MessageReader;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Res, ResMut};
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

pub(super) fn obey(
    mut actions: MessageReader<Action>,
    traced: Res<Traced>,
    mut ranges: ResMut<BoxRanges>,
    mut inspect: ResMut<InspectSettings>,
    mut notices: ResMut<Notices>,
) {
    for action in actions.read() {
        match action {
            Action::ToggleGizmos => {
                inspect.on = !inspect.on;
                notices.tell(match inspect.on {
                    true => "The tracer's lines are shown again.",
                    false => "The tracer's lines are hidden; G shows them again.",
                });
            }
            Action::Inspect(preset) => {
                // How many lines a machine can draw is no part of the question.
                let max_lines = inspect.max_lines;
                *inspect = InspectSettings {
                    max_lines,
                    ..preset.settings()
                };
                notices.tell(preset.says());
            }
            Action::PreviousLeaf | Action::NextLeaf => {
                let boxes = &inspect.boxes;
                let shown = inspect.on && boxes.on && boxes.form == TreeForm::Binary;
                if !shown || boxes.choice != BoxChoice::Leaf {
                    notices.tell(
                        "A and S step through the leaves of the trees: draw one leaf (Debug, Trees) first.",
                    );
                    continue;
                }
                let range = ranges.of(&traced.world, boxes);
                let last = (range.leaves as u32).saturating_sub(1);
                let leaf = match action {
                    Action::NextLeaf => boxes.leaf.saturating_add(1).min(last),
                    _ => boxes.leaf.saturating_sub(1).min(last),
                };
                if boxes.leaf != leaf {
                    inspect.boxes.leaf = leaf;
                }
            }
            _ => {}
        }
    }
}
