//! What the pointer's doings draw over the scene: what is selected, and the box that selects.

use super::super::navigation::LookThrough;
use super::super::pick;
use super::super::selection::Selection;
use super::super::viewport::Viewport;
use super::{Pointer, PointerUse};
use crate::view::{Outlined, Symbols};
use bevy::ecs::system::{Res, ResMut};
use bevy::ecs::world::World;
use bevy::math::Rect;
use bevy_egui::egui;

/// What is selected is outlined; a camera that is looked through is not drawn.
pub(super) fn outline_selection(
    selection: Res<Selection>,
    through: Res<LookThrough>,
    mut outlined: ResMut<Outlined>,
    mut symbols: ResMut<Symbols>,
) {
    if outlined.0 != selection.ids() {
        outlined.0 = selection.ids().to_vec();
    }
    if symbols.hidden_camera != through.camera {
        symbols.hidden_camera = through.camera;
    }
}

/// The box that is being drawn around what is to be selected.
pub(super) fn draw_box(world: &mut World) {
    let PointerUse::Box { from, to } = *world.resource::<PointerUse>() else {
        return;
    };
    let Some(context) = pick::egui_context(world) else {
        return;
    };
    let viewport = world.resource::<Viewport>().rect;
    let offset = world.resource::<Pointer>().offset;
    let rect = |rect: Rect| {
        let [min, max] =
            [rect.min, rect.max].map(|place| pick::to_points(&context, place + offset));
        egui::Rect::from_min_max(min, max)
    };
    let color = egui::Color32::from_rgb(255, 190, 60);
    context
        .layer_painter(egui::LayerId::background())
        .with_clip_rect(rect(viewport))
        .rect(
            rect(Rect::from_corners(from, to)),
            0.0,
            color.gamma_multiply(0.12),
            egui::Stroke::new(1.0, color),
            egui::StrokeKind::Inside,
        );
}
