//! The boxes that builders work on: not the callers' own, but copies with which no builder can go wrong.

use glam::{DVec3, Vec3A};
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};

/// Boxes multiplied by a power of two, so that the largest coordinate lies in [1, 2).
///
/// Areas then neither overflow (obvhs turns ∞ − ∞ into a broken tree) nor vanish, and a scene scaled by a
/// power of two gets the very same tree. Nothing is rounded but what falls 2^126 below the scene's size.
/// A box that is not finite becomes a point at the origin.
pub(super) fn normalised(boxes: &[Aabb]) -> Vec<Aabb> {
    let is_finite = |b: &&Aabb| b.min.is_finite() && b.max.is_finite();
    let largest = boxes
        .iter()
        .filter(is_finite)
        .fold(Vec3A::ZERO, |largest, b| {
            largest.max(b.min.abs()).max(b.max.abs())
        })
        .max_element();
    let scale = power_of_two_towards_one(largest);
    let scaled = |v: Vec3A| (v.as_dvec3() * scale).as_vec3a();
    boxes
        .iter()
        .map(|b| Some(b).filter(is_finite).copied().unwrap_or_default())
        .map(|b| Aabb::new(scaled(b.min), scaled(b.max)))
        .collect()
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

/// The `i`th box as the leaf that holds primitive `i` alone: 32 bytes that partitioning can move about.
pub(super) fn items(boxes: &[Aabb]) -> Vec<Bvh2Node> {
    boxes
        .iter()
        .zip(0..)
        .map(|(b, i)| Bvh2Node::new(*b, 1, i))
        .collect()
}

/// The centre of a box, the point by which builders sort primitives.
pub(super) fn centroid(item: &Bvh2Node) -> Vec3A {
    item.aabb().center()
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
    boxes
        .iter()
        .zip(0..)
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
pub(super) fn union(boxes: impl IntoIterator<Item = Aabb>) -> Option<Aabb> {
    boxes.into_iter().reduce(|a, b| a.union(&b))
}
