//! AgX, Troy Sobotka's view transform (github.com/sobotka/AgX), as fitted by Benjamin Wrensch,
//! "Minimal AgX Implementation" (iolite-engine.com/blog_posts/minimal_agx_implementation, 2023).
//!
//! Colours are drawn towards grey (the inset), each channel's logarithm is spread over the range
//! of a screen by an S-shaped curve, and the inset is undone. Because the curve is steep only in
//! the middle and the inset mixes the channels, what is very bright tends to white.

use glam::{Mat3, Vec3};

/// Linear sRGB to the inset's primaries; the columns are red, green and blue.
pub(super) const INSET: Mat3 = Mat3::from_cols_array(&[
    0.842_479_06,
    0.042_328_242,
    0.042_375_655,
    0.078_433_6,
    0.878_468_64,
    0.078_433_6,
    0.079_223_745,
    0.079_166_13,
    0.879_143,
]);

/// The way back.
pub(super) const OUTSET: Mat3 = Mat3::from_cols_array(&[
    1.196_879,
    -0.052_896_852,
    -0.052_971_636,
    -0.098_020_88,
    1.151_903_1,
    -0.098_043_45,
    -0.099_029_74,
    -0.098_961_18,
    1.151_073_7,
]);

/// Stops around 1.0 that the curve covers: middle grey, 0.18, lies 10 above the lowest and 6.5
/// below the highest.
pub(super) const STOPS: [f32; 2] = [-12.473_93, 4.026_069];

/// No channel counts as brighter: the inset's sums stay finite.
pub(in crate::film) const LARGEST: f32 = f32::MAX / 4.0;

/// A linear colour as a screen shows it, encoded, in [0, 1]. Negative components and NaN count as 0.
pub fn agx(linear: Vec3) -> Vec3 {
    let inset = INSET * linear.map(|x| if x > 0.0 { x.min(LARGEST) } else { 0.0 });
    // The fit's black is -0.0023: below what a screen shows.
    (OUTSET * inset.map(curve)).clamp(Vec3::ZERO, Vec3::ONE)
}

/// What becomes of a channel's light between inset and outset: its logarithm, spread over the stops,
/// then the contrast.
pub(super) fn curve(light: f32) -> f32 {
    let [low, high] = STOPS;
    contrast((light.log2().clamp(low, high) - low) / (high - low))
}

/// AgX's base contrast for x in [0, 1]: Wrensch's polynomial of 6th order, mean squared error 3.7e-6.
fn contrast(x: f32) -> f32 {
    const COEFFICIENTS: [f32; 7] = [15.5, -40.14, 31.96, -6.868, 0.429_8, 0.119_1, -0.002_32];
    COEFFICIENTS.iter().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From 2^-20 to 2^20 in steps of a 16th of a stop.
    fn stops() -> impl Iterator<Item = f32> {
        (-320..=320).map(|i| (i as f32 / 16.0).exp2())
    }

    #[test]
    fn more_light_is_never_shown_darker_and_nothing_leaves_the_screens_range() {
        let mut before = agx(Vec3::ZERO).x;
        for light in stops() {
            let shown = agx(Vec3::splat(light));
            assert!(
                shown.x >= before && shown.max_element() <= 1.0,
                "{light} becomes {shown}, after {before}"
            );
            before = shown.x;
        }
        assert!(before > 0.99, "the brightest is {before}");
        for extreme in [f32::INFINITY, f32::MAX, 1e-45] {
            let shown = agx(Vec3::new(extreme, 0.0, extreme));
            assert!(
                shown.is_finite() && shown.cmple(Vec3::ONE).all() && shown.cmpge(Vec3::ZERO).all(),
                "{extreme} becomes {shown}"
            );
        }
    }

    #[test]
    fn black_what_is_negative_and_what_is_no_number_are_black() {
        for nothing in [0.0, -1.0, f32::NEG_INFINITY, f32::NAN] {
            assert_eq!(agx(Vec3::splat(nothing)), Vec3::ZERO, "{nothing}");
        }
    }

    #[test]
    fn grey_stays_grey_within_half_a_step_of_eight_bits() {
        for light in stops() {
            let shown = agx(Vec3::splat(light));
            let tint = shown.max_element() - shown.min_element();
            assert!(tint < 0.5 / 255.0, "{light} is tinted by {tint}");
        }
    }

    #[test]
    fn middle_grey_lies_in_the_middle_of_the_screens_range() {
        // AgX's curve turns at (0.606, 0.5), where 0.606 is 0.18's place among the stops.
        let shown = agx(Vec3::splat(0.18)).x;
        assert!((shown - 0.5).abs() < 0.005, "{shown}");
    }

    #[test]
    fn a_very_bright_red_turns_towards_white_and_a_dim_one_stays_red() {
        let dim = agx(Vec3::new(0.18, 0.0, 0.0));
        let bright = agx(Vec3::new(1000.0, 1.0, 1.0));
        assert!(dim.x > 2.0 * dim.y, "{dim}");
        assert!(bright.min_element() > 0.6, "{bright}");
    }
}
