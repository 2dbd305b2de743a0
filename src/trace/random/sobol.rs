//! Points of the Owen-scrambled Sobol sequence for many samples at once: the numbers of [`sobol_burley::sample_4d`], bit
//! for bit, in loops over columns that vectorise.
//!
//! The sequence, its scrambling and the hashes are the crate's (Burley 2020, "Practical Hash-based Owen Scrambling", JCGT
//! 9(4)). What a loop cannot have is its search for the set bits of an index. In the second dimension, whose matrix is
//! Pascal's triangle modulo 2, that sum takes four steps of shifting halves onto each other; in the third and fourth it
//! is written out over all 16 bits.

use super::sampler::mix;
use crate::instruction_sets::vectorized;
use sobol_burley::parts::{hash, owen_scramble_rev, u32_to_f32_norm};

/// The sequence is 2^16 points long; a longer run goes on with another scrambling.
pub(super) const LENGTH_BITS: u32 = 16;

/// What tells the dimensions of a block apart.
const KEYS: [u32; 4] = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8];

/// Direction numbers, bits reversed, of the third and the fourth dimension (Joe and Kuo 2008, "Constructing Sobol
/// sequences with better two-dimensional projections").
const DIRECTIONS: [[u32; LENGTH_BITS as usize]; 2] = [
    [
        0x0001, 0x0003, 0x0006, 0x0009, 0x0017, 0x003a, 0x0071, 0x00a3, 0x0116, 0x0339, 0x0677,
        0x09aa, 0x1601, 0x3903, 0x7706, 0xaa09,
    ],
    [
        0x0001, 0x0003, 0x0004, 0x000a, 0x001f, 0x002e, 0x0045, 0x00c9, 0x011b, 0x02a4, 0x079a,
        0x0b67, 0x101e, 0x302d, 0x4041, 0xa0c3,
    ],
];

/// The seed of a block: of a pixel's numbers, what they are for, and the path that asks. A run that is longer than the
/// sequence goes on with another seed.
#[inline(always)]
fn block_seed(pixel: u32, key: u32, path: u32, beyond: u32) -> u32 {
    let seed = mix(mix(pixel, key), path);
    if beyond == 0 { seed } else { mix(seed, beyond) }
}

/// The place of a point in the sequence that the seed shuffles, as bits of which the first counts least.
#[inline(always)]
fn shuffled(within: u32, seed: u32) -> u32 {
    let order = owen_scramble_rev(within.reverse_bits(), hash(seed ^ 0x79c6_8e4a));
    order.reverse_bits() & ((1 << LENGTH_BITS) - 1)
}

/// The second dimension, bits reversed, at a place of the sequence.
#[inline(always)]
fn second(place: u32) -> u32 {
    let mut v = place;
    v ^= (v & 0xaaaa_aaaa) >> 1;
    v ^= (v & 0xcccc_cccc) >> 2;
    v ^= (v & 0xf0f0_f0f0) >> 4;
    v ^ ((v & 0xff00_ff00) >> 8)
}

/// A further dimension, bits reversed.
#[inline(always)]
fn by_directions(place: u32, directions: &[u32; LENGTH_BITS as usize]) -> u32 {
    let mut sum = 0;
    for (bit, direction) in directions.iter().enumerate() {
        sum ^= direction & (place >> bit & 1).wrapping_neg();
    }
    sum
}

/// The number in [0, 1) of a dimension, from its bits reversed.
#[inline(always)]
fn scrambled(reversed: u32, seed: u32, key: u32) -> f32 {
    let scramble = hash(seed.wrapping_mul(0x9c8f_2d3b) ^ key);
    u32_to_f32_norm(owen_scramble_rev(reversed, scramble).reverse_bits())
}

/// Which numbers of a block: its first alone, its first two or its last two.
const FIRST: u8 = 0;
const FIRST_TWO: u8 = 1;
const LAST_TWO: u8 = 2;

/// Those numbers of a block, for the point `within` the sequence; the second is 0 where it is none of them.
#[inline(always)]
fn two<const WHICH: u8>(seed: u32, within: u32) -> (f32, f32) {
    let place = shuffled(within, seed);
    match WHICH {
        FIRST => (scrambled(place, seed, KEYS[0]), 0.0),
        FIRST_TWO => (
            scrambled(place, seed, KEYS[0]),
            scrambled(second(place), seed, KEYS[1]),
        ),
        _ => (
            scrambled(by_directions(place, &DIRECTIONS[0]), seed, KEYS[2]),
            scrambled(by_directions(place, &DIRECTIONS[1]), seed, KEYS[3]),
        ),
    }
}

