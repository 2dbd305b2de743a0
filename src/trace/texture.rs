use super::{mipmap, srgb};
use crate::scene::TextureFilter;
use glam::{Vec2, Vec3, Vec4};
use std::sync::OnceLock;

/// A picture that rays read. Row 0 is the top one; (0, 0) is the top left corner, v grows downwards.
#[derive(Clone, Debug)]
pub struct Texture {
    width: u32,
    height: u32,
    texels: Texels,
    /// Made when first asked for: a scene without mipmaps has none.
    levels: OnceLock<Vec<Texture>>,
    /// Looked for when first asked for.
    brightest: OnceLock<Vec3>,
}

/// How the texels are kept: as the file had them, so that a large map stays small.
#[derive(Clone, Debug)]
pub enum Texels {
    /// 8 bits a channel, sRGB-encoded, RGBA.
    Srgb8(Vec<[u8; 4]>),
    /// 8 bits a channel, linear, RGBA.
    Linear8(Vec<[u8; 4]>),
    /// Linear floating point.
    Linear32(Vec<[f32; 3]>),
}

/// Why texels are no picture.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum TextureError {
    /// A picture needs at least one pixel.
    #[error("a picture of {width}x{height} has no pixels")]
    Empty {
        /// Pixels a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The array is not as long as the size says.
    #[error("{width}x{height} pixels need {expected} texels, there are {found}")]
    WrongLength {
        /// Pixels a row.
        width: u32,
        /// Rows.
        height: u32,
        /// width · height.
        expected: u64,
        /// What there is.
        found: u64,
    },
}

impl Texture {
    /// A texture of `width` × `height` texels, row by row from the top.
    pub fn new(width: u32, height: u32, texels: Texels) -> Result<Self, TextureError> {
        if width == 0 || height == 0 {
            return Err(TextureError::Empty { width, height });
        }
        let found = match &texels {
            Texels::Srgb8(t) | Texels::Linear8(t) => t.len(),
            Texels::Linear32(t) => t.len(),
        } as u64;
        let expected = u64::from(width) * u64::from(height);
        if found != expected {
            return Err(TextureError::WrongLength {
                width,
                height,
                expected,
                found,
            });
        }
        Ok(Self::level(width, height, texels))
    }

    /// A level of a pyramid: its texels are known to be as many as its size says.
    pub(super) fn level(width: u32, height: u32, texels: Texels) -> Self {
        Self {
            width,
            height,
            texels,
            levels: OnceLock::new(),
            brightest: OnceLock::new(),
        }
    }

    /// As they are kept.
    pub(super) fn texels(&self) -> &Texels {
        &self.texels
    }

    /// Linear RGB and alpha of one texel.
    pub(super) fn linear_texel(&self, x: u32, y: u32) -> Vec4 {
        self.texel(x, y, false).extend(self.alpha(x, y))
    }

    /// Pixels a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Linear RGB of one texel; `raw` leaves sRGB texels as they are (Classic lighting).
    pub fn texel(&self, x: u32, y: u32, raw: bool) -> Vec3 {
        let i = y as usize * self.width as usize + x as usize;
        match &self.texels {
            Texels::Srgb8(t) if !raw => {
                let table = srgb::decode_table();
                Vec3::new(
                    table[t[i][0] as usize],
                    table[t[i][1] as usize],
                    table[t[i][2] as usize],
                )
            }
            Texels::Srgb8(t) | Texels::Linear8(t) => {
                Vec3::new(t[i][0] as f32, t[i][1] as f32, t[i][2] as f32) / 255.0
            }
            Texels::Linear32(t) => Vec3::from(t[i]),
        }
    }

    /// The largest value of each channel, linear RGB.
    pub(super) fn brightest(&self) -> Vec3 {
        *self.brightest.get_or_init(|| {
            let rows = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
            rows.fold(Vec3::ZERO, |most, (x, y)| most.max(self.texel(x, y, false)))
        })
    }

    /// Alpha of one texel in [0, 1]; floating-point pictures are opaque.
    fn alpha(&self, x: u32, y: u32) -> f32 {
        match &self.texels {
            Texels::Srgb8(t) | Texels::Linear8(t) => {
                t[y as usize * self.width as usize + x as usize][3] as f32 / 255.0
            }
            Texels::Linear32(_) => 1.0,
        }
    }

