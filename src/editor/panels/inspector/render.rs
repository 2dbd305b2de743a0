//! The tab Render: every setting of the table, in groups, each with a field that fits its range.

use super::super::fields::{Number, integer, row, section, switch};
use super::super::says::Says;
use super::super::state::Panels;
use super::environment::environment_ui;
use crate::scene::{RenderSettings, SETTINGS, Setting, SettingRange, setting_problems};
use bevy::ecs::world::World;
use bevy::math::UVec2;
use bevy::reflect::enums::{DynamicEnum, DynamicVariant};
use bevy::reflect::{GetPath, PartialReflect, ReflectRef};
use bevy_egui::egui::{ComboBox, DragValue, Ui};

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

pub(super) fn render_ui(ui: &mut Ui, world: &mut World, panels: &mut Panels) {
    environment_ui(ui, world, panels);
    let before = world.resource::<RenderSettings>().clone();
    let mut settings = before.clone();
    for &(title, open, paths) in GROUPS {
        section(ui, title, open, |ui| settings_ui(ui, paths, &mut settings));
    }
    for problem in setting_problems(&settings) {
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

/// The settings of these paths.
pub(super) fn settings_ui(ui: &mut Ui, paths: &[&str], settings: &mut RenderSettings) {
    for path in paths {
        if let Some(setting) = SETTINGS.iter().find(|setting| setting.path == *path) {
            setting_ui(ui, setting, settings);
        }
    }
}

fn setting_ui(ui: &mut Ui, setting: &Setting, settings: &mut RenderSettings) {
    let label = label_of(setting.path);
    let says = format!("{} ({})", sentence(setting.says), setting.path);
    match setting.range {
        SettingRange::Integer(least, most) => {
            if let Ok(value) = settings.path_mut::<u32>(setting.path) {
                integer(ui, &label, &says, value, least..=most, false);
            }
        }
        SettingRange::Number(least, most) => {
            if let Ok(value) = settings.path_mut::<f32>(setting.path) {
                number_of(setting.path, least, most).row(ui, &label, &says, value, false);
            }
        }
        SettingRange::Switch => {
            if let Ok(value) = settings.path_mut::<bool>(setting.path) {
                switch(ui, &label, &says, value, false);
            }
        }
        SettingRange::Choice => {
            if let Ok(value) = settings.reflect_path_mut(setting.path) {
                choice_ui(ui, &label, &says, value, &setting.choices());
            }
        }
        SettingRange::Size { side, pixels } => {
            if let Ok(value) = settings.path_mut::<UVec2>(setting.path) {
                size_ui(ui, &label, &says, value, side, pixels);
            }
        }
    }
}

/// How a number of the table is entered: where the table's end is only there to be safe, a slider
/// to it would be of no use.
fn number_of(path: &str, least: f32, most: f32) -> Number {
    match path {
        "sampling.error" => Number::positive(0.001, "").within(least, most),
        "sampling.time" => Number::positive(0.1, "s").within(least, most),
        "output.bloom.sigma" => Number::positive(0.1, "px").within(least, most),
        "output.exposure" => Number::free(0.02, "EV").within(least, most),
        _ => Number::slider(least, most, ""),
    }
}

/// One of an enum's variants by name.
pub(super) fn choice_ui(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut dyn PartialReflect,
    choices: &[&str],
) {
    let current = match value.reflect_ref() {
        ReflectRef::Enum(value) => value.variant_name().to_owned(),
        _ => return,
    };
    row(ui, label, says, |ui| {
        ComboBox::from_id_salt(label)
            .selected_text(words(&current))
            .width((ui.available_width() - 8.0).clamp(60.0, 240.0))
            .show_ui(ui, |ui| {
                for &choice in choices {
                    let is_current = choice == current;
                    let response = ui.selectable_label(is_current, words(choice));
                    if response.says(about(choice)).clicked() && !is_current {
                        let chosen = DynamicEnum::new(choice, DynamicVariant::Unit);
                        // It fails only for a variant that the table of choices does not hold.
                        let _ = value.try_apply(&chosen);
                    }
                }
            })
            .response
            .says(says);
    });
}

fn size_ui(ui: &mut Ui, label: &str, says: &str, value: &mut UVec2, side: u32, pixels: u64) {
    row(ui, label, says, |ui| {
        let mut entered = *value;
        let mut changed = false;
        for (axis, name) in ["width", "height"].into_iter().enumerate() {
            if axis == 1 {
                ui.label("×");
            }
            let field = DragValue::new(&mut entered[axis])
                .range(1..=side)
                .clamp_existing_to_range(false);
            let says = format!("The picture's {name} in a file, in pixels; the view has its own");
            changed |= ui.add(field).says(&says).changed();
        }
        let count = u64::from(entered.x) * u64::from(entered.y);
        if changed && count <= pixels {
            *value = entered;
        }
        let says = "Sizes that are often wanted";
        ui.menu_button("…", |ui| {
            for (name, size, says) in SIZES {
                let text = format!("{name}: {} × {}", size.x, size.y);
                if ui.button(text).says(says).clicked() {
                    *value = size;
                    ui.close();
                }
            }
        })
        .response
        .says(says);
    });
}

/// `features.soft_shadows` as a label: `Soft shadows`.
fn label_of(path: &str) -> String {
    match path {
        "spp" => return "Samples (spp)".into(),
        "jitter" => return "Jitter n×n".into(),
        "max_depth" => return "Mirror depth".into(),
        "features.environment" => return "Environment map".into(),
        "features.scale_light_samples" => return "Scale by size".into(),
        "features.normal_interpolation" => return "Smooth normals".into(),
        "features.lens" => return "Lens".into(),
        "features.motion" => return "Motion blur".into(),
        "output.bloom.enabled" => return "Bloom".into(),
        "sampling.error" => return "Stop at error".into(),
        "sampling.time" => return "Stop after".into(),
        "pixel" => return "In the pixel".into(),
        "tree.max_depth" => return "Most levels".into(),
        "tree.max_leaf_size" => return "Leaf size".into(),
        _ => {}
    }
    if let Some(bloom) = path.strip_prefix("output.bloom.") {
        return format!("Bloom {bloom}");
    }
    let name = path.rsplit('.').next().unwrap_or(path);
    sentence(&name.replace('_', " "))
}

/// With a capital.
fn sentence(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) => first.to_uppercase().chain(characters).collect(),
        None => String::new(),
    }
}

