//! Which places of an equirectangular map light comes from: those that are brighter than its mean, as often as they are
//! brighter. All others a surface finds by itself, by where it faces (`dome`).
//!
//! Leaving the mean out is what Karlík, Šik, Vévoda, Skřivan and Křivánek 2019 call compensation ("MIS Compensation:
//! Optimizing Sampling Techniques in Multiple Importance Sampling"); a table of rows and one of columns in each row are
//! inverted one after the other (Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., 12.5).
//!
//! The map is bilinear between its texels' middles (`Texture::sample_sphere`), and so is the density: what lies between a
//! bright texel and a dark one is found as often as it shines. Nodes stand in the middles, each worth
//! `max(luminance - mean, 0) · sin θ`, and 0 at the poles.

use super::texture::Texture;
use super::wrap;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Luminances above this count as this: their squares, and sums of them, stay finite.
const BRIGHTEST: f32 = (1_u128 << 64) as f32;

/// No more than this part of a light's points is chosen by the map alone: in the shadow of a sun all others see the sky.
const LARGEST_SHARE: f64 = 0.5;

/// Sums over a map's cells. A cell lies between four nodes: in the first and the last band two of them are the pole.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::trace) struct DomeTable {
    /// The part of a light's points that this table is to choose, 1/2 at most: that of the light which is more than the
    /// mean. More than 0.
    pub share: f32,
    /// What is left out of relative luminances.
    mean: f32,
    /// One over the largest luminance.
    scale: f32,
    /// Of each row of nodes.
    sines: Vec<f32>,
    /// Of bands of cells from the top: the part of the whole down to its lower end. One more than rows.
    bands: Vec<f32>,
    /// Of each band's cells the part of the band up to its right end: as many as columns.
    cells: Vec<f32>,
    /// One over the integral of the nodes over the map as a unit square.
    per_total: f32,
}

/// A place between four nodes: left and right of the upper row, then of the lower one.
struct Cell {
    nodes: [f32; 4],
    /// From the left, and from the top, each in [0, 1].
    across: f32,
    down: f32,
}

impl DomeTable {
    /// `None` of a map that is equally bright everywhere.
    pub fn new(map: &Texture) -> Option<Self> {
        let (width, height) = (map.width(), map.height());
        let sines: Vec<f32> = (0..height)
            .map(|y| (PI * (y as f32 + 0.5) / height as f32).sin())
            .collect();
        let (mut most, mut sum, mut area) = (0.0_f32, 0.0_f64, 0.0_f64);
        for (y, &sine) in (0..).zip(&sines) {
            let mut row = 0.0_f64;
            for x in 0..width {
                let luminance = luminance(map.texel(x, y, false));
                most = most.max(luminance);
                row += f64::from(luminance);
            }
            sum += row * f64::from(sine);
            area += f64::from(width) * f64::from(sine);
        }
        if most < f32::MIN_POSITIVE {
            return None;
        }
        let mut table = Self {
            share: 0.0,
            mean: (sum / area / f64::from(most)) as f32,
            scale: 1.0 / most,
            sines,
            bands: Vec::with_capacity(height as usize + 1),
            cells: Vec::with_capacity((height as usize + 1) * width as usize),
            per_total: 0.0,
        };
        let beyond_mean = table.add_up(map);
        table.per_total = (f64::from(width) * f64::from(height) / beyond_mean) as f32;
        let share = beyond_mean / (sum / f64::from(most));
        table.share = share.min(LARGEST_SHARE) as f32;
        // What is left of an even map is rounding.
        (share > 1e-6).then_some(table)
    }

    /// Adds up the nodes: their sum, but for what bends between rows.
    fn add_up(&mut self, map: &Texture) -> f64 {
        let (width, height) = (map.width() as usize, map.height() as usize);
        let mut sums = vec![0.0_f64; width];
        let (mut upper, mut lower) = (vec![0.0_f32; width], vec![0.0_f32; width]);
        let mut bands = Vec::with_capacity(height + 1);
        for band in 0..=height {
            std::mem::swap(&mut upper, &mut lower);
            for (x, node) in lower.iter_mut().enumerate() {
                *node = self.node(map, x as u32, band as i64);
            }
            let mut sum = 0.0;
            for x in 0..width {
                let next = (x + 1) % width;
                let corners = [upper[x], upper[next], lower[x], lower[next]];
                sum += corners.into_iter().map(f64::from).sum::<f64>();
                sums[x] = sum;
            }
            let per_sum = if sum > 0.0 { 1.0 / sum } else { 0.0 };
            self.cells.extend(sums.iter().map(|s| (s * per_sum) as f32));
            // From a pole to the first row's middle it is half as far as from row to row.
            let size = if band == 0 || band == height {
                0.5
            } else {
                1.0
            };
            bands.push(sum * size);
        }
        let mut sum = 0.0;
        for band in &mut bands {
            sum += *band;
            *band = sum;
        }
        let per_sum = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        self.bands
            .extend(bands.iter().map(|s| (s * per_sum) as f32));
        0.25 * sum
    }

