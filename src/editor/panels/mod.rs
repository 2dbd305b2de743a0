//! Everything that egui draws: menu and toolbar above, hierarchy left, inspector right, status
//! below, and the scene in the middle, which egui leaves free.

use super::viewport::Viewport;
use bevy::app::{App, Plugin};
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy::math::{Rect, Vec2};
use bevy_egui::{EguiContext, EguiPlugin, EguiPrimaryContextPass, PrimaryEguiContext, egui};

/// Draws the panels.
pub(super) struct PanelsPlugin;

impl Plugin for PanelsPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(EguiPlugin::default())
            .add_systems(EguiPrimaryContextPass, draw_panels);
    }
}

fn draw_panels(world: &mut World) {
    let mut contexts = world.query_filtered::<&mut EguiContext, With<PrimaryEguiContext>>();
    let Ok(mut context) = contexts.single_mut(world) else {
        return;
    };
    let context = context.get_mut().clone();
    let window = egui::UiBuilder::new()
        .layer_id(egui::LayerId::background())
        .max_rect(context.viewport_rect());
    let mut ui = egui::Ui::new(context.clone(), "window".into(), window);
    egui::Panel::top("menu").show_inside(&mut ui, |ui| {
        ui.label("Glassbox");
    });
    egui::Panel::bottom("status").show_inside(&mut ui, |ui| {
        ui.label("");
    });
    let free = ui.available_rect_before_wrap();
    let mut viewport = world.resource_mut::<Viewport>();
    viewport.rect = Rect {
        min: Vec2::new(free.min.x, free.min.y),
        max: Vec2::new(free.max.x, free.max.y),
    };
    let pointer = context.pointer_latest_pos();
    viewport.hovered = pointer.is_some_and(|at| free.contains(at))
        && !context.is_pointer_over_egui()
        && !context.egui_wants_pointer_input();
    viewport.takes_keys = !context.egui_wants_keyboard_input();
}
