//! Eight numbers at once, whatever the machine.

use super::portable::Portable;

/// Eight `f32`s. Every operation is lane by lane, rounded as IEEE 754 says, so that all implementations agree to the
/// last bit; nothing is fused.
pub(crate) trait Eight: Copy {
    /// A truth for each lane.
    type Mask: Copy;

    /// The same number in every lane.
    fn splat(x: f32) -> Self;
    /// From memory.
    fn load(from: &[f32; 8]) -> Self;
    /// To memory.
    fn to_array(self) -> [f32; 8];
    /// Sum.
    fn add(self, other: Self) -> Self;
    /// Difference.
    fn sub(self, other: Self) -> Self;
    /// Product.
    fn mul(self, other: Self) -> Self;
    /// The smaller; `other` where either is NaN or both are zero.
    fn min(self, other: Self) -> Self;
    /// The larger; `other` where either is NaN or both are zero.
    fn max(self, other: Self) -> Self;
    /// Without its sign.
    fn abs(self) -> Self;
    /// Whether it is smaller; not where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether it is smaller or equal; not where either is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Both.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// The second, and not the first.
    fn and_not(not: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Lane `i` as bit `i`.
    fn bits(mask: Self::Mask) -> u32;
}

/// A question to a tree, written for any [`Eight`].
pub(crate) trait Query {
    /// What comes back.
    type Answer;
    /// Answers it. Implementations are `#[inline(always)]`, so that they become part of a function that is compiled for
    /// the instruction set.
    fn ask<E: Eight>(self) -> Self::Answer;
}

/// Answers a question with the widest instructions that this machine has.
#[inline(always)]
pub(crate) fn answer<Q: Query>(query: Q) -> Q::Answer {
    #[cfg(target_arch = "x86_64")]
    if super::avx2::is_available() {
        return super::avx2::answer(query);
    }
    query.ask::<Portable>()
}
