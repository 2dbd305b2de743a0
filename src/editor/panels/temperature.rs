//! The colour of a glowing body, to eyes that take daylight for white: the mixer and a lamp's own field mean the same by a
//! number of kelvins.

use crate::scene::Quantity;
use bevy::math::Vec3;

/// The temperature whose light counts as white, in kelvin: that of D65, sRGB's white.
pub(super) const WHITE: f32 = 6504.0;
/// What [`color`] is known of.
const RANGE: [f32; 2] = [1667.0, 25_000.0];
/// What a light's own temperature may be: a screen shows no redder white.
pub(super) const OF_LIGHTS: Quantity = Quantity::within(2000.0, RANGE[1] as f64, "K").step(20.0);

/// What white light becomes that shines as a body of this temperature does, linear sRGB of about the same luminance: of
/// [`WHITE`] exactly white. Kelvin, brought into [`RANGE`]. Daylight is not quite the colour of a body of its temperature
/// (it is greener), so that all are seen relative to that.
pub(super) fn color(kelvin: f32) -> Vec3 {
    let [least, most] = RANGE;
    body(kelvin.clamp(least, most)) / body(WHITE)
}

/// Linear sRGB of luminance 1. The chromaticity is that of Kim et al., "Design of Advanced Color Temperature Control System
/// for HDTV Applications" (2002): cubics that follow Planck's law to about 0.001 in x and y.
fn body(kelvin: f32) -> Vec3 {
    let t = 1e3 / kelvin;
    let x = if kelvin < 4000.0 {
        ((-0.266_123_9 * t - 0.234_358_9) * t + 0.877_695_6) * t + 0.179_910
    } else {
        ((-3.025_847 * t + 2.107_037_9) * t + 0.222_634_7) * t + 0.240_390
    };
    let y = if kelvin < 2222.0 {
        ((-1.106_381_4 * x - 1.348_110_2) * x + 2.185_558_3) * x - 0.202_196_83
    } else if kelvin < 4000.0 {
        ((-0.954_947_6 * x - 1.374_185_9) * x + 2.091_37) * x - 0.167_488_67
    } else {
        ((3.081_758 * x - 5.873_387) * x + 3.751_13) * x - 0.370_014_83
    };
    let (x, z) = (x / y, (1.0 - x - y) / y);
    // IEC 61966-2-1, from XYZ.
    let red = 3.240_97 * x - 1.537_383 - 0.498_611 * z;
    let green = -0.969_244 * x + 1.875_968 + 0.041_555 * z;
    let blue = 0.055_63 * x - 0.203_977 + 1.056_972 * z;
    // Below 1900 K such light is redder than a screen can be.
    Vec3::new(red, green, blue).max(Vec3::ZERO)
}

/// How bright a colour is (Rec. 709).
pub(super) fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// The temperature whose light has the same ratio of red to blue, within [`OF_LIGHTS`]; [`WHITE`] of what is black. A colour
/// that no body has by glowing, green for example, is taken for the nearest in that.
pub(super) fn nearest(linear: Vec3) -> f32 {
    if linear.x <= 0.0 && linear.z <= 0.0 {
        return WHITE;
    }
    let is_redder = |kelvin: f32| {
        let glow = color(kelvin);
        glow.x * linear.z > linear.x * glow.z
    };
    let [mut cool, mut hot] = [OF_LIGHTS.least as f32, OF_LIGHTS.most as f32];
    // Halved so often, the two are neighbours in f32.
    for _ in 0..40 {
        let middle = 0.5 * (cool + hot);
        if is_redder(middle) {
            cool = middle;
        } else {
            hot = middle;
        }
    }
    0.5 * (cool + hot)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cool_bodies_are_red_hot_ones_blue_and_all_are_as_bright() {
        let mut before = f32::INFINITY;
        for kelvin in [
            1700.0, 2200.0, 2300.0, 3900.0, 4100.0, 6500.0, 9000.0, 25_000.0,
        ] {
            let light = color(kelvin);
            let ratio = light.x / light.z.max(1e-6);
            assert!(ratio < before, "{kelvin} K: {light}");
            before = ratio;
            let luminance = luminance(light);
            assert!((luminance - 1.0).abs() < 0.02, "{kelvin} K: {luminance}");
        }
        assert_eq!(color(WHITE), Vec3::ONE);
        assert_eq!(color(0.0), color(RANGE[0]));
        // A lamp's 2856 K, CIE illuminant A, has the chromaticity (0.4476, 0.4074).
        let lamp = body(2856.0);
        let expected = Vec3::new(1.845, 0.826, 0.233);
        assert!((lamp - expected).abs().max_element() < 0.01, "{lamp}");
    }

    #[test]
    fn the_temperature_of_a_glowing_bodys_colour_is_found_again_however_bright_it_is() {
        for kelvin in [2000.0, 2856.0, 4000.0, 6500.0, 12_000.0, 25_000.0] {
            for brightness in [0.01, 1.0, 300.0] {
                let found = nearest(brightness * color(kelvin));
                let error = (found / kelvin - 1.0).abs();
                assert!(error < 1e-3, "{kelvin} K at {brightness}: {found} K");
            }
        }
        assert_eq!(nearest(Vec3::ZERO), WHITE);
        assert_eq!(nearest(Vec3::ONE).round(), WHITE);
        let [red, blue] = [Vec3::X, Vec3::Z].map(nearest);
        assert!(
            (red - 2000.0).abs() < 1.0 && (blue - 25_000.0).abs() < 1.0,
            "{red} {blue}"
        );
    }
}
