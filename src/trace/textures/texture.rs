use super::dome_table::DomeTable;
use super::mipmap::{self, Weight};
use super::texels::Texels;
use super::wrap::{self, Reading};
use crate::scene::{TextureFilter, Wrap};
use glam::{Vec2, Vec3};
use std::sync::OnceLock;

/// A picture that rays read. Row 0 is the top one; (0, 0) is the top left corner, v grows downwards.
#[derive(Clone, Debug)]
pub struct Texture {
    width: u32,
    height: u32,
    texels: Texels,
    opaque: bool,
    /// Made when first asked for: a scene without mipmaps has none.
    levels: OnceLock<Vec<Texture>>,
    /// Those whose colours are weighted by alpha, likewise.
    cut_out_levels: OnceLock<Vec<Texture>>,
    /// Looked for when first asked for.
    brightest: OnceLock<Vec3>,
    /// Where light comes from, if it is an environment that lights; likewise.
    dome_table: OnceLock<Option<Box<DomeTable>>>,
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
        let found = texels.len() as u64;
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
            opaque: texels.are_opaque(),
            texels,
            levels: OnceLock::new(),
            cut_out_levels: OnceLock::new(),
            brightest: OnceLock::new(),
            dome_table: OnceLock::new(),
        }
    }

    /// As they are kept.
    pub(in crate::trace) fn texels(&self) -> &Texels {
        &self.texels
    }

    /// Pixels a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Whether every alpha is 1.
    pub(super) fn is_opaque(&self) -> bool {
        self.opaque
    }

    fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// Linear RGB of one texel; `raw` leaves sRGB texels as they are (Classic lighting).
    pub fn texel(&self, x: u32, y: u32, raw: bool) -> Vec3 {
        self.texels.rgb(self.index(x, y), raw)
    }

    /// Alpha of one texel in [0, 1].
    pub(in crate::trace) fn alpha(&self, x: u32, y: u32) -> f32 {
        self.texels.alpha(self.index(x, y))
    }

    /// Opacity of one texel: the alpha channel times the brightest colour channel, so that both a
    /// grey map (MTL's map_d) and a colour map with alpha (glTF) say what they mean.
    pub(super) fn texel_opacity(&self, x: u32, y: u32) -> f32 {
        self.alpha(x, y) * self.texel(x, y, true).max_element()
    }

    /// The largest value of each channel, linear RGB.
    pub(in crate::trace) fn brightest(&self) -> Vec3 {
        *self.brightest.get_or_init(|| {
            // An environment's, and large.
            if let Texels::Linear32(texels) = &self.texels {
                let texels = texels.iter().copied().map(Vec3::from);
                return texels.fold(Vec3::ZERO, Vec3::max);
            }
            let rows = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
            rows.fold(Vec3::ZERO, |most, (x, y)| most.max(self.texel(x, y, false)))
        })
    }

    /// Has all made now that an environment needs of this map, equirectangular; of one that lights some tenths of a second
    /// where it is large. Else whoever needs it first waits for it.
    pub fn prepare_as_environment(&self, lights: bool) {
        self.brightest();
        if lights {
            self.dome_table();
        }
    }

    /// Whether what a lighting environment needs was made.
    pub fn has_dome_table(&self) -> bool {
        self.dome_table.get().is_some()
    }

    /// Has the smaller copies made now that mipmaps are read from. Else whoever needs them first waits for them.
    pub fn prepare_levels(&self) {
        self.plain_levels();
    }

    /// The same of a map of colours that is cut out.
    pub fn prepare_cut_out_levels(&self) {
        self.cut_out_levels();
    }

    /// Whether smaller copies were made, of some kind.
    pub fn has_levels(&self) -> bool {
        self.levels.get().is_some() || self.cut_out_levels.get().is_some()
    }

    /// Where light comes from around an equirectangular map; `None` of one that is the same everywhere.
    pub(in crate::trace) fn dome_table(&self) -> Option<&DomeTable> {
        let table = || DomeTable::new(self).map(Box::new);
        self.dome_table.get_or_init(table).as_deref()
    }

    /// Colour at `uv`. `footprint` is the edge of the square that the ray covers, in texture
    /// coordinates: only mipmaps look at it.
    pub fn sample(&self, uv: Vec2, footprint: f32, reading: impl Into<Reading>, raw: bool) -> Vec3 {
        let reading = reading.into();
        self.across_levels(footprint, reading.filter, |level| {
            level.filtered(uv, reading, |x, y| level.texel(x, y, raw))
        })
    }

    /// Opacity at `uv`: alpha times the brightest colour channel, filtered.
    pub fn opacity(&self, uv: Vec2, footprint: f32, reading: impl Into<Reading>) -> f32 {
        let reading = reading.into();
        let opacity = self.across_levels(footprint, reading.filter, |level| {
            level.filtered(uv, reading, |x, y| Vec3::splat(level.texel_opacity(x, y)))
        });
        opacity.x
    }

    fn across_levels(
        &self,
        footprint: f32,
        filter: TextureFilter,
        look_up: impl Fn(&Texture) -> Vec3,
    ) -> Vec3 {
        let (finer, coarser) = self.levels_between(footprint, filter, Self::plain_levels);
        let near = look_up(finer);
        match coarser {
            Some((level, fraction)) => near.lerp(look_up(level), fraction),
            None => near,
        }
    }

    fn plain_levels(&self) -> &[Texture] {
        self.levels
            .get_or_init(|| mipmap::pyramid(self, Weight::Area))
    }

    pub(super) fn cut_out_levels(&self) -> &[Texture] {
        self.cut_out_levels
            .get_or_init(|| mipmap::pyramid(self, Weight::AreaAndAlpha))
    }

    /// The two levels whose texels are about as large as the footprint, and how much the second counts.
    pub(super) fn levels_between(
        &self,
        footprint: f32,
        filter: TextureFilter,
        levels: fn(&Texture) -> &[Texture],
    ) -> (&Texture, Option<(&Texture, f32)>) {
        if filter != TextureFilter::Mipmap {
            return (self, None);
        }
        let texels = footprint * self.width.max(self.height) as f32;
        let level = texels.log2();
        if level.is_nan() || level <= 0.0 {
            return (self, None);
        }
        let levels = levels(self);
        let level = level.min(levels.len() as f32);
        let (below, fraction) = (level as usize, level.fract());
        let finer = if below == 0 { self } else { &levels[below - 1] };
        (finer, levels.get(below).map(|coarser| (coarser, fraction)))
    }

    fn filtered(&self, uv: Vec2, reading: Reading, texel: impl Fn(u32, u32) -> Vec3) -> Vec3 {
        match reading.filter {
            TextureFilter::Nearest => {
                let uv = wrap::inside(uv, reading.wrap);
                texel(
                    ((uv.x * self.width as f32) as u32).min(self.width - 1),
                    ((uv.y * self.height as f32) as u32).min(self.height - 1),
                )
            }
            TextureFilter::Bilinear | TextureFilter::Mipmap => {
                let ([x0, x1], [y0, y1], fx, fy) = self.around(uv, reading.wrap);
                let top = texel(x0, y0).lerp(texel(x1, y0), fx);
                let bottom = texel(x0, y1).lerp(texel(x1, y1), fx);
                top.lerp(bottom, fy)
            }
        }
    }

    /// The columns and rows of the four texels around a place, and how far it lies to the second ones.
    pub(in crate::trace) fn around(
        &self,
        uv: Vec2,
        wrap: [Wrap; 2],
    ) -> ([u32; 2], [u32; 2], f32, f32) {
        let uv = wrap::inside(uv, wrap);
        let (x, fx) = split(uv.x * self.width as f32 - 0.5);
        let (y, fy) = split(uv.y * self.height as f32 - 0.5);
        (
            [x, x + 1].map(|x| wrap::texel(x, self.width, wrap[0])),
            [y, y + 1].map(|y| wrap::texel(y, self.height, wrap[1])),
            fx,
            fy,
        )
    }

    /// Equirectangular look-up: u around, v from pole to pole, bilinear. Columns wrap; a row beyond
    /// a pole is the pole's own row, half a turn away, so that nothing jumps there.
    pub(in crate::trace) fn sample_sphere(&self, uv: Vec2) -> Vec3 {
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
            let [left, right] = [x, x + 1].map(|x| {
                let x = x.rem_euclid(i64::from(self.width));
                self.texel(x as u32, y, false)
            });
            left.lerp(right, fx)
        };
        row(y).lerp(row(y + 1), fy)
    }
}

/// Whole and fractional part.
fn split(x: f32) -> (i64, f32) {
    let floor = wrap::floor(x);
    (floor as i64, x - floor)
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
