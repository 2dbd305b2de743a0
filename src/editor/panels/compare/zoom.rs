//! A picture to look into: the wheel zooms where the pointer is, a drag moves it, and from near pixels show their numbers.

use crate::editor::panels::says::Says;
use bevy::math::UVec2;
use bevy_egui::egui::{
    self, Align2, Color32, CornerRadius, FontId, Pos2, Rect, Sense, TextureId, Ui, WidgetInfo,
    WidgetType, pos2, vec2,
};

/// Points of a pixel's side from which its numbers have room.
const NUMBERS: f32 = 44.0;
/// Points of a pixel's side at most.
const LARGEST: f32 = 160.0;
/// How much closer a point of scrolling goes.
const PER_POINT: f32 = 1.005;

/// What part of a picture is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Zoom {
    /// Points of a pixel's side, and the place in the picture, in pixels, that is in the middle; all of it, where there is none.
    near: Option<(f32, Pos2)>,
    /// The first and the last pixel that are seen; `None` where the picture is out of the room.
    pub seen: Option<[UVec2; 2]>,
}

impl Zoom {
    /// Points of a pixel's side, and what is in the middle.
    fn of(self, size: UVec2, room: egui::Vec2) -> (f32, Pos2) {
        let whole = vec2(size.x as f32, size.y as f32);
        let fits = (room / whole).min_elem();
        let (scale, middle) = self.near.unwrap_or((fits, (0.5 * whole).to_pos2()));
        (scale.clamp(fits.min(LARGEST), LARGEST), middle)
    }

    /// Draws it into the room that is left; returns the pixel under the pointer. `text` is what a pixel says from near.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        height: f32,
        (texture, size): (TextureId, UVec2),
        text: impl Fn(UVec2) -> [f32; 3],
    ) -> Option<UVec2> {
        let room = vec2(ui.available_width(), height);
        let (place, response) = ui.allocate_exact_size(room, Sense::click_and_drag());
        let says = "The wheel zooms to the pointer, a drag moves the picture, two clicks show all of it; from near, pixels say their numbers";
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, says));
        let pointer = response.hover_pos();
        self.follow(ui, &response, size, place);
        let (scale, middle) = self.of(size, room);
        let corner = place.center() - scale * middle.to_vec2();
        let whole = Rect::from_min_size(corner, scale * vec2(size.x as f32, size.y as f32));
        let painter = ui.painter_at(place);
        painter.rect_filled(place, CornerRadius::ZERO, Color32::from_gray(12));
        let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture, whole, all, Color32::WHITE);
        let pixel_at = |at: Pos2| {
            let pixel = (at - corner) / scale;
            let inside = whole.contains(at);
            inside.then(|| UVec2::new(pixel.x as u32, pixel.y as u32).min(size - UVec2::ONE))
        };
        let first = pixel_at(place.min.max(whole.min));
        let last = pixel_at(place.max.min(whole.max - vec2(0.5, 0.5)));
        self.seen = first.zip(last).map(|(first, last)| [first, last]);
        if let Some([first, last]) = self.seen
            && scale >= NUMBERS
        {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let at = corner + scale * vec2(x as f32 + 0.5, y as f32 + 0.5);
                    numbers_ui(&painter, at, text(UVec2::new(x, y)));
                }
            }
        }
        response.says(says);
        pointer.and_then(pixel_at)
    }

    fn follow(&mut self, ui: &Ui, response: &egui::Response, size: UVec2, place: Rect) {
        if response.double_clicked() {
            self.near = None;
            return;
        }
        let (scale, middle) = self.of(size, place.size());
        if response.dragged() {
            self.near = Some((scale, middle - response.drag_delta() / scale));
        }
        let Some(at) = response.hover_pos() else {
            return;
        };
        let scrolled = ui.input(|input| input.smooth_scroll_delta.y);
        if scrolled != 0.0 {
            let offset = at - place.center();
            let below = middle + offset / scale;
            let closer = Self {
                near: Some((scale * PER_POINT.powf(scrolled), middle)),
                ..*self
            };
            let (scale, _) = closer.of(size, place.size());
            // What is below the pointer stays there.
            self.near = Some((scale, below - offset / scale));
        }
    }
}

/// A pixel's three channels, one below the other, on whatever colour it has.
fn numbers_ui(painter: &egui::Painter, at: Pos2, numbers: [f32; 3]) {
    let font = FontId::monospace(10.0);
    let inks = [
        Color32::from_rgb(255, 150, 140),
        Color32::from_rgb(150, 255, 150),
        Color32::from_rgb(160, 190, 255),
    ];
    let back = Rect::from_center_size(at, vec2(42.0, 38.0));
    painter.rect_filled(back, CornerRadius::same(3), Color32::from_black_alpha(150));
    for ((number, ink), line) in numbers.into_iter().zip(inks).zip([-12.0, 0.0, 12.0]) {
        let text = short(number);
        painter.text(
            at + vec2(0.0, line),
            Align2::CENTER_CENTER,
            text,
            font.clone(),
            ink,
        );
    }
}

/// With three digits that count, in at most six letters.
fn short(number: f32) -> String {
    match number.abs() {
        size if size != 0.0 && !(1e-3..1e4).contains(&size) => format!("{number:.0e}"),
        size if size < 10.0 => format!("{number:.3}"),
        size if size < 100.0 => format!("{number:.2}"),
        _ => format!("{number:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_pixel_are_short() {
        for (number, text) in [
            (0.0, "0.000"),
            (0.12345, "0.123"),
            (-0.5, "-0.500"),
            (12.345, "12.35"),
            (345.6, "346"),
            (1e-5, "1e-5"),
            (123_456.0, "1e5"),
        ] {
            assert_eq!(short(number), text);
        }
    }

    #[test]
    fn a_picture_fits_at_first_and_is_never_smaller_than_that() {
        let size = UVec2::new(200, 100);
        let room = vec2(400.0, 400.0);
        assert_eq!(Zoom::default().of(size, room), (2.0, pos2(100.0, 50.0)));
        let far = Zoom {
            near: Some((0.01, pos2(3.0, 3.0))),
            ..Zoom::default()
        };
        assert_eq!(far.of(size, room).0, 2.0);
    }
}
