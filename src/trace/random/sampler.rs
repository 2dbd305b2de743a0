use super::sobol::LENGTH_BITS;
use crate::scene::Sequence;
use glam::UVec2;
use sobol_burley::sample_4d;

/// Names one sample of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleId {
    /// (0, 0) is the top left pixel.
    pub pixel: UVec2,
    /// Counts the pixel's samples from 0.
    pub index: u64,
}

/// Low-discrepancy numbers for one pixel: Owen-scrambled Sobol points (Burley 2020, "Practical
/// Hash-based Owen Scrambling", JCGT 9(4)), padded as he advises.
///
/// Numbers come in blocks of four. Within a block they are stratified together over the sample
/// index; two blocks are independent of each other. A block is named by its [`Purpose`] and by the
/// path that asks: the same question at the same place of the same path gets the same block.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    seed: u32,
    sequence: Sequence,
    /// Cells a side of the grid that [`Sequence::Jittered`] fills.
    side: u32,
}

/// What a block of four numbers is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Two for the place in the pixel, two for the lens.
    Camera,
    /// One: when in the shutter's time.
    Time,
    /// Two: the point of the light with this id.
    Light(u64),
    /// Two: the place in a glossy reflection's disc.
    Gloss,
    /// Two: the place in a translucent surface's disc.
    Translucency,
    /// One: which way a ray goes on that could go two.
    Branch,
    /// One: whether a faint point of the light with this id is asked for.
    Faint(u64),
}

impl Purpose {
    pub(super) fn key(self) -> u32 {
        match self {
            Self::Camera => 1,
            Self::Time => 2,
            Self::Gloss => 3,
            Self::Translucency => 4,
            Self::Branch => 5,
            Self::Light(id) => mix(mix(6, id as u32), (id >> 32) as u32),
            Self::Faint(id) => mix(mix(7, id as u32), (id >> 32) as u32),
        }
    }
}

impl Sampler {
    /// The numbers of pixel (x, y) under `seed`.
    pub fn new(x: u32, y: u32, seed: u32, sequence: Sequence) -> Self {
        Self::of_pixel(pixel_seed(seed, x, y), sequence, 1)
    }

    /// The numbers of the pixel with that [`pixel_seed`], those of [`Sequence::Jittered`] in the cells of a grid of
    /// `side` × `side`.
    pub(in crate::trace) fn of_pixel(seed: u32, sequence: Sequence, side: u32) -> Self {
        Self {
            seed,
            sequence,
            side: side.clamp(1, 1 << 12),
        }
    }

    /// The same numbers, those of [`Sequence::Jittered`] in the cells of a grid of `side` × `side`.
    pub fn on_grid(self, side: u32) -> Self {
        Self::of_pixel(self.seed, self.sequence, side)
    }

    /// Four numbers in [0, 1): point `index` of the block for `purpose` on the path `path`
    /// (0 at the camera and at the first hit).
    pub fn block(self, index: u64, purpose: Purpose, path: u32) -> [f32; 4] {
        let mut seed = mix(mix(self.seed, purpose.key()), path);
        match self.sequence {
            Sequence::Sobol => {}
            Sequence::Independent => return independent(seed, index),
            Sequence::Jittered => return jittered(seed, index, self.side),
        }
        let beyond = (index >> LENGTH_BITS) as u32;
        if beyond != 0 {
            seed = mix(seed, beyond);
        }
        sample_4d((index & ((1 << LENGTH_BITS) - 1)) as u32, 0, seed)
    }
}

/// What all numbers of pixel (x, y) come from, under the picture's `seed`.
#[inline(always)]
pub(super) fn pixel_seed(seed: u32, x: u32, y: u32) -> u32 {
    mix(mix(mix(0x9e37_79b9, seed), x), y)
}

/// Random numbers.
fn independent(seed: u32, index: u64) -> [f32; 4] {
    let of_sample = mix(mix(seed, index as u32), (index >> 32) as u32);
    // 24 bits, as many as a float in [0, 1) holds evenly.
    [0, 1, 2, 3].map(|i| (mix(of_sample, i) >> 8) as f32 / (1 << 24) as f32)
}

/// Random places in random cells of a grid, for the first and the second pair: each cell once in side² samples.
fn jittered(seed: u32, index: u64, side: u32) -> [f32; 4] {
    let cells = side * side;
    let (round, within) = (index / u64::from(cells), (index % u64::from(cells)) as u32);
    let seed = mix(mix(seed, round as u32), (round >> 32) as u32);
    let mut numbers = independent(seed, u64::from(within));
    for (pair, numbers) in (0..).zip(numbers.as_chunks_mut::<2>().0) {
        let cell = shuffled(within, cells, mix(seed, 0x51ab_0000 + pair));
        for (number, column) in numbers.iter_mut().zip([cell % side, cell / side]) {
            // Rounding may reach 1, which belongs to the next cell.
            *number = ((column as f32 + *number) / side as f32).min(1.0_f32.next_down());
        }
    }
    numbers
}