/// Points that are worked out together, those that nobody asked for among them: what is left of a column would else go one
/// by one, which takes as long as all that goes before.
const LANES: usize = 32;

/// The same of columns: of `pixels` their seeds, of `indices` the points. Their indices become numbers of 32 bits first:
/// beside wider ones a register holds half as many. `v` stays empty where there is no second number.
#[inline(always)]
fn fill<const WHICH: u8>(
    key: u32,
    pixels: &[u32],
    paths: &[u32],
    indices: &[u64],
    u: &mut [f32],
    v: &mut [f32],
) {
    let [mut pixel, mut path, mut within, mut beyond] = [[0; LANES]; 4];
    let mut two_of = ([0.0; LANES], [0.0; LANES]);
    for (chunk, u) in u.chunks_mut(LANES).enumerate() {
        let count = u.len();
        let some = chunk * LANES..chunk * LANES + count;
        pixel[..count].copy_from_slice(&pixels[some.clone()]);
        path[..count].copy_from_slice(&paths[some.clone()]);
        for (i, index) in indices[some.clone()].iter().enumerate() {
            within[i] = *index as u32 & ((1 << LENGTH_BITS) - 1);
            beyond[i] = (*index >> LENGTH_BITS) as u32;
        }
        if beyond == [0; LANES] {
            for i in 0..LANES {
                let seed = block_seed(pixel[i], key, path[i], 0);
                (two_of.0[i], two_of.1[i]) = two::<WHICH>(seed, within[i]);
            }
        } else {
            for i in 0..LANES {
                let seed = block_seed(pixel[i], key, path[i], beyond[i]);
                (two_of.0[i], two_of.1[i]) = two::<WHICH>(seed, within[i]);
            }
        }
        u.copy_from_slice(&two_of.0[..count]);
        if WHICH != FIRST {
            v[some].copy_from_slice(&two_of.1[..count]);
        }
    }
}

vectorized! {
    /// The first number of a block.
    pub(in crate::trace) fn firsts(key: u32, pixels: &[u32], paths: &[u32], indices: &[u64], u: &mut [f32]) {
        fill::<FIRST>(key, pixels, paths, indices, u, &mut []);
    }

    /// The first two numbers of a block.
    pub(in crate::trace) fn pairs(
        key: u32,
        pixels: &[u32],
        paths: &[u32],
        indices: &[u64],
        u: &mut [f32],
        v: &mut [f32],
    ) {
        fill::<FIRST_TWO>(key, pixels, paths, indices, u, v);
    }

    /// The last two numbers of a block.
    pub(super) fn last_pairs(
        key: u32,
        pixels: &[u32],
        paths: &[u32],
        indices: &[u64],
        u: &mut [f32],
        v: &mut [f32],
    ) {
        fill::<LAST_TWO>(key, pixels, paths, indices, u, v);
    }
}

#[cfg(test)]
mod tests {
    use super::super::sampler::{Purpose, Sampler};
    use super::*;
    use crate::scene::Sequence;

    #[test]
    fn a_column_has_the_numbers_that_each_sample_has_by_itself() {
        let count = 1 << 17;
        let pixels: Vec<u32> = (0..count)
            .map(|i: u32| i.wrapping_mul(0x9e37_79b9))
            .collect();
        let paths: Vec<u32> = pixels
            .iter()
            .map(|pixel| pixel.rotate_left(7) % 5)
            .collect();
        // All points of the sequence, those of its second and third run, and some far beyond.
        let indices: Vec<u64> = (0..u64::from(count))
            .map(|i| if i % 97 == 0 { i << 24 } else { i })
            .collect();
        let mut columns = [const { Vec::new() }; 4];
        for column in &mut columns {
            column.resize(count as usize, 0.0);
        }
        let [u, v, w, x] = &mut columns;
        pairs(Purpose::Gloss.key(), &pixels, &paths, &indices, u, v);
        last_pairs(Purpose::Gloss.key(), &pixels, &paths, &indices, w, x);
        let mut alone = vec![0.0; count as usize];
        firsts(Purpose::Gloss.key(), &pixels, &paths, &indices, &mut alone);
        assert_eq!(alone, *u);
        for i in 0..count as usize {
            let sampler = Sampler::of_pixel(pixels[i], Sequence::Sobol, 1);
            let block = sampler.block(indices[i], Purpose::Gloss, paths[i]);
            let column = [0, 1, 2, 3].map(|j| columns[j][i]);
            assert_eq!(column, block, "point {} of {:#x}", indices[i], pixels[i]);
        }
    }
}
