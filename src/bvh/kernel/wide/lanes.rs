//! Several numbers at once, whatever the machine.

use super::portable::Portable;

/// Several `f32`s. Every operation is lane by lane, rounded as IEEE 754 says, so that all implementations agree to the
/// last bit; nothing is fused.
pub(crate) trait Lanes: Copy {
    /// Its lanes in memory.
    type Array: Copy + AsRef<[f32]> + AsMut<[f32]>;
    /// A truth for each lane.
    type Mask: Copy;
    /// An `f64` for each lane.
    type Doubles: Copy;

    /// How many lanes it has, at most 16.
    const COUNT: usize;

    /// The same number in every lane.
    fn splat(x: f32) -> Self;
    /// From memory.
    fn load(from: &Self::Array) -> Self;
    /// Columns: the `i`th has the `i`th number of each row. As many of the rows as there are lanes.
    fn columns(rows: &[[f32; 8]; 16]) -> [Self; 8];
    /// To memory.
    fn to_array(self) -> Self::Array;
    /// Sum.
    fn add(self, other: Self) -> Self;
    /// Difference.
    fn sub(self, other: Self) -> Self;
    /// Product.
    fn mul(self, other: Self) -> Self;
    /// Quotient.
    fn div(self, other: Self) -> Self;
    /// The smaller; `other` where either is NaN or both are zero.
    fn min(self, other: Self) -> Self;
    /// The larger; `other` where either is NaN or both are zero.
    fn max(self, other: Self) -> Self;
    /// Without its sign.
    fn abs(self) -> Self;
    /// With the sign of the other.
    fn copysign(self, sign: Self) -> Self;
    /// The smallest of its lanes, none of which is NaN.
    fn smallest(self) -> f32;
    /// The largest of its lanes, none of which is NaN.
    fn largest(self) -> f32;
    /// Whether it is smaller; not where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether it is smaller or equal; not where either is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Whether the bits are the same.
    fn same_bits(self, other: Self) -> Self::Mask;
    /// Both.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// The second, and not the first.
    fn and_not(not: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Lane `i` as bit `i`.
    fn bits(mask: Self::Mask) -> u32;
    /// Bit `i` as lane `i`.
    fn mask(bits: u32) -> Self::Mask;
    /// `yes` where the mask says so, and else `no`; bit for bit.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Asks for something that is soon to be read, all of its cache lines.
    #[inline(always)]
    fn prefetch<T>(_soon: &T) {}

    /// The same `f64` for every lane.
    fn splat_f64(x: f64) -> Self::Doubles;
    /// As `f64`, exactly.
    fn widen(self) -> Self::Doubles;
    /// Rounded to `f32`.
    fn narrow(doubles: Self::Doubles) -> Self;
    /// Sum.
    fn add_f64(a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    /// Difference.
    fn sub_f64(a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    /// Product.
    fn mul_f64(a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    /// Quotient.
    fn div_f64(a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
}

/// An array of what `$of` is for the axes 0, 1 and 2. In place of a closure: that would not become part of the function
/// that is compiled for an instruction set, and only an `#[inline(always)]` function does.
macro_rules! by_axis {
    (|$axis:ident| $of:expr) => {
        [
            {
                let $axis = 0;
                $of
            },
            {
                let $axis = 1;
                $of
            },
            {
                let $axis = 2;
                $of
            },
        ]
    };
}
pub(crate) use by_axis;

/// Eight lanes: a node's children, or a block's triangles, against one ray.
pub(crate) trait Eight: Lanes<Array = [f32; 8]> {}

impl<L: Lanes<Array = [f32; 8]>> Eight for L {}

/// What an instruction set has.
pub(crate) trait InstructionSet {
    /// For one ray.
    type Eight: Eight;
    /// For a packet of rays, each a lane.
    type Packet: Lanes;
}

/// A question to a tree, written for any [`InstructionSet`].
pub(crate) trait Query {
    /// What comes back.
    type Answer;
    /// Answers it. Implementations are `#[inline(always)]`, so that they become part of a function that is compiled for
    /// the instruction set.
    fn ask<S: InstructionSet>(self) -> Self::Answer;
}

/// Answers a question with the widest instructions that this machine has.
#[inline(always)]
pub(crate) fn answer<Q: Query>(query: Q) -> Q::Answer {
    #[cfg(target_arch = "x86_64")]
    {
        if super::avx512::is_available() {
            return super::avx512::answer(query);
        }
        if super::avx2::is_available() {
            return super::avx2::answer(query);
        }
    }
    query.ask::<Portable>()
}

/// Answers a question with each instruction set that this machine has, and names those that it lacks.
#[cfg(test)]
pub(crate) fn answer_with_each<Q: Query>(
    mut query: impl FnMut() -> Q,
    mut check: impl FnMut(&str, Q::Answer),
) -> Vec<&'static str> {
    let mut lacking = Vec::new();
    #[cfg(target_arch = "x86_64")]
    {
        if super::avx512::is_available() {
            check("AVX-512", super::avx512::answer(query()));
        } else {
            lacking.push("AVX-512");
        }
        if super::avx2::is_available() {
            check("AVX2", super::avx2::answer(query()));
        } else {
            lacking.push("AVX2");
        }
    }
    check("portable", query().ask::<Portable>());
    lacking
}