/// Where `i` of `count` things stands in an order that the seed chooses. Steps that can be undone shuffle the next
/// power of two; what falls beyond the count walks on until it does not (Black and Rogaway 2002, "Ciphers with
/// Arbitrary Finite Domains").
fn shuffled(mut i: u32, count: u32, seed: u32) -> u32 {
    let bits = (count - 1).checked_ilog2().map_or(0, |bits| bits + 1);
    let mask = ((1u64 << bits) - 1) as u32;
    loop {
        for step in 0..4 {
            i = (i ^ mix(seed, step)) & mask;
            i = i.wrapping_mul(0x9e37_79b1) & mask;
            i ^= i >> (bits / 2).max(1);
        }
        if i < count {
            return i;
        }
    }
}

/// Mixes `value` into `state`: one round of MurmurHash3's finaliser (Appleby, public domain), whose
/// every output bit depends on every input bit.
#[inline(always)]
pub(in crate::trace) fn mix(state: u32, value: u32) -> u32 {
    let mut h = state
        ^ value
            .wrapping_mul(0xcc9e_2d51)
            .rotate_left(15)
            .wrapping_mul(0x1b87_3593);
    h = h.rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64);
    h ^= h >> 16;
    h = h.wrapping_mul(0x85eb_ca6b);
    h ^= h >> 13;
    h = h.wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_of_a_block_is_stratified_in_every_elementary_interval() {
        // The first 256 points of a (0, m, 2)-net have exactly one point in each cell of every
        // 2^a × 2^b grid with a + b = 8.
        let sampler = Sampler::new(3, 5, 7, Sequence::Sobol);
        for a in 0..=8 {
            let (columns, rows) = (1usize << a, 1usize << (8 - a));
            let mut cells = vec![0; 256];
            for i in 0..256 {
                let [u, v, ..] = sampler.block(i, Purpose::Light(9), 0);
                cells[(v * rows as f32) as usize * columns + (u * columns as f32) as usize] += 1;
            }
            assert!(cells.iter().all(|&n| n == 1), "{columns}x{rows}: {cells:?}");
        }
    }

    #[test]
    fn jittered_pairs_have_one_point_in_each_cell_of_their_grid_whatever_its_side() {
        for side in [1, 2, 3, 4, 7, 16] {
            let sampler = Sampler::new(3, 5, 7, Sequence::Jittered).on_grid(side);
            let cells = u64::from(side * side);
            // In the first round, and in a later one.
            for first in [0, 5 * cells] {
                for pair in [0, 2] {
                    let mut seen = vec![0; cells as usize];
                    for i in first..first + cells {
                        let block = sampler.block(i, Purpose::Gloss, 0);
                        let [u, v] =
                            [block[pair], block[pair + 1]].map(|x| (x * side as f32) as u32);
                        seen[(v * side + u) as usize] += 1;
                    }
                    assert!(
                        seen.iter().all(|&n| n == 1),
                        "side {side}, pair {pair}: {seen:?}"
                    );
                }
            }
        }
        let order = |seed| [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|i| shuffled(i, 9, seed));
        assert_ne!(order(1), order(2), "the seed does not matter");
    }

    #[test]
    fn independent_numbers_fill_the_square_without_order() {
        let sampler = Sampler::new(3, 5, 7, Sequence::Independent);
        let mut cells = [0.0_f64; 64];
        let n = 64 * 1024;
        for i in 0..n {
            let [u, v, ..] = sampler.block(i, Purpose::Gloss, 0);
            cells[(v * 8.0) as usize * 8 + (u * 8.0) as usize] += 1.0;
        }
        // χ² of 63 degrees of freedom: between 30 and 115 but for one time in ten thousand; a
        // stratified sequence would give nearly zero.
        let chi: f64 = cells.iter().map(|c| (c - 1024.0).powi(2) / 1024.0).sum();
        assert!((30.0..115.0).contains(&chi), "χ² = {chi:.1}");
    }

    #[test]
    fn different_purposes_pixels_paths_and_seeds_give_different_numbers() {
        let base = Sampler::new(1, 2, 3, Sequence::Sobol).block(4, Purpose::Gloss, 0);
        for other in [
            Sampler::new(2, 1, 3, Sequence::Sobol).block(4, Purpose::Gloss, 0),
            Sampler::new(1, 2, 4, Sequence::Sobol).block(4, Purpose::Gloss, 0),
            Sampler::new(1, 2, 3, Sequence::Sobol).block(4, Purpose::Camera, 0),
            Sampler::new(1, 2, 3, Sequence::Sobol).block(4, Purpose::Gloss, 1),
            Sampler::new(1, 2, 3, Sequence::Sobol).block(4 + (1 << 16), Purpose::Gloss, 0),
        ] {
            assert_ne!(base, other);
        }
    }
}
