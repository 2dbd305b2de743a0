use super::heatmap::{Beginning, Scale, auto_range};
use super::{Source, View, object_color};
use crate::film::{FirstHits, Picture, bloom_layer, bloom_threshold, develop, view_transform};
use crate::scene::{Bloom, Output};
use crate::trace::{FirstHit, srgb};
use glam::{UVec2, Vec3};
use rayon::prelude::*;

/// What views are made from. A view asks for one of these; the others may be missing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sources<'a> {
    /// Linear, scene-referred.
    pub picture: Option<&'a Picture>,
    /// What the camera meets first.
    pub first_hits: Option<&'a FirstHits>,
    /// Columns and rows, and the number of each pixel's samples, row by row from the top.
    pub samples: Option<(UVec2, &'a [u32])>,
    /// Columns and rows, and the estimated error of each pixel, row by row from the top; NaN where it
    /// is not known.
    pub errors: Option<(UVec2, &'a [f32])>,
}

/// A view as a screen shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Encoded for a screen, in [0, 1], row by row from the top.
    pub pixels: Vec<[f32; 3]>,
    /// What a heatmap's colours mean; `None` for the other views.
    pub scale: Option<Scale>,
    /// Some of a heatmap's values are not known and drawn in [`UNKNOWN`](super::UNKNOWN).
    pub has_unknown: bool,
}

/// Why a view cannot be shown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ViewError {
    /// What the view reads was not given.
    #[error("the view `{view}` is made from {made_from}, which was not traced or kept")]
    Missing {
        /// The view.
        view: View,
        /// What is missing.
        made_from: Source,
    },
    /// There is not one value for each pixel.
    #[error("the view `{view}` of {width}x{height} pixels has {found} values")]
    WrongLength {
        /// The view.
        view: View,
        /// Pixels a row.
        width: u32,
        /// Rows.
        height: u32,
        /// How many values there are.
        found: usize,
    },
    /// Not a range.
    #[error("{low}..{high} is no range: give two finite numbers, the smaller one first")]
    BadRange {
        /// The first number.
        low: f32,
        /// The second number.
        high: f32,
    },
}

/// Shows one view. `output` is for those made from the picture. `range` is for heatmaps: the values
/// at the palette's ends; `None` takes it from the values, the 1st (for counts and errors: zero) to
/// the 99th percentile.
///
/// No ray is traced.
pub fn show(
    view: View,
    sources: &Sources,
    output: &Output,
    range: Option<[f32; 2]>,
) -> Result<Shown, ViewError> {
    if let Some([low, high]) = range
        && !(low < high && low.is_finite() && high.is_finite())
    {
        return Err(ViewError::BadRange { low, high });
    }
    let missing = || ViewError::Missing {
        view,
        made_from: view.source(),
    };
    let heatmap = |size: UVec2, values: &[f32]| {
        let scale = scale(view, values, range);
        let pixels = values.par_iter().map(|&value| scale.color(value)).collect();
        let shown = shown(view, size, pixels, Some(scale))?;
        Ok(Shown {
            has_unknown: values.iter().any(|value| value.is_nan()),
            ..shown
        })
    };
    match view.source() {
        Source::Picture => {
            let picture = sources.picture.ok_or_else(missing)?;
            shown(
                view,
                UVec2::new(picture.width, picture.height),
                of_picture(view, picture, output),
                None,
            )
        }
        Source::FirstHits => {
            let hits = sources.first_hits.ok_or_else(missing)?;
            match of_first_hits(view, hits) {
                Layer::Colors(colors) => shown(view, hits.size(), colors, None),
                Layer::Values(values) => heatmap(hits.size(), &values),
            }
        }
        Source::Samples => {
            let (size, counts) = sources.samples.ok_or_else(missing)?;
            heatmap(size, &counts.iter().map(|&n| n as f32).collect::<Vec<_>>())
        }
        Source::Errors => {
            let (size, errors) = sources.errors.ok_or_else(missing)?;
            heatmap(size, errors)
        }
    }
}

fn shown(
    view: View,
    size: UVec2,
    pixels: Vec<[f32; 3]>,
    scale: Option<Scale>,
) -> Result<Shown, ViewError> {
    if pixels.len() as u64 != u64::from(size.x) * u64::from(size.y) {
        return Err(ViewError::WrongLength {
            view,
            width: size.x,
            height: size.y,
            found: pixels.len(),
        });
    }
    Ok(Shown {
        width: size.x,
        height: size.y,
        pixels,
        scale,
        has_unknown: false,
    })
}

/// The views of the picture itself.
fn of_picture(view: View, picture: &Picture, output: &Output) -> Vec<[f32; 3]> {
    let bloom: &Bloom = &output.bloom;
    match view {
        View::BloomThreshold => view_transform(&bloom_threshold(picture, bloom), output),
        View::BloomLayer => view_transform(&bloom_layer(picture, bloom), output),
        _ => develop(picture, output),
    }
}

enum Layer {
    Colors(Vec<[f32; 3]>),
    Values(Vec<f32>),
}

