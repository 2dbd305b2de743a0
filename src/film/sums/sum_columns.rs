//! The sums of many pixels at once: those of [`Sum`], bit for bit, in loops over columns that vectorise.

use super::fixed_point::{UNIT, joined, saturating_sum, sum, to_f64, to_fixed, whole_steps};
use super::sum::Sum;
use super::tiles::{BLOCK_PIXELS, HALF_PIXELS, TILE_PIXELS};
use crate::instruction_sets::vectorized;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Numbers of a pixel.
pub(in crate::film) const CHANNELS: usize = 3;
/// What a pixel of several planes together takes.
pub(in crate::film) const BLEND_BYTES: usize = size_of::<i128>() * CHANNELS;
/// What a pixel of a plane takes.
pub(in crate::film) const PLANE_BYTES: usize = BLEND_BYTES + size_of::<f32>() * CHANNELS;
/// Numbers of a block, of which each half's lie together.
const BLOCK_LANES: usize = CHANNELS * BLOCK_PIXELS;
const HALF_LANES: usize = CHANNELS * HALF_PIXELS;

/// A number for each channel of each pixel of a tile, in the order of its memory.
pub(in crate::film) type TileColors = [f32; CHANNELS * TILE_PIXELS];

/// The sums of pixels, 128-bit fixed-point numbers as two columns of 64 bits, three for each pixel.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::film) struct SumColumns {
    low: Vec<u64>,
    high: Vec<u64>,
}

/// Some of them.
#[derive(Clone, Copy, Debug)]
pub(in crate::film) struct Sums<'a> {
    low: &'a [u64],
    high: &'a [u64],
}

impl SumColumns {
    /// As many sums of nothing.
    pub fn reset(&mut self, pixels: usize) {
        self.truncate(0);
        self.extend(pixels);
    }

    /// No more than so many.
    pub fn truncate(&mut self, pixels: usize) {
        self.low.truncate(CHANNELS * pixels);
        self.high.truncate(CHANNELS * pixels);
    }

    /// So many more sums of nothing.
    pub fn extend(&mut self, pixels: usize) {
        let lanes = self.low.len() + CHANNELS * pixels;
        self.low.resize(lanes, 0);
        self.high.resize(lanes, 0);
    }

    pub fn is_empty(&self) -> bool {
        self.low.is_empty()
    }

    /// How many pixels' they are.
    pub fn len(&self) -> usize {
        self.low.len() / CHANNELS
    }

    /// All of them, to be read.
    pub fn all(&self) -> Sums<'_> {
        Sums {
            low: &self.low,
            high: &self.high,
        }
    }

    /// Becomes these sums. Memory is written without being read: new memory comes page by page, and a page that is read
    /// before it is written comes twice.
    pub fn copy_from(&mut self, others: Sums) {
        self.truncate(0);
        self.low.extend_from_slice(others.low);
        self.high.extend_from_slice(others.high);
    }

    /// Adds a colour to each pixel from the `first` on, as [`Sum::add`] does.
    pub fn add(&mut self, first: usize, values: &[Vec3]) {
        let lanes = CHANNELS * first..CHANNELS * (first + values.len());
        let (low, high) = (&mut self.low[lanes.clone()], &mut self.high[lanes]);
        add_columns(bytemuck::cast_slice(values), low, high);
    }

    /// Adds so many colours to each pixel from the `first` on: those of a pixel follow one another.
    pub fn add_series(&mut self, first: usize, length: usize, values: &[Vec3]) {
        let lanes = CHANNELS * first..CHANNELS * (first + values.len() / length);
        let (low, high) = (&mut self.low[lanes.clone()], &mut self.high[lanes]);
        add_all(bytemuck::cast_slice(values), CHANNELS * length, low, high);
    }

    /// Adds to the pixels from the `first` on what others hold.
    pub fn merge(&mut self, first: usize, others: Sums) {
        let lanes = CHANNELS * first..CHANNELS * first + others.low.len();
        let (low, high) = (&mut self.low[lanes.clone()], &mut self.high[lanes]);
        merge_columns(low, high, others.low, others.high);
    }

    /// These pixels have nothing.
    pub fn clear(&mut self, pixels: Range<usize>) {
        let lanes = CHANNELS * pixels.start..CHANNELS * pixels.end;
        self.low[lanes.clone()].fill(0);
        self.high[lanes].fill(0);
    }

    /// The sum of one pixel.
    pub fn get(&self, pixel: usize) -> Sum {
        self.all().get(pixel)
    }

    /// Another sum of one pixel.
    pub fn set(&mut self, pixel: usize, sum: &Sum) {
        for (channel, sum) in sum.0.into_iter().enumerate() {
            let at = CHANNELS * pixel + channel;
            self.low[at] = sum as u64;
            self.high[at] = (sum >> 64) as u64;
        }
    }
}

