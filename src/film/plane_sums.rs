//! What a plane of a tile has: nothing, one sample of each pixel, or more. While a light is moved every picture has new
//! first samples; a first sample is an `f32` and a quarter of a sum to write and to read.

use super::Sum;
use super::sum_columns::{Blend, CHANNELS, SumColumns, Sums, TileColors};
use super::tiles::TILE_PIXELS;
use glam::{DVec3, Vec3};

/// The sums of a tile's pixels in one plane.
#[derive(Default)]
pub(super) struct PlaneSums {
    /// Of one sample each, [`TileColors`]. At least one of the two is empty.
    first: Vec<f32>,
    /// Of more.
    sums: SumColumns,
}

impl PlaneSums {
    pub fn is_empty(&self) -> bool {
        self.first.is_empty() && self.sums.is_empty()
    }

    /// Has nothing any more, but for its memory.
    pub fn forget(&mut self) {
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

    /// The sums, for what is added to them: of nothing where it has nothing.
    pub fn as_sums(&mut self) -> &mut SumColumns {
        if self.sums.is_empty() {
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
        } else if !self.sums.is_empty() {
            blend.add(self.sums.all(), factors);
        }
    }

    /// The means of a picture of so many samples that is `others` and these, times a factor for each half and channel.
    pub fn means_with(&self, others: Sums, factors: [DVec3; 2], counts: [u32; 2]) -> TileColors {
        if !self.first.is_empty() {
            others.means_with_values(&self.first, factors, counts)
        } else if !self.sums.is_empty() {
            others.means_with(self.sums.all(), factors, counts)
        } else {
            others.means(counts)
        }
    }

    /// The means, those of each half of so many samples.
    pub fn means(&self, counts: [u32; 2]) -> TileColors {
        match TileColors::try_from(self.first.as_slice()) {
            Ok(first) => first,
            Err(_) => self.sums.all().means(counts),
        }
    }

    /// A copy of the sums.
    pub fn to_columns(&self) -> SumColumns {
        if self.first.is_empty() {
            return self.sums.clone();
        }
        let mut sums = SumColumns::default();
        sums.reset(TILE_PIXELS);
        sums.add(0, bytemuck::cast_slice(&self.first));
        sums
    }

    /// The sums, without a copy where that can be.
    pub fn into_columns(self) -> SumColumns {
        if self.first.is_empty() {
            self.sums
        } else {
            self.to_columns()
        }
    }

    /// The sum of one pixel.
    pub fn get(&self, pixel: usize) -> Sum {
        let Some(first) = self.first.get(CHANNELS * pixel..CHANNELS * (pixel + 1)) else {
            return self.sums.get(pixel);
        };
        let mut sum = Sum::default();
        sum.add(Vec3::from_slice(first));
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixed_point::tests::values;
    use super::*;

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
