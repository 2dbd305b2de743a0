//! What there is of a texture beyond its edges, and between its texels.

use crate::scene::{MapFilter, TextureFilter, Wrap};
use glam::Vec2;

/// How a texture is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Between texels.
    pub filter: TextureFilter,
    /// Beyond its edges, across and down.
    pub wrap: [Wrap; 2],
}

impl From<TextureFilter> for Reading {
    /// It repeats.
    fn from(filter: TextureFilter) -> Self {
        Self {
            filter,
            wrap: [Wrap::Repeat; 2],
        }
    }
}

impl MapFilter {
    /// What becomes of the render's setting.
    pub fn with(self, setting: TextureFilter) -> TextureFilter {
        match (self, setting) {
            (Self::Nearest, _) => TextureFilter::Nearest,
            (Self::Linear, TextureFilter::Nearest) => TextureFilter::Bilinear,
            (Self::Setting | Self::Linear, setting) => setting,
        }
    }
}

/// The place inside the picture, each coordinate in [0, 1], that stands for this one. A coordinate that is
/// not finite (a broken mesh) reads the first texel.
pub(in crate::trace) fn inside(uv: Vec2, wrap: [Wrap; 2]) -> Vec2 {
    let uv = if uv.is_finite() { uv } else { Vec2::ZERO };
    if wrap == [Wrap::Repeat; 2] {
        return uv - Vec2::new(floor(uv.x), floor(uv.y));
    }
    let along = |x: f32, wrap| match wrap {
        Wrap::Repeat => x - floor(x),
        Wrap::Clamp => x.clamp(0.0, 1.0),
        // Of every two, the second is reversed.
        Wrap::Mirror => 1.0 - (x.rem_euclid(2.0) - 1.0).abs(),
    };
    Vec2::new(along(uv.x, wrap[0]), along(uv.y, wrap[1]))
}

/// [`f32::floor`], which is a call where nothing is known of the processor. (That of -0.0 is 0.0.)
#[inline(always)]
pub(in crate::trace) fn floor(x: f32) -> f32 {
    /// From here on all are whole.
    const WHOLE: f32 = (1 << 23) as f32;
    if x.abs() < WHOLE {
        let whole = x as i32 as f32;
        if whole > x { whole - 1.0 } else { whole }
    } else {
        x
    }
}

/// The texel of `n` in a row that stands for this one, which lies one beyond them at most.
pub(in crate::trace) fn texel(i: i64, n: u32, wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat if i < 0 => n - 1,
        Wrap::Repeat if i >= i64::from(n) => 0,
        Wrap::Repeat => i as u32,
        // A mirrored picture begins with the texel that it ended with.
        Wrap::Clamp | Wrap::Mirror => i.clamp(0, i64::from(n) - 1) as u32,
    }
}

#[cfg(test)]
mod tests {
    use super::super::texels::Texels;
    use super::super::texture::Texture;
    use super::*;

    #[test]
    fn beyond_its_edge_a_texture_repeats_ends_or_turns_back() {
        let texels = vec![[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]];
        let row = Texture::new(4, 1, Texels::Linear32(texels)).unwrap();
        let found = |wrap, filter, from: f32| -> Vec<f32> {
            let reading = Reading {
                filter,
                wrap: [wrap, Wrap::Repeat],
            };
            let at = |i: u8| Vec2::new(from + f32::from(i) / 4.0, 0.5);
            (0..12)
                .map(|i| row.sample(at(i), 0.0, reading, false).x)
                .collect()
        };
        // Texels' middles, from one picture before the first to one behind it.
        let middles = -1.0 + 0.125;
        for filter in [TextureFilter::Nearest, TextureFilter::Bilinear] {
            assert_eq!(
                found(Wrap::Repeat, filter, middles),
                [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0]
            );
            assert_eq!(
                found(Wrap::Clamp, filter, middles),
                [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0]
            );
            assert_eq!(
                found(Wrap::Mirror, filter, middles),
                [3.0, 2.0, 1.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 2.0, 1.0, 0.0]
            );
        }
        // Texels' edges, where the two neighbours are mixed.
        let edges = found(Wrap::Repeat, TextureFilter::Bilinear, 0.0);
        assert_eq!(edges[..5], [1.5, 0.5, 1.5, 2.5, 1.5]);
        let edges = found(Wrap::Clamp, TextureFilter::Bilinear, 0.0);
        assert_eq!(edges[..5], [0.0, 0.5, 1.5, 2.5, 3.0]);
        let edges = found(Wrap::Mirror, TextureFilter::Bilinear, 0.0);
        assert_eq!(edges[..6], [0.0, 0.5, 1.5, 2.5, 3.0, 2.5]);
    }

    #[test]
    fn a_map_can_ask_for_hard_pixels_and_for_none() {
        use TextureFilter::{Bilinear, Mipmap, Nearest};
        for (filter, expected) in [
            (MapFilter::Setting, [Nearest, Bilinear, Mipmap]),
            (MapFilter::Nearest, [Nearest, Nearest, Nearest]),
            (MapFilter::Linear, [Bilinear, Bilinear, Mipmap]),
        ] {
            let found = [Nearest, Bilinear, Mipmap].map(|setting| filter.with(setting));
            assert_eq!(found, expected, "{filter:?}");
        }
    }

    #[test]
    fn the_whole_part_is_that_of_the_standard_library() {
        let bits = (0..=u32::MAX).step_by(4099);
        let near_whole = (-70..70).flat_map(|i| [-1_i32, 0, 1].map(|by| (i as f32 / 2.0, by)));
        let near_whole = near_whole.map(|(x, by)| x.to_bits().wrapping_add_signed(by));
        for x in bits.chain(near_whole).map(f32::from_bits) {
            let (found, expected) = (floor(x), x.floor());
            assert!(found == expected || x.is_nan() && found.is_nan(), "{x:e}");
        }
    }

    #[test]
    fn a_repeated_row_has_one_texel_more_at_each_end() {
        for n in [1, 2, 7, u32::MAX] {
            for i in [-1, 0, 1, i64::from(n) - 1, i64::from(n)] {
                let expected = i.rem_euclid(i64::from(n)) as u32;
                assert_eq!(texel(i, n, Wrap::Repeat), expected, "{i} of {n}");
            }
        }
    }

    #[test]
    fn a_place_that_is_no_number_reads_the_first_texel_and_a_far_one_is_inside() {
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            for x in [f32::NAN, f32::INFINITY, -1e30, 1e30, -1e-30, 0.999_999_94] {
                let uv = inside(Vec2::splat(x), [wrap; 2]);
                let range = Vec2::ZERO.cmple(uv).all() && uv.cmple(Vec2::ONE).all();
                assert!(range, "{wrap:?} {x}: {uv}");
            }
        }
    }
}
