//! What a film knows of each pixel beside its colour.

use super::error::Moves;
use super::{ErrorEstimate, Film};
use rayon::prelude::*;

/// Edge in pixels of the square whose pixels are estimated together: the means of a single pixel
/// moved too much by chance.
const SQUARE: u32 = 4;

impl Film {
    /// The number of each pixel's samples, row by row from the top.
    pub fn counts(&self) -> Vec<u32> {
        let size = self.size();
        (0..size.y)
            .flat_map(|y| (0..size.x).map(move |x| self.count(x, y)))
            .collect()
    }

    /// The estimated relative error of each pixel, row by row from the top: 0.01 is one percent. That
    /// of the 4 × 4 pixels around, by the same rule as the picture's ([`ErrorEstimate::relative`]);
    /// NaN where a pixel has less than two samples.
    pub fn relative_errors(&self) -> Vec<f32> {
        let size = self.size();
        let columns = size.x.div_ceil(SQUARE);
        let squares: Vec<f32> = (0..columns * size.y.div_ceil(SQUARE))
            .into_par_iter()
            .map(|i| self.square_error(i % columns * SQUARE, i / columns * SQUARE))
            .collect();
        (0..size.y)
            .flat_map(|y| (0..size.x).map(move |x| y / SQUARE * columns + x / SQUARE))
            .map(|i| squares[i as usize])
            .collect()
    }

    /// Of the pixels from (left, top) on. Those with x + y even may have another number of samples
    /// than the odd ones, so they are two groups.
    fn square_error(&self, left: u32, top: u32) -> f32 {
        let size = self.size();
        let groups = [0, 1].map(|half| {
            Moves::of(
                (top..size.y.min(top + SQUARE))
                    .flat_map(|y| (left..size.x.min(left + SQUARE)).map(move |x| (x, y)))
                    .filter(|(x, y)| (x + y) % 2 == half)
                    .map(|(x, y)| self.pixel(x, y)),
            )
        });
        ErrorEstimate::of(groups.into_iter()).map_or(f32::NAN, |error| error.relative() as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Rendered, render, test_scene};
    use glam::UVec2;

    fn rendered(spp: u32) -> Rendered {
        let settings = test_scene::settings(UVec2::new(36, 28), spp);
        render(
            &test_scene::world(),
            &test_scene::camera(),
            &settings,
            &|_, _| {},
        )
    }

    #[test]
    fn every_pixel_has_the_samples_that_were_asked_for() {
        let counts = rendered(8).film.counts();
        assert_eq!(counts, vec![8; 36 * 28]);
    }

    #[test]
    fn the_mean_square_of_the_pixels_errors_is_the_pictures() {
        let rendered = rendered(16);
        let errors = rendered.film.relative_errors();
        let squares: f64 = errors.iter().map(|&e| f64::from(e).powi(2)).sum();
        let mean = squares / errors.len() as f64;
        let picture = rendered.status.error().unwrap().relative_mse;
        assert!(
            (mean / picture - 1.0).abs() < 1e-4,
            "{mean}, the picture's {picture}"
        );
        let (least, most) = errors
            .iter()
            .fold((f32::MAX, 0.0_f32), |(least, most), &e| {
                (least.min(e), most.max(e))
            });
        assert!(
            most > 4.0 * least,
            "from {least} to {most}: it does not tell places apart"
        );
    }

    #[test]
    fn the_error_of_a_single_sample_is_not_known() {
        assert!(
            rendered(1)
                .film
                .relative_errors()
                .iter()
                .all(|e| e.is_nan())
        );
        assert!(
            Film::new(UVec2::new(3, 5))
                .relative_errors()
                .iter()
                .all(|e| e.is_nan())
        );
    }
}
