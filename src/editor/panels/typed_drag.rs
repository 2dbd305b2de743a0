//! The number that is typed in the middle of a drag, over the picture.

use crate::editor::handles::TypedDrag;
use bevy::ecs::world::World;
use bevy_egui::egui::{Align2, Color32, FontId, Rect, Ui, vec2};

/// Shows it, where anything was typed.
pub(super) fn typed_drag_ui(ui: &Ui, free: Rect, world: &World) {
    let typed = world.get_resource::<TypedDrag>().and_then(TypedDrag::shown);
    let Some(text) = typed else {
        return;
    };
    let at = free.center_top() + vec2(0.0, 24.0);
    let font = FontId::proportional(16.0);
    let galley = ui.painter().layout_no_wrap(text, font, Color32::WHITE);
    let place = Align2::CENTER_CENTER.anchor_size(at, galley.size());
    let back = Color32::from_black_alpha(190);
    ui.painter().rect_filled(place.expand(7.0), 4.0, back);
    ui.painter().galley(place.min, galley, Color32::WHITE);
}
