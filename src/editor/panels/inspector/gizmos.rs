//! What is drawn over the picture: a switch for every system, and three ready-made answers.

use super::super::fields::{properties_ui, section};
use super::super::says::Says;
use super::boxes::boxes_ui;
use crate::editor::inspection::{preset_settings, show_preset};
use crate::inspect::{InspectPreset, InspectSettings};
use bevy::ecs::world::World;
use bevy_egui::egui::{Button, Label, RichText, Ui};

/// A group of settings: its title, whether it is open at first, and the paths in it.
type Group = (&'static str, bool, &'static [&'static str]);

const RAYS: Group = (
    "Debug rays",
    true,
    &[
        "rays.on",
        "rays.camera",
        "rays.mirror",
        "rays.transmission",
        "rays.shadow",
        "rays.light_samples",
        "rays.misses",
        "rays.max_depth",
        "rays.visited",
        "rays.pruned",
        "rays.hit_triangles",
        "rays.hit_normals",
    ],
);

const NORMALS: Group = (
    "Normals",
    false,
    &[
        "normals.on",
        "normals.between",
        "normals.length",
        "normals.spacing",
    ],
);

const OTHERS: Group = (
    "Lights, lens, motion",
    false,
    &[
        "lights",
        "lens",
        "motion",
        "lobes",
        "pattern.on",
        "pattern.x",
        "pattern.y",
        "max_lines",
    ],
);

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
            let button = Button::selectable(answers, preset.title());
            if ui.add(button).says(preset.says()).clicked() {
                show_preset(world, preset);
                settings = world.resource::<InspectSettings>().clone();
            }
        }
    });
    let mut presets = InspectPreset::ALL.into_iter();
    if let Some(preset) = presets.find(|&preset| is_answer(preset, &settings)) {
        ui.add(Label::new(RichText::new(preset.says()).weak()).wrap());
    }
    ui.add_enabled_ui(settings.on, |ui| {
        let group = |ui: &mut Ui, (title, open, paths): Group, settings: &mut InspectSettings| {
            section(ui, title, open, |ui| properties_ui(ui, settings, paths));
        };
        group(ui, RAYS, &mut settings);
        section(ui, "Trees", true, |ui| {
            boxes_ui(ui, world, &mut settings);
        });
        group(ui, NORMALS, &mut settings);
        group(ui, OTHERS, &mut settings);
    });
    if settings != before {
        *world.resource_mut::<InspectSettings>() = settings;
    }
}

fn is_answer(preset: InspectPreset, settings: &InspectSettings) -> bool {
    *settings == preset_settings(preset, settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Property;
    use bevy::reflect::Typed;

    #[test]
    fn every_setting_of_these_groups_says_what_it_does_and_so_do_its_choices() {
        for path in [RAYS, NORMALS, OTHERS]
            .into_iter()
            .flat_map(|group| group.2)
        {
            let setting = Property::of(InspectSettings::type_info(), path).expect(path);
            assert_ne!(setting.says, "", "{path}");
            for choice in setting.choices() {
                assert_ne!(choice.says, "", "{path}: {}", choice.name);
            }
        }
    }
}