    /// Colour at `uv`, repeated in both directions. `footprint` is the edge of the square that the
    /// ray covers, in texture coordinates: only mipmaps look at it.
    pub fn sample(&self, uv: Vec2, footprint: f32, filter: TextureFilter, raw: bool) -> Vec3 {
        self.across_levels(footprint, filter, |level| {
            level.filtered(uv, filter, |x, y| level.texel(x, y, raw))
        })
    }

    /// Opacity at `uv`: the alpha channel times the brightest colour channel, so that both a
    /// grey map (MTL's map_d) and a colour map with alpha (glTF) say what they mean.
    pub fn opacity(&self, uv: Vec2, footprint: f32, filter: TextureFilter) -> f32 {
        let opacity = self.across_levels(footprint, filter, |level| {
            level.filtered(uv, filter, |x, y| {
                Vec3::splat(level.alpha(x, y) * level.texel(x, y, true).max_element())
            })
        });
        opacity.x
    }

    /// Between the two levels whose texels are about as large as the footprint.
    fn across_levels(
        &self,
        footprint: f32,
        filter: TextureFilter,
        look_up: impl Fn(&Texture) -> Vec3,
    ) -> Vec3 {
        if filter != TextureFilter::Mipmap {
            return look_up(self);
        }
        let texels = footprint * self.width.max(self.height) as f32;
        let level = texels.log2();
        if level.is_nan() || level <= 0.0 {
            return look_up(self);
        }
        let levels = self.levels.get_or_init(|| mipmap::pyramid(self));
        let level = level.min(levels.len() as f32);
        let (below, fraction) = (level as usize, level.fract());
        let finer = if below == 0 {
            look_up(self)
        } else {
            look_up(&levels[below - 1])
        };
        match levels.get(below) {
            Some(coarser) => finer.lerp(look_up(coarser), fraction),
            None => finer,
        }
    }

    fn filtered(&self, uv: Vec2, filter: TextureFilter, texel: impl Fn(u32, u32) -> Vec3) -> Vec3 {
        // A coordinate that is not finite (a broken mesh) reads the first texel.
        let uv = if uv.is_finite() { uv } else { Vec2::ZERO };
        let uv = uv - uv.floor();
        let (width, height) = (self.width as f32, self.height as f32);
        match filter {
            TextureFilter::Nearest => texel(
                ((uv.x * width) as u32).min(self.width - 1),
                ((uv.y * height) as u32).min(self.height - 1),
            ),
            TextureFilter::Bilinear | TextureFilter::Mipmap => {
                let (x, fx) = split(uv.x * width - 0.5);
                let (y, fy) = split(uv.y * height - 0.5);
                let (x0, x1) = (wrap(x, self.width), wrap(x + 1, self.width));
                let (y0, y1) = (wrap(y, self.height), wrap(y + 1, self.height));
                let top = texel(x0, y0).lerp(texel(x1, y0), fx);
                let bottom = texel(x0, y1).lerp(texel(x1, y1), fx);
                top.lerp(bottom, fy)
            }
        }
    }

    /// Equirectangular look-up: u around, v from pole to pole, bilinear. Columns wrap; a row beyond
    /// a pole is the pole's own row, half a turn away, so that nothing jumps there.
    pub(super) fn sample_sphere(&self, uv: Vec2) -> Vec3 {
        let column = uv.x * self.width as f32 - 0.5;
        let (y, fy) = split(uv.y * self.height as f32 - 0.5);
        let row = |y: i64| {
            let beyond_pole = y < 0 || y >= i64::from(self.height);
            // Half a turn is no whole number of columns where their number is odd.
            let turn = if beyond_pole {
                self.width as f32 / 2.0
            } else {
                0.0
            };
            let (x, fx) = split(column + turn);
            let y = y.clamp(0, i64::from(self.height) - 1) as u32;
            let left = self.texel(wrap(x, self.width), y, false);
            let right = self.texel(wrap(x + 1, self.width), y, false);
            left.lerp(right, fx)
        };
        row(y).lerp(row(y + 1), fy)
    }
}

