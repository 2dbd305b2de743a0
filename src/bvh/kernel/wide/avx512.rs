//! Sixteen numbers in one AVX-512 register, or eight in half of one.
//!
//! The types are private to this file: only [`answer`] names them, and that is only called where [`is_available`] said
//! yes. So wherever their operations run, the machine has them.

use std::arch::x86_64::*;

use super::{InstructionSet, Lanes, Query};

/// What is compiled for these machines.
enum Avx512 {}

impl InstructionSet for Avx512 {
    type Eight = Half;
    type Packet = Full;
}

/// Eight numbers in half a register; a mask of its own kind instead of numbers.
#[derive(Clone, Copy)]
struct Half(__m256);

/// Sixteen numbers in a register.
#[derive(Clone, Copy)]
struct Full(__m512);

/// Whether this machine has what [`answer`] is compiled for. The standard library asks the processor once.
#[inline(always)]
pub(super) fn is_available() -> bool {
    std::arch::is_x86_feature_detected!("avx512f")
        && std::arch::is_x86_feature_detected!("avx512vl")
        && std::arch::is_x86_feature_detected!("avx512dq")
        && std::arch::is_x86_feature_detected!("avx512bw")
        && std::arch::is_x86_feature_detected!("bmi1")
        && std::arch::is_x86_feature_detected!("bmi2")
}

/// Answers a question with AVX-512.
///
/// # Panics
/// On a machine for which [`is_available`] is false; where the caller has asked that, the check costs nothing.
#[inline(always)]
pub(super) fn answer<Q: Query>(query: Q) -> Q::Answer {
    assert!(is_available(), "AVX-512 was asked for where there is none");
    // SAFETY: the machine has the features, by the line above.
    unsafe { compiled(query) }
}

#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,bmi1,bmi2")]
fn compiled<Q: Query>(query: Q) -> Q::Answer {
    query.ask::<Avx512>()
}

/// A method that is one instruction or a few, all of registers.
macro_rules! method {
    ($($name:ident($($argument:ident $(: $kind:ty)?),*) -> $answer:ty = $body:expr;)*) => {$(
        #[inline(always)]
        fn $name($($argument $(: $kind)?),*) -> $answer {
            // SAFETY: the machine has the instructions, by the privacy of these types (see the module); they touch no
            // memory.
            unsafe { $body }
        }
    )*};
}

/// A method of a number and another.
macro_rules! of_two {
    ($($name:ident = $instruction:ident;)*) => {$(
        #[inline(always)]
        fn $name(self, other: Self) -> Self {
            // SAFETY: the machine has the instruction, by the privacy of these types (see the module); it touches no
            // memory.
            Self(unsafe { $instruction(self.0, other.0) })
        }
    )*};
}

impl Lanes for Half {
    type Array = [f32; 8];
    type Mask = __mmask8;
    type Doubles = __m512d;

    const COUNT: usize = 8;