/// `VerySlow` as words: `Very slow`. Names that are none stay.
fn words(variant: &str) -> String {
    match variant {
        "AgX" | "Sah" | "Ploc" | "Srgb" => {
            return match variant {
                "Sah" => "SAH".into(),
                "Ploc" => "PLOC".into(),
                "Srgb" => "sRGB".into(),
                other => other.into(),
            };
        }
        _ => {}
    }
    let mut text = String::new();
    for (i, character) in variant.chars().enumerate() {
        if i > 0 && character.is_uppercase() {
            text.push(' ');
            text.extend(character.to_lowercase());
        } else {
            text.push(character);
        }
    }
    text
}

/// What a choice means.
pub(super) fn about(variant: &str) -> &'static str {
    match variant {
        "Sobol" => {
            "Well spread points: the error falls faster than one over the root of the samples"
        }
        "Jittered" => "One random point in each cell of a grid: better than independent ones",
        "Independent" => "Independent random numbers, to compare with",
        "Area" => "Spread over the pixel: smooth edges",
        "Center" => "All at the pixel's centre: jagged edges",
        "Corner" => "All at the pixel's lower left corner",
        "Physical" => "Inverse square, lights add up",
        "Classic" => {
            "Light colours are not attenuated, and lights are averaged: simple, not physical"
        }
        "Nearest" => "The texel that the point falls into: squares when near",
        "Bilinear" => "Between the four nearest texels",
        "Mipmap" => {
            "Trilinear: from smaller copies of the texture, by the width of the ray; no flicker far away"
        }
        "None" => "No tree: every ray tests every triangle",
        "Median" => "Half of the triangles on either side, along the longest axis",
        "Sah" => "Binned surface area heuristic: splits where the estimated cost is lowest",
        "Ploc" => {
            "Merges neighbours bottom-up, then improves the tree: the lowest estimated cost, slower to build"
        }
        "Fastest" => "The quickest to build, and the slowest to trace",
        "Fast" => "Quick to build: a little improvement",
        "Medium" => "A middle way between building and tracing",
        "Slow" => "Much improvement: slow to build, quick to trace",
        "VerySlow" => "Improves every node, again and again: the quickest to trace",
        "One" => "One tree over every triangle of every object",
        "Two" => "A tree for each mesh, and one over the objects: moving rebuilds little",
        "Raw" => "Clamped to the screen's range, nothing else",
        "Srgb" => "Clamped, then the sRGB curve",
        "AgX" => "Fits very bright light into the screen's range without hard clipping",
        "Carried" => "The light that the ray carries: the background's, or that of its picture",
        "Red" => "Red, whatever the ray carries",
        "PixelX" => "The place in the pixel, from the left",
        "PixelY" => "The place in the pixel, from the top",
        "LensU" => "The first number of the place on the lens",
        "LensV" => "The second number of the place on the lens",
        "Time" => "When the shutter is open",
        "LightU" => "The first number of the place on a light",
        "LightV" => "The second number of the place on a light",
        "GlossU" => "The first number of the place in a blurred reflection's disc",
        "GlossV" => "The second number of the place in a blurred reflection's disc",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::super::pair::{BUILDERS, about_builder};
    use super::super::shape::about_shape;
    use super::*;
    use crate::editor::action::shapes;

    #[test]
    fn every_setting_of_the_table_has_its_field_in_this_tab_or_in_that_of_the_trees() {
        let shown: Vec<&str> = GROUPS
            .iter()
            .flat_map(|group| group.2)
            .chain(super::super::bvh::SETTINGS_OF_TREES)
            .copied()
            .collect();
        for setting in SETTINGS {
            let count = shown.iter().filter(|&&path| path == setting.path).count();
            assert_eq!(count, 1, "{}", setting.path);
        }
        assert_eq!(shown.len(), SETTINGS.len());
    }

    #[test]
    fn every_choice_says_what_it_means() {
        for setting in SETTINGS {
            for choice in setting.choices() {
                assert_ne!(about(choice), "", "{}: {choice}", setting.path);
            }
        }
        for (name, ..) in shapes() {
            assert_ne!(about_shape(name), "", "{name}");
        }
        for builder in BUILDERS {
            assert_ne!(about_builder(builder), "", "{builder:?}");
        }
    }

    #[test]
    fn labels_are_words() {
        assert_eq!(label_of("features.soft_shadows"), "Soft shadows");
        assert_eq!(label_of("gloss_samples"), "Gloss samples");
        assert_eq!(label_of("output.bloom.sigma"), "Bloom sigma");
        assert_eq!(words("VerySlow"), "Very slow");
        assert_eq!(words("AgX"), "AgX");
    }
}
