//! Eight numbers in one AVX register.
//!
//! The type is private to this file: only [`answer`] names it, and that is only called where [`is_available`] said yes.
//! So wherever its operations run, the machine has them.

use std::arch::x86_64::{
    __m256, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps, _mm256_cmp_ps,
    _mm256_loadu_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps,
    _mm256_set1_ps, _mm256_storeu_ps, _mm256_sub_ps,
};

use super::{Eight, Query};

/// Eight numbers in a register.
#[derive(Clone, Copy)]
struct Avx2(__m256);

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

impl Eight for Avx2 {
    type Mask = __m256;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: AVX is there, by the privacy of this type (see the module).
        Self(unsafe { _mm256_set1_ps(x) })
    }

    #[inline(always)]
    fn load(from: &[f32; 8]) -> Self {
        // SAFETY: AVX is there, by the privacy of this type; the reference is good for 32 bytes, at any alignment.
        Self(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        let mut array = [0.0; 8];
        // SAFETY: AVX is there, by the privacy of this type; the array is good for 32 bytes, at any alignment.
        unsafe { _mm256_storeu_ps(array.as_mut_ptr(), self.0) };
        array
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: AVX is there, by the privacy of this type.
        Self(unsafe { _mm256_add_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: AVX is there, by the privacy of this type.
        Self(unsafe { _mm256_sub_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: AVX is there, by the privacy of this type.
        Self(unsafe { _mm256_mul_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: AVX is there, by the privacy of this type.
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: AVX is there, by the privacy of this type.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: AVX is there, by the privacy of this type.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> __m256 {
        // SAFETY: AVX is there, by the privacy of this type.
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) }
    }

    #[inline(always)]
    fn le(self, other: Self) -> __m256 {
        // SAFETY: AVX is there, by the privacy of this type.
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) }
    }

    #[inline(always)]
    fn and(a: __m256, b: __m256) -> __m256 {
        // SAFETY: AVX is there, by the privacy of this type.
        unsafe { _mm256_and_ps(a, b) }
    }

    #[inline(always)]
    fn and_not(not: __m256, b: __m256) -> __m256 {
        // SAFETY: AVX is there, by the privacy of this type.
        unsafe { _mm256_andnot_ps(not, b) }
    }

    #[inline(always)]
    fn bits(mask: __m256) -> u32 {
        // SAFETY: AVX is there, by the privacy of this type.
        unsafe { _mm256_movemask_ps(mask) as u32 }
    }
}
