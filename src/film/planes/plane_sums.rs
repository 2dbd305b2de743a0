//! What a plane of a tile has: nothing, the same of every pixel, one sample of each, or more. While a light is moved every
//! picture has new first samples; a first sample is an `f32` and a quarter of a sum to write and to read. And where there is
//! nothing to be seen a sum of each half is all.

use crate::film::Sum;
use crate::film::sums::sum_columns::{Blend, CHANNELS, SumColumns, Sums, TileColors};
use crate::film::sums::tiles::{Pixels, TILE_PIXELS, half_of};
use glam::{DVec3, Vec3};
use std::borrow::Cow;

/// The sums of a tile's pixels in one plane. Equal where they are the same sums, however they are kept.
#[derive(Clone, Debug, Default)]
pub(in crate::film) struct PlaneSums {
    /// The sum of every pixel of each half, where they are the same. At most one of the three is anything.
    even: Option<[Sum; 2]>,
    /// Of one sample each, [`TileColors`].
    first: Vec<f32>,
    /// Of more.
    sums: SumColumns,
}

impl PlaneSums {
    pub fn is_empty(&self) -> bool {
        self.even.is_none() && self.first.is_empty() && self.sums.is_empty()
    }

    /// Has nothing any more, but for its memory.
    pub fn forget(&mut self) {
        self.even = None;
        self.first.clear();
        self.sums.truncate(0);
    }

    /// Takes sums where it has none, of one sample each where `is_one`.
    pub fn begin(&mut self, sums: Sums, is_one: bool) {
        if is_one {
            self.first.extend_from_slice(&sums.means([1; 2]));
        } else {
            self.sums.copy_from(sums);
        }
    }

    /// Adds the same to every one of these pixels.
    pub fn add_even(&mut self, pixels: Pixels, sum: &Sum) {
        let mut more = [Sum::default(); 2];
        pixels.halves().for_each(|half| more[half] = *sum);
        if self.is_empty() {
            self.even = Some(more);
        } else if let Some(sums) = &mut self.even {
            (sums.iter_mut().zip(&more)).for_each(|(sum, more)| sum.merge(more));
        } else {
            self.as_sums().merge(0, columns_of(&more).all());
        }
    }

    /// Adds the sums of others.
    pub fn merge(&mut self, others: &Self) {
        match others.even {
            _ if self.is_empty() => *self = others.clone(),
            Some(even) => (0..2).for_each(|half| self.add_even(Pixels::Half(half), &even[half])),
            None if others.is_empty() => {}
            None => self.as_sums().merge(0, others.columns().all()),
        }
    }

    /// The sums, for what is added to them: of nothing where it has nothing.
    pub fn as_sums(&mut self) -> &mut SumColumns {
        if let Some(even) = self.even.take() {
            self.sums = columns_of(&even);
        } else if self.sums.is_empty() {
            self.sums.reset(TILE_PIXELS);
            if !self.first.is_empty() {
                self.sums.add(0, bytemuck::cast_slice(&self.first));
                self.first = Vec::new();
            }
        }
        &mut self.sums
    }

    /// Adds them to a picture, those of each half times a factor for each channel.
    pub fn add_to(&self, blend: &mut Blend, factors: [DVec3; 2]) {
        if !self.first.is_empty() {
            blend.add_values(&self.first, factors);
        } else if !self.is_empty() {
            blend.add(self.columns().all(), factors);
        }
    }

    /// The means of a picture of so many samples that is `others` and these, times a factor for each half and channel.
    pub fn means_with(&self, others: Sums, factors: [DVec3; 2], counts: [u32; 2]) -> TileColors {
        if !self.first.is_empty() {
            others.means_with_values(&self.first, factors, counts)
        } else if !self.is_empty() {
            others.means_with(self.columns().all(), factors, counts)
        } else {
            others.means(counts)
        }
    }

    /// The means, those of each half of so many samples; black where it has nothing.
    pub fn means(&self, counts: [u32; 2]) -> TileColors {
        if let Some(even) = &self.even {
            let means = [0, 1].map(|half| even[half].mean(counts[half]).to_array());
            std::array::from_fn(|lane| means[half_of(lane / CHANNELS)][lane % CHANNELS])
        } else if let Ok(first) = TileColors::try_from(self.first.as_slice()) {
            first
        } else if self.sums.is_empty() {
            [0.0; CHANNELS * TILE_PIXELS]
        } else {
            self.sums.all().means(counts)
        }
    }

    /// The mean of every pixel of each half, where they are the same.
    pub fn even_means(&self, counts: [u32; 2]) -> Option<[Vec3; 2]> {
        let even = self.even.as_ref()?;
        Some([0, 1].map(|half| even[half].mean(counts[half])))
    }

