//! Columns of sums against sums one by one.

use super::super::fixed_point;
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
        let mut merged = columns.all().to_columns();
        merged.merge(0, columns.all());
        for (pixel, sum) in sums.iter().enumerate() {
            prop_assert_eq!(columns.get(pixel), *sum);
            let mut twice = *sum;
            twice.merge(sum);
            prop_assert_eq!(merged.get(pixel), twice);
            columns.set(pixel, &twice);
            prop_assert_eq!(columns.get(pixel), twice);
        }
    }

    #[test]
    fn means_and_what_they_moved_by_are_those_of_each_number(
        pairs in prop::collection::vec(any::<[i128; 2]>(), 48),
        shift in 0..127_u32,
        counts in any::<[u16; 2]>(),
    ) {
        let own = tile(|lane| pairs[lane % 48][0] >> shift);
        let other = tile(|lane| pairs[lane % 48][1] >> shift);
        let means = own.all().means(counts.map(u32::from));
        let mut moved = [0.0; CHANNELS * TILE_PIXELS];
        own.all().half_differences(other.all(), 8, &mut moved);
        for lane in 0..CHANNELS * TILE_PIXELS {
            let [own, other] = pairs[lane % 48].map(|number| number >> shift);
            let count = counts[lane % 48 / 24];
            let mean = if count > 0 { own as f64 * UNIT / f64::from(count) } else { 0.0 };
            prop_assert!((f64::from(means[lane]) - mean).abs() <= 1e-7 * mean.abs() + 1e-45);
            let half = other.wrapping_sub(own) as f64 * UNIT / 16.0;
            prop_assert!((f64::from(moved[lane]) - half).abs() <= 1e-7 * half.abs() + 1e-45);
        }
    }

    #[test]
    fn a_blend_adds_whole_steps_of_each_plane_whatever_their_order(
        numbers in prop::collection::vec(any::<[i128; 2]>(), 48),
        shift in 1..127_u32,
        factors in prop::array::uniform2(prop_oneof![Just(1.0), Just(0.0), -1e3..1e3_f64, Just(1e30)]),
    ) {
        let planes = [0, 1].map(|plane| tile(|lane| numbers[lane % 48][plane] >> shift));
        let scaled = |lane: usize, plane: usize| {
            let number = numbers[lane % 48][plane] >> shift;
            match factors[plane] {
                1.0 => number,
                factor => ((number as f64 * factor) as i128).max(-i128::MAX),
            }
        };
        let blend = |order: [usize; 2]| {
            let mut blend = Blend::new();
            for plane in order {
                let factor = DVec3::splat(factors[plane]);
                // The channels of the other half are not 1, whatever this one's are.
                blend.add(planes[plane].all(), [factor, factor]);
            }
            blend.sums().to_columns()
        };
        let both = blend([0, 1]);
        prop_assert_eq!(&both, &blend([1, 0]));
        for lane in 0..48 {
            let expected = scaled(lane, 0).saturating_add(scaled(lane, 1));
            let number = both.get(lane / CHANNELS).0[lane % CHANNELS];
            // The conversion to f64 may be the number beside the nearest.
            let tolerance = (expected.unsigned_abs() >> 51) + (number.unsigned_abs() >> 51);
            let largest = (0..2).map(|plane| scaled(lane, plane).unsigned_abs() >> 51).max();
            let tolerance = tolerance.max(largest.unwrap_or(0));
            prop_assert!(number.abs_diff(expected) <= tolerance, "{number} {expected}");
        }
    }
}

/// A tile in which each lane has such a number.
fn tile(number: impl Fn(usize) -> i128) -> SumColumns {
    let mut columns = SumColumns::default();
    columns.reset(TILE_PIXELS);
    for pixel in 0..TILE_PIXELS {
        let sum = Sum(std::array::from_fn(|channel| {
            number(CHANNELS * pixel + channel)
        }));
        columns.set(pixel, &sum);
    }
    columns
}

#[test]
fn every_exponent_and_both_signs_are_added_as_one_by_one() {
    for value in fixed_point::tests::values() {
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
