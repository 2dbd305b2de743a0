//! Eight numbers in an array: for machines without vectors of their own file, and what the others are compared with.

use super::{InstructionSet, Lanes};

/// Eight numbers; the compiler makes of them what the machine has.
#[derive(Clone, Copy)]
pub(crate) struct Portable([f32; 8]);

impl Portable {
    #[inline(always)]
    fn each(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|lane| f(self.0[lane], other.0[lane])))
    }

    #[inline(always)]
    fn mask(self, other: Self, f: impl Fn(f32, f32) -> bool) -> u32 {
        (0..8).fold(0, |bits, lane| {
            bits | u32::from(f(self.0[lane], other.0[lane])) << lane
        })
    }
}

impl InstructionSet for Portable {
    type Eight = Self;
    type Packet = Self;
}

fn each_f64(a: [f64; 8], b: [f64; 8], f: impl Fn(f64, f64) -> f64) -> [f64; 8] {
    std::array::from_fn(|lane| f(a[lane], b[lane]))
}

impl Lanes for Portable {
    type Array = [f32; 8];
    type Mask = u32;
    type Doubles = [f64; 8];

    const COUNT: usize = 8;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; 8])
    }

    #[inline(always)]
    fn load(from: &[f32; 8]) -> Self {
        Self(*from)
    }

    #[inline(always)]
    fn columns(rows: &[[f32; 8]; 16]) -> [Self; 8] {
        std::array::from_fn(|i| Self(std::array::from_fn(|lane| rows[lane][i])))
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        self.0
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.each(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.each(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.each(other, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.each(other, |a, b| a / b)
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.each(sign, f32::copysign)
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        (self.0.into_iter()).fold(f32::INFINITY, |a, b| if b < a { b } else { a })
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        (self.0.into_iter()).fold(f32::NEG_INFINITY, |a, b| if b > a { b } else { a })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.each(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.each(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane].abs()))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        self.mask(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        self.mask(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn same_bits(self, other: Self) -> u32 {
        self.mask(other, |a, b| a.to_bits() == b.to_bits())
    }

    #[inline(always)]
    fn and(a: u32, b: u32) -> u32 {
        a & b
    }

    #[inline(always)]
    fn and_not(not: u32, b: u32) -> u32 {
        !not & b
    }

    #[inline(always)]
    fn bits(mask: u32) -> u32 {
        mask
    }

    #[inline(always)]
    fn mask(bits: u32) -> u32 {
        bits
    }

    #[inline(always)]
    fn select(mask: u32, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|lane| {
            if mask >> lane & 1 == 1 {
                yes.0[lane]
            } else {
                no.0[lane]
            }
        }))
    }

    #[inline(always)]
    fn splat_f64(x: f64) -> [f64; 8] {
        [x; 8]
    }

    #[inline(always)]
    fn widen(self) -> [f64; 8] {
        self.0.map(f64::from)
    }

    #[inline(always)]
    fn narrow(doubles: [f64; 8]) -> Self {
        Self(doubles.map(|x| x as f32))
    }

    #[inline(always)]
    fn add_f64(a: [f64; 8], b: [f64; 8]) -> [f64; 8] {
        each_f64(a, b, |a, b| a + b)
    }

    #[inline(always)]
    fn sub_f64(a: [f64; 8], b: [f64; 8]) -> [f64; 8] {
        each_f64(a, b, |a, b| a - b)
    }

    #[inline(always)]
    fn mul_f64(a: [f64; 8], b: [f64; 8]) -> [f64; 8] {
        each_f64(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn div_f64(a: [f64; 8], b: [f64; 8]) -> [f64; 8] {
        each_f64(a, b, |a, b| a / b)
    }
}