    /// The sums: none where it has nothing.
    fn columns(&self) -> Cow<'_, SumColumns> {
        if let Some(even) = &self.even {
            Cow::Owned(columns_of(even))
        } else if self.first.is_empty() {
            Cow::Borrowed(&self.sums)
        } else {
            let mut sums = SumColumns::default();
            sums.reset(TILE_PIXELS);
            sums.add(0, bytemuck::cast_slice(&self.first));
            Cow::Owned(sums)
        }
    }

    /// A copy of the sums.
    #[cfg(test)]
    pub fn to_columns(&self) -> SumColumns {
        self.columns().into_owned()
    }

    /// The sum of one pixel.
    pub fn get(&self, pixel: usize) -> Sum {
        if let Some(even) = &self.even {
            return even[half_of(pixel)];
        }
        let Some(first) = self.first.get(CHANNELS * pixel..CHANNELS * (pixel + 1)) else {
            return if self.sums.is_empty() {
                Sum::default()
            } else {
                self.sums.get(pixel)
            };
        };
        let mut sum = Sum::default();
        sum.add(Vec3::from_slice(first));
        sum
    }
}

impl From<SumColumns> for PlaneSums {
    fn from(sums: SumColumns) -> Self {
        Self {
            sums,
            ..Self::default()
        }
    }
}

impl PartialEq for PlaneSums {
    fn eq(&self, other: &Self) -> bool {
        self.columns() == other.columns()
    }
}

/// Such a sum of every pixel of each half.
fn columns_of(even: &[Sum; 2]) -> SumColumns {
    let mut columns = SumColumns::default();
    columns.reset(TILE_PIXELS);
    (0..TILE_PIXELS).for_each(|pixel| columns.set(pixel, &even[half_of(pixel)]));
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::sums::fixed_point::tests::values;

    #[test]
    fn the_same_of_every_pixel_is_the_sums_that_it_stands_for() {
        let [one, other] = [3, 5].map(|count| Sum::of_many(Vec3::new(0.1, 2.0, -7.0), count));
        let mut even = PlaneSums::default();
        even.add_even(Pixels::All, &one);
        even.add_even(Pixels::Half(1), &other);
        let columns = even.to_columns();
        let plain = PlaneSums::from(columns.clone());
        assert_eq!(even, plain);
        assert_eq!(even.means([3, 8]), columns.all().means([3, 8]));
        let factors = [DVec3::splat(0.3), DVec3::ONE];
        let others = columns.all();
        assert_eq!(
            even.means_with(others, factors, [6, 16]),
            plain.means_with(others, factors, [6, 16])
        );
        for (a, b) in [
            (&even, &even),
            (&even, &plain),
            (&plain, &even),
            (&PlaneSums::default(), &even),
            (&even, &PlaneSums::default()),
        ] {
            let mut merged = a.clone();
            merged.merge(b);
            for pixel in 0..TILE_PIXELS {
                let mut sum = a.get(pixel);
                sum.merge(&b.get(pixel));
                assert_eq!(merged.get(pixel), sum);
            }
        }
        let mut more = even.clone();
        more.as_sums().merge(0, columns.all());
        more.add_even(Pixels::Half(0), &one);
        assert_eq!(more.get(0), Sum::of_many(Vec3::new(0.1, 2.0, -7.0), 9));
        even.forget();
        assert!(even.is_empty());
    }

    #[test]
    fn a_first_sample_is_the_sum_that_it_was_whatever_its_size() {
        let values: Vec<f32> = values().chain([0.0, -0.0, 1.0, 0.1]).collect();
        for some in values.chunks(CHANNELS * TILE_PIXELS) {
            let mut tile = [0.0; CHANNELS * TILE_PIXELS];
            tile[..some.len()].copy_from_slice(some);
            let mut sums = SumColumns::default();
            sums.reset(TILE_PIXELS);
            sums.add(0, bytemuck::cast_slice(&tile));
            let [mut first, mut more] = [PlaneSums::default(), PlaneSums::default()];
            first.begin(sums.all(), true);
            more.begin(sums.all(), false);
            assert!(!first.first.is_empty() && first.sums.is_empty() && more.first.is_empty());
            assert_eq!(first.to_columns(), sums);
            assert_eq!(first.means([1; 2]), more.means([1; 2]));
            for pixel in 0..TILE_PIXELS {
                assert_eq!(first.get(pixel), sums.get(pixel));
            }
            let others = sums.all().to_columns();
            for factor in [1.0, 0.3, -7.0, 1e30] {
                let factors = [DVec3::splat(factor), DVec3::new(1.0, factor, 0.5)];
                let blended = [&first, &more].map(|plane| {
                    let mut blend = Blend::new();
                    blend.add(others.all(), [DVec3::ONE; 2]);
                    plane.add_to(&mut blend, factors);
                    blend.sums().to_columns()
                });
                assert_eq!(blended[0], blended[1], "times {factor:e}");
                let means = [&first, &more].map(|p| p.means_with(others.all(), factors, [3, 0]));
                assert_eq!(means[0], means[1], "times {factor:e}");
                assert_eq!(means[0], blended[0].all().means([3, 0]), "times {factor:e}");
            }
            let more = first.as_sums().clone();
            assert_eq!(more, sums);
            assert!(first.first.is_empty());
        }
    }
}
