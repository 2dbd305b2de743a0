//! What of the trees there is to choose from.

use super::boxes::wanted;
use super::settings::{BoxSettings, TreeForm};
use super::trees::trees;
use crate::bvh::WideBox;
use crate::trace::World;
use bevy::platform::collections::HashSet;

/// What of the trees there is to choose from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoxRange {
    /// Leaves that [`BoxSettings::leaf`] counts.
    pub leaves: usize,
    /// The deepest level of the form that is asked for.
    pub deepest: u32,
}

impl BoxRange {
    /// Of the trees that the settings ask for. One look at every node of every tree.
    pub fn of(world: &World, settings: &BoxSettings) -> Self {
        let mut range = Self::default();
        let mut seen = HashSet::new();
        for view in trees(world).filter(|view| wanted(settings, view)) {
            range.leaves += view.tree.nodes.len().div_ceil(2);
            if !seen.insert(std::ptr::from_ref(view.tree)) {
                continue;
            }
            let deepest = match (settings.form, view.instance()) {
                (TreeForm::Binary, _) => view.depths().into_iter().max(),
                (TreeForm::Wide, None) => deepest(world.aggregate.wide_boxes()),
                (TreeForm::Wide, Some((_, instance))) => deepest(instance.mesh.wide_boxes()),
            };
            range.deepest = range.deepest.max(deepest.unwrap_or(0));
        }
        range
    }
}

fn deepest(boxes: Vec<WideBox>) -> Option<u32> {
    boxes.into_iter().map(|wide| wide.depth).max()
}