    /// A node of row `y`; 0 of the poles, which are the rows -1 and one beyond the last.
    fn node(&self, map: &Texture, x: u32, y: i64) -> f32 {
        let Some(&sine) = usize::try_from(y).ok().and_then(|y| self.sines.get(y)) else {
            return 0.0;
        };
        let luminance = luminance(map.texel(x, y as u32, false)) * self.scale;
        (luminance - self.mean).max(0.0) * sine
    }

    fn nodes(&self, map: &Texture, column: usize, band: usize) -> [f32; 4] {
        let columns = [column, (column + 1) % map.width() as usize].map(|x| x as u32);
        let rows = [band as i64 - 1, band as i64];
        let [a, b] = rows.map(|y| columns.map(|x| self.node(map, x, y)));
        [a[0], a[1], b[0], b[1]]
    }

    /// The place, as `equirectangular` has it, that the numbers `u` in [0, 1)² choose. The map is the table's own.
    pub fn place(&self, map: &Texture, u: [f32; 2]) -> Vec2 {
        let (width, height) = (map.width() as usize, map.height() as usize);
        let (band, along_bands) = chosen(&self.bands, u[1]);
        let (column, along_cells) = chosen(&self.cells[band * width..][..width], u[0]);
        let [a, b, c, d] = self.nodes(map, column, band);
        let down = linear([a + b, c + d], along_bands);
        let across = linear([a + (c - a) * down, b + (d - b) * down], along_cells);
        let row = match band {
            0 => 0.5 * down,
            band if band == height => band as f32 - 0.5 + 0.5 * down,
            band => band as f32 - 0.5 + down,
        };
        let column = column as f32 + 0.5 + across;
        Vec2::new((column / width as f32).fract(), row / height as f32)
    }

    /// How likely a place is chosen, per area of the map as a unit square.
    pub fn density(&self, map: &Texture, place: Vec2) -> f32 {
        let Cell {
            nodes: [a, b, c, d],
            across,
            down,
        } = self.cell(map, place);
        let (left, right) = (a + (c - a) * down, b + (d - b) * down);
        (left + (right - left) * across) * self.per_total
    }

    fn cell(&self, map: &Texture, place: Vec2) -> Cell {
        let (width, height) = (map.width(), map.height());
        let x = place.x * width as f32 - 0.5;
        let whole = wrap::floor(x);
        let column = (whole as i64).rem_euclid(i64::from(width)) as usize;
        let y = place.y * height as f32;
        let band = ((y + 0.5) as usize).min(height as usize);
        let down = match band {
            0 => 2.0 * y,
            band if band == height as usize => 2.0 * (y + 0.5 - band as f32),
            band => y + 0.5 - band as f32,
        };
        Cell {
            nodes: self.nodes(map, column, band),
            across: x - whole,
            down: down.clamp(0.0, 1.0),
        }
    }
}

/// Rec. 709's weights; 0 for what is no light.
fn luminance(color: Vec3) -> f32 {
    let luminance = color.dot(Vec3::new(0.2126, 0.7152, 0.0722));
    if luminance > 0.0 {
        luminance.min(BRIGHTEST)
    } else {
        0.0
    }
}

/// The part that the number in [0, 1) falls into, and how far into it, in [0, 1).
fn chosen(up_to: &[f32], number: f32) -> (usize, f32) {
    let part = up_to.partition_point(|&end| end <= number);
    let part = part.min(up_to.len() - 1);
    let start = if part == 0 { 0.0 } else { up_to[part - 1] };
    let share = (number - start) / (up_to[part] - start);
    // What is empty is chosen by nobody but rounding.
    (
        part,
        if share.is_finite() {
            share.clamp(0.0, 1.0)
        } else {
            0.5
        },
    )
}

