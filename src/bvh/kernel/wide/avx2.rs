//! Eight numbers in one AVX register.
//!
//! The type is private to this file: only [`answer`] names it, and that is only called where [`is_available`] said yes.
//! So wherever its operations run, the machine has them.

use std::arch::x86_64::*;

use super::{InstructionSet, Lanes, Query};

/// Eight numbers in a register.
#[derive(Clone, Copy)]
struct Avx2(__m256);

impl InstructionSet for Avx2 {
    type Eight = Self;
    type Packet = Self;
}

/// Whether this machine has what [`answer`] is compiled for. The standard library asks the processor once.
#[inline(always)]
pub(super) fn is_available() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("bmi1")
        && std::arch::is_x86_feature_detected!("bmi2")
}

/// Answers a question with AVX2.
///
/// # Panics
/// On a machine for which [`is_available`] is false; where the caller has asked that, the check costs nothing.
#[inline(always)]
pub(super) fn answer<Q: Query>(query: Q) -> Q::Answer {
    assert!(is_available(), "AVX2 was asked for where there is none");
    // SAFETY: the machine has the features, by the line above.
    unsafe { compiled(query) }
}

#[target_feature(enable = "avx2,bmi1,bmi2")]
fn compiled<Q: Query>(query: Q) -> Q::Answer {
    query.ask::<Avx2>()
}

/// A method that is one instruction or a few, all of registers.
macro_rules! method {
    ($($name:ident($($argument:ident $(: $kind:ty)?),*) -> $answer:ty = $body:expr;)*) => {$(
        #[inline(always)]
        fn $name($($argument $(: $kind)?),*) -> $answer {
            // SAFETY: the machine has the instructions, by the privacy of this type (see the module); they touch no
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
            // SAFETY: the machine has the instruction, by the privacy of this type (see the module); it touches no
            // memory.
            Self(unsafe { $instruction(self.0, other.0) })
        }
    )*};
}

/// The lower half and the upper half.
macro_rules! halves {
    ($($name:ident = $instruction:ident;)*) => {$(
        #[inline(always)]
        fn $name(a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
            // SAFETY: the machine has the instruction, by the privacy of this type (see the module); it touches no
            // memory.
            unsafe { [$instruction(a[0], b[0]), $instruction(a[1], b[1])] }
        }
    )*};
}

/// Four numbers of four rows, column by column: columns 0 to 3 in the lower half, and 4 to 7 in the upper.
#[inline(always)]
fn four_rows(a: &[f32; 8], b: &[f32; 8], c: &[f32; 8], d: &[f32; 8]) -> [__m256; 4] {
    let (a, b) = (Avx2::load(a).0, Avx2::load(b).0);
    let (c, d) = (Avx2::load(c).0, Avx2::load(d).0);
    // SAFETY: only this file's instruction set comes here, whose type is private; no memory is touched.
    unsafe {
        let (ab, ab_high) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        let (cd, cd_high) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
        [
            _mm256_shuffle_ps::<0x44>(ab, cd),
            _mm256_shuffle_ps::<0xee>(ab, cd),
            _mm256_shuffle_ps::<0x44>(ab_high, cd_high),
            _mm256_shuffle_ps::<0xee>(ab_high, cd_high),
        ]
    }
}

impl Lanes for Avx2 {
    type Array = [f32; 8];
    type Mask = __m256;
    type Doubles = [__m256d; 2];

    const COUNT: usize = 8;

    #[inline(always)]
    fn load(from: &[f32; 8]) -> Self {
        // SAFETY: AVX is there, by the privacy of this type; the reference is good for 32 bytes, at any alignment.
        Self(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn columns(rows: &[[f32; 8]; 16]) -> [Self; 8] {
        let [a, b, c, d] = four_rows(&rows[0], &rows[1], &rows[2], &rows[3]);
        let [e, f, g, h] = four_rows(&rows[4], &rows[5], &rows[6], &rows[7]);
        let halves = [(a, e), (b, f), (c, g), (d, h)];
        let mut columns = [Self::splat(0.0); 8];
        for (i, (first, last)) in halves.into_iter().enumerate() {
            // SAFETY: AVX is there, by the privacy of this type; no memory is touched.
            unsafe {
                columns[i].0 = _mm256_permute2f128_ps::<0x20>(first, last);
                columns[4 + i].0 = _mm256_permute2f128_ps::<0x31>(first, last);
            }
        }
        columns
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
    fn smallest(self) -> f32 {
        // SAFETY: AVX is there, by the privacy of this type; no memory is touched.
        unsafe {
            let four = _mm_min_ps(
                _mm256_castps256_ps128(self.0),
                _mm256_extractf128_ps::<1>(self.0),
            );
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)))
        }
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        // SAFETY: AVX is there, by the privacy of this type; no memory is touched.
        unsafe {
            let four = _mm_max_ps(
                _mm256_castps256_ps128(self.0),
                _mm256_extractf128_ps::<1>(self.0),
            );
            let two = _mm_max_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_max_ss(two, _mm_movehdup_ps(two)))
        }
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

    method! {
        splat(x: f32) -> Self = Self(_mm256_set1_ps(x));
        lt(self, other: Self) -> __m256 = _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0);
        le(self, other: Self) -> __m256 = _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0);
        same_bits(self, other: Self) -> __m256 = _mm256_castsi256_ps(_mm256_cmpeq_epi32(
            _mm256_castps_si256(self.0),
            _mm256_castps_si256(other.0),
        ));
        and(a: __m256, b: __m256) -> __m256 = _mm256_and_ps(a, b);
        and_not(not: __m256, b: __m256) -> __m256 = _mm256_andnot_ps(not, b);
        bits(mask: __m256) -> u32 = _mm256_movemask_ps(mask) as u32;
        select(mask: __m256, yes: Self, no: Self) -> Self = Self(_mm256_blendv_ps(no.0, yes.0, mask));
        splat_f64(x: f64) -> [__m256d; 2] = [_mm256_set1_pd(x); 2];
        widen(self) -> [__m256d; 2] = [
            _mm256_cvtps_pd(_mm256_castps256_ps128(self.0)),
            _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self.0)),
        ];
        narrow(x: [__m256d; 2]) -> Self =
            Self(_mm256_set_m128(_mm256_cvtpd_ps(x[1]), _mm256_cvtpd_ps(x[0])));
    }

    halves! {
        add_f64 = _mm256_add_pd;
        sub_f64 = _mm256_sub_pd;
        mul_f64 = _mm256_mul_pd;
        div_f64 = _mm256_div_pd;
    }

    #[inline(always)]
    fn mask(bits: u32) -> __m256 {
        // SAFETY: AVX2 is there, by the privacy of this type; no memory is touched.
        unsafe {
            let lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let of_lane = _mm256_and_si256(_mm256_set1_epi32(bits as i32), lanes);
            _mm256_castsi256_ps(_mm256_cmpeq_epi32(of_lane, lanes))
        }
    }
}
