//! The tab Render: every setting of the render, in groups.

use super::super::fields::{properties_ui, row, section};
use super::super::says::Says;
use super::environment::environment_ui;
use super::maps::Thumbnails;
use crate::scene::{RenderSettings, range_problems};
use bevy::ecs::world::World;
use bevy::math::UVec2;
use bevy_egui::egui::Ui;

/// A group of settings: its title, whether it is open at first, and the paths in it.
type Group = (&'static str, bool, &'static [&'static str]);

/// The groups in their order. The trees are in a tab of their own.
const GROUPS: &[Group] = &[
    (
        "Features",
        true,
        &[
            "features.shading",
            "features.mirrors",
            "max_depth",
            "features.shadows",
            "features.soft_shadows",
            "features.scale_light_samples",
            "features.normal_interpolation",
            "features.textures",
            "texture_filter",
            "features.environment",
            "features.glossy",
            "gloss_samples",
            "features.transparency",
            "features.translucency",
            "translucency_samples",
            "features.lens",
            "features.motion",
            "lighting",
        ],
    ),
    (
        "Sampling",
        true,
        &[
            "spp",
            "jitter",
            "pixel",
            "sequence",
            "seed",
            "sampling.adaptive",
            "sampling.error",
            "sampling.time",
        ],
    ),
    (
        "Output",
        true,
        &[
            "size",
            "output.exposure",
            "output.view_transform",
            "output.bloom.enabled",
            "output.bloom.threshold",
            "output.bloom.intensity",
            "output.bloom.sigma",
        ],
    ),
];

/// Sizes of pictures, and what they are for.
const SIZES: [(&str, UVec2, &str); 5] = [
    (
        "Square",
        UVec2::new(800, 800),
        "As wide as high: quick to render",
    ),
    (
        "HD",
        UVec2::new(1280, 720),
        "16 to 9, as small as videos are",
    ),
    (
        "Full HD",
        UVec2::new(1920, 1080),
        "16 to 9, as most screens have it",
    ),
    (
        "Square, large",
        UVec2::new(2048, 2048),
        "As wide as high, for prints and textures",
    ),
    (
        "4K",
        UVec2::new(3840, 2160),
        "16 to 9, four times the pixels of Full HD",
    ),
];

pub(super) fn render_ui(ui: &mut Ui, world: &mut World, thumbnails: &mut Thumbnails) {
    environment_ui(ui, world, thumbnails);
    let before = world.resource::<RenderSettings>().clone();
    let mut settings = before.clone();
    for &(title, open, paths) in GROUPS {
        section(ui, title, open, |ui| {
            properties_ui(ui, &mut settings, paths);
            if paths.contains(&"size") {
                sizes_ui(ui, &mut settings);
            }
        });
    }
    for problem in range_problems(&settings) {
        ui.colored_label(ui.visuals().warn_fg_color, problem.to_string());
    }
    ui.horizontal(|ui| {
        let says =
            "Sets features, sampling and output, but not the size, to what they are in a new scene";
        if ui.button("Reset").says(says).clicked() {
            settings = RenderSettings {
                size: settings.size,
                tree: settings.tree,
                ..RenderSettings::default()
            };
        }
    });
    if settings != before {
        *world.resource_mut::<RenderSettings>() = settings;
    }
}

/// Sizes that are often wanted, beside the field for the size.
fn sizes_ui(ui: &mut Ui, settings: &mut RenderSettings) {
    let says = "Sizes that are often wanted; the view has its own";
    row(ui, "", says, |ui| {
        ui.menu_button("Usual sizes…", |ui| {
            for (name, size, says) in SIZES {
                let text = format!("{name}: {} × {}", size.x, size.y);
                if ui.button(text).says(says).clicked() {
                    settings.size = size;
                    ui.close();
                }
            }
        })
        .response
        .says(says);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SETTINGS;

    #[test]
    fn every_setting_of_the_table_has_its_field_in_this_tab_or_in_that_of_the_trees() {
        let shown: Vec<&str> = GROUPS
            .iter()
            .flat_map(|group| group.2)
            .chain(super::super::bvh::SETTINGS_OF_TREES)
            .copied()
            .collect();
        for setting in SETTINGS.iter() {
            let count = shown.iter().filter(|&&path| path == setting.path).count();
            assert_eq!(count, 1, "{}", setting.path);
        }
        assert_eq!(shown.len(), SETTINGS.len());
    }
}
