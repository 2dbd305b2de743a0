//! One source for all instruction sets: plain loops over columns, compiled for each of them and chosen when they are
//! called.
//!
//! The bits are the same everywhere: Rust never turns a product and a sum into one fused operation, and loops of this kind
//! have no other freedom.

/// Functions of plain loops, each compiled for AVX-512, for AVX2 and for any processor.
///
/// What they call has to be `#[inline(always)]`, and no closure: else it is compiled for any processor only.
macro_rules! vectorized {
    ($($function:item)*) => {
        $(
            #[multiversion::multiversion(targets(
                "x86_64+avx512f+avx512bw+avx512cd+avx512dq+avx512vl+avx2+bmi1+bmi2+fma+lzcnt+popcnt",
                "x86_64+avx2+bmi1+bmi2+fma+lzcnt+popcnt"
            ))]
            $function
        )*
    };
}

pub(crate) use vectorized;