/// The views of what the camera meets first.
fn of_first_hits(view: View, hits: &FirstHits) -> Layer {
    let values =
        |value: fn(&FirstHit) -> f32| Layer::Values(hits.centers.iter().map(value).collect());
    match view {
        View::Depth => values(|hit| hit.depth),
        View::Nodes => values(|hit| hit.cost.nodes as f32),
        View::Triangles => values(|hit| hit.cost.triangles as f32),
        View::Object => {
            let color = |hit: &FirstHit| hit.object.map_or([0.0; 3], object_color);
            Layer::Colors(hits.centers.iter().map(color).collect())
        }
        View::Normal => {
            // What meets nothing is black, not the grey of a normal of length 0.
            let color = |(&n, &part): (&Vec3, &f32)| (0.5 * n + 0.5 * Vec3::splat(part)).to_array();
            Layer::Colors(hits.normals.iter().zip(&hits.coverage).map(color).collect())
        }
        _ => {
            let encode = |x: f32| srgb::encode(x.clamp(0.0, 1.0));
            let color = |kd: &Vec3| kd.to_array().map(encode);
            Layer::Colors(hits.albedo.par_iter().map(color).collect())
        }
    }
}

/// What a heatmap's values are called, where its range begins, and whether low is bright.
fn kind(view: View) -> (&'static str, Beginning, bool) {
    match view {
        View::Depth => ("m", Beginning::Lowest, true),
        View::Nodes => ("nodes", Beginning::Zero, false),
        View::Triangles => ("triangles", Beginning::Zero, false),
        View::Samples => ("samples", Beginning::Zero, false),
        _ => ("relative error", Beginning::Zero, false),
    }
}

fn scale(view: View, values: &[f32], range: Option<[f32; 2]>) -> Scale {
    let (unit, beginning, low_is_bright) = kind(view);
    let [low, high] = range.unwrap_or_else(|| auto_range(values, beginning));
    Scale {
        low,
        high,
        unit,
        low_is_bright,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::views::{UNKNOWN, viridis};
    use crate::scene::ViewTransform;

    const SIZE: UVec2 = UVec2::new(2, 1);

    fn picture() -> Picture {
        let mut picture = Picture::black(SIZE);
        picture.pixels[0] = Vec3::new(2.0, 0.5, 0.0);
        picture.pixels[1] = Vec3::splat(0.25);
        picture
    }

    fn output() -> Output {
        Output {
            bloom: Bloom {
                enabled: true,
                threshold: 0.8,
                intensity: 0.5,
                sigma: 0.0,
            },
            exposure: -2.0,
            view_transform: ViewTransform::Raw,
        }
    }

    #[test]
    fn the_picture_the_part_above_the_threshold_and_the_layer_go_through_the_same_exposure() {
        let picture = picture();
        let sources = Sources {
            picture: Some(&picture),
            ..Sources::default()
        };
        let pixels = |view| show(view, &sources, &output(), None).unwrap().pixels;
        assert_eq!(pixels(View::BloomThreshold), [[0.5, 0.125, 0.0], [0.0; 3]]);
        assert_eq!(pixels(View::BloomLayer), [[0.25, 0.0625, 0.0], [0.0; 3]]);
        assert_eq!(pixels(View::Shaded), [[0.75, 0.1875, 0.0], [0.0625; 3]]);
    }

    #[test]
    fn samples_and_errors_become_heatmaps_from_zero_or_over_the_range_asked_for() {
        let sources = Sources {
            samples: Some((SIZE, &[8, 16])),
            errors: Some((SIZE, &[0.5, f32::NAN])),
            ..Sources::default()
        };
        let show = |view, range| show(view, &sources, &output(), range).unwrap();
        let samples = show(View::Samples, None);
        assert_eq!(samples.pixels, [viridis(0.5), viridis(1.0)]);
        assert_eq!(samples.scale.map(|s| (s.low, s.high)), Some((0.0, 16.0)));
        let errors = show(View::Error, Some([0.0, 2.0]));
        assert_eq!(errors.pixels, [viridis(0.25), UNKNOWN]);
        assert_eq!((samples.has_unknown, errors.has_unknown), (false, true));
    }

    #[test]
    fn what_is_missing_or_does_not_fit_is_said() {
        let sources = Sources {
            samples: Some((UVec2::new(3, 3), &[8, 16])),
            ..Sources::default()
        };
        for (view, range, said) in [
            (View::Depth, None, "first hits"),
            (View::Shaded, None, "the picture"),
            (View::Error, None, "the error of each pixel"),
            (View::Samples, None, "3x3"),
            (View::Samples, Some([2.0, 1.0]), "2..1"),
            (View::Samples, Some([0.0, f32::NAN]), "NaN"),
            (View::Shaded, Some([0.0, f32::INFINITY]), "inf"),
        ] {
            let error = show(view, &sources, &output(), range)
                .unwrap_err()
                .to_string();
            assert!(error.contains(said), "{view}: {error}");
        }
    }
}
