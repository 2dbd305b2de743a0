//! A bar with the palette, the values at its ends and the unit, written into a heatmap.

use super::font::{ADVANCE, HEIGHT, WIDTH, glyph};
use super::{Scale, Shown, UNKNOWN};
use glam::UVec2;

/// Width of the bar in units of a font pixel.
const BAR_WIDTH: u32 = 160;

/// Height of the bar in the same unit.
const BAR_HEIGHT: u32 = 8;

/// Between the legend and the picture's border, and around its parts.
const MARGIN: u32 = 3;

/// Rows of a picture for each pixel of a font pixel's edge: at 400 rows letters are 7 pixels high.
const ROWS_PER_UNIT: u32 = 400;

/// What of the picture is left behind the legend.
const DIMMED: f32 = 0.15;

const INK: [f32; 3] = [1.0; 3];

/// What the colour of values that are not known is called.
const UNKNOWN_TEXT: &str = "unknown";

/// Writes the legend into the lower left corner; false where the view is no heatmap and has none.
/// What a small picture has no room for is cut off.
pub fn burn_legend(shown: &mut Shown) -> bool {
    let Some(scale) = shown.scale else {
        return false;
    };
    let unit = (shown.height / ROWS_PER_UNIT).max(1);
    let (low, high) = (number(scale.low), number(scale.high));
    let high = format!("{high} {}", scale.unit);
    let text_width = |text: &str| text.chars().count() as u32 * ADVANCE - 1;
    // Both numbers, with a gap between them, or the bar: whichever is wider.
    let inner = BAR_WIDTH.max(text_width(&low) + 2 * ADVANCE + text_width(&high));
    // A line more where some values are not known: a square of their colour, and what it means.
    let line = if shown.has_unknown {
        HEIGHT + MARGIN
    } else {
        0
    };
    let (width, height) = (inner + 2 * MARGIN, BAR_HEIGHT + HEIGHT + 3 * MARGIN + line);
    let mut canvas = Canvas {
        left: MARGIN * unit,
        top: shown.height.saturating_sub((height + MARGIN) * unit),
        unit,
        shown,
    };
    canvas.dim(width, height);
    if line > 0 {
        canvas.fill(MARGIN, MARGIN, UVec2::splat(HEIGHT), UNKNOWN);
        canvas.text(MARGIN + HEIGHT + MARGIN, MARGIN, UNKNOWN_TEXT);
    }
    canvas.text(MARGIN, MARGIN + line, &low);
    canvas.text(MARGIN + inner - text_width(&high), MARGIN + line, &high);
    canvas.bar(MARGIN, 2 * MARGIN + HEIGHT + line, inner, &scale);
    true
}

/// At most four digits: `12`, `0.125`, `98760`, `1.2e-7`.
fn number(value: f32) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..99_999.5).contains(&size) {
        return format!("{value:.1e}");
    }
    // Three digits behind the first one that counts, no digits behind whole numbers of four.
    let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A place in a picture, measured in font pixels of `unit` × `unit` pixels.
struct Canvas<'a> {
    left: u32,
    top: u32,
    unit: u32,
    shown: &'a mut Shown,
}