    #[inline(always)]
    fn load(from: &[f32; 8]) -> Self {
        // SAFETY: AVX is there, by the privacy of this type; the reference is good for 32 bytes, at any alignment.
        Self(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn columns(rows: &[[f32; 8]; 16]) -> [Self; 8] {
        let mut columns = [[0.0; 8]; 8];
        for (lane, row) in rows[..8].iter().enumerate() {
            for (column, number) in columns.iter_mut().zip(row) {
                column[lane] = *number;
            }
        }
        let [a, b, c, d, e, f, g, h] = &columns;
        [
            Self::load(a),
            Self::load(b),
            Self::load(c),
            Self::load(d),
            Self::load(e),
            Self::load(f),
            Self::load(g),
            Self::load(h),
        ]
    }

    #[inline(always)]
    fn prefetch<T>(soon: &T) {
        for line in 0..size_of::<T>().div_ceil(64) {
            let line = (&raw const *soon).cast::<i8>().wrapping_add(64 * line);
            // SAFETY: every x86-64 machine has the instruction; it reads nothing that the program sees, and does not fail
            // at any address.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(line) };
        }
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        let mut array = [0.0; 8];
        // SAFETY: AVX is there, by the privacy of this type; the array is good for 32 bytes, at any alignment.
        unsafe { _mm256_storeu_ps(array.as_mut_ptr(), self.0) };
        array
    }

    of_two! {
        add = _mm256_add_ps;
        sub = _mm256_sub_ps;
        mul = _mm256_mul_ps;
        div = _mm256_div_ps;
        min = _mm256_min_ps;
        max = _mm256_max_ps;
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: AVX is there, by the privacy of this type.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        // SAFETY: AVX is there, by the privacy of this type.
        let sign = unsafe { _mm256_and_ps(_mm256_set1_ps(-0.0), sign.0) };
        // SAFETY: as above.
        Self(unsafe { _mm256_or_ps(sign, self.abs().0) })
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        self.to_array()
            .into_iter()
            .fold(f32::INFINITY, |a, b| if b < a { b } else { a })
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        self.to_array()
            .into_iter()
            .fold(f32::NEG_INFINITY, |a, b| if b > a { b } else { a })
    }

    method! {
        splat(x: f32) -> Self = Self(_mm256_set1_ps(x));
        lt(self, other: Self) -> __mmask8 = _mm256_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0);
        le(self, other: Self) -> __mmask8 = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0);
        same_bits(self, other: Self) -> __mmask8 = _mm256_cmpeq_epi32_mask(
            _mm256_castps_si256(self.0),
            _mm256_castps_si256(other.0),
        );
        select(mask: __mmask8, yes: Self, no: Self) -> Self = Self(_mm256_mask_blend_ps(mask, no.0, yes.0));
        splat_f64(x: f64) -> __m512d = _mm512_set1_pd(x);
        widen(self) -> __m512d = _mm512_cvtps_pd(self.0);
        narrow(x: __m512d) -> Self = Self(_mm512_cvtpd_ps(x));
        add_f64(a: __m512d, b: __m512d) -> __m512d = _mm512_add_pd(a, b);
        sub_f64(a: __m512d, b: __m512d) -> __m512d = _mm512_sub_pd(a, b);
        mul_f64(a: __m512d, b: __m512d) -> __m512d = _mm512_mul_pd(a, b);
        div_f64(a: __m512d, b: __m512d) -> __m512d = _mm512_div_pd(a, b);
    }

    #[inline(always)]
    fn and(a: __mmask8, b: __mmask8) -> __mmask8 {
        a & b
    }

    #[inline(always)]
    fn and_not(not: __mmask8, b: __mmask8) -> __mmask8 {
        !not & b
    }

    #[inline(always)]
    fn bits(mask: __mmask8) -> u32 {
        u32::from(mask)
    }

    #[inline(always)]
    fn mask(bits: u32) -> __mmask8 {
        bits as __mmask8
    }
}

/// The lower half and the upper half.
macro_rules! halves {
    ($($name:ident = $instruction:ident;)*) => {$(
        #[inline(always)]
        fn $name(a: [__m512d; 2], b: [__m512d; 2]) -> [__m512d; 2] {
            // SAFETY: the machine has the instruction, by the privacy of this type (see the module); it touches no
            // memory.
            unsafe { [$instruction(a[0], b[0]), $instruction(a[1], b[1])] }
        }
    )*};
}

