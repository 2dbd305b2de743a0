//! How often each brightness is there.

use crate::editor::panels::says::Says;
use crate::editor::panels::temperature::luminance;
use crate::film::Picture;
use bevy_egui::egui::{
    self, Align2, Color32, CornerRadius, FontId, Sense, Shape, Stroke, Ui, pos2, vec2,
};

/// Stops from 1 that it shows; what is darker or brighter counts for the first and for the last.
const STOPS: [f32; 2] = [-10.0, 6.0];
const BINS: usize = 64;
/// Points.
const HEIGHT: f32 = 56.0;

/// The parts of a picture's pixels in each range of brightness; the ranges are equal in stops.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Histogram([f32; BINS]);

impl Histogram {
    pub fn of(picture: &Picture) -> Self {
        let mut counts = [0_u32; BINS];
        for color in &picture.pixels {
            counts[bin(luminance(*color))] += 1;
        }
        let all = picture.pixels.len().max(1) as f32;
        Self(counts.map(|count| count as f32 / all))
    }
}

fn bin(luminance: f32) -> usize {
    let part = (luminance.log2() - STOPS[0]) / (STOPS[1] - STOPS[0]);
    // What is black, or no number, is in the first.
    (part.max(0.0) * BINS as f32).min(BINS as f32 - 1.0) as usize
}

/// Draws several over each other.
pub(super) fn histogram_ui(ui: &mut Ui, all: &[(&Histogram, Color32)]) {
    let size = vec2(ui.available_width(), HEIGHT);
    let (place, response) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter_at(place);
    painter.rect_filled(place, CornerRadius::same(3), ui.visuals().extreme_bg_color);
    let parts = all.iter().flat_map(|(histogram, _)| histogram.0);
    let most = parts.fold(f32::MIN_POSITIVE, f32::max);
    for (histogram, color) in all {
        let points = histogram.0.iter().enumerate().map(|(i, part)| {
            let x = (i as f32 + 0.5) / BINS as f32;
            // Roots, so that rare ones are seen beside frequent ones.
            let y = (part / most).sqrt();
            pos2(
                egui::lerp(place.x_range(), x),
                place.bottom() - 2.0 - y * (HEIGHT - 6.0),
            )
        });
        painter.add(Shape::line(points.collect(), Stroke::new(1.5, *color)));
    }
    let ink = ui.visuals().weak_text_color();
    for (at, align, text) in [
        (place.left_top(), Align2::LEFT_TOP, "dark"),
        (place.right_top(), Align2::RIGHT_TOP, "bright"),
    ] {
        painter.text(at, align, text, FontId::proportional(10.5), ink);
    }
    response.says("How many pixels have each brightness, from 2^-10 to 2^6, equal in stops; heights are roots");
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::{UVec2, Vec3};

    #[test]
    fn a_stop_is_four_ranges_and_what_is_beyond_counts_at_the_ends() {
        assert_eq!(bin(2.0) - bin(1.0), BINS / 16);
        assert_eq!([bin(0.0), bin(-1.0), bin(f32::NAN)], [0; 3]);
        assert_eq!([bin(1e9), bin(f32::INFINITY)], [BINS - 1; 2]);
        let mut picture = Picture::black(UVec2::new(2, 2));
        picture.pixels[3] = Vec3::ONE;
        let Histogram(parts) = Histogram::of(&picture);
        assert_eq!((parts[0], parts[bin(1.0)]), (0.75, 0.25));
    }
}
