//! Over the picture: which builder's trees are on which side, and which of them is traced.

use super::overlays::label_within;
use crate::editor::trees::of_setting;
use crate::editor::trees::pair::{Side, SideState, TreePair};
use crate::editor::viewport::Viewport;
use crate::inspect::InspectSettings;
use crate::report::performance::title;
use crate::scene::Builder;
use bevy::ecs::world::World;
use bevy_egui::egui::{Align2, Rect, Ui, pos2};

/// Between the divider and what stands beside it, in points.
const MARGIN: f32 = 8.0;
/// Where there is less room for it, nothing is written.
const LEAST_WIDTH: f32 = 80.0;
/// Lines are no longer: they would cover the picture.
const MOST_WIDTH: f32 = 280.0;

/// Whether two trees are shown.
pub(super) fn is_shown(world: &World) -> bool {
    let inspect = world.get_resource::<InspectSettings>();
    inspect.is_some_and(|inspect| inspect.on && inspect.pair.on)
}

/// What a side is, in a few words.
fn heading(builder: Builder, side: &Side) -> String {
    let name = title(of_setting(builder));
    match side.state() {
        SideState::Traced => format!("{name}: these trees are traced"),
        SideState::Built => format!("{name}: to look at, not traced"),
        SideState::Building => format!("{name}: being built…"),
        SideState::Failed(why) => format!("{name}: {why}"),
    }
}

/// A heading on either side of the divider, and below it what was left out. With the split view they
/// stand below its own.
pub(super) fn labels_ui(ui: &Ui, free: Rect, world: &World, split: bool) {
    let divider = world.resource::<Viewport>().divider.clamp(0.0, 1.0);
    let x = free.min.x + divider * free.width();
    let wanted = &world.resource::<InspectSettings>().pair;
    let pair = world.resource::<TreePair>();
    let top = free.min.y + if split { 34.0 } else { 8.0 };
    let sides = [
        (wanted.left, &pair.sides[0], Align2::RIGHT_TOP, free.min.x),
        (wanted.right, &pair.sides[1], Align2::LEFT_TOP, free.max.x),
    ];
    for (builder, side, align, end) in sides {
        let width = (x - end).abs() - 2.0 * MARGIN;
        if width < LEAST_WIDTH {
            continue;
        }
        let at = x + MARGIN * (end - x).signum();
        let mut texts = vec![heading(builder, side)];
        for text in side.says() {
            if !texts.contains(&text) {
                texts.push(text);
            }
        }
        let mut y = top;
        for text in texts {
            let rect = label_within(ui, pos2(at, y), align, &text, width.min(MOST_WIDTH));
            y = rect.max.y + 7.0;
        }
    }
}
