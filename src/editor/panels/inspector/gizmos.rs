//! What is drawn over the picture: a switch for every system, and three ready-made answers.

use super::super::fields::{Number, integer, section, switch};
use super::super::says::Says;
use super::boxes::boxes_ui;
use super::render::choice_ui;
use crate::editor::inspection::{DebugRay, Which};
use crate::inspect::{InspectPreset, InspectSettings};
use bevy::ecs::world::World;
use bevy::reflect::{GetPath, PartialReflect, ReflectRef, TypeInfo};
use bevy_egui::egui::{Button, Label, RichText, Ui};

/// How a setting is entered.
enum Field {
    Switch,
    Choice,
    Integer(u32, u32),
    Number(f32, f32),
}

/// A setting: its path, its label, and what it does.
struct Row(&'static str, &'static str, Field, &'static str);

const RAYS: &[Row] = &[
    Row(
        "rays.on",
        "Draw",
        Field::Switch,
        "The debug rays: point at the picture and press R",
    ),
    Row("rays.camera", "Camera", Field::Switch, "From the camera"),
    Row(
        "rays.mirror",
        "Mirror",
        Field::Switch,
        "Mirrored, sharp or blurred",
    ),
    Row(
        "rays.transmission",
        "Transmission",
        Field::Switch,
        "Through transparent surfaces",
    ),
    Row(
        "rays.shadow",
        "Shadow",
        Field::Switch,
        "To point lights, in the colour that arrives",
    ),
    Row(
        "rays.light_samples",
        "Light samples",
        Field::Switch,
        "To points of area lights",
    ),
    Row(
        "rays.misses",
        "Misses",
        Field::Choice,
        "The colour of rays that met nothing",
    ),
    Row(
        "rays.max_depth",
        "Bounces",
        Field::Integer(0, 50),
        "No ray behind more surfaces than this",
    ),
    Row(
        "rays.visited",
        "Visited nodes",
        Field::Switch,
        "Nodes that the rays entered, white",
    ),
    Row(
        "rays.pruned",
        "Pruned nodes",
        Field::Switch,
        "Nodes behind a nearer hit, red",
    ),
    Row(
        "rays.hit_triangles",
        "Hit triangles",
        Field::Switch,
        "Outlines of the triangles that were hit",
    ),
    Row(
        "rays.hit_normals",
        "Hit normals",
        Field::Switch,
        "The normal at each hit",
    ),
];

const NORMALS: &[Row] = &[
    Row("normals.on", "Draw", Field::Switch, "Normals of the meshes"),
    Row(
        "normals.between",
        "Between",
        Field::Integer(0, 2),
        "Normals between the vertices too: 1 and 2 are finer",
    ),
    Row(
        "normals.length",
        "Length",
        Field::Number(1.0, 200.0),
        "Pixels on the screen",
    ),
    Row(
        "normals.spacing",
        "Spacing",
        Field::Number(0.0, 100.0),
        "Of those within so many pixels only the nearest is drawn",
    ),
];

const OTHERS: &[Row] = &[
    Row(
        "lights",
        "Lights",
        Field::Switch,
        "The lights themselves, with their colours",
    ),
    Row(
        "lens",
        "Lens",
        Field::Switch,
        "Aperture, focus plane and field of view of the camera",
    ),
    Row(
        "motion",
        "Motion",
        Field::Switch,
        "Where moving things stand when the shutter opens and closes",
    ),
    Row(
        "lobes",
        "Blur discs",
        Field::Switch,
        "The discs of blurred reflections at the debug rays' hits",
    ),
    Row(
        "pattern.on",
        "Sample pattern",
        Field::Switch,
        "Where the samples of the picked pixel lie",
    ),
    Row(
        "pattern.x",
        "Pattern across",
        Field::Choice,
        "The number of a sample that goes to the right",
    ),
    Row(
        "pattern.y",
        "Pattern down",
        Field::Choice,
        "The number of a sample that goes down",
    ),
    Row(
        "max_lines",
        "Most lines",
        Field::Integer(1, 10_000_000),
        "No system draws more; what is left out is said",
    ),
];

pub(super) fn gizmos_ui(ui: &mut Ui, world: &mut World) {
    let Some(before) = world.get_resource::<InspectSettings>().cloned() else {
        return;
    };
    let mut settings = before.clone();
    ui.horizontal_wrapped(|ui| {
        let says = "Everything of this tab, without losing what is chosen below (G)";
        ui.toggle_value(&mut settings.on, "Draw").says(says);
        for preset in InspectPreset::ALL {
            let answers = is_answer(preset, &settings);
            let button = Button::selectable(answers, preset.question());
            if ui.add(button).says(preset.says()).clicked() {
                settings = answer(preset, &settings);
                // Noise is what samples differ in.
                if preset == InspectPreset::WhereIsTheNoiseFrom
                    && let Some(mut ray) = world.get_resource_mut::<DebugRay>()
                {
                    ray.which = Which::All;
                }
            }
        }
    });
    let mut presets = InspectPreset::ALL.into_iter();
    if let Some(preset) = presets.find(|&preset| is_answer(preset, &settings)) {
        ui.add(Label::new(RichText::new(preset.says()).weak()).wrap());
    }
    ui.add_enabled_ui(settings.on, |ui| {
        for (title, open, rows) in [
            ("Debug rays", true, RAYS),
            ("Normals", false, NORMALS),
            ("Lights, lens, motion", false, OTHERS),
        ] {
            section(ui, title, open, |ui| {
                for row in rows {
                    row_ui(ui, row, &mut settings);
                }
            });
            if title == "Debug rays" {
                section(ui, "Trees", true, |ui| {
                    boxes_ui(ui, world, &mut settings);
                });
            }
        }
    });
    if settings != before {
        *world.resource_mut::<InspectSettings>() = settings;
    }
}

/// The settings that answer a question. How many lines a machine can draw is no part of it.
fn answer(preset: InspectPreset, settings: &InspectSettings) -> InspectSettings {
    InspectSettings {
        max_lines: settings.max_lines,
        ..preset.settings()
    }
}

fn is_answer(preset: InspectPreset, settings: &InspectSettings) -> bool {
    *settings == answer(preset, settings)
}

fn row_ui(ui: &mut Ui, row: &Row, settings: &mut InspectSettings) {
    let &Row(path, label, ref field, says) = row;
    match *field {
        Field::Switch => {
            if let Ok(value) = settings.path_mut::<bool>(path) {
                switch(ui, label, says, value, false);
            }
        }
        Field::Integer(least, most) => {
            if let Ok(value) = settings.path_mut::<u32>(path) {
                integer(ui, label, says, value, least..=most, false);
            }
        }
        Field::Number(least, most) => {
            if let Ok(value) = settings.path_mut::<f32>(path) {
                Number::slider(least, most, "px").row(ui, label, says, value, false);
            }
        }
        Field::Choice => {
            if let Ok(value) = settings.reflect_path_mut(path) {
                let choices = choices_of(value);
                choice_ui(ui, label, says, value, &choices);
            }
        }
    }
}

fn choices_of(value: &dyn PartialReflect) -> Vec<&'static str> {
    match (value.reflect_ref(), value.get_represented_type_info()) {
        (ReflectRef::Enum(_), Some(TypeInfo::Enum(info))) => info.variant_names().to_vec(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::render::about;
    use super::*;

    #[test]
    fn every_choice_says_what_it_means() {
        let mut settings = InspectSettings::default();
        for row in [RAYS, NORMALS, OTHERS].into_iter().flatten() {
            if !matches!(row.2, Field::Choice) {
                continue;
            }
            for choice in choices_of(settings.reflect_path_mut(row.0).unwrap()) {
                assert_ne!(about(choice), "", "{}: {choice}", row.0);
            }
        }
    }

    #[test]
    fn every_row_fits_the_type_of_its_setting() {
        let mut settings = InspectSettings::default();
        for row in [RAYS, NORMALS, OTHERS].into_iter().flatten() {
            let path = row.0;
            let fits = match row.2 {
                Field::Switch => settings.path::<bool>(path).is_ok(),
                Field::Integer(..) => settings.path::<u32>(path).is_ok(),
                Field::Number(..) => settings.path::<f32>(path).is_ok(),
                Field::Choice => settings
                    .reflect_path_mut(path)
                    .is_ok_and(|value| choices_of(value).len() > 1),
            };
            assert!(fits, "{path}");
        }
    }
}
