//! A separable Gaussian blur of a linear picture.
//!
//! The kernel is the normal distribution at whole pixels, cut off at four sigma and made to sum
//! to 1. Outside the picture it is dark: what is blurred over the border is lost, and the kernel
//! is not renormalised there. So blurring is linear, and a pixel spreads the same light wherever
//! it stands; of a pixel at the border half stays in the picture, at a corner a quarter.

use crate::film::Picture;
use glam::Vec3;
use rayon::prelude::*;

/// Larger standard deviations are taken as this one, in pixels.
pub const MAX_SIGMA: f32 = 1000.0;

/// The kernel's reach in standard deviations: 6e-5 of a Gaussian lie beyond.
const REACH: f32 = 4.0;

/// Numbers worked on at once: 32 sums stay in half of the baseline's sixteen vector registers.
const STRIP: usize = 32;

/// Rows that a task of the vertical pass makes: its strips then fit into the first-level cache.
const ROWS: usize = 32;

/// The weights at distances 0, 1, 2 … pixels; w₀ + 2 Σ wᵢ = 1. A sigma that is negative or not a
/// number is 0, which leaves only w₀.
pub fn kernel(sigma: f32) -> Vec<f32> {
    if sigma.is_nan() || sigma <= 0.0 {
        return vec![1.0];
    }
    let sigma = f64::from(sigma.min(MAX_SIGMA));
    let reach = (f64::from(REACH) * sigma).ceil() as i32;
    let weights: Vec<f64> = (0..=reach)
        .map(|i| (-0.5 * (f64::from(i) / sigma).powi(2)).exp())
        .collect();
    let sum = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    weights.iter().map(|w| (w / sum) as f32).collect()
}

/// The picture through a Gaussian of `sigma` pixels. Black rows and columns cost little.
pub fn blurred(picture: &Picture, sigma: f32) -> Picture {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let weights = kernel(sigma);
    if weights.len() == 1 || picture.pixels.is_empty() {
        return picture.clone();
    }
    let lit: Vec<bool> = picture
        .pixels
        .par_chunks(width)
        .map(|row| row.iter().any(|&p| p != Vec3::ZERO))
        .collect();
    let stride = stride(width);
    let mut across = vec![0.0_f32; stride * height];
    across
        .par_chunks_mut(stride)
        .zip(picture.pixels.par_chunks(width))
        .zip(&lit)
        .filter(|(_, lit)| **lit)
        .for_each_init(Vec::new, |padded, ((out, row), _)| {
            blur_row(row, &weights, padded, out);
        });
    let mut pixels = vec![Vec3::ZERO; picture.pixels.len()];
    pixels
        .par_chunks_mut(width * ROWS)
        .enumerate()
        .for_each(|(block, out)| {
            blur_columns(&across, stride, &lit, &weights, block * ROWS, width, out);
        });
    Picture { pixels, ..*picture }
}

/// Floats from a row to the next: whole strips, and an odd number of them, so that the rows of a
/// column do not all fall into the same set of the cache.
fn stride(width: usize) -> usize {
    ((3 * width).div_ceil(STRIP) | 1) * STRIP
}

/// One row along x. The channels stay interleaved: a pixel's neighbours are three floats away.
fn blur_row(row: &[Vec3], weights: &[f32], padded: &mut Vec<f32>, out: &mut [f32]) {
    let reach = (weights.len() - 1).min(row.len());
    let margin = 3 * reach;
    padded.clear();
    padded.resize(out.len() + 2 * margin, 0.0);
    for (to, from) in padded[margin..].chunks_exact_mut(3).zip(row) {
        to.copy_from_slice(&from.to_array());
    }
    for (i, out) in out.chunks_exact_mut(STRIP).enumerate() {
        let at = margin + i * STRIP;
        let mut sums = [0.0; STRIP];
        add(&mut sums, weights[0], &padded[at..]);
        for (distance, &weight) in weights[..=reach].iter().enumerate().skip(1) {
            add(&mut sums, weight, &padded[at - 3 * distance..]);
            add(&mut sums, weight, &padded[at + 3 * distance..]);
        }
        out.copy_from_slice(&sums);
    }
    // What ran into the padding behind the row is not part of it.
    out[3 * row.len()..].fill(0.0);
}

/// The rows from `first` on that `out` has room for, along y.
fn blur_columns(
    across: &[f32],
    stride: usize,
    lit: &[bool],
    weights: &[f32],
    first: usize,
    width: usize,
    out: &mut [Vec3],
) {
    let reach = weights.len() - 1;
    let rows = out.len() / width;
    let from = first.saturating_sub(reach);
    let to = (first + rows + reach).min(lit.len());
    let lit: Vec<usize> = (from..to).filter(|&y| lit[y]).collect();
    if lit.is_empty() {
        return;
    }
    // Strip by strip for all rows of the block, so that a strip of the source is read from memory once.
    let mut sums = vec![0.0; stride * rows];
    for x in (0..stride).step_by(STRIP) {
        for row in 0..rows {
            let mut strip = [0.0; STRIP];
            for &y in &lit {
                if let Some(&weight) = weights.get(y.abs_diff(first + row)) {
                    add(&mut strip, weight, &across[y * stride + x..]);
                }
            }
            sums[row * stride + x..][..STRIP].copy_from_slice(&strip);
        }
    }
    for (out, sums) in out.chunks_exact_mut(width).zip(sums.chunks_exact(stride)) {
        for (pixel, rgb) in out.iter_mut().zip(sums.as_chunks::<3>().0) {
            *pixel = Vec3::from_array(*rgb);
        }
    }
}

