//! What is drawn over the picture: a switch for every system, and three ready-made answers.

use super::super::fields::{Number, integer, section, switch};
use super::super::says::Says;
use super::render::choice_ui;
use crate::editor::inspection::{DebugRay, Which};
use crate::inspect::{InspectPreset, InspectSettings};
use bevy::ecs::world::World;
use bevy::reflect::{GetPath, PartialReflect, ReflectRef, TypeInfo};
use bevy_egui::egui::Ui;

/// How a setting is entered.
enum Field {
    Switch,
    Choice,
    Integer(u32, u32),
    Number(f32, f32),
}

/// A setting: its path, its label, and what it does.
struct Row(&'static str, &'static str, Field, &'static str);

const BOXES: &[Row] = &[
    Row(
        "boxes.on",
        "Draw",
        Field::Switch,
        "Boxes of the trees' nodes",
    ),
    Row(
        "boxes.choice",
        "Which",
        Field::Choice,
        "A range of levels, one leaf, or the way to a triangle",
    ),
    Row(
        "boxes.from_level",
        "From level",
        Field::Integer(0, 64),
        "The first level that is drawn; the root's is 0",
    ),
    Row(
        "boxes.to_level",
        "To level",
        Field::Integer(0, 64),
        "The last level that is drawn",
    ),
    Row(
        "boxes.leaf",
        "Leaf",
        Field::Integer(0, 1_000_000),
        "Which leaf, in their order; A and S step",
    ),
    Row(
        "boxes.trees",
        "Trees",
        Field::Choice,
        "The one over the objects, those of the meshes, or both",
    ),
    Row(
        "boxes.color",
        "Colour",
        Field::Choice,
        "What a box's colour says",
    ),
    Row(
        "boxes.split_planes",
        "Split planes",
        Field::Switch,
        "The plane between each drawn node's children",
    ),
    Row(
        "boxes.triangles",
        "Triangles",
        Field::Switch,
        "The triangles of drawn leaves",
    ),
];

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
        let says = "Everything of this tab, without losing what is chosen below";
        ui.toggle_value(&mut settings.on, "Draw").says(says);
        for preset in InspectPreset::ALL {
            let question = preset.question();
            if ui
                .button(question)
                .says("Sets what is drawn so that it answers this")
                .clicked()
            {
                settings = preset.settings();
                // Noise is what samples differ in.
                if preset == InspectPreset::WhereIsTheNoiseFrom
                    && let Some(mut ray) = world.get_resource_mut::<DebugRay>()
                {
                    ray.which = Which::All;
                }
            }
        }
    });
    ui.add_enabled_ui(settings.on, |ui| {
        for (title, open, rows) in [
            ("Debug rays", true, RAYS),
            ("Trees", true, BOXES),
            ("Normals", false, NORMALS),
            ("Lights, lens, motion", false, OTHERS),
        ] {
            section(ui, title, open, |ui| {
                for row in rows {
                    row_ui(ui, row, &mut settings);
                }
            });
        }
    });
    if settings != before {
        *world.resource_mut::<InspectSettings>() = settings;
    }
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
    use super::*;

    #[test]
    fn every_row_fits_the_type_of_its_setting() {
        let mut settings = InspectSettings::default();
        for row in [RAYS, BOXES, NORMALS, OTHERS].into_iter().flatten() {
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
