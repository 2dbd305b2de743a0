//! What is chosen and needs a switch of the render that is off: said where it was chosen, and turned on there.

use super::super::says::Says;
use crate::editor::history::History;
use crate::scene::{Property, RenderSettings};
use bevy::ecs::world::World;
use bevy::reflect::{GetPath, Typed};
use bevy_egui::egui::{Label, RichText, Ui};

/// Says which of these switches are off and offers to turn them on; nothing where all are on.
pub(super) fn switches_ui(ui: &mut Ui, world: &mut World, what: &str, paths: &[&str]) {
    let settings = world.resource::<RenderSettings>();
    let is_off = |path: &&&str| matches!(settings.path::<bool>(**path), Ok(false));
    let off: Vec<&str> = paths.iter().filter(is_off).copied().collect();
    if off.is_empty() {
        return;
    }
    let labels = off.iter().filter_map(|path| {
        let property = Property::of(RenderSettings::type_info(), path)?;
        Some(property.label)
    });
    let labels = labels.collect::<Vec<String>>().join(" and ");
    let are = if off.len() == 1 { "is" } else { "are" };
    let text = format!("{what} needs {labels}, which {are} off.");
    let text = RichText::new(text).color(ui.visuals().warn_fg_color);
    ui.horizontal_wrapped(|ui| {
        ui.add(Label::new(text).wrap());
        let says = format!("Turns {labels} on for the whole picture (Render, Features)");
        if ui.small_button("Turn on").says(&says).clicked() {
            let mut history = world.resource_mut::<History>();
            history.name_next(format!("Turn on {labels}"));
            let mut settings = world.resource_mut::<RenderSettings>();
            for path in &off {
                if let Ok(switch) = settings.path_mut::<bool>(*path) {
                    *switch = true;
                }
            }
        }
    });
}
