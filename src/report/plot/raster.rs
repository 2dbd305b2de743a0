//! A backend of plotters that draws pixels, two to each of the plot's own, and writes with the legend's font.

use crate::film::views::{Shown, font};
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    rasterizer,
};
use std::convert::Infallible;

/// Pixels to one of the plot's own.
const FINER: i32 = 2;
/// Pixels to one of the font's.
const FONT: i32 = 3;

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// The pixels, at their own scale.
struct Pixels<'a>(&'a mut Shown);

impl DrawingBackend for Pixels<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (self.0.width, self.0.height)
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Drawn {
        let (width, height) = (self.0.width, self.0.height);
        if (0..width as i32).contains(&x) && (0..height as i32).contains(&y) {
            let pixel = &mut self.0.pixels[y as usize * width as usize + x as usize];
            let alpha = color.alpha as f32;
            let (r, g, b) = color.rgb;
            for (old, new) in pixel.iter_mut().zip([r, g, b]) {
                *old += alpha * (f32::from(new) / 255.0 - *old);
            }
        }
        Ok(())
    }
}

/// A style whose lines are as much thicker as the picture is finer.
struct Thicker<'a, S>(&'a S);

impl<S: BackendStyle> BackendStyle for Thicker<'_, S> {
    fn color(&self) -> BackendColor {
        self.0.color()
    }

    fn stroke_width(&self) -> u32 {
        self.0.stroke_width() * FINER as u32
    }
}

/// The picture that a plot is drawn into.
pub(super) struct Raster<'a>(pub &'a mut Shown);

fn finer((x, y): BackendCoord) -> BackendCoord {
    (x * FINER, y * FINER)
}

impl DrawingBackend for Raster<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (self.0.width / FINER as u32, self.0.height / FINER as u32)
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, color: BackendColor) -> Drawn {
        let (x, y) = finer(at);
        rasterizer::draw_rect(
            &mut Pixels(self.0),
            (x, y),
            (x + FINER - 1, y + FINER - 1),
            &color,
            true,
        )
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
        rasterizer::draw_line(&mut Pixels(self.0), finer(from), finer(to), &Thicker(style))
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        rasterizer::draw_rect(
            &mut Pixels(self.0),
            finer(from),
            finer(to),
            &Thicker(style),
            fill,
        )
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        Pixels(self.0).draw_path(path.into_iter().map(finer), &Thicker(style))
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let radius = radius * FINER as u32;
        rasterizer::draw_circle(
            &mut Pixels(self.0),
            finer(center),
            radius,
            &Thicker(style),
            fill,
        )
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        Pixels(self.0).fill_polygon(corners.into_iter().map(finer), style)
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, at: BackendCoord) -> Drawn {
        let (width, height) = text_size(text);
        let left = match style.anchor().h_pos {
            HPos::Left => 0,
            HPos::Center => -width / 2,
            HPos::Right => -width,
        };
        let top = match style.anchor().v_pos {
            VPos::Top => 0,
            VPos::Center => -height / 2,
            VPos::Bottom => -height,
        };
        let (x0, y0) = finer(at);
        let (turn, color) = (style.transform(), style.color());
        let mut pixels = Pixels(self.0);
        for (i, character) in (0..).zip(text.chars()) {
            let rows = font::glyph(character).or_else(|| font::glyph('?'));
            for (row, bits) in (0..).zip(rows.into_iter().flatten()) {
                let inked = |column: &i32| bits >> (font::WIDTH as i32 - 1 - column) & 1 == 1;
                for column in (0..font::WIDTH as i32).filter(inked) {
                    let x = left + (i * font::ADVANCE as i32 + column) * FONT;
                    let y = top + row * FONT;
                    for dot in 0..FONT * FONT {
                        let (dx, dy) = turn.transform(x + dot % FONT, y + dot / FONT);
                        pixels.draw_pixel((x0 + dx, y0 + dy), color)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn estimate_text_size<T: BackendTextStyle>(
        &self,
        text: &str,
        _: &T,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let (width, height) = text_size(text);
        Ok(((width / FINER) as u32, (height / FINER) as u32))
    }
}

/// Columns and rows of the finer pixels.
fn text_size(text: &str) -> (i32, i32) {
    let columns = text.chars().count() as i32 * font::ADVANCE as i32;
    (columns * FONT, font::HEIGHT as i32 * FONT)
}
