//! The boxes that builders work on: not the callers' own, but copies with which no builder can go wrong.

use glam::{DVec3, Vec3A, Vec4};
use obvhs::aabb::Aabb;
use rayon::prelude::*;

/// Below this many boxes a pass over them takes less time than handing it to other threads.
const PARALLEL_SIZE: usize = 1 << 14;

/// A primitive as builders move it about: its box and its number, 32 bytes.
///
/// The lanes behind the corners' coordinates hold the number, 16 bits each, as floats that are neither tiny nor NaN:
/// whatever is computed with a whole register never meets a denormal number there, which takes a hundred cycles.
#[derive(Clone, Copy, Debug)]
pub(in crate::bvh) struct Item {
    min: Vec4,
    max: Vec4,
}

impl Item {
    /// The bits of 1.0.
    const ONE: u32 = 0x3f80_0000;

    pub(in crate::bvh) fn new(bounds: &Aabb, number: u32) -> Self {
        let half = |bits: u32| f32::from_bits(Self::ONE | bits);
        Self {
            min: bounds.min.extend(half(number & 0xffff)),
            max: bounds.max.extend(half(number >> 16)),
        }
    }

    /// The primitive's number.
    #[inline(always)]
    pub(in crate::bvh) fn number(&self) -> u32 {
        (self.min.w.to_bits() & 0xffff) | (self.max.w.to_bits() & 0xffff) << 16
    }

    /// Its box.
    #[inline(always)]
    pub(in crate::bvh) fn bounds(&self) -> Aabb {
        Aabb::new(Vec3A::from_vec4(self.min), Vec3A::from_vec4(self.max))
    }

    /// Twice the centre of its box: the point by which builders sort primitives.
    #[inline(always)]
    pub(in crate::bvh) fn centre(&self) -> Vec3A {
        Vec3A::from_vec4(self.min + self.max)
    }
}

/// What boxes are multiplied by, so that their largest coordinate lies in [1, 2): a power of two.
///
/// Areas then neither overflow (obvhs turns ∞ − ∞ into a broken tree) nor vanish, and a scene scaled by a
/// power of two gets the very same tree. Nothing is rounded but what falls 2^126 below the scene's size.
/// A box that is not finite becomes a point at the origin.
#[derive(Clone, Copy)]
pub(super) struct Normalisation {
    scale: f64,
}

impl Normalisation {
    pub(in crate::bvh) fn of(boxes: &[Aabb]) -> Self {
        let largest = |boxes: &[Aabb]| {
            (boxes.iter().filter(|b| is_finite(b)))
                .fold(Vec3A::ZERO, |largest, b| {
                    largest.max(b.min.abs()).max(b.max.abs())
                })
                .max_element()
        };
        let largest = (boxes.par_chunks(PARALLEL_SIZE).map(largest)).reduce(|| 0.0, f32::max);
        Self {
            scale: power_of_two_towards_one(largest),
        }
    }

    /// The box, multiplied.
    pub(super) fn apply(self, bounds: &Aabb) -> Aabb {
        if !is_finite(bounds) {
            return Aabb::default();
        }
        let scaled = |v: Vec3A| (v.as_dvec3() * self.scale).as_vec3a();
        Aabb::new(scaled(bounds.min), scaled(bounds.max))
    }
}

fn is_finite(b: &Aabb) -> bool {
    b.min.is_finite() && b.max.is_finite()
}

/// 2^-⌊log2 x⌋, or 1 for zero. In f64, where the reciprocal of every f32's power of two is a normal number.
fn power_of_two_towards_one(x: f32) -> f64 {
    if x == 0.0 {
        return 1.0;
    }
    // An f32 is a normal f64, so the exponent's bits alone are the power of two.
    let power = f64::from_bits(f64::from(x).to_bits() & 0x7ff0_0000_0000_0000);
    1.0 / power
}

/// The `i`th box, normalised, as primitive `i`.
pub(super) fn items(boxes: &[Aabb]) -> Vec<Item> {
    let normalisation = Normalisation::of(boxes);
    (boxes.par_iter().with_min_len(PARALLEL_SIZE).enumerate())
        .map(|(i, b)| Item::new(&normalisation.apply(b), i as u32))
        .collect()
}

/// All of them, normalised.
pub(super) fn normalised(boxes: &[Aabb]) -> Vec<Aabb> {
    let normalisation = Normalisation::of(boxes);
    (boxes.par_iter().with_min_len(PARALLEL_SIZE))
        .map(|b| normalisation.apply(b))
        .collect()
}

/// By how much of its longest side a box is jittered at most. Measured on five meshes of 100k triangles, three
/// presets: against no jitter the cost of the tree is 0.5 % lower to 0.25 % higher, and a sixteenth of this
/// still separates 1e5 identical triangles.
const JITTER_OF_SIDE: f32 = 1.0 / 4096.0;
/// The same relative to the coordinates: four units in the last place, for boxes without any extent.
const JITTER_OF_COORDINATE: f32 = 4.0 * f32::EPSILON;
/// The same relative to the scene, for boxes without extent at the origin: far below what f32 resolves
/// elsewhere, and its square is still a normal number.
const JITTER_OF_SCENE: f32 = 1.0 / (1u64 << 40) as f32;

/// Widens every box by a small amount of its own, from a hash of its index.
///
/// Locally-ordered clustering joins two neighbours when each is the other's best; when costs tie, as they do
/// among duplicates and in equally spaced rows, everyone prefers the neighbour on the same side and a round
/// joins one pair: n rounds, and a tree n deep. With a jitter no two costs are equal, a round joins a third
/// of the primitives, and duplicates are an ordinary input.
pub(super) fn jittered(boxes: &[Aabb]) -> Vec<Aabb> {
    (boxes.par_iter().with_min_len(PARALLEL_SIZE))
        .zip(0..boxes.len() as u32)
        .map(|(b, i)| {
            let side = Vec3A::splat(b.diagonal().max_element() * JITTER_OF_SIDE + JITTER_OF_SCENE);
            let coordinate = b.min.abs().max(b.max.abs()) * JITTER_OF_COORDINATE;
            let pad = (side + coordinate) * random_fractions(i);
            Aabb::new(b.min - pad, b.max + pad)
        })
        .collect()
}

/// Three numbers in [0, 1) that look random: 21 bits each of SplitMix64 (Steele, Lea, Flood 2014).
fn random_fractions(index: u32) -> Vec3A {
    let mut bits = (u64::from(index) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    let fraction = |shift: u32| (bits >> shift & 0x1f_ffff) as f64 / (1u64 << 21) as f64;
    DVec3::new(fraction(0), fraction(21), fraction(42)).as_vec3a()
}

/// The smallest box around all of them; `None` for none.
pub(in crate::bvh) fn union(boxes: impl IntoIterator<Item = Aabb>) -> Option<Aabb> {
    boxes.into_iter().reduce(|a, b| a.union(&b))
}
