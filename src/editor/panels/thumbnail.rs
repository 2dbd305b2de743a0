//! A small picture within a place of another shape.

use bevy_egui::egui::{self, Color32, Rect, Stroke, StrokeKind, TextureHandle, Ui};

/// Draws it as large as it fits, or where it is none yet, its place. Only an edge parts it from what is around: a ground
/// beside it would be as white in the light theme as what is brightest in the picture.
pub(super) fn thumbnail_ui(ui: &Ui, place: Rect, picture: Option<&TextureHandle>, tint: Color32) {
    let edge = Stroke::new(1.0, ui.visuals().widgets.noninteractive.bg_stroke.color);
    let Some(texture) = picture else {
        ui.painter()
            .rect_stroke(place, 3.0, edge, StrokeKind::Inside);
        return;
    };
    let size = texture.size_vec2();
    let size = size * (place.size() / size).min_elem();
    let inner = Rect::from_center_size(place.center(), size);
    egui::Image::new(texture).tint(tint).paint_at(ui, inner);
    ui.painter()
        .rect_stroke(inner, 0.0, edge, StrokeKind::Outside);
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_egui::egui::epaint::ClippedShape;
    use bevy_egui::egui::{ColorImage, Context, RawInput, Shape, TextureOptions, Theme, vec2};

    #[test]
    fn nothing_is_filled_beside_a_picture_in_either_theme() {
        for theme in [Theme::Dark, Theme::Light] {
            let context = Context::default();
            context.set_theme(theme);
            let image = ColorImage::filled([8, 2], Color32::BLACK);
            let texture = context.load_texture("strip", image, TextureOptions::LINEAR);
            let place = Rect::from_min_size(egui::pos2(10.0, 10.0), vec2(36.0, 36.0));
            for picture in [Some(&texture), None] {
                let output = context.run_ui(RawInput::default(), |ui| {
                    thumbnail_ui(ui, place, picture, Color32::WHITE);
                });
                let rects =
                    output
                        .shapes
                        .iter()
                        .filter_map(|ClippedShape { shape, .. }| match shape {
                            Shape::Rect(rect) if place.contains_rect(rect.rect) => Some(rect),
                            _ => None,
                        });
                let mut edges = 0;
                for rect in rects {
                    let is_picture = rect.brush.is_some();
                    let filled = rect.fill != Color32::TRANSPARENT;
                    assert!(is_picture || !filled, "{theme:?}: {rect:?}");
                    assert!(!is_picture || rect.rect.height() == 9.0, "{rect:?}");
                    edges += usize::from(rect.stroke.width > 0.0);
                }
                assert_eq!(edges, 1, "{theme:?}");
            }
        }
    }
}
