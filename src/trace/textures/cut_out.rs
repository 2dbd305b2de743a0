//! Colours where a picture is cut out by its opacity.
//!
//! What a transparent texel holds as its colour is nothing that anyone has painted. So where texels are
//! mixed, between four neighbours, into a smaller level or between two levels, each counts by its alpha:
//! `Σ w α c / Σ w α`, which is what Porter and Duff's premultiplied colours (1984, "Compositing Digital
//! Images", section 3) give once they are divided by their alpha again. Where the alphas are all 0 the
//! plain mean is left.

use super::texture::Texture;
use super::wrap::Reading;
use crate::scene::TextureFilter;
use glam::{Vec2, Vec3};

/// A colour, and how much it counts.
#[derive(Clone, Copy)]
struct Weighted {
    color: Vec3,
    alpha: f32,
}

impl Texture {
    /// As [`Texture::sample`], but for a picture that is cut out: colours are weighted by alpha.
    pub fn sample_cut_out(
        &self,
        uv: Vec2,
        footprint: f32,
        reading: impl Into<Reading>,
        raw: bool,
    ) -> Vec3 {
        let reading = reading.into();
        // A single texel is what it is.
        if self.is_opaque() || reading.filter == TextureFilter::Nearest {
            return self.sample(uv, footprint, reading, raw);
        }
        let (finer, coarser) =
            self.levels_between(footprint, reading.filter, Texture::cut_out_levels);
        let near = finer.weighted(uv, reading, raw);
        let Some((level, fraction)) = coarser else {
            return near.color;
        };
        let far = level.weighted(uv, reading, raw);
        mean(
            [near, far],
            [1.0 - fraction, fraction],
            near.color.lerp(far.color, fraction),
        )
        .color
    }

    /// Between the four texels around a place.
    fn weighted(&self, uv: Vec2, reading: Reading, raw: bool) -> Weighted {
        let ([x0, x1], [y0, y1], fx, fy) = self.around(uv, reading.wrap);
        let texels = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| Weighted {
            color: self.texel(x, y, raw),
            alpha: self.alpha(x, y),
        });
        let [a, b, c, d] = texels.map(|texel| texel.color);
        let plain = a.lerp(b, fx).lerp(c.lerp(d, fx), fy);
        let (gx, gy) = (1.0 - fx, 1.0 - fy);
        mean(texels, [gx * gy, fx * gy, gx * fy, fx * fy], plain)
    }

    /// The same colours with what `map` says of each texel's opacity as their alpha, so that they are
    /// filtered by it. `None` where that is the alpha that they have.
    ///
    /// Where the two pictures differ in size, a texel takes the opacity of the place that it covers.
    pub(crate) fn cut_out_by(&self, map: &Texture) -> Option<Texture> {
        let (width, height) = (self.width(), self.height());
        let same_size = (map.width(), map.height()) == (width, height);
        let size = Vec2::new(width as f32, height as f32);
        let opacity = |x: u32, y: u32| {
            let opacity = if same_size {
                map.texel_opacity(x, y)
            } else {
                let uv = (Vec2::new(x as f32, y as f32) + 0.5) / size;
                map.opacity(uv, size.max_element().recip(), TextureFilter::Mipmap)
            };
            opacity.clamp(0.0, 1.0)
        };
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let texels = self.texels().with_alpha(places.map(|(x, y)| opacity(x, y)));
        let own = *self.texels() == texels || (self.is_opaque() && texels.are_opaque());
        (!own).then(|| Texture::level(width, height, texels))
    }
}

/// The mean of colours by their shares and alphas; `plain` where all of that is nothing.
fn mean<const N: usize>(of: [Weighted; N], shares: [f32; N], plain: Vec3) -> Weighted {
    let (mut color, mut alpha) = (Vec3::ZERO, 0.0);
    for (texel, share) in of.into_iter().zip(shares) {
        let weight = share * texel.alpha;
        color += weight * texel.color;
        alpha += weight;
    }
    // So small a weight cannot be divided by, and none of it is seen.
    let color = if alpha < f32::MIN_POSITIVE {
        plain
    } else {
        color / alpha
    };
    Weighted { color, alpha }
}

#[cfg(test)]
mod tests {
    use super::super::texels::Texels;
    use super::*;

    /// A white disc; what is transparent is black.
    fn leaf(size: u32) -> Vec<[u8; 4]> {
        let middle = (size as f32 - 1.0) / 2.0;
        let inside = |i: u32| {
            let (x, y) = (i % size, i / size);
            let offset = Vec2::new(x as f32, y as f32) - middle;
            offset.length() < 0.4 * size as f32
        };
        (0..size * size)
            .map(|i| if inside(i) { [255; 4] } else { [0; 4] })
            .collect()
    }