/// Whole and fractional part.
fn split(x: f32) -> (i64, f32) {
    let floor = x.floor();
    (floor as i64, x - floor)
}

fn wrap(i: i64, n: u32) -> u32 {
    i.rem_euclid(i64::from(n)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_by_two() -> Texture {
        let texels = vec![[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]];
        Texture::new(2, 2, Texels::Linear32(texels)).unwrap()
    }

    #[test]
    fn around_a_pole_a_map_is_the_same_half_a_turn_away_whatever_its_width() {
        for width in [2, 3, 7] {
            let texels = (0..2 * width).map(|i| [(i * i % 5) as f32; 3]).collect();
            let map = Texture::new(width, 2, Texels::Linear32(texels)).unwrap();
            for i in 0..20 {
                for pole in [0.0, 1.0] {
                    let u = i as f32 / 40.0;
                    let [here, there] = [u, u + 0.5].map(|u| map.sample_sphere(Vec2::new(u, pole)));
                    assert!(
                        (here - there).length() < 1e-4,
                        "{width}, {u}: {here} {there}"
                    );
                }
            }
        }
    }

    #[test]
    fn nearest_reads_the_texel_that_holds_the_point_and_bilinear_the_mean_between_four() {
        let t = two_by_two();
        let nearest = |u, v| {
            t.sample(Vec2::new(u, v), 0.0, TextureFilter::Nearest, false)
                .x
        };
        assert_eq!(
            [nearest(0.1, 0.1), nearest(0.9, 0.1), nearest(0.1, 0.9)],
            [0.0, 1.0, 2.0]
        );
        let bilinear = |u, v| {
            t.sample(Vec2::new(u, v), 0.0, TextureFilter::Bilinear, false)
                .x
        };
        assert_eq!(bilinear(0.25, 0.25), 0.0);
        assert_eq!(bilinear(0.5, 0.5), 1.5);
        assert_eq!(bilinear(0.5, 0.25), 0.5);
    }

    #[test]
    fn coordinates_repeat_and_one_equals_zero() {
        let t = two_by_two();
        for filter in [TextureFilter::Nearest, TextureFilter::Bilinear] {
            for (a, b) in [((0.0, 0.0), (1.0, 1.0)), ((0.3, 0.7), (-0.7, 5.7))] {
                let a = t.sample(Vec2::from(a), 0.0, filter, false);
                let b = t.sample(Vec2::from(b), 0.0, filter, false);
                assert!((a - b).length() < 1e-5, "{filter:?}: {a} and {b}");
            }
        }
        assert!(
            t.sample(Vec2::NAN, 0.0, TextureFilter::Bilinear, false)
                .is_finite()
        );
    }

    #[test]
    fn a_wide_ray_sees_the_mean_of_the_picture_and_a_narrow_one_its_texels() {
        let t = two_by_two();
        let at = |footprint| {
            t.sample(Vec2::splat(0.25), footprint, TextureFilter::Mipmap, false)
                .x
        };
        assert_eq!((at(0.0), at(0.5), at(1.0), at(100.0)), (0.0, 0.0, 1.5, 1.5));
        let between = at(0.5_f32.sqrt());
        assert!((between - 0.75).abs() < 1e-5, "{between}");
    }

    #[test]
    fn srgb_is_decoded_unless_raw_is_asked_for() {
        let t = Texture::new(1, 1, Texels::Srgb8(vec![[188, 0, 255, 255]])).unwrap();
        let linear = t.texel(0, 0, false);
        assert!(
            (linear - Vec3::new(0.5029, 0.0, 1.0)).length() < 1e-3,
            "{linear}"
        );
        assert_eq!(t.texel(0, 0, true).x, 188.0 / 255.0);
    }

    #[test]
    fn a_picture_without_pixels_or_of_the_wrong_length_is_refused() {
        assert!(Texture::new(0, 4, Texels::Linear32(vec![])).is_err());
        assert!(Texture::new(2, 2, Texels::Linear32(vec![[0.0; 3]; 3])).is_err());
    }
}
