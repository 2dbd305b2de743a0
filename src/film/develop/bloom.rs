//! Bloom: what is brighter than a threshold glows into its surroundings.
//!
//! Everything here reads a finished linear picture and makes a new one: no ray is traced, and
//! nothing is written into what is being read. The rule at the border: [`blurred`].

use super::gaussian::blurred;
use crate::film::Picture;
use crate::scene::Bloom;
use glam::Vec3;
use rayon::prelude::*;

/// The pixels whose largest component exceeds the threshold, as they are; the rest is black.
///
/// A pixel that is not finite does not pass: it would fill the picture.
pub fn bloom_threshold(picture: &Picture, bloom: &Bloom) -> Picture {
    let passes = |p: Vec3| p.is_finite() && p.max_element() > bloom.threshold;
    Picture {
        pixels: picture
            .pixels
            .par_iter()
            .map(|&p| if passes(p) { p } else { Vec3::ZERO })
            .collect(),
        ..*picture
    }
}

/// What bloom adds to the picture: the pixels above the threshold, blurred, times the intensity.
/// Whether bloom is enabled is not asked.
pub fn bloom_layer(picture: &Picture, bloom: &Bloom) -> Picture {
    let mut layer = blurred(&bloom_threshold(picture, bloom), bloom.sigma);
    layer
        .pixels
        .par_iter_mut()
        .for_each(|p| *p *= bloom.intensity);
    layer
}

/// The picture and its bloom, linear; without bloom where that is not enabled.
pub fn with_bloom(picture: &Picture, bloom: &Bloom) -> Picture {
    if !bloom.enabled {
        return picture.clone();
    }
    let mut sum = bloom_layer(picture, bloom);
    sum.pixels
        .par_iter_mut()
        .zip(&picture.pixels)
        .for_each(|(sum, &p)| *sum += p);
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    const BLOOM: Bloom = Bloom {
        enabled: true,
        threshold: 0.8,
        intensity: 0.5,
        sigma: 3.0,
    };

    /// Dim grey with one bright pixel, far from the border.
    fn picture() -> Picture {
        let mut picture = Picture::black(UVec2::new(60, 50));
        picture.pixels.fill(Vec3::splat(0.25));
        picture.pixels[25 * 60 + 30] = Vec3::new(0.1, 8.0, 2.0);
        picture
    }

    #[test]
    fn one_component_above_the_threshold_is_enough_and_equal_is_not_above() {
        let mut picture = Picture::black(UVec2::new(4, 1));
        picture.pixels[0] = Vec3::new(0.0, 0.0, 0.9);
        picture.pixels[1] = Vec3::splat(0.8);
        picture.pixels[2] = Vec3::new(f32::INFINITY, 0.0, 0.0);
        picture.pixels[3] = Vec3::new(1.0, f32::NAN, 0.0);
        let passed = bloom_threshold(&picture, &BLOOM);
        let expected = [picture.pixels[0], Vec3::ZERO, Vec3::ZERO, Vec3::ZERO];
        assert_eq!(passed.pixels, expected);
    }

    #[test]
    fn away_from_borders_bloom_adds_exactly_the_energy_that_passes_times_the_intensity() {
        let picture = picture();
        let total = |p: &Picture| p.pixels.iter().map(|p| p.as_dvec3()).sum::<glam::DVec3>();
        let added = total(&with_bloom(&picture, &BLOOM)) - total(&picture);
        let expected = 0.5 * glam::DVec3::new(f64::from(0.1_f32), 8.0, 2.0);
        let off = (added / expected - 1.0).abs().max_element();
        assert!(off < 1e-5, "{added} for {expected}");
    }

    #[test]
    fn the_layer_is_what_bloom_adds_and_the_original_is_left_alone() {
        let picture = picture();
        let before = picture.clone();
        let (layer, sum) = (bloom_layer(&picture, &BLOOM), with_bloom(&picture, &BLOOM));
        assert_eq!(picture, before);
        for ((&sum, &layer), &p) in sum.pixels.iter().zip(&layer.pixels).zip(&picture.pixels) {
            assert_eq!(sum, p + layer);
        }
    }

    #[test]
    fn nothing_is_added_where_bloom_is_off_or_nothing_is_bright_enough() {
        let picture = picture();
        let off = Bloom {
            enabled: false,
            ..BLOOM
        };
        assert_eq!(with_bloom(&picture, &off), picture);
        let high = Bloom {
            threshold: 9.0,
            ..BLOOM
        };
        assert_eq!(with_bloom(&picture, &high), picture);
    }
}
