use super::fixed_point::{UNIT, joined, to_f64, to_fixed};
use glam::Vec3;

/// The exact sum of colours, whatever the order in which they are added: 128-bit fixed point.
///
/// A value is rounded to a multiple of 2^-64 and limited to ±2^40 when it is added; both limits are
/// far outside what 24-bit values of a scene-referred picture can show. 2^22 samples of the largest
/// value fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sum(pub(in crate::film) [i128; 3]);

pub(super) const FRACTION_BITS: u32 = 64;
pub(in crate::film) const LARGEST: f32 = (1u64 << 40) as f32;

impl Sum {
    /// Adds a colour. A component that is not a number counts as zero, an infinite one as the largest.
    pub fn add(&mut self, value: Vec3) {
        for (sum, value) in self.0.iter_mut().zip(value.to_array()) {
            let (low, high) = to_fixed(value);
            *sum += joined(low, high);
        }
    }

    /// That of so many times the same colour.
    pub fn of_many(value: Vec3, count: u64) -> Self {
        let mut sum = Self::default();
        sum.add(value);
        Self(sum.0.map(|sum| sum * i128::from(count)))
    }

    /// Adds what another sum holds.
    pub fn merge(&mut self, other: &Self) {
        for (sum, other) in self.0.iter_mut().zip(other.0) {
            *sum += other;
        }
    }

    /// The sum as it stands in files: for each component the 128 bits of the fixed-point number, in
    /// two's complement, 32 bits a word, the lowest first.
    pub fn to_words(&self) -> [[u32; 4]; 3] {
        self.0
            .map(|sum| std::array::from_fn(|i| (sum >> (32 * i)) as u32))
    }

    /// The sum that [`Self::to_words`] wrote.
    pub fn from_words(words: [[u32; 4]; 3]) -> Self {
        let sum = |words: [u32; 4]| {
            let bits = words
                .iter()
                .rev()
                .fold(0_u128, |bits, word| bits << 32 | u128::from(*word));
            bits as i128
        };
        Self(words.map(sum))
    }

    /// The mean over `count` values; zero where there are none.
    pub fn mean(&self, count: u32) -> Vec3 {
        if count == 0 {
            return Vec3::ZERO;
        }
        let unit = UNIT / f64::from(count);
        let [r, g, b] = self
            .0
            .map(|sum| (to_f64(sum as u64, (sum >> 64) as u64) * unit) as f32);
        Vec3::new(r, g, b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_value_comes_back_as_it_was(exponent in -38..39_i32, mantissa in 1.0..2.0_f32, negative: bool) {
            let value = mantissa * 2f32.powi(exponent) * if negative { -1.0 } else { 1.0 };
            let mut sum = Sum::default();
            sum.add(Vec3::splat(value));
            prop_assert_eq!(sum.mean(1).x, value);
        }

        #[test]
        fn the_order_does_not_matter(mut values in prop::collection::vec(-1e6..1e6_f32, 1..64)) {
            let total = |values: &[f32]| {
                let mut sum = Sum::default();
                values.iter().for_each(|&v| sum.add(Vec3::splat(v)));
                sum
            };
            let forwards = total(&values);
            values.reverse();
            prop_assert_eq!(forwards, total(&values));
            prop_assert_eq!(Sum::from_words(forwards.to_words()), forwards);
            let (a, b) = values.split_at(values.len() / 2);
            let mut merged = total(b);
            merged.merge(&total(a));
            prop_assert_eq!(forwards, merged);
        }
    }

    #[test]
    fn the_sum_of_many_times_the_same_is_what_adding_it_as_often_gives() {
        for value in [Vec3::new(0.1, -3.0, 1e30), Vec3::new(f32::NAN, 1e-20, 0.7)] {
            let mut one_by_one = Sum::default();
            (0..37).for_each(|_| one_by_one.add(value));
            assert_eq!(Sum::of_many(value, 37), one_by_one);
        }
    }

    #[test]
    fn nan_counts_as_nothing_and_infinity_as_the_largest_value() {
        let mut sum = Sum::default();
        sum.add(Vec3::new(f32::NAN, f32::INFINITY, f32::NEG_INFINITY));
        assert_eq!(sum.mean(1), Vec3::new(0.0, LARGEST, -LARGEST));
    }
}
