//! A texture's smaller versions (Williams 1983, "Pyramidal Parametrics").

use super::srgb;
use super::texels::{Texels, eight_bits, sixteen_bits};
use super::texture::Texture;
use glam::{Vec3, Vec4};

/// How much a texel's colour counts in the mean of several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Weight {
    /// By the area that it shares with the larger texel.
    Area,
    /// By that and its alpha, where any of them has one.
    AreaAndAlpha,
}

/// Halves a texture again and again, down to one texel: the first of them is level 1.
///
/// Texels are averaged by the area that they share, in linear light, so odd sizes stay in place and
/// the mean of the picture is kept; then kept in the format of the base level.
pub(super) fn pyramid(base: &Texture, weight: Weight) -> Vec<Texture> {
    let mut levels: Vec<Texture> = Vec::new();
    loop {
        let above = levels.last().unwrap_or(base);
        if above.width() == 1 && above.height() == 1 {
            return levels;
        }
        let level = half(above, weight);
        levels.push(level);
    }
}

fn half(above: &Texture, weight: Weight) -> Texture {
    let (width, height) = ((above.width() / 2).max(1), (above.height() / 2).max(1));
    let columns: Vec<_> = (0..width)
        .map(|x| shares(x, above.width(), width))
        .collect();
    let averages = (0..height).flat_map(|y| {
        let rows = shares(y, above.height(), height);
        let columns = &columns;
        (0..width as usize).map(move |x| {
            let mut sum = Vec4::ZERO;
            let mut premultiplied = Vec3::ZERO;
            for &(row, share) in rows.iter().filter(|(_, share)| *share > 0.0) {
                for &(column, part) in columns[x].iter().filter(|(_, part)| *part > 0.0) {
                    let color = above.texel(column, row, false);
                    let alpha = above.alpha(column, row);
                    sum += share * part * color.extend(alpha);
                    premultiplied += share * part * alpha * color;
                }
            }
            // So small an alpha cannot be divided by, and none of it is seen.
            if weight == Weight::AreaAndAlpha && sum.w >= f32::MIN_POSITIVE {
                (premultiplied / sum.w).extend(sum.w)
            } else {
                sum
            }
        })
    });
    let encoded = |t: Vec4| [t.x, t.y, t.z].map(srgb::encode);
    let texels = match above.texels() {
        Texels::Srgb8(_) => Texels::Srgb8(
            averages
                .map(|t| {
                    let [r, g, b] = encoded(t).map(eight_bits);
                    [r, g, b, eight_bits(t.w)]
                })
                .collect(),
        ),
        Texels::Linear8(_) => {
            Texels::Linear8(averages.map(|t| t.to_array().map(eight_bits)).collect())
        }
        Texels::Srgb16(_) => Texels::Srgb16(
            averages
                .map(|t| {
                    let [r, g, b] = encoded(t).map(sixteen_bits);
                    [r, g, b, sixteen_bits(t.w)]
                })
                .collect(),
        ),
        Texels::Linear16(_) => {
            Texels::Linear16(averages.map(|t| t.to_array().map(sixteen_bits)).collect())
        }
        Texels::Linear32(_) => Texels::Linear32(averages.map(|t| [t.x, t.y, t.z]).collect()),
        Texels::LinearAlpha32(_) => Texels::LinearAlpha32(averages.map(|t| t.to_array()).collect()),
    };
    Texture::level(width, height, texels)
}

/// Which of `from` texels in a row the texel `i` of `to` lies over, with their shares of it: two
/// of them, or three where the row is odd.
fn shares(i: u32, from: u32, to: u32) -> [(u32, f32); 3] {
    let scale = f64::from(from) / f64::from(to);
    let (start, end) = (f64::from(i) * scale, f64::from(i + 1) * scale);
    std::array::from_fn(|k| {
        let texel = start as u32 + k as u32;
        let low = start.max(f64::from(texel));
        let high = end.min(f64::from(texel + 1));
        let share = ((high - low) / scale).max(0.0);
        (texel.min(from - 1), share as f32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_keeps_the_mean_whatever_the_size() {
        for (width, height) in [(8, 8), (7, 5), (1, 9), (13, 1)] {
            let texels: Vec<_> = (0..width * height)
                .map(|i| [(i * 37 % 101) as f32, 1.0, (i % 3) as f32])
                .collect();
            let mean: f32 = texels.iter().map(|t| t[0]).sum::<f32>() / texels.len() as f32;
            let base = Texture::new(width, height, Texels::Linear32(texels)).unwrap();
            let levels = pyramid(&base, Weight::Area);
            let last = levels.last().unwrap();
            assert_eq!((last.width(), last.height()), (1, 1));
            for level in &levels {
                let (w, h) = (level.width(), level.height());
                let sum: f32 = (0..w * h).map(|i| level.texel(i % w, i / w, false).x).sum();
                let found = sum / (w * h) as f32;
                assert!(
                    (found / mean - 1.0).abs() < 1e-4,
                    "{w}x{h}: {found} for {mean}"
                );
            }
        }
    }

    #[test]
    fn a_black_and_white_checker_becomes_the_grey_that_gives_half_the_light() {
        let texels = (0..16)
            .map(|i| {
                if (i + i / 4) % 2 == 0 {
                    [255; 4]
                } else {
                    [0, 0, 0, 255]
                }
            })
            .collect();
        let base = Texture::new(4, 4, Texels::Srgb8(texels)).unwrap();
        let level = &pyramid(&base, Weight::Area)[0];
        assert_eq!(level.texel(0, 0, true).x, 188.0 / 255.0);
    }
}
