//! What a picture of the window shows.

use image::RgbImage;
use std::path::Path;

/// A picture of the window, and the part of it that shows the scene.
pub(super) struct Shot(RgbImage);

impl Shot {
    pub fn open(path: &Path) -> Self {
        let picture =
            image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        Self(picture.to_rgb8())
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.0.dimensions().into()
    }

    /// As it is on the screen, from the top left.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        self.0.get_pixel(x, y).0
    }

    /// How far pixels differ on average, in levels of 255, in a part of the window given from
    /// (0, 0) to (1, 1).
    pub fn difference(&self, other: &Self, area: [f32; 4]) -> f64 {
        assert_eq!(self.0.dimensions(), other.0.dimensions());
        let places = self.places(area);
        let sum: f64 = places
            .iter()
            .map(|&(x, y)| {
                let (a, b) = (self.0.get_pixel(x, y).0, other.0.get_pixel(x, y).0);
                let channels = a.iter().zip(b);
                channels.map(|(a, b)| f64::from(a.abs_diff(b))).sum::<f64>() / 3.0
            })
            .sum();
        sum / places.len() as f64
    }

    /// The same for a part of one picture and one of the same size that lies so many pixels further right.
    pub fn difference_to_the_right(&self, by: u32, area: [f32; 4]) -> f64 {
        let (width, height) = self.0.dimensions();
        let moved = RgbImage::from_fn(width, height, |x, y| {
            *self.0.get_pixel((x + by).min(width - 1), y)
        });
        self.difference(&Self(moved), area)
    }

    /// Mean brightness of a part of the window, in levels of 255.
    pub fn brightness(&self, area: [f32; 4]) -> f64 {
        let places = self.places(area);
        let sum: f64 = places
            .iter()
            .map(|&(x, y)| {
                let channels = self.0.get_pixel(x, y).0;
                channels.iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0
            })
            .sum();
        sum / places.len() as f64
    }

    /// How many different colours there are in a part of the window.
    pub fn colors(&self, area: [f32; 4]) -> usize {
        let places = self.places(area).into_iter();
        let colors = places.map(|(x, y)| self.0.get_pixel(x, y).0);
        colors.collect::<std::collections::HashSet<_>>().len()
    }

    fn places(&self, [left, top, right, bottom]: [f32; 4]) -> Vec<(u32, u32)> {
        let (width, height) = self.0.dimensions();
        let x = |part: f32| (part * width as f32) as u32;
        let y = |part: f32| (part * height as f32) as u32;
        (y(top)..y(bottom))
            .flat_map(|row| (x(left)..x(right)).map(move |column| (column, row)))
            .collect()
    }
}
