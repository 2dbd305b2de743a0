//! Functions of a stated error that a loop over columns can compute for several items at once, which those of the
//! platform's library cannot: plain operations on floats and their bits, the same on every machine.

use std::f32::consts::LN_2;

/// 1.5 · 2²³: a float of at most 2²² that this is added to is rounded to a whole number in its last bits.
const ROUNDS: f32 = 12_582_912.0;

/// log₂ x of a normal positive float, within 6e-5.
///
/// Of the mantissa m in [1/√2, √2): 2/ln 2 · atanh z with z = (m-1)/(m+1), |z| < 0.172, by its series to z³.
#[inline(always)]
pub(in crate::trace) fn log2(x: f32) -> f32 {
    let (exponent, z) = exponent_and_z(x);
    let z2 = z * z;
    exponent + z * (2.885_39 + z2 * (0.961_797 + z2 * 0.577_08))
}

/// The exponent of a number whose mantissa m lies in [1/√2, √2), and (m-1)/(m+1).
#[inline(always)]
fn exponent_and_z(x: f32) -> (f32, f32) {
    const HALF_ROOT: u32 = 0x3f35_04f3;
    let shifted = x.to_bits().wrapping_sub(HALF_ROOT);
    let exponent = (shifted as i32) >> 23;
    let mantissa = f32::from_bits((shifted & 0x007f_ffff).wrapping_add(HALF_ROOT));
    (exponent as f32, (mantissa - 1.0) / (mantissa + 1.0))
}

/// 2^x within 2e-4 of itself, for x ≤ 0; 2^-126 below.
///
/// The rest f in [-1/2, 1/2] by Taylor's series to f⁴.
#[inline(always)]
pub(in crate::trace) fn exp2(x: f32) -> f32 {
    let x = x.max(-126.0);
    let shifted = x + ROUNDS;
    let f = x - (shifted - ROUNDS);
    let p = 1.0 + f * (LN_2 + f * (0.240_227 + f * (0.055_504 + f * 0.009_618)));
    // The whole number, as it stands in the last bits, times 2²³ is what an exponent adds.
    f32::from_bits(p.to_bits().wrapping_add(shifted.to_bits() << 23))
}

/// x^s for x in [0, 1] and s > 0, within 4e-7 + 1.6e-7 · |log₂ x^s| of itself; 0 below 2^-126.
///
/// As [`log2`] and [`exp2`], with as many terms of their series as a float has digits for. Where x is near 1 the logarithm
/// is as exact as it is small, so that large s do no harm.
#[inline(always)]
pub(in crate::trace) fn power(x: f32, s: f32) -> f32 {
    let (exponent, z) = exponent_and_z(x);
    let z2 = z * z;
    let series =
        2.885_39 + z2 * (0.961_796_7 + z2 * (0.577_078 + z2 * (0.412_198_6 + z2 * 0.320_598_9)));
    let y = s * (exponent + z * series);
    let shifted = y.max(-127.0) + ROUNDS;
    let f = y.max(-127.0) - (shifted - ROUNDS);
    let p = 0.001_333_355_8 + f * (0.000_154_035_3 + f * 0.000_015_252_73);
    let p = 1.0 + f * (LN_2 + f * (0.240_226_5 + f * (0.055_504_11 + f * (0.009_618_129 + f * p))));
    let power = f32::from_bits(p.to_bits().wrapping_add(shifted.to_bits() << 23));
    let is_nothing = (x < f32::MIN_POSITIVE) | (y < -126.0);
    if is_nothing { 0.0 } else { power }
}

/// sin x and cos x for |x| ≤ π/4, within 1.2e-7.
///
/// By Taylor's series to x⁹ and x¹⁰.
#[inline(always)]
pub(in crate::trace) fn sin_cos(x: f32) -> (f32, f32) {
    let x2 = x * x;
    let sine = 1.0 - x2 / 6.0 * (1.0 - x2 / 20.0 * (1.0 - x2 / 42.0 * (1.0 - x2 / 72.0)));
    let cosine = 1.0 - x2 / 56.0 * (1.0 - x2 / 90.0);
    let cosine = 1.0 - x2 / 2.0 * (1.0 - x2 / 12.0 * (1.0 - x2 / 30.0 * cosine));
    (x * sine, cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_cosines_are_within_their_stated_error() {
        let (mut worst, mut rounds) = (0.0_f64, 0.0_f64);
        for s in [
            1e-3_f32,
            0.5,
            1.0,
            2.0,
            7.3,
            40.0,
            1000.0,
            1e5,
            1e8,
            f32::MAX,
        ] {
            for i in 0..100_000 {
                // Cosines of all angles, and those next to 1.
                let x = match i % 2 {
                    0 => (i as f32 * 1.5e-5).cos().max(0.0),
                    _ => 1.0 - i as f32 * f32::EPSILON,
                };
                let exact = f64::from(x).powf(f64::from(s));
                let found = f64::from(power(x, s));
                assert!((0.0..=1.0).contains(&found), "{x}^{s} = {found}");
                if exact < 2.0_f64.powi(-125) {
                    assert!(found < 2.0_f64.powi(-124), "{x}^{s} = {found:e}");
                    continue;
                }
                let error = (found / exact - 1.0).abs();
                worst = worst.max(error / (4e-7 - 1.6e-7 * exact.log2()));
                rounds = rounds.max(error);
            }
        }
        assert!(
            worst < 1.0,
            "{worst} of the stated error; {rounds:e} at most"
        );
        assert_eq!(
            [power(1.0, 3.0), power(1.0, f32::MAX), power(0.0, 2.0)],
            [1.0, 1.0, 0.0]
        );
    }

    #[test]
    fn sines_and_cosines_are_within_their_stated_error() {
        let mut worst = 0.0_f64;
        for i in -100_000..=100_000 {
            let x = i as f32 * (std::f32::consts::FRAC_PI_4 / 100_000.0);
            let (sine, cosine) = sin_cos(x);
            let exact = f64::from(x).sin_cos();
            let errors = [f64::from(sine) - exact.0, f64::from(cosine) - exact.1];
            worst = errors
                .into_iter()
                .fold(worst, |worst, error| worst.max(error.abs()));
        }
        assert!(worst < 1.2e-7, "{worst:e}");
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
    }

    #[test]
    fn logarithms_are_within_their_stated_error() {
        let mut worst = 0.0_f64;
        for i in 0..200_000 {
            let x = f32::from_bits(0x0080_0000 + i * 10_000);
            if x.is_finite() {
                worst = worst.max((f64::from(log2(x)) - f64::from(x).log2()).abs());
            }
        }
        assert!(worst < 6e-5, "{worst:e}");
        assert_eq!(log2(1.0), 0.0);
    }

    #[test]
    fn powers_are_within_their_stated_error() {
        let mut worst = 0.0_f64;
        for i in 0..126_000 {
            let x = -(i as f32) / 1000.0;
            worst = worst.max((f64::from(exp2(x)) / f64::from(x).exp2() - 1.0).abs());
        }
        assert!(worst < 2e-4, "{worst:e}");
        assert_eq!(exp2(0.0), 1.0);
        assert_eq!(exp2(-1e30), 2.0_f32.powi(-126));
    }
}
