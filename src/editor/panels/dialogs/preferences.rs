//! What a person chooses about the editor itself.

use super::super::fields::{Number, choice, integer};
use crate::editor::preferences::{Preferences, ThemeChoice, config_folder};
use bevy::ecs::world::World;
use bevy_egui::egui::Ui;

pub(super) fn preferences_ui(ui: &mut Ui, world: &mut World) {
    let before = world.resource::<Preferences>().clone();
    let mut preferences = before.clone();
    choice(
        ui,
        "Theme",
        "The colours of the panels",
        &mut preferences.theme,
        &[
            (ThemeChoice::Dark, "Dark", "Light text on dark"),
            (ThemeChoice::Light, "Light", "Dark text on light"),
            (
                ThemeChoice::System,
                "As the system",
                "What the desktop says",
            ),
        ],
        false,
    );
    let says = "Size of text and controls, besides the screen's own scale; entered, not dragged";
    Number::free(0.01, "×")
        .within(0.5, 3.0)
        .row(ui, "Size", says, &mut preferences.zoom, false);
    let says = "Screen pixels along each side of a traced one: 2 is four times as fast";
    integer(
        ui,
        "Traced pixel",
        says,
        &mut preferences.pixel_size,
        1..=8,
        false,
    );
    ui.checkbox(&mut preferences.show_hierarchy, "Show the hierarchy");
    ui.checkbox(&mut preferences.show_inspector, "Show the inspector");
    let mut hint = !preferences.hint_seen;
    ui.checkbox(&mut hint, "Show the hint for beginners");
    preferences.hint_seen = !hint;
    ui.add_space(6.0);
    match config_folder() {
        Some(folder) => ui.weak(format!("Kept in {}", folder.display())),
        None => ui.weak("Not kept: the system names no folder for it."),
    };
    if preferences != before {
        *world.resource_mut::<Preferences>() = preferences;
    }
}