#[inline(always)]
fn add(sums: &mut [f32; STRIP], weight: f32, values: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(&values[..STRIP]) {
        *sum += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;
    use proptest::prelude::*;

    fn dot(size: UVec2, at: UVec2) -> Picture {
        let mut picture = Picture::black(size);
        picture.pixels[(at.y * size.x + at.x) as usize] = Vec3::new(1.0, 2.0, 4.0);
        picture
    }

    fn energy(picture: &Picture) -> glam::DVec3 {
        picture.pixels.iter().map(|p| p.as_dvec3()).sum()
    }

    /// The Gaussian as a double sum over all pairs of pixels, in 64 bits.
    fn by_definition(picture: &Picture, sigma: f64) -> Vec<glam::DVec3> {
        let reach = (4.0 * sigma).ceil() as i64;
        let weight = |d: i64| (-0.5 * (d as f64 / sigma).powi(2)).exp();
        let sum: f64 = (-reach..=reach).map(weight).sum();
        let (width, height) = (i64::from(picture.width), i64::from(picture.height));
        let at = |i: i64| (i % width, i / width);
        (0..width * height)
            .map(at)
            .map(|(x, y)| {
                let spread = |(i, p): (usize, &Vec3)| {
                    let (u, v) = at(i as i64);
                    let near = (u - x).abs() <= reach && (v - y).abs() <= reach;
                    let weight = if near {
                        weight(u - x) * weight(v - y)
                    } else {
                        0.0
                    };
                    p.as_dvec3() * (weight / (sum * sum))
                };
                picture.pixels.iter().enumerate().map(spread).sum()
            })
            .collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn every_pixel_is_the_gaussian_mean_of_all_pixels(
            width in 1..50_u32,
            height in 1..50_u32,
            sigma in 0.1..9.0_f32,
            lit in prop::collection::vec((any::<prop::sample::Index>(), 0.0..100.0_f32), 1..20),
        ) {
            let mut picture = Picture::black(UVec2::new(width, height));
            for (at, value) in lit {
                let i = at.index(picture.pixels.len());
                picture.pixels[i] = Vec3::new(value, 1.0, -value);
            }
            let expected = by_definition(&picture, f64::from(sigma));
            for (found, expected) in blurred(&picture, sigma).pixels.iter().zip(expected) {
                let off = (found.as_dvec3() - expected).abs().max_element();
                prop_assert!(off < 1e-4, "{found} for {expected}");
            }
        }
    }

    #[test]
    fn away_from_the_border_no_light_is_lost_or_made() {
        for sigma in [0.2, 1.0, 3.7, 10.0] {
            let picture = dot(UVec2::new(101, 97), UVec2::new(50, 48));
            let blurred = blurred(&picture, sigma);
            let off = (energy(&blurred) / energy(&picture) - 1.0)
                .abs()
                .max_element();
            assert!(off < 1e-6, "sigma {sigma}: energy off by {off}");
        }
    }

    #[test]
    fn at_the_border_what_falls_outside_is_lost_and_the_rest_is_as_elsewhere() {
        let size = UVec2::new(101, 97);
        let whole = blurred(&dot(size, UVec2::new(50, 48)), 5.0);
        let corner = blurred(&dot(size, UVec2::ZERO), 5.0);
        for (x, y) in [(0, 0), (3, 0), (0, 7), (11, 9)] {
            assert_eq!(corner.pixel(x, y), whole.pixel(50 + x, 48 + y), "{x}, {y}");
        }
        // Half of the kernel and half of its middle weight stay, in either direction.
        let kept = (1.0 + f64::from(kernel(5.0)[0])) / 2.0;
        let off = (energy(&corner).x - kept * kept).abs();
        assert!(off < 1e-6, "{} for {}", energy(&corner).x, kept * kept);
    }

    #[test]
    fn a_constant_picture_stays_constant_where_the_kernel_does_not_reach_the_border() {
        let mut picture = Picture::black(UVec2::new(64, 70));
        picture.pixels.fill(Vec3::new(3.0, 0.5, 7.0));
        let blurred = blurred(&picture, 4.0);
        for (x, y) in [(16, 16), (47, 16), (30, 53), (32, 35)] {
            let ratio = blurred.pixel(x, y) / picture.pixel(x, y);
            assert!((ratio - 1.0).abs().max_element() < 1e-6, "{ratio}");
        }
    }

    #[test]
    fn a_dots_glow_is_symmetric_and_has_the_kernels_variance() {
        let glow = blurred(&dot(UVec2::new(81, 81), UVec2::new(40, 40)), 6.0);
        let mut moment = 0.0;
        for y in 0..81 {
            for x in 0..81 {
                let here = glow.pixel(x, y);
                for there in [
                    glow.pixel(80 - x, y),
                    glow.pixel(x, 80 - y),
                    glow.pixel(y, x),
                ] {
                    assert!(
                        (here - there).abs().max_element() < 1e-9,
                        "{x}, {y}: {here} {there}"
                    );
                }
                moment += f64::from(here.x) * (f64::from(x) - 40.0).powi(2);
            }
        }
        // The cut at four sigma takes 0.1 % of the variance.
        assert!(
            (moment / 36.0 - 1.0).abs() < 2e-3,
            "variance {moment} for 36"
        );
    }

    #[test]
    fn a_sigma_of_nothing_leaves_the_picture_and_a_huge_one_is_bounded() {
        let picture = dot(UVec2::new(5, 4), UVec2::new(1, 2));
        for sigma in [0.0, -3.0, f32::NAN] {
            assert_eq!(blurred(&picture, sigma), picture, "sigma {sigma}");
        }
        assert_eq!(kernel(f32::INFINITY), kernel(MAX_SIGMA));
        assert!(energy(&blurred(&picture, f32::INFINITY)).x > 0.0);
        let none = Picture::black(UVec2::ZERO);
        assert_eq!(blurred(&none, 3.0), none);
    }
}