/// Eight rows, column by column, in quarters: columns 0 to 3 of the first four rows, their columns 4 to 7, and the same of
/// the last four rows.
#[inline(always)]
fn eight_rows(rows: &[[f32; 8]]) -> [__m512; 4] {
    let (a, b) = (two_rows(&rows[0], &rows[4]), two_rows(&rows[1], &rows[5]));
    let (c, d) = (two_rows(&rows[2], &rows[6]), two_rows(&rows[3], &rows[7]));
    // SAFETY: only this file's instruction set comes here, whose types are private; no memory is touched.
    unsafe {
        let (ab, ab_high) = (_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
        let (cd, cd_high) = (_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
        [
            _mm512_shuffle_ps::<0x44>(ab, cd),
            _mm512_shuffle_ps::<0xee>(ab, cd),
            _mm512_shuffle_ps::<0x44>(ab_high, cd_high),
            _mm512_shuffle_ps::<0xee>(ab_high, cd_high),
        ]
    }
}

/// Two rows, one behind the other.
#[inline(always)]
fn two_rows(first: &[f32; 8], last: &[f32; 8]) -> __m512 {
    let (first, last) = (Half::load(first).0, Half::load(last).0);
    // SAFETY: only this file's instruction set comes here, whose types are private; no memory is touched.
    unsafe { _mm512_insertf32x8::<1>(_mm512_castps256_ps512(first), last) }
}

impl Lanes for Full {
    type Array = [f32; 16];
    type Mask = __mmask16;
    type Doubles = [__m512d; 2];

    const COUNT: usize = 16;

    #[inline(always)]
    fn load(from: &[f32; 16]) -> Self {
        // SAFETY: AVX-512 is there, by the privacy of this type; the reference is good for 64 bytes, at any alignment.
        Self(unsafe { _mm512_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn columns(rows: &[[f32; 8]; 16]) -> [Self; 8] {
        let [a, b, c, d] = eight_rows(&rows[0..8]);
        let [e, f, g, h] = eight_rows(&rows[8..16]);
        let halves = [(a, e), (b, f), (c, g), (d, h)];
        let mut columns = [Self::splat(0.0); 8];
        for (i, (first, last)) in halves.into_iter().enumerate() {
            // SAFETY: AVX-512 is there, by the privacy of this type; no memory is touched.
            unsafe {
                columns[i].0 = _mm512_shuffle_f32x4::<0x88>(first, last);
                columns[4 + i].0 = _mm512_shuffle_f32x4::<0xdd>(first, last);
            }
        }
        columns
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 16] {
        let mut array = [0.0; 16];
        // SAFETY: AVX-512 is there, by the privacy of this type; the array is good for 64 bytes, at any alignment.
        unsafe { _mm512_storeu_ps(array.as_mut_ptr(), self.0) };
        array
    }

    of_two! {
        add = _mm512_add_ps;
        sub = _mm512_sub_ps;
        mul = _mm512_mul_ps;
        div = _mm512_div_ps;
        min = _mm512_min_ps;
        max = _mm512_max_ps;
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: AVX-512 is there, by the privacy of this type.
        Self(unsafe { _mm512_abs_ps(self.0) })
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        // SAFETY: AVX-512 is there, by the privacy of this type.
        let sign = unsafe { _mm512_and_ps(_mm512_set1_ps(-0.0), sign.0) };
        // SAFETY: as above.
        Self(unsafe { _mm512_or_ps(sign, self.abs().0) })
    }

    method! {
        splat(x: f32) -> Self = Self(_mm512_set1_ps(x));
        smallest(self) -> f32 = _mm512_reduce_min_ps(self.0);
        largest(self) -> f32 = _mm512_reduce_max_ps(self.0);
        lt(self, other: Self) -> __mmask16 = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0);
        le(self, other: Self) -> __mmask16 = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0);
        same_bits(self, other: Self) -> __mmask16 = _mm512_cmpeq_epi32_mask(
            _mm512_castps_si512(self.0),
            _mm512_castps_si512(other.0),
        );
        select(mask: __mmask16, yes: Self, no: Self) -> Self = Self(_mm512_mask_blend_ps(mask, no.0, yes.0));
        splat_f64(x: f64) -> [__m512d; 2] = [_mm512_set1_pd(x); 2];
        widen(self) -> [__m512d; 2] = [
            _mm512_cvtps_pd(_mm512_castps512_ps256(self.0)),
            _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(self.0)),
        ];
        narrow(x: [__m512d; 2]) -> Self = Self(_mm512_insertf32x8::<1>(
            _mm512_castps256_ps512(_mm512_cvtpd_ps(x[0])),
            _mm512_cvtpd_ps(x[1]),
        ));
    }

    halves! {
        add_f64 = _mm512_add_pd;
        sub_f64 = _mm512_sub_pd;
        mul_f64 = _mm512_mul_pd;
        div_f64 = _mm512_div_pd;
    }

    #[inline(always)]
    fn and(a: __mmask16, b: __mmask16) -> __mmask16 {
        a & b
    }

    #[inline(always)]
    fn and_not(not: __mmask16, b: __mmask16) -> __mmask16 {
        !not & b
    }

    #[inline(always)]
    fn bits(mask: __mmask16) -> u32 {
        u32::from(mask)
    }

    #[inline(always)]
    fn mask(bits: u32) -> __mmask16 {
        bits as __mmask16
    }
}