/// Where the share of a density ends that is linear between these, in [0, 1]: `piecewise` has the formula.
fn linear([a, b]: [f32; 2], share: f32) -> f32 {
    // Their squares may be too small to be told from nothing.
    let a = a / (a + b);
    if !a.is_finite() {
        return share;
    }
    let b = 1.0 - a;
    let root = ((1.0 - share) * (a * a) + share * (b * b)).sqrt();
    (share / (a + root)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::texels::Texels;
    use super::*;

    fn map(width: u32, height: u32, of: impl Fn(u32, u32) -> f32) -> Texture {
        let texels = (0..width * height).map(|i| [of(i % width, i / width); 3]);
        Texture::new(width, height, Texels::Linear32(texels.collect())).unwrap()
    }

    /// Some maps with bright places: a gradient, a sun, a sun at either pole, at the seam, noise, few texels.
    fn maps() -> Vec<Texture> {
        let sun = |at: (u32, u32)| move |x, y| if (x, y) == at { 1e4 } else { 1.0 };
        vec![
            map(16, 8, |_, y| (8 - y) as f32),
            map(16, 8, sun((3, 2))),
            map(16, 8, sun((3, 0))),
            map(16, 8, sun((15, 7))),
            map(15, 9, |x, y| ((x * 7 + y * 13) % 11) as f32),
            map(1, 2, |_, y| y as f32),
            map(2, 1, |x, _| x as f32),
            map(3, 3, |x, y| if (x, y) == (1, 1) { 1.8e19 } else { 0.0 }),
        ]
    }

    #[test]
    fn the_density_integrates_to_one_over_the_map() {
        let n = 1024;
        for map in maps() {
            let table = DomeTable::new(&map).unwrap();
            let middle = |i: u32| (i as f32 + 0.5) / n as f32;
            let places = (0..n * n).map(|i| Vec2::new(middle(i % n), middle(i / n)));
            let sum: f64 = places.map(|at| f64::from(table.density(&map, at))).sum();
            let mean = sum / f64::from(n * n);
            let size = (map.width(), map.height());
            // Bends of a bilinear function that fall between the grid's points: a part in 10⁴.
            assert!((mean - 1.0).abs() < 1e-3, "{size:?}: {mean}");
        }
    }

    #[test]
    fn places_come_as_often_as_their_density_says() {
        let n = 512;
        for map in maps() {
            let table = DomeTable::new(&map).unwrap();
            // The integrals over the map of functions that are 0 where the density is: f = density · g.
            let (mut chosen, mut even) = ([0.0_f64; 3], [0.0_f64; 3]);
            for i in 0..n * n {
                let u = [i % n, i / n].map(|i| (i as f32 + 0.5) / n as f32);
                let at = table.place(&map, u);
                let density = f64::from(table.density(&map, at));
                assert!(
                    density > 0.0,
                    "{u:?} chose {at}, where nothing is to be chosen"
                );
                assert!(Vec2::ZERO.cmple(at).all() && at.cmple(Vec2::ONE).all());
                let weight = f64::from(table.density(&map, Vec2::from(u)));
                for (g, (chosen, even)) in chosen.iter_mut().zip(&mut even).enumerate() {
                    let of = |at: Vec2| f64::from([at.y, at.y * at.y, (6.3 * at.x).sin()][g]);
                    *chosen += of(at) / f64::from(n * n);
                    *even += weight * of(Vec2::from(u)) / f64::from(n * n);
                }
            }
            let size = (map.width(), map.height());
            for (chosen, even) in chosen.iter().zip(even) {
                assert!((chosen - even).abs() < 3e-3, "{size:?}: {chosen}, {even}");
            }
        }
    }

    #[test]
    fn a_map_that_is_the_same_everywhere_or_black_has_no_table() {
        for value in [0.0, 1.0, 0.3, 1e-30, 1.8e19] {
            assert_eq!(DomeTable::new(&map(7, 5, |_, _| value)), None, "{value}");
        }
        assert_eq!(DomeTable::new(&map(1, 1, |_, _| 5.0)), None);
    }

    #[test]
    fn what_is_no_light_counts_as_none_and_what_is_infinite_as_much() {
        let wrong = [f32::NAN, -1.0, f32::NEG_INFINITY, 1.0];
        let table = DomeTable::new(&map(4, 2, |x, _| wrong[x as usize])).unwrap();
        let right = DomeTable::new(&map(4, 2, |x, _| [0.0, 0.0, 0.0, 1.0][x as usize]));
        assert_eq!(Some(table), right);
        let bright = map(4, 2, |x, _| if x == 1 { f32::INFINITY } else { 1.0 });
        let table = DomeTable::new(&bright).unwrap();
        let at = table.place(&bright, [0.5, 0.5]);
        assert!(table.density(&bright, at).is_finite());
        assert!((0.125..0.625).contains(&at.x), "{at}");
    }

    #[test]
    fn a_sun_gets_half_of_the_points_and_a_gradient_a_quarter() {
        let sun = map(16, 8, |x, y| if (x, y) == (3, 2) { 1e6 } else { 1.0 });
        assert_eq!(DomeTable::new(&sun).unwrap().share, 0.5);
        // 1 + cos θ: the upper half has a quarter of the light beyond the mean.
        let gradient = map(64, 64, |_, y| 1.0 + (PI * (y as f32 + 0.5) / 64.0).cos());
        let share = DomeTable::new(&gradient).unwrap().share;
        assert!((share - 0.25).abs() < 1e-2, "{share}");
    }
}
