//! An icon for each kind of entity, drawn of lines so that it is sharp at every size of the screen's
//! pixels.

use super::outline::Kind;
use bevy_egui::egui::{
    Color32, CornerRadius, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, pos2, vec2,
};

/// Points along a side.
pub(super) const SIDE: f32 = 14.0;

/// The icon in a line of text.
pub(super) fn kind_ui(ui: &mut Ui, kind: Kind) {
    let (rect, response) = ui.allocate_exact_size(vec2(SIDE, SIDE), Sense::hover());
    draw_kind(ui.painter(), rect.center(), kind, ui.visuals().text_color());
    response.on_hover_text(kind.name());
}

/// The icon around a point.
pub(super) fn draw_kind(painter: &Painter, center: Pos2, kind: Kind, ink: Color32) {
    // Lines of one width lie on whole pixels, or they are grey on both sides.
    let center = center.round();
    let at = |x: f32, y: f32| center + vec2(x, y);
    let stroke = Stroke::new(1.2, ink);
    let line = |a: Pos2, b: Pos2| painter.line_segment([a, b], stroke);
    let closed = |points: Vec<Pos2>| painter.add(Shape::closed_line(points, stroke));
    match kind {
        Kind::Object => {
            let rim = [
                (0.0, -6.0),
                (5.5, -3.0),
                (5.5, 3.0),
                (0.0, 6.0),
                (-5.5, 3.0),
                (-5.5, -3.0),
            ];
            closed(rim.map(|(x, y)| at(x, y)).to_vec());
            for i in [1, 3, 5] {
                line(at(0.0, 0.0), at(rim[i].0, rim[i].1));
            }
        }
        Kind::Material => {
            painter.circle_stroke(center, 5.5, stroke);
            painter.circle_filled(at(-1.7, -1.7), 1.8, ink);
        }
        Kind::PointLamp => {
            painter.circle_filled(center, 2.4, ink);
            for i in 0..8 {
                let (y, x) = (i as f32 * std::f32::consts::FRAC_PI_4).sin_cos();
                line(at(4.0 * x, 4.0 * y), at(6.3 * x, 6.3 * y));
            }
        }
        Kind::DirectionalLamp => {
            for x in [-4.0, 0.0, 4.0] {
                line(at(x, -6.0), at(x, 5.0));
                line(at(x - 1.8, 2.8), at(x, 5.4));
                line(at(x + 1.8, 2.8), at(x, 5.4));
            }
        }
        Kind::SegmentLamp => {
            let thick = Stroke::new(2.2, ink);
            painter.line_segment([at(-4.5, 4.5), at(4.5, -4.5)], thick);
            painter.circle_filled(at(-4.5, 4.5), 2.0, ink);
            painter.circle_filled(at(4.5, -4.5), 2.0, ink);
        }
        Kind::ParallelogramLamp => {
            let corners = [(-6.0, 4.5), (-2.0, -4.5), (6.0, -4.5), (2.0, 4.5)];
            let corners = corners.map(|(x, y)| at(x, y)).to_vec();
            let glow = ink.gamma_multiply(0.35);
            painter.add(Shape::convex_polygon(corners, glow, stroke));
        }
        Kind::Camera => {
            let body = Rect::from_min_max(at(-6.0, -4.0), at(2.5, 4.0));
            painter.rect_stroke(body, CornerRadius::same(1), stroke, StrokeKind::Middle);
            let lens = vec![at(2.5, -1.0), at(6.2, -3.6), at(6.2, 3.6), at(2.5, 1.0)];
            painter.add(Shape::closed_line(lens, stroke));
        }
        Kind::Group => {
            let folder = [
                (-6.0, 4.5),
                (-6.0, -4.5),
                (-2.0, -4.5),
                (-0.5, -2.8),
                (6.0, -2.8),
                (6.0, 4.5),
            ];
            closed(folder.map(|(x, y)| at(x, y)).to_vec());
        }
    }
}

/// The triangle that folds.
pub(super) fn draw_fold(painter: &Painter, center: Pos2, folded: bool, ink: Color32) {
    let triangle = if folded {
        [vec2(-2.5, -4.0), vec2(3.0, 0.0), vec2(-2.5, 4.0)]
    } else {
        [vec2(-4.0, -2.5), vec2(4.0, -2.5), vec2(0.0, 3.0)]
    };
    let points = triangle.map(|offset| center + offset).to_vec();
    painter.add(Shape::convex_polygon(points, ink, Stroke::NONE));
}

/// The eye that hides, crossed out where it does.
pub(super) fn draw_eye(painter: &Painter, center: Pos2, hidden: bool, ink: Color32) {
    let center = center.round();
    let lid = |up: f32| -> Vec<Pos2> {
        let part = |i: i32| i as f32 / 8.0 - 1.0;
        (0..=16)
            .map(part)
            .map(|x| pos2(center.x + 6.0 * x, center.y + up * 3.8 * (1.0 - x * x)))
            .collect()
    };
    let stroke = Stroke::new(1.1, ink);
    painter.add(Shape::line(lid(1.0), stroke));
    painter.add(Shape::line(lid(-1.0), stroke));
    painter.circle_filled(center, 1.8, ink);
    if hidden {
        let [a, b] = [vec2(-5.0, 4.0), vec2(5.0, -4.0)].map(|offset| center + offset);
        painter.line_segment([a, b], Stroke::new(1.3, ink));
    }
}