impl<'a> Sums<'a> {
    /// Those of these pixels.
    pub fn part(self, pixels: Range<usize>) -> Sums<'a> {
        let lanes = CHANNELS * pixels.start..CHANNELS * pixels.end;
        Sums {
            low: &self.low[lanes.clone()],
            high: &self.high[lanes],
        }
    }

    /// A copy.
    pub fn to_columns(self) -> SumColumns {
        let mut copy = SumColumns::default();
        copy.copy_from(self);
        copy
    }

    /// The sum of one pixel.
    pub fn get(self, pixel: usize) -> Sum {
        Sum(std::array::from_fn(|channel| {
            let at = CHANNELS * pixel + channel;
            joined(self.low[at], self.high[at])
        }))
    }

    /// The means of a tile's pixels, of which those of each half have so many samples; black where they have none.
    pub fn means(self, counts: [u32; 2]) -> TileColors {
        let mut means = [0.0; CHANNELS * TILE_PIXELS];
        multiply(&mut means, self.low, self.high, &units(counts));
        means
    }

    /// The means of these sums and others, those of each half times a factor for each channel: what [`Blend::add`] and
    /// [`Self::means`] come to.
    pub fn means_with(self, others: Sums, factors: [DVec3; 2], counts: [u32; 2]) -> TileColors {
        let mut means = [0.0; CHANNELS * TILE_PIXELS];
        multiply_both(
            &mut means,
            [self.low, self.high],
            [others.low, others.high],
            &lanes_of(factors),
            &units(counts),
        );
        means
    }

    /// [`Self::means_with`] of sums of one sample each.
    pub fn means_with_values(
        self,
        values: &[f32],
        factors: [DVec3; 2],
        counts: [u32; 2],
    ) -> TileColors {
        let mut means = [0.0; CHANNELS * TILE_PIXELS];
        let own = [self.low, self.high];
        multiply_with_values(&mut means, own, values, &steps(factors), &units(counts));
        means
    }

    /// Half the difference between the means of `others` and of these sums, each over `count` values: how far the mean of
    /// both together is from that of these.
    pub fn half_differences(self, others: Sums, count: u32, moved: &mut [f32]) {
        let unit = UNIT / (2.0 * f64::from(count.max(1)));
        half_differences(
            moved,
            [self.low, self.high],
            [others.low, others.high],
            unit,
        );
    }
}

/// The picture of a tile as a sum of others, each with a tint: exact where that is 1, else each rounded to 53 bits. What is
/// larger than a sum can hold stays as large as that.
pub(in crate::film) struct Blend {
    low: [u64; CHANNELS * TILE_PIXELS],
    high: [u64; CHANNELS * TILE_PIXELS],
}

impl Blend {
    pub fn new() -> Self {
        Self {
            low: [0; CHANNELS * TILE_PIXELS],
            high: [0; CHANNELS * TILE_PIXELS],
        }
    }

    /// One that is kept.
    pub fn boxed() -> Box<Self> {
        Box::new(Self::new())
    }

    /// It is black.
    pub fn clear(&mut self) {
        self.low.fill(0);
        self.high.fill(0);
    }

    /// Adds the sums of a tile, those of each half times a factor for each channel.
    pub fn add(&mut self, sums: Sums, factors: [DVec3; 2]) {
        if factors == [DVec3::ONE; 2] {
            saturating_merge(&mut self.low, &mut self.high, sums.low, sums.high);
        } else {
            let lanes = lanes_of(factors);
            merge_scaled(&mut self.low, &mut self.high, sums.low, sums.high, &lanes);
        }
    }

