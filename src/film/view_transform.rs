use super::Picture;
use crate::scene::{Output, ViewTransform};
use crate::trace::srgb;
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
                ViewTransform::Srgb => clamped.to_array().map(srgb::encode),
            }
        })
        .collect()
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
}
