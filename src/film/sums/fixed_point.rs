//! 128-bit numbers as lower and upper 64 bits, in expressions without a branch: loops of them vectorise.

use super::sum::{FRACTION_BITS, LARGEST};

/// What a fixed-point step is worth.
pub(super) const UNIT: f64 = 1.0 / (1u128 << FRACTION_BITS) as f64;
/// What a step of the upper 64 bits is worth in steps.
const HIGH: f64 = (1u128 << 64) as f64;

/// The number of which these are the lower and the upper 64 bits.
#[inline(always)]
pub(in crate::film) fn joined(low: u64, high: u64) -> i128 {
    i128::from(high as i64) << 64 | i128::from(low)
}

/// The sum of two numbers, each with its lower and its upper 64 bits.
#[inline(always)]
pub(in crate::film) fn sum(low: u64, high: u64, other_low: u64, other_high: u64) -> (u64, u64) {
    let sum = low.wrapping_add(other_low);
    let carry = u64::from(sum < other_low);
    (sum, high.wrapping_add(other_high).wrapping_add(carry))
}

/// The same, as large as a number can be where it is larger.
#[inline(always)]
pub(super) fn saturating_sum(low: u64, high: u64, other_low: u64, other_high: u64) -> (u64, u64) {
    let (sum_low, sum_high) = sum(low, high, other_low, other_high);
    let is_over = ((high ^ sum_high) & (other_high ^ sum_high)) >> 63 == 1;
    let is_negative = high >> 63;
    let most_low = is_negative.wrapping_sub(1);
    let most_high = (1 << 63) ^ most_low;
    let low = if is_over { most_low } else { sum_low };
    let high = if is_over { most_high } else { sum_high };
    (low, high)
}

/// The nearest f64, or the one beside it: both halves are rounded, and their sum once more.
#[inline(always)]
pub(super) fn to_f64(low: u64, high: u64) -> f64 {
    let negative = (high >> 63).wrapping_neg();
    let (low, high) = negated(low, high, negative);
    let magnitude = high as f64 * HIGH + low as f64;
    f64::from_bits(magnitude.to_bits() | negative << 63)
}

/// The number's complement where all bits of `negative` are set, and itself where none is.
#[inline(always)]
fn negated(low: u64, high: u64, negative: u64) -> (u64, u64) {
    let low = (low ^ negative).wrapping_sub(negative);
    let borrow = negative & u64::from(low == 0);
    (low, (high ^ negative).wrapping_add(borrow & 1))
}

/// The whole number next to a value on the side of zero: the lower and the upper 64 bits. As large as a number can be where
/// the value is larger; nothing for NaN.
#[inline(always)]
pub(super) fn whole_steps(value: f64) -> (u64, u64) {
    const MANTISSA: u64 = (1 << 52) - 1;
    let bits = value.to_bits();
    let biased = bits >> 52 & 0x7ff;
    let counts = u64::from(!value.is_nan()).wrapping_neg();
    let mantissa = (bits & MANTISSA | 1 << 52) & counts;
    let left = biased.wrapping_sub(1075) as i64;
    let (low, high) = shifted(mantissa, left);
    // Above 2^127.
    let is_over = left > 74 && !value.is_nan();
    let low = if is_over { u64::MAX } else { low };
    let high = if is_over { u64::MAX >> 1 } else { high };
    negated(low, high, (bits >> 63).wrapping_neg())
}

/// The fixed-point number of a value, as [`Sum::add`] rounds it: the lower and the upper 64 bits.
#[inline(always)]
pub(super) fn to_fixed(value: f32) -> (u64, u64) {
    let bits = value.clamp(-LARGEST, LARGEST).to_bits();
    let biased = bits >> 23 & 0xff;
    // Zero, what is smaller than 2^-126, and NaN count as nothing.
    let counts = u64::from(biased != 0 && biased != 0xff).wrapping_neg();
    let mantissa = u64::from(bits & 0x7f_ffff | 0x80_0000) & counts;
    let left = i64::from(biased) - 150 + i64::from(FRACTION_BITS);
    let half = shifted_left(1, left.wrapping_neg().wrapping_sub(1) as u64);
    let (low, high) = shifted(if left < 0 { mantissa + half } else { mantissa }, left);
    negated(low, high, u64::from(bits >> 31).wrapping_neg())
}

/// 64 bits shifted to the left among 128, or to the right where that is less than 0.
#[inline(always)]
fn shifted(bits: u64, left: i64) -> (u64, u64) {
    if left >= 0 {
        let left = left as u64;
        let over = shifted_right(bits, 64_u64.wrapping_sub(left));
        (
            shifted_left(bits, left),
            over | shifted_left(bits, left.wrapping_sub(64)),
        )
    } else {
        (shifted_right(bits, left.wrapping_neg() as u64), 0)
    }
}

/// Nothing is left where all bits are shifted out.
#[inline(always)]
fn shifted_left(bits: u64, by: u64) -> u64 {
    if by < 64 { bits << by } else { 0 }
}

#[inline(always)]
fn shifted_right(bits: u64, by: u64) -> u64 {
    if by < 64 { bits >> by } else { 0 }
}

#[cfg(test)]
pub(in crate::film) mod tests {
    use super::*;

    #[test]
    fn whole_steps_are_those_of_a_conversion_of_one_number() {
        let mut values = vec![
            0.0,
            0.49,
            0.5,
            1.0,
            1.5,
            1e30,
            1e38,
            2e38,
            1e300,
            f64::INFINITY,
            f64::NAN,
        ];
        values.extend((-3..130).map(|exponent| 1.234_567 * 2f64.powi(exponent)));
        for value in values.into_iter().flat_map(|value| [value, -value]) {
            let (low, high) = whole_steps(value);
            assert_eq!(
                joined(low, high),
                (value as i128).max(-i128::MAX),
                "{value:e}"
            );
        }
    }

    /// A value in 128 bits, with branches: exact but for what lies below 2^-64; NaN becomes zero.
    fn one_by_one(value: f32) -> i128 {
        let value = value.clamp(-LARGEST, LARGEST);
        // `value` = mantissa · 2^exponent with a 24-bit mantissa; a shift puts it in place.
        let bits = value.to_bits();
        let biased = (bits >> 23) & 0xff;
        if biased == 0 || biased == 0xff {
            return 0; // Zero, what is smaller than 2^-126, or NaN.
        }
        let mantissa = i128::from((bits & 0x7f_ffff) | 0x80_0000);
        let shift = biased as i32 - 150 + FRACTION_BITS as i32;
        let magnitude = match shift {
            0.. => mantissa << shift,
            -24..0 => (mantissa + (1 << (-shift - 1))) >> -shift,
            _ => 0,
        };
        if bits >> 31 == 1 {
            -magnitude
        } else {
            magnitude
        }
    }

    /// Of every exponent and of both signs.
    pub(in crate::film) fn values() -> impl Iterator<Item = f32> {
        let mantissas = [0, 1, 0x40_0000, 0x7f_ffff, 0x2a_aaaa];
        let bits = (0..=255_u32)
            .flat_map(move |exponent| mantissas.map(|mantissa| exponent << 23 | mantissa));
        bits.flat_map(|bits| [bits, 1 << 31 | bits])
            .map(f32::from_bits)
    }

    #[test]
    fn every_exponent_of_both_signs_is_what_a_shift_of_128_bits_makes_of_it() {
        for value in values() {
            let (low, high) = to_fixed(value);
            assert_eq!(joined(low, high), one_by_one(value), "{value:e}");
        }
    }
}
