//! The properties: of what is selected, of the rendering, of what the gizmos show, of the trees.

mod boxes;
mod builders;
mod bvh;
mod camera;
mod debug;
mod environment;
mod error_plot;
mod figure_table;
mod foreign;
mod gizmos;
mod lamps;
mod maps;
mod material;
mod material_maps;
mod measuring;
mod motion;
mod object;
mod pair;
mod performance;
mod presets;
mod render;
mod save_text;
mod shape;
mod still_plot;
mod transform;

use super::number_field::set_owner;
use super::says::Says;
use super::state::{Panels, Tab};
use crate::editor::selection::Selection;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, ScrollArea, Ui};

pub(super) use builders::Builders;
pub(super) use bvh::Trees;
pub(super) use error_plot::ErrorCurve;
pub(super) use maps::Thumbnails;
pub(super) use performance::PerformanceForm;

/// What was typed into a field that is drawn no more, and what was chosen in a file dialog, reaches
/// those for whom it was meant: another object may be selected by now.
pub(super) fn settle(context: &egui::Context, world: &mut World, panels: &mut Panels) {
    object::settle_name(context, world, panels);
    maps::settle_pictures(context, world, &mut panels.thumbnails);
}

pub(super) fn inspector_ui(ui: &mut Ui, world: &mut World, panels: &mut Panels) {
    ui.horizontal(|ui| {
        for (tab, name, says) in [
            (Tab::Object, "Object", "What is selected"),
            (
                Tab::Render,
                "Render",
                "How the scene is rendered, and its environment",
            ),
            (
                Tab::Debug,
                "Debug",
                "What is drawn over the picture, and how the error falls",
            ),
            (Tab::Bvh, "BVH", "The trees that rays walk"),
        ] {
            ui.selectable_value(&mut panels.tab, tab, name).says(says);
        }
    });
    ui.separator();
    let selected = world.resource::<Selection>().ids();
    set_owner(ui.ctx(), (panels.tab as u8, selected));
    ScrollArea::vertical()
        .id_salt(panels.tab as u8)
        .auto_shrink([false, false])
        .show(ui, |ui| match panels.tab {
            Tab::Object => object::object_ui(ui, world, panels),
            Tab::Render => render::render_ui(ui, world, panels),
            Tab::Debug => debug::debug_ui(ui, world, panels),
            Tab::Bvh => bvh::bvh_ui(ui, world, panels),
        });
}