    /// Adds a sample of each pixel of a tile, those of each half times a factor for each channel.
    pub fn add_values(&mut self, values: &[f32], factors: [DVec3; 2]) {
        merge_values(&mut self.low, &mut self.high, values, &steps(factors));
    }

    pub fn sums(&self) -> Sums<'_> {
        Sums {
            low: &self.low,
            high: &self.high,
        }
    }
}

/// What turns values into steps, times such factors. One rounding fewer than those of sums, for which it makes no difference:
/// as a sum a value is a whole number of steps, and as exact.
fn steps(factors: [DVec3; 2]) -> [f64; BLOCK_LANES] {
    lanes_of(factors.map(|factor| factor / UNIT))
}

/// What turns sums of so many samples into means.
fn units(counts: [u32; 2]) -> [f64; BLOCK_LANES] {
    lanes_of(counts.map(|count| {
        DVec3::splat(if count > 0 {
            UNIT / f64::from(count)
        } else {
            0.0
        })
    }))
}

/// A factor of each half for each channel, as a block's numbers have it.
fn lanes_of(halves: [DVec3; 2]) -> [f64; BLOCK_LANES] {
    std::array::from_fn(|lane| halves[lane / HALF_LANES][lane % CHANNELS])
}

/// A sum times a factor: exact where that is 1, else rounded to 53 bits and to whole steps.
#[inline(always)]
fn scaled(low: u64, high: u64, factor: f64) -> (u64, u64) {
    let (scaled_low, scaled_high) = whole_steps(to_f64(low, high) * factor);
    let is_exact = factor == 1.0;
    (
        if is_exact { low } else { scaled_low },
        if is_exact { high } else { scaled_high },
    )
}

/// Adds a value to each of some sums.
#[inline(always)]
fn add_lanes((low, high): &mut ([u64; HALF_LANES], [u64; HALF_LANES]), values: &[f32; HALF_LANES]) {
    for i in 0..HALF_LANES {
        let (value_low, value_high) = to_fixed(values[i]);
        (low[i], high[i]) = sum(low[i], high[i], value_low, value_high);
    }
}