    fn filters() -> [(TextureFilter, f32); 5] {
        [
            (TextureFilter::Nearest, 0.0),
            (TextureFilter::Bilinear, 0.0),
            (TextureFilter::Mipmap, 0.0),
            (TextureFilter::Mipmap, 0.1),
            (TextureFilter::Mipmap, 0.45),
        ]
    }

    /// The farthest from white that a leaf over white becomes, over many places.
    fn worst(color: &Texture, opacity: &Texture, filter: TextureFilter, footprint: f32) -> f32 {
        let mut worst = 0.0_f32;
        for i in 0..10_000 {
            let uv = Vec2::new((i % 100) as f32 + 0.37, (i / 100) as f32 + 0.61) / 100.0;
            let d = opacity.opacity(uv, footprint, filter);
            let over = d * color.sample_cut_out(uv, footprint, filter, false) + (1.0 - d);
            worst = worst.max((over - Vec3::ONE).abs().max_element());
        }
        worst
    }

    #[test]
    fn a_white_leaf_over_white_is_white_whatever_the_filter_and_the_kind_of_texels() {
        let leaf = leaf(32);
        let wide: Vec<[u16; 4]> = leaf.iter().map(|t| t.map(|c| u16::from(c) * 257)).collect();
        let float: Vec<[f32; 4]> = leaf
            .iter()
            .map(|t| t.map(|c| f32::from(c) / 255.0))
            .collect();
        let kinds = [
            Texels::Srgb8(leaf.clone()),
            Texels::Linear8(leaf),
            Texels::Srgb16(wide.clone()),
            Texels::Linear16(wide),
            Texels::LinearAlpha32(float),
        ];
        for texels in kinds {
            let texture = Texture::new(32, 32, texels).unwrap();
            for (filter, footprint) in filters() {
                let worst = worst(&texture, &texture, filter, footprint);
                assert!(worst < 1e-6, "{filter:?}, {footprint}: {worst} off");
            }
        }
    }

    #[test]
    fn an_opacity_map_of_its_own_cuts_out_as_an_alpha_channel_does_whatever_its_size() {
        let opaque = leaf(32)
            .into_iter()
            .map(|[r, g, b, _]| [r, g, b, 255])
            .collect();
        let color = Texture::new(32, 32, Texels::Srgb8(opaque)).unwrap();
        let mask = |size| Texture::new(size, size, Texels::Linear8(leaf(size))).unwrap();
        let cut = color.cut_out_by(&mask(32)).unwrap();
        for (filter, footprint) in filters() {
            let worst = worst(&cut, &mask(32), filter, footprint);
            assert!(worst < 1e-6, "{filter:?}, {footprint}: {worst} off");
        }
        let from_larger = color.cut_out_by(&mask(128)).unwrap();
        let of = |texture: &Texture, x| texture.alpha(x, 16);
        assert_eq!([of(&from_larger, 16), of(&from_larger, 0)], [1.0, 0.0]);
        assert_eq!([of(&cut, 16), of(&cut, 0)], [1.0, 0.0]);
        assert!(cut.cut_out_by(&mask(32)).is_none(), "it has that alpha");
    }

    #[test]
    fn an_opaque_picture_and_one_whose_alpha_means_nothing_are_filtered_as_ever() {
        let texels: Vec<[u8; 4]> = (0..64_u32)
            .map(|i| [(i * 7 % 256) as u8, (i * 31 % 256) as u8, i as u8, 255])
            .collect();
        let alpha = texels.iter().map(|&[r, g, b, _]| [r, g, b, r]).collect();
        let opaque = Texture::new(8, 8, Texels::Srgb8(texels)).unwrap();
        let unused = Texture::new(8, 8, Texels::Srgb8(alpha)).unwrap();
        for (filter, footprint) in filters() {
            for i in 0..1000 {
                let uv = Vec2::new(i as f32 * 0.137, i as f32 * 0.071);
                let plain = opaque.sample(uv, footprint, filter, false);
                assert_eq!(plain, opaque.sample_cut_out(uv, footprint, filter, false));
                assert_eq!(plain, unused.sample(uv, footprint, filter, false));
            }
        }
    }

    #[test]
    fn where_all_is_transparent_the_plain_mean_is_left() {
        let texels = vec![[0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 1.0, 0.0]];
        let texture = Texture::new(2, 1, Texels::LinearAlpha32(texels)).unwrap();
        let at = |footprint, filter| {
            let uv = Vec2::new(0.5, 0.5);
            texture.sample_cut_out(uv, footprint, filter, false).x
        };
        assert_eq!(at(0.0, TextureFilter::Bilinear), 0.5);
        assert_eq!(at(4.0, TextureFilter::Mipmap), 0.5);
    }
}
