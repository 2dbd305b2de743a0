//! Functions of a stated error that a loop over columns can compute for several items at once, which those of the
//! platform's library cannot: plain operations on floats and their bits, the same on every machine.

use std::f32::consts::LN_2;

/// 1.5 · 2²³: a float of at most 2²² that this is added to is rounded to a whole number in its last bits.
const ROUNDS: f32 = 12_582_912.0;

/// log₂ x of a normal positive float, within 6e-5.
///
/// Of the mantissa m in [1/√2, √2): 2/ln 2 · atanh z with z = (m-1)/(m+1), |z| < 0.172, by its series to z³.
#[inline(always)]
pub(super) fn log2(x: f32) -> f32 {
    const HALF_ROOT: u32 = 0x3f35_04f3;
    let shifted = x.to_bits().wrapping_sub(HALF_ROOT);
    let exponent = (shifted as i32) >> 23;
    let mantissa = f32::from_bits((shifted & 0x007f_ffff).wrapping_add(HALF_ROOT));
    let z = (mantissa - 1.0) / (mantissa + 1.0);
    let z2 = z * z;
    exponent as f32 + z * (2.885_39 + z2 * (0.961_797 + z2 * 0.577_08))
}

/// 2^x within 2e-4 of itself, for x ≤ 0; 2^-126 below.
///
/// The rest f in [-1/2, 1/2] by Taylor's series to f⁴.
#[inline(always)]
pub(super) fn exp2(x: f32) -> f32 {
    let x = x.max(-126.0);
    let shifted = x + ROUNDS;
    let f = x - (shifted - ROUNDS);
    let p = 1.0 + f * (LN_2 + f * (0.240_227 + f * (0.055_504 + f * 0.009_618)));
    // The whole number, as it stands in the last bits, times 2²³ is what an exponent adds.
    f32::from_bits(p.to_bits().wrapping_add(shifted.to_bits() << 23))
}

#[cfg(test)]
mod tests {
    use super::*;

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
