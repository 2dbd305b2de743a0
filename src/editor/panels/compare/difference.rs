//! Two pictures as one that shows where they differ, and how much they do in figures.

use crate::editor::panels::temperature::luminance;
use crate::film::Picture;
use bevy::math::Vec3;
use bevy_egui::egui::{Color32, Rgba};

/// What is added to a brightness that something is divided by, so that black does not count for everything.
const LEAST: f32 = 0.01;

/// How two pictures are shown as one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum How {
    /// The first alone, as it is shown.
    First,
    /// The second alone.
    Second,
    /// What the second has more, less what it has less.
    #[default]
    Signed,
    /// The same as a part of the first's brightness.
    Relative,
}

/// How much they differ, over all pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Figures {
    /// Root of the mean squared difference of all channels.
    pub rmse: f64,
    /// Root of the mean squared relative difference of the brightness, a part.
    pub relative: f64,
    /// By how much of the first's brightness the second is brighter, a part.
    pub brighter: f64,
}

/// By how much the second is brighter at a pixel, in its unit or as a part of the first.
pub(super) fn difference(first: Vec3, second: Vec3, is_relative: bool) -> f32 {
    let [a, b] = [first, second].map(luminance);
    match is_relative {
        true => (b - a) / (a + LEAST),
        false => b - a,
    }
}

/// `None` where they differ in size.
pub(super) fn figures(first: &Picture, second: &Picture) -> Option<Figures> {
    let rmse = first.rmse(second)?;
    let (mut squares, mut sums) = (0.0, [0.0; 2]);
    for (a, b) in first.pixels.iter().zip(&second.pixels) {
        squares += f64::from(difference(*a, *b, true)).powi(2);
        for (sum, color) in sums.iter_mut().zip([a, b]) {
            *sum += f64::from(luminance(*color));
        }
    }
    let count = first.pixels.len().max(1) as f64;
    Some(Figures {
        rmse,
        relative: (squares / count).sqrt(),
        brighter: (sums[1] - sums[0]) / (sums[0] + count * f64::from(f32::MIN_POSITIVE)),
    })
}

/// Orange where the second is brighter, blue where it is darker, black where they are the same; `gain` times the difference
/// of 1 is full. Nothing where they differ in size.
pub(super) fn pixels(
    first: &Picture,
    second: &Picture,
    is_relative: bool,
    gain: f32,
) -> Option<Vec<Color32>> {
    if first.size() != second.size() {
        return None;
    }
    let pairs = first.pixels.iter().zip(&second.pixels);
    let color = |(a, b): (&Vec3, &Vec3)| {
        let by = gain * difference(*a, *b, is_relative);
        let strength = by.abs().min(1.0);
        let [red, green, blue] = match by > 0.0 {
            true => [1.0, 0.35, 0.05],
            false => [0.08, 0.4, 1.0],
        };
        match strength.is_nan() {
            true => Color32::from_rgb(255, 0, 255),
            false => Rgba::from_rgb(red * strength, green * strength, blue * strength).into(),
        }
    };
    Some(pairs.map(color).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::UVec2;

    fn grey(level: f32) -> Picture {
        let mut picture = Picture::black(UVec2::new(4, 2));
        picture.pixels.fill(Vec3::splat(level));
        picture
    }

    #[test]
    fn figures_of_a_picture_that_is_a_tenth_brighter() {
        let figures = figures(&grey(1.0), &grey(1.1)).unwrap();
        assert!((figures.rmse - 0.1).abs() < 1e-6, "{figures:?}");
        assert!((figures.brighter - 0.1).abs() < 1e-6, "{figures:?}");
        assert!((figures.relative - 0.1 / 1.01).abs() < 1e-6, "{figures:?}");
        let same = super::figures(&grey(0.0), &grey(0.0)).unwrap();
        assert_eq!([same.rmse, same.relative, same.brighter], [0.0; 3]);
        assert_eq!(
            super::figures(&grey(1.0), &Picture::black(UVec2::ONE)),
            None
        );
    }

    #[test]
    fn brighter_is_orange_darker_is_blue_and_the_same_is_black() {
        let [up, down, same] =
            [1.2, 0.8, 1.0].map(|level| pixels(&grey(1.0), &grey(level), false, 2.0).unwrap()[0]);
        assert!(up.r() > up.b() && down.b() > down.r(), "{up:?} {down:?}");
        assert_eq!(same, Color32::BLACK);
        // A tenth of little is as much as a tenth of a lot.
        let parts = [10.0, 100.0].map(|level| {
            let first = Vec3::splat(level);
            difference(first, 1.1 * first, true)
        });
        assert!((parts[0] - parts[1]).abs() < 1e-3, "{parts:?}");
        assert!(pixels(&grey(1.0), &Picture::black(UVec2::ONE), true, 1.0).is_none());
    }
}
