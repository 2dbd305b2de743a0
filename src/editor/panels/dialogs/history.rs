//! Every step, the newest below; a click goes to the scene as it was after it.

use super::super::says::Says;
use crate::editor::history::{History, go_to};
use bevy::ecs::world::World;
use bevy_egui::egui::{RichText, Ui};

pub(super) fn history_ui(ui: &mut Ui, world: &mut World) {
    let history = world.resource::<History>();
    let position = history.position();
    let steps: Vec<String> = history.steps().map(str::to_owned).collect();
    if steps.is_empty() {
        ui.weak("Nothing was changed yet.");
        return;
    }
    let mut wanted = None;
    let begin = ui.selectable_label(position == 0, "The scene as it was opened");
    if begin.says("Takes all steps back").clicked() {
        wanted = Some(0);
    }
    for (i, step) in steps.into_iter().enumerate() {
        let text = match i < position {
            true => RichText::new(step),
            false => RichText::new(step).weak().italics(),
        };
        let says = "Goes to the scene as it was after this step; those below are kept";
        let response = ui.selectable_label(position == i + 1, text).says(says);
        if response.clicked() {
            wanted = Some(i + 1);
        }
    }
    if let Some(wanted) = wanted.filter(|&wanted| wanted != position) {
        go_to(world, wanted);
    }
}