impl Canvas<'_> {
    /// The pixel at (x, y) pixels from the canvas' top left corner, where the picture has one.
    fn pixel(&mut self, x: u32, y: u32) -> Option<&mut [f32; 3]> {
        let (x, y) = (self.left + x, self.top + y);
        let inside = x < self.shown.width && y < self.shown.height;
        let index = y as usize * self.shown.width as usize + x as usize;
        if inside {
            self.shown.pixels.get_mut(index)
        } else {
            None
        }
    }

    fn dim(&mut self, width: u32, height: u32) {
        for y in 0..height * self.unit {
            for x in 0..width * self.unit {
                if let Some(pixel) = self.pixel(x, y) {
                    *pixel = pixel.map(|channel| channel * DIMMED);
                }
            }
        }
    }

    /// The palette from `scale.low` on the left to `scale.high` on the right.
    fn bar(&mut self, x: u32, y: u32, width: u32, scale: &Scale) {
        let columns = width * self.unit;
        for column in 0..columns {
            let place = column as f32 / (columns - 1) as f32;
            let color = scale.color(scale.low + place * (scale.high - scale.low));
            for row in 0..BAR_HEIGHT * self.unit {
                if let Some(pixel) = self.pixel(x * self.unit + column, y * self.unit + row) {
                    *pixel = color;
                }
            }
        }
    }

    fn text(&mut self, x: u32, y: u32, text: &str) {
        for (i, rows) in (0..).zip(text.chars().map(glyph)) {
            let Some(rows) = rows else { continue };
            for (row, bits) in (0..).zip(rows) {
                for column in (0..WIDTH).filter(|column| bits >> (WIDTH - 1 - column) & 1 == 1) {
                    self.dot(x + i * ADVANCE + column, y + row);
                }
            }
        }
    }

    /// One pixel of the font.
    fn dot(&mut self, x: u32, y: u32) {
        self.fill(x, y, UVec2::ONE, INK);
    }

    /// A rectangle whose top left corner is at (x, y).
    fn fill(&mut self, x: u32, y: u32, extent: UVec2, color: [f32; 3]) {
        for dy in 0..extent.y * self.unit {
            for dx in 0..extent.x * self.unit {
                if let Some(pixel) = self.pixel(x * self.unit + dx, y * self.unit + dy) {
                    *pixel = color;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::views::{Sources, View, show};
    use crate::scene::Output;

    fn heatmap(size: UVec2) -> Shown {
        let values = vec![5; (size.x * size.y) as usize];
        let sources = Sources {
            samples: Some((size, &values)),
            ..Sources::default()
        };
        show(View::Samples, &sources, &Output::default(), None).unwrap()
    }

    #[test]
    fn the_numbers_are_short_and_say_what_they_are() {
        for (value, text) in [
            (0.0, "0"),
            (12.0, "12"),
            (0.125, "0.125"),
            (1.0 / 3.0, "0.333"),
            (5.6789, "5.68"),
            (-250.4, "-250"),
            (98760.0, "98760"),
            (1.23e-7, "1.2e-7"),
            (4.0e9, "4.0e9"),
            (1e30, "1.0e30"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn every_heatmaps_unit_and_every_number_can_be_written() {
        let size = UVec2::ONE;
        let sources = Sources {
            samples: Some((size, &[1])),
            errors: Some((size, &[1.0])),
            ..Sources::default()
        };
        let units = [View::Samples, View::Error].map(|view| {
            let shown = show(view, &sources, &Output::default(), None).unwrap();
            shown.scale.unwrap().unit
        });
        let numbers = "0123456789.-e";
        for text in units
            .into_iter()
            .chain(["m", "nodes", "triangles", UNKNOWN_TEXT, numbers])
        {
            for character in text.chars() {
                assert!(glyph(character).is_some(), "no `{character}` for `{text}`");
            }
        }
    }

    #[test]
    fn the_legend_covers_a_corner_and_leaves_the_rest_alone() {
        let before = heatmap(UVec2::new(300, 200));
        let mut after = before.clone();
        assert!(burn_legend(&mut after));
        let changed = |x: u32, y: u32| {
            let i = (y * 300 + x) as usize;
            before.pixels[i] != after.pixels[i]
        };
        let rows: Vec<u32> = (0..200)
            .filter(|&y| (0..300).any(|x| changed(x, y)))
            .collect();
        let columns: Vec<u32> = (0..300)
            .filter(|&x| (0..200).any(|y| changed(x, y)))
            .collect();
        assert_eq!((rows[0], rows[rows.len() - 1]), (173, 196));
        assert_eq!((columns[0], columns[columns.len() - 1]), (3, 168));
        // The bar's ends are the palette's.
        let scale = after.scale.unwrap();
        let at = |x: u32, y: u32| after.pixels[(y * 300 + x) as usize];
        assert_eq!(at(6, 190), scale.color(scale.low));
        assert_eq!(at(165, 190), scale.color(scale.high));
    }

    #[test]
    fn what_is_not_known_gets_a_line_with_its_colour() {
        let size = UVec2::new(300, 200);
        let mut values = vec![0.5; 300 * 200];
        values[0] = f32::NAN;
        let sources = Sources {
            errors: Some((size, &values)),
            ..Sources::default()
        };
        let mut shown = show(View::Error, &sources, &Output::default(), None).unwrap();
        assert!(burn_legend(&mut shown));
        let of_unknown = |shown: &Shown| shown.pixels.iter().filter(|p| **p == UNKNOWN).count();
        assert_eq!(of_unknown(&shown), 1 + (HEIGHT * HEIGHT) as usize);
        // The legend is a line higher: 7 pixels of text and 3 between the lines.
        let top = |shown: &Shown| {
            let dimmed = |y: &usize| shown.pixels[y * 300 + 100] != shown.pixels[100];
            (0..200).find(dimmed).unwrap()
        };
        let mut known = heatmap(size);
        burn_legend(&mut known);
        assert_eq!(top(&shown) + 10, top(&known));
        assert_eq!(of_unknown(&known), 0);
    }

    #[test]
    fn a_picture_too_small_for_it_is_no_error_and_one_without_a_scale_has_none() {
        for size in [UVec2::ONE, UVec2::new(20, 3), UVec2::new(3, 500)] {
            assert!(burn_legend(&mut heatmap(size)));
        }
        let mut plain = Shown {
            scale: None,
            ..heatmap(UVec2::new(64, 64))
        };
        let before = plain.clone();
        assert!(!burn_legend(&mut plain));
        assert_eq!(plain, before);
    }
}
