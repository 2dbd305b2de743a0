//! The tab Debug: what is drawn over the picture, and how the error of the render falls.

use super::super::fields::section;
use super::super::state::with;
use super::error_plot::error_plot_ui;
use super::gizmos::gizmos_ui;
use crate::editor::viewport::traced_render;
use crate::view::TracedRender;
use bevy::ecs::world::World;
use bevy_egui::egui::Ui;

pub(super) fn debug_ui(ui: &mut Ui, world: &mut World) {
    let status = traced_render(world).and_then(TracedRender::status);
    section(ui, "Error against time", true, |ui| {
        with(world, |_, curve| error_plot_ui(ui, status.as_ref(), curve));
    });
    gizmos_ui(ui, world);
}
