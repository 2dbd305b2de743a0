//! What a person chooses about the editor itself.

use super::super::fields::{number_row, row};
use super::super::says::Says;
use crate::editor::preferences::{Preferences, ThemeChoice, config_folder};
use crate::editor::texts::path_text;
use crate::scene::Quantity;
use bevy::ecs::world::World;
use bevy_egui::egui::Ui;

pub(super) fn preferences_ui(ui: &mut Ui, world: &mut World) {
    let before = world.resource::<Preferences>().clone();
    let mut preferences = before.clone();
    let says = "The colours of the panels";
    row(ui, "Theme", says, |ui| {
        for (theme, name, says) in [
            (ThemeChoice::Dark, "Dark", "Light text on dark"),
            (ThemeChoice::Light, "Light", "Dark text on light"),
            (
                ThemeChoice::System,
                "As the system",
                "What the desktop says",
            ),
        ] {
            ui.selectable_value(&mut preferences.theme, theme, name)
                .says(says);
        }
    });
    let says = "Size of text and controls, besides the screen's own scale";
    let sizes = Quantity::within(0.5, 3.0, "×");
    number_row(ui, "Size", says, &mut preferences.zoom, sizes);
    let says = "Screen pixels along each side of a traced one: 2 is four times as fast";
    let sizes = Quantity::slider(1.0, 8.0, "");
    number_row(ui, "Traced pixel", says, &mut preferences.pixel_size, sizes);
    ui.checkbox(&mut preferences.show_hierarchy, "Show the hierarchy");
    ui.checkbox(&mut preferences.show_inspector, "Show the inspector");
    let mut hint = !preferences.hint_seen;
    ui.checkbox(&mut hint, "Show the first steps");
    preferences.hint_seen = !hint;
    ui.add_space(6.0);
    match config_folder() {
        Some(folder) => ui.weak(format!("Kept in {}", path_text(&folder))),
        None => ui.weak("Not kept: the system names no folder for it."),
    };
    if preferences != before {
        *world.resource_mut::<Preferences>() = preferences;
    }
}
