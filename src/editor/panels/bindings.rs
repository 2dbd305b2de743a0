//! Which keys send which command, and giving them others.

use super::says::Says;
use crate::editor::command::{Command, CommandTable};
use crate::editor::keys::{Keys, Recording};
use crate::editor::preferences::Preferences;
use bevy::ecs::world::{Mut, World};
use bevy_egui::egui::{Button, Grid, Label, RichText, TextEdit, Ui};
use std::sync::Arc;

/// How much room names get, in points: the longest of them.
const NAMES: f32 = 215.0;
/// And keys.
const KEYS: f32 = 150.0;

/// What was done to a row.
enum Wish {
    /// The next key is for it.
    Record(String),
    Reset(Arc<Command>),
}

pub(super) fn bindings_ui(ui: &mut Ui, world: &mut World, search: &mut String) {
    let recorded = world.get_resource::<Recording>();
    let recorded = recorded.and_then(|recording| recording.0.clone());
    let mut resets = false;
    ui.horizontal(|ui| {
        ui.label(RichText::new("Keys").strong());
        ui.weak("Press a button, then the keys that shall send it.");
        let field = TextEdit::singleline(&mut *search)
            .hint_text("Search")
            .desired_width(140.0);
        ui.add(field)
            .says("Shows only commands whose name or keys contain this");
        let button = ui.button("Reset all");
        let says = "Gives every command the keys that it had at first";
        resets = button.says(says).clicked();
    });
    let table = world.resource::<CommandTable>();
    let bindings = &world.resource::<Preferences>().keys;
    let conflicts = table.conflicts(bindings);
    let needle = search.trim().to_lowercase();
    let mut wish = None;
    let mut shown = 0;
    let width = ui.available_width() - NAMES - KEYS - 60.0;
    Grid::new("keys")
        .num_columns(3)
        .striped(true)
        .spacing([18.0, 3.0])
        .show(ui, |ui| {
            for row in table.rows() {
                let keys: Vec<String> = bindings.of(row).iter().map(Keys::text).collect();
                let keys = keys.join(", ");
                let fits = |text: &str| text.to_lowercase().contains(&needle);
                if !fits(&row.name) && !fits(&keys) {
                    continue;
                }
                shown += 1;
                let records = recorded.as_deref() == Some(&*row.id);
                let clash = conflicts
                    .iter()
                    .find(|(_, rows)| rows.iter().any(|other| other.id == row.id));
                ui.scope(|ui| {
                    ui.set_min_width(NAMES);
                    ui.set_max_width(NAMES);
                    ui.add(Label::new(&*row.name).truncate()).says(&row.id);
                });
                ui.horizontal(|ui| {
                    ui.set_min_width(KEYS);
                    let text = match (records, keys.as_str()) {
                        (true, _) => "press keys…",
                        (false, "") => "–",
                        (false, keys) => keys,
                    };
                    let mut text = RichText::new(text).monospace();
                    if clash.is_some() {
                        text = text.color(ui.visuals().warn_fg_color);
                    }
                    let says = match clash {
                        Some((keys, rows)) => clash_text(*keys, rows),
                        None => "Changes the keys; Escape leaves them".to_owned(),
                    };
                    if ui.add(Button::new(text).small()).says(&says).clicked() {
                        wish = Some(Wish::Record(row.id.to_string()));
                    }
                    if bindings.is_chosen(row) {
                        let button = ui.small_button("⟲");
                        if button.says("Its own keys again").clicked() {
                            wish = Some(Wish::Reset(row.clone()));
                        }
                    }
                });
                ui.scope(|ui| {
                    ui.set_max_width(width.max(80.0));
                    ui.add(Label::new(&*row.help).wrap());
                });
                ui.end_row();
            }
        });
    if shown == 0 {
        ui.weak("No command is called that, nor has such keys.");
    }
    match wish {
        Some(Wish::Record(id)) => {
            if let Some(mut recording) = world.get_resource_mut::<Recording>() {
                recording.0 = Some(id);
            }
        }
        Some(Wish::Reset(row)) => world.resource_scope(|world, table: Mut<CommandTable>| {
            world.resource_mut::<Preferences>().keys.reset(&table, &row);
        }),
        None if resets => world.resource_mut::<Preferences>().keys.reset_all(),
        None => {
            // Who turns to something else, as to the field above, does not mean the command any more.
            if ui.input(|input| input.pointer.any_pressed()) {
                note_recording(world, false);
            }
        }
    }
}

/// Whether a command waits for keys; none does where their list is not in front.
pub(super) fn note_recording(world: &mut World, is_in_front: bool) -> bool {
    let Some(mut recording) = world.get_resource_mut::<Recording>() else {
        return false;
    };
    if !is_in_front && recording.0.is_some() {
        recording.0 = None;
    }
    recording.0.is_some()
}

fn clash_text(keys: Keys, rows: &[Arc<Command>]) -> String {
    let names: Vec<&str> = rows.iter().map(|row| &*row.name).collect();
    format!("{} is wanted by {}", keys.text(), names.join(" and by "))
}