vectorized! {
    fn add_columns(values: &[f32], low: &mut [u64], high: &mut [u64]) {
        let count = values.len();
        let (low, high) = (&mut low[..count], &mut high[..count]);
        for i in 0..count {
            let (value_low, value_high) = to_fixed(values[i]);
            (low[i], high[i]) = sum(low[i], high[i], value_low, value_high);
        }
    }

    fn add_all(values: &[f32], of_pixel: usize, low: &mut [u64], high: &mut [u64]) {
        let pixels = low.chunks_exact_mut(CHANNELS).zip(high.chunks_exact_mut(CHANNELS));
        for ((low, high), values) in pixels.zip(values.chunks_exact(of_pixel)) {
            let mut sums = ([0; HALF_LANES], [0; HALF_LANES]);
            let (whole, rest) = values.as_chunks::<HALF_LANES>();
            for values in whole {
                add_lanes(&mut sums, values);
            }
            if !rest.is_empty() {
                let mut values = [0.0; HALF_LANES];
                values[..rest.len()].copy_from_slice(rest);
                add_lanes(&mut sums, &values);
            }
            for i in 0..HALF_LANES {
                let channel = i % CHANNELS;
                (low[channel], high[channel]) = sum(low[channel], high[channel], sums.0[i], sums.1[i]);
            }
        }
    }

    fn merge_columns(low: &mut [u64], high: &mut [u64], other_low: &[u64], other_high: &[u64]) {
        let count = low.len();
        let (high, other_low, other_high) = (&mut high[..count], &other_low[..count], &other_high[..count]);
        for i in 0..count {
            (low[i], high[i]) = sum(low[i], high[i], other_low[i], other_high[i]);
        }
    }

    fn saturating_merge(low: &mut [u64], high: &mut [u64], other_low: &[u64], other_high: &[u64]) {
        let count = low.len();
        let (high, other_low, other_high) = (&mut high[..count], &other_low[..count], &other_high[..count]);
        for i in 0..count {
            (low[i], high[i]) = saturating_sum(low[i], high[i], other_low[i], other_high[i]);
        }
    }

    fn merge_scaled(
        low: &mut [u64],
        high: &mut [u64],
        other_low: &[u64],
        other_high: &[u64],
        factors: &[f64; BLOCK_LANES],
    ) {
        let sums = low.chunks_exact_mut(BLOCK_LANES).zip(high.chunks_exact_mut(BLOCK_LANES));
        let others = other_low.chunks_exact(BLOCK_LANES).zip(other_high.chunks_exact(BLOCK_LANES));
        for ((low, high), (other_low, other_high)) in sums.zip(others) {
            for i in 0..BLOCK_LANES {
                let (scaled_low, scaled_high) = scaled(other_low[i], other_high[i], factors[i]);
                (low[i], high[i]) = saturating_sum(low[i], high[i], scaled_low, scaled_high);
            }
        }
    }

    fn merge_values(low: &mut [u64], high: &mut [u64], values: &[f32], steps: &[f64; BLOCK_LANES]) {
        let sums = low.chunks_exact_mut(BLOCK_LANES).zip(high.chunks_exact_mut(BLOCK_LANES));
        for ((low, high), values) in sums.zip(values.chunks_exact(BLOCK_LANES)) {
            for i in 0..BLOCK_LANES {
                let (value_low, value_high) = whole_steps(f64::from(values[i]) * steps[i]);
                (low[i], high[i]) = saturating_sum(low[i], high[i], value_low, value_high);
            }
        }
    }

    fn multiply_with_values(
        products: &mut [f32],
        own: [&[u64]; 2],
        values: &[f32],
        steps: &[f64; BLOCK_LANES],
        factors: &[f64; BLOCK_LANES],
    ) {
        let [low, high] = own.map(|column| column.chunks_exact(BLOCK_LANES));
        let values = values.chunks_exact(BLOCK_LANES);
        let products = products.chunks_exact_mut(BLOCK_LANES);
        for (((low, high), values), products) in low.zip(high).zip(values).zip(products) {
            for i in 0..BLOCK_LANES {
                let (value_low, value_high) = whole_steps(f64::from(values[i]) * steps[i]);
                let (low, high) = saturating_sum(low[i], high[i], value_low, value_high);
                products[i] = (to_f64(low, high) * factors[i]) as f32;
            }
        }
    }

    fn multiply_both(
        products: &mut [f32],
        own: [&[u64]; 2],
        other: [&[u64]; 2],
        other_factors: &[f64; BLOCK_LANES],
        factors: &[f64; BLOCK_LANES],
    ) {
        let [low, high] = own.map(|column| column.chunks_exact(BLOCK_LANES));
        let [other_low, other_high] = other.map(|column| column.chunks_exact(BLOCK_LANES));
        let products = products.chunks_exact_mut(BLOCK_LANES);
        for (((low, high), (other_low, other_high)), products) in
            low.zip(high).zip(other_low.zip(other_high)).zip(products)
        {
            for i in 0..BLOCK_LANES {
                let (scaled_low, scaled_high) = scaled(other_low[i], other_high[i], other_factors[i]);
                let (low, high) = saturating_sum(low[i], high[i], scaled_low, scaled_high);
                products[i] = (to_f64(low, high) * factors[i]) as f32;
            }
        }
    }

    fn multiply(products: &mut [f32], low: &[u64], high: &[u64], factors: &[f64; BLOCK_LANES]) {
        let sums = low.chunks_exact(BLOCK_LANES).zip(high.chunks_exact(BLOCK_LANES));
        for ((low, high), products) in sums.zip(products.chunks_exact_mut(BLOCK_LANES)) {
            for i in 0..BLOCK_LANES {
                products[i] = (to_f64(low[i], high[i]) * factors[i]) as f32;
            }
        }
    }

    fn half_differences(moved: &mut [f32], own: [&[u64]; 2], other: [&[u64]; 2], unit: f64) {
        let count = moved.len();
        let [own_low, own_high] = own.map(|column| &column[..count]);
        let [other_low, other_high] = other.map(|column| &column[..count]);
        for i in 0..count {
            let low = other_low[i].wrapping_sub(own_low[i]);
            let borrow = u64::from(other_low[i] < own_low[i]);
            let high = other_high[i].wrapping_sub(own_high[i]).wrapping_sub(borrow);
            moved[i] = (to_f64(low, high) * unit) as f32;
        }
    }
}

#[cfg(test)]
mod tests;
