//! Colours that tell objects apart.

use crate::scene::SceneId;
use crate::trace::srgb;
use std::f32::consts::TAU;

/// Steps of hue and lightness from one number to the next, as fractions of 2^64: 1/φ and 1/φ² for
/// φ³ = φ + 1. Points of this sequence keep apart however many there are (Martin Roberts, "The
/// unreasonable effectiveness of quasirandom sequences", 2018: R₂).
const HUE_STEP: u64 = 0xc13f_a9a9_02a6_328f;
const LIGHTNESS_STEP: u64 = 0x91e1_0da5_c79e_7b1c;

/// OKLCH lightness of the darkest and of the lightest object.
const LIGHTNESS: [f32; 2] = [0.5, 0.9];

/// OKLCH chroma: strong, and within a screen's range for most hues.
const CHROMA: f32 = 0.12;

/// The colour of an object in the object view, sRGB in [0, 1]: it depends on the number alone, so
/// an object keeps it whatever else comes and goes. Spread evenly in OKLCH (Björn Ottosson, "A
/// perceptual color space for image processing", 2020).
pub fn object_color(id: SceneId) -> [f32; 3] {
    // Counted by 64-bit wrapping steps: the fraction of id · step, exact for every id.
    let fraction = |step: u64| (id.0.wrapping_mul(step) >> 40) as f32 / (1u64 << 24) as f32;
    let (sin, cos) = (TAU * fraction(HUE_STEP)).sin_cos();
    let [dark, light] = LIGHTNESS;
    let lightness = dark + (light - dark) * fraction(LIGHTNESS_STEP);
    oklab_to_linear([lightness, CHROMA * cos, CHROMA * sin])
        .map(|x| srgb::encode(x.clamp(0.0, 1.0)))
}

/// Ottosson's matrices.
#[expect(
    clippy::excessive_precision,
    reason = "the published digits, so that they can be compared"
)]
fn oklab_to_linear([l, a, b]: [f32; 3]) -> [f32; 3] {
    let cone = |of_a: f32, of_b: f32| (l + of_a * a + of_b * b).powi(3);
    let long = cone(0.396_337_777_4, 0.215_803_757_3);
    let medium = cone(-0.105_561_345_8, -0.063_854_172_8);
    let short = cone(-0.089_484_177_5, -1.291_485_548_0);
    [
        4.076_741_662_1 * long - 3.307_711_591_3 * medium + 0.230_969_929_2 * short,
        -1.268_438_004_6 * long + 2.609_757_401_1 * medium - 0.341_319_396_5 * short,
        -0.004_196_086_3 * long - 0.703_418_614_7 * medium + 1.707_614_701_0 * short,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// sRGB to OKLab.
    fn oklab(color: [f32; 3]) -> [f64; 3] {
        let bytes = color.map(|x| (255.0 * x).round() as usize);
        let [r, g, b] = bytes.map(|i| f64::from(srgb::decode_table()[i]));
        let cone = |c: [f64; 3]| (c[0] * r + c[1] * g + c[2] * b).cbrt();
        let l = cone([0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9]);
        let m = cone([0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6]);
        let s = cone([0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5]);
        [
            0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
            1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
            0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
        ]
    }

    fn closest(ids: impl Iterator<Item = u64>) -> f64 {
        let colors: Vec<_> = ids.map(|id| oklab(object_color(SceneId(id)))).collect();
        let mut closest = f64::INFINITY;
        for (i, a) in colors.iter().enumerate() {
            for b in &colors[..i] {
                let squared: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
                closest = closest.min(squared.sqrt());
            }
        }
        closest
    }

    #[test]
    fn neighbouring_numbers_have_colours_that_are_easily_told_apart() {
        // A difference of 0.02 in OKLab is just noticed.
        let few = closest(1..=12);
        assert!(few > 0.08, "the closest of 12 are {few} apart");
        let many = closest(1..=32);
        assert!(many > 0.04, "the closest of 32 are {many} apart");
    }

    #[test]
    fn any_number_has_a_colour_that_is_neither_black_nor_white() {
        for id in [0, 1, u64::MAX, 1 << 63, 12345678901234567] {
            let [l, ..] = oklab(object_color(SceneId(id)));
            assert!((0.4..0.95).contains(&l), "{id}: lightness {l}");
        }
    }
}
