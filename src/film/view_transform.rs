use super::Picture;
use crate::scene::{Output, ViewTransform};
use glam::Vec3;
use rayon::prelude::*;

/// A linear picture as a screen shows it: times 2^exposure, then the view transform. In [0, 1].
pub fn view_transform(picture: &Picture, output: &Output) -> Vec<[f32; 3]> {
    let gain = output.exposure.exp2();
    picture
        .pixels
        .par_iter()
        .map(|&linear| {
            let clamped = (linear * gain).clamp(Vec3::ZERO, Vec3::ONE);
            match output.view_transform {
                ViewTransform::Raw => clamped.to_array(),
                ViewTransform::Srgb => clamped.to_array().map(srgb),
            }
        })
        .collect()
}

/// The sRGB curve (IEC 61966-2-1) for a linear value in [0, 1].
pub fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn exposure_is_in_stops_and_raw_only_clamps() {
        let mut picture = Picture::black(UVec2::new(2, 1));
        picture.pixels[0] = Vec3::new(0.1, 0.4, -1.0);
        let output = Output {
            exposure: 1.0,
            view_transform: ViewTransform::Raw,
        };
        assert_eq!(view_transform(&picture, &output)[0], [0.2, 0.8, 0.0]);
    }

    #[test]
    fn middle_grey_becomes_a_half_on_the_screen() {
        assert!((srgb(0.214_04) - 0.5).abs() < 1e-4, "{}", srgb(0.214_04));
        assert!(srgb(0.0) == 0.0 && (srgb(1.0) - 1.0).abs() < 1e-6);
    }
}
