//! The number that is typed in the middle of a drag, over the picture.

use crate::editor::handles::TypedDrag;
use bevy::ecs::world::World;
use bevy_egui::egui::{Align2, Color32, FontId, Id, LayerId, Order, Rect, Ui, vec2};

/// Shows it, where anything was typed: over all cards, since it says what the next key does.
pub(super) fn typed_drag_ui(ui: &Ui, free: Rect, world: &World) {
    let typed = world.get_resource::<TypedDrag>().and_then(TypedDrag::shown);
    let Some(text) = typed else {
        return;
    };
    let at = free.center_top() + vec2(0.0, 24.0);
    let font = FontId::proportional(16.0);
    let layer = LayerId::new(Order::Tooltip, Id::new("typed drag"));
    let painter = ui.ctx().layer_painter(layer);
    let galley = painter.layout_no_wrap(text, font, Color32::WHITE);
    let place = Align2::CENTER_CENTER.anchor_size(at, galley.size());
    let back = Color32::from_black_alpha(190);
    painter.rect_filled(place.expand(7.0), 4.0, back);
    painter.galley(place.min, galley, Color32::WHITE);
}
