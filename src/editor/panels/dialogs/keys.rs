//! What the mouse does, and every key.

use super::super::bindings::bindings_ui;
use super::Dialogs;
use bevy::ecs::world::World;
use bevy_egui::egui::{Grid, Label, RichText, Ui};

/// How much room keys get, in points: the longest of them.
const KEYS: f32 = 215.0;

/// What is no command of the table: held keys and the mouse.
const MOUSE: &[(&str, &str)] = &[
    (
        "Click",
        "Selects what is under the pointer; with Ctrl as well as the rest",
    ),
    ("Drag on nothing", "Selects what is in the frame"),
    ("Double click", "Moves the view so that the object fills it"),
    (
        "Middle drag, Alt+drag",
        "Turns the view around what it looks at",
    ),
    (
        "Alt+click",
        "Traces that pixel again and draws its rays, as R does",
    ),
    (
        "Click on a ray or a box",
        "Chooses it; a second click is for what is behind it",
    ),
    ("Shift+middle drag", "Moves the view sideways"),
    ("Wheel", "Moves towards what is under the pointer, or away"),
    ("Ctrl+wheel", "Changes the field of view"),
    ("Right button held", "Looks around; W A S D Q E fly"),
    (
        "C held",
        "Shows the kept picture in place of the traced one",
    ),
    ("Shift while dragging a number", "Changes it in small steps"),
];

pub(super) fn keys_ui(ui: &mut Ui, world: &mut World, dialogs: &mut Dialogs) {
    ui.weak("On a Mac, Command works as Ctrl.");
    ui.add_space(4.0);
    ui.label(RichText::new("Mouse and held keys").strong());
    Grid::new("mouse")
        .num_columns(2)
        .min_col_width(KEYS)
        .max_col_width(ui.available_width() - KEYS - 30.0)
        .striped(true)
        .spacing([18.0, 3.0])
        .show(ui, |ui| {
            for (key, says) in MOUSE {
                ui.label(RichText::new(*key).monospace());
                ui.add(Label::new(*says).wrap());
                ui.end_row();
            }
        });
    ui.add_space(8.0);
    bindings_ui(ui, world, &mut dialogs.bindings_search);
}
