use super::agx::agx;
use super::bloom::with_bloom;
use crate::film::Picture;
use crate::scene::{Output, ViewTransform};
use crate::trace::srgb;
use glam::Vec3;
use rayon::prelude::*;

/// A linear picture as a screen shows it: bloom, exposure and view transform, in this order. In
/// [0, 1], encoded as `output.view_transform` says. No ray is traced.
pub fn develop(picture: &Picture, output: &Output) -> Vec<[f32; 3]> {
    if output.bloom.enabled {
        view_transform(&with_bloom(picture, &output.bloom), output)
    } else {
        view_transform(picture, output)
    }
}

/// The last two steps of [`develop`]: times 2^exposure, then the view transform.
pub fn view_transform(picture: &Picture, output: &Output) -> Vec<[f32; 3]> {
    let gain = output.exposure.exp2();
    picture
        .pixels
        .par_iter()
        .map(|&linear| {
            let exposed = linear * gain;
            match output.view_transform {
                ViewTransform::Raw => clamped(exposed),
                ViewTransform::Srgb => clamped(exposed).map(srgb::encode),
                ViewTransform::AgX => agx(exposed).to_array(),
            }
        })
        .collect()
}

/// NaN becomes 0.
fn clamped(color: Vec3) -> [f32; 3] {
    color
        .to_array()
        .map(|x| if x > 0.0 { x.min(1.0) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Bloom;
    use glam::UVec2;

    #[test]
    fn exposure_is_in_stops_and_raw_only_clamps() {
        let mut picture = Picture::black(UVec2::new(2, 1));
        picture.pixels[0] = Vec3::new(0.1, 0.4, -1.0);
        picture.pixels[1] = Vec3::new(f32::NAN, f32::INFINITY, 0.0);
        let output = Output {
            exposure: 1.0,
            view_transform: ViewTransform::Raw,
            ..Output::default()
        };
        let shown = view_transform(&picture, &output);
        assert_eq!(shown, [[0.2, 0.8, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn bloom_comes_before_the_exposure() {
        let mut picture = Picture::black(UVec2::new(1, 1));
        picture.pixels[0] = Vec3::splat(0.5);
        let bloom = Bloom {
            enabled: true,
            threshold: 0.4,
            intensity: 0.5,
            sigma: 0.0,
        };
        let output = |bloom| Output {
            bloom,
            exposure: -1.0,
            view_transform: ViewTransform::Raw,
        };
        // (0.5 + 0.5 · 0.5) / 2: half of 0.5 would be below the threshold.
        assert_eq!(develop(&picture, &output(bloom)), [[0.375; 3]]);
        let off = Bloom {
            enabled: false,
            ..bloom
        };
        assert_eq!(develop(&picture, &output(off)), [[0.25; 3]]);
    }
}
