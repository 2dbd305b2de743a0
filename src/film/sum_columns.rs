//! The sums of many pixels at once: those of [`Sum`], bit for bit, in loops over columns that vectorise.

use super::Sum;
use super::sum::{FRACTION_BITS, LARGEST};
use crate::instruction_sets::vectorized;
use glam::Vec3;

/// The sums of pixels, 128-bit fixed-point numbers as two columns of 64 bits, three for each pixel.
#[derive(Clone, Debug, Default)]
pub(super) struct SumColumns {
    low: Vec<u64>,
    high: Vec<u64>,
}

impl SumColumns {
    /// As many sums of nothing.
    pub fn reset(&mut self, pixels: usize) {
        for column in [&mut self.low, &mut self.high] {
            column.clear();
            column.resize(3 * pixels, 0);
        }
    }

    /// Adds a colour to each pixel from the `first` on, as [`Sum::add`] does.
    pub fn add(&mut self, first: usize, values: &[Vec3]) {
        let range = 3 * first..3 * (first + values.len());
        let (low, high) = (&mut self.low[range.clone()], &mut self.high[range]);
        add_columns(bytemuck::cast_slice(values), low, high);
    }

    /// The sum of one pixel.
    pub fn get(&self, pixel: usize) -> Sum {
        Sum(std::array::from_fn(|channel| {
            let at = 3 * pixel + channel;
            (i128::from(self.high[at] as i64) << 64) | i128::from(self.low[at])
        }))
    }
}

vectorized! {
    fn add_columns(values: &[f32], low: &mut [u64], high: &mut [u64]) {
        let count = values.len();
        let (low, high) = (&mut low[..count], &mut high[..count]);
        for i in 0..count {
            let (value_low, value_high) = to_fixed(values[i]);
            let sum = low[i].wrapping_add(value_low);
            let carry = u64::from(sum < value_low);
            low[i] = sum;
            high[i] = high[i].wrapping_add(value_high).wrapping_add(carry);
        }
    }
}

/// The fixed-point number of a value, as [`Sum::add`] rounds it: the lower and the upper 64 bits.
#[inline(always)]
fn to_fixed(value: f32) -> (u64, u64) {
    let bits = value.clamp(-LARGEST, LARGEST).to_bits();
    let biased = bits >> 23 & 0xff;
    // Zero, what is smaller than 2^-126, and NaN count as nothing.
    let counts = u64::from(biased != 0 && biased != 0xff).wrapping_neg();
    let mantissa = u64::from(bits & 0x7f_ffff | 0x80_0000) & counts;
    let left = i64::from(biased) - 150 + i64::from(FRACTION_BITS);
    let (low, high) = if left >= 0 {
        let left = left as u64;
        let over = shifted_right(mantissa, 64_u64.wrapping_sub(left));
        (
            shifted_left(mantissa, left),
            over | shifted_left(mantissa, left.wrapping_sub(64)),
        )
    } else {
        let right = left.wrapping_neg() as u64;
        let half = shifted_left(1, right.wrapping_sub(1));
        (shifted_right(mantissa + half, right), 0)
    };
    // The number's complement where it is negative.
    let negative = u64::from(bits >> 31).wrapping_neg();
    let low = (low ^ negative).wrapping_sub(negative);
    let borrow = negative & u64::from(low == 0);
    (low, (high ^ negative).wrapping_add(borrow & 1))
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
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn columns_have_the_sums_that_each_pixel_has_by_itself(
            bits in prop::collection::vec(any::<[u32; 3]>(), 1..40),
            pixels in 1_usize..5,
        ) {
            let values: Vec<Vec3> =
                (bits.iter()).map(|bits| Vec3::from_array(bits.map(f32::from_bits))).collect();
            let mut columns = SumColumns::default();
            columns.reset(pixels);
            let mut sums = vec![Sum::default(); pixels];
            for run in values.chunks(pixels) {
                columns.add(pixels - run.len(), run);
                for (sum, value) in sums[pixels - run.len()..].iter_mut().zip(run) {
                    sum.add(*value);
                }
            }
            for (pixel, sum) in sums.iter().enumerate() {
                prop_assert_eq!(columns.get(pixel), *sum);
            }
        }
    }

    #[test]
    fn every_exponent_and_both_signs_are_added_as_one_by_one() {
        for exponent in 0..=255_u32 {
            for mantissa in [0, 1, 0x40_0000, 0x7f_ffff, 0x2a_aaaa] {
                for sign in [0, 1 << 31] {
                    let value = f32::from_bits(sign | exponent << 23 | mantissa);
                    let mut columns = SumColumns::default();
                    columns.reset(1);
                    let mut sum = Sum::default();
                    for added in [Vec3::splat(value), Vec3::new(-1.0, 2.5, value)] {
                        columns.add(0, &[added]);
                        sum.add(added);
                    }
                    assert_eq!(columns.get(0), sum, "{value:e}");
                }
            }
        }
    }
}
