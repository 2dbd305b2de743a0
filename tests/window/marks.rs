//! Lines that are sought in pictures of the window, with what is drawn and without.

use super::pictures::Shot;

/// A line in a picture, in pixels from its top left, and its colour on the screen.
pub(super) struct Line(pub [f32; 2], pub [f32; 2], pub [u8; 3]);

/// A part of a picture: left, top, right, bottom in pixels.
pub(super) type Area = [f32; 4];

pub(super) struct Pictures(pub tempfile::TempDir);

impl Pictures {
    pub fn open(&self, name: &str) -> Shot {
        Shot::open(&self.0.path().join(format!("{name}.png")))
    }

    /// With the gizmo, and without it.
    pub fn pair(&self, on: &str, off: &str) -> Pair {
        Pair {
            name: on.into(),
            on: self.open(on),
            off: self.open(off),
        }
    }
}

/// The same picture with a gizmo and without.
pub(super) struct Pair {
    pub name: String,
    pub on: Shot,
    pub off: Shot,
}

impl Pair {
    /// Each of the lines is there with the gizmo, and not without it.
    pub fn shows(&self, lines: &[Line]) -> &Self {
        for Line(from, to, color) in lines {
            let places = places(*from, *to);
            let of = places.len();
            let seen = places.iter().filter(|at| self.is_drawn(**at, *color));
            let seen = seen.count();
            let before = places.iter().filter(|at| self.was_there(**at, *color));
            let before = before.count();
            let line = format!("{}: {color:?} from {from:?} to {to:?}", self.name);
            assert!(seen * 5 >= of * 4, "{line}: seen at {seen} of {of} places");
            assert!(
                before * 5 <= of,
                "{line}: without the gizmo at {before} of {of} places"
            );
        }
        self
    }

    /// Near this place a pixel has become a mixture of what it was and of the colour.
    fn is_drawn(&self, at: [f32; 2], color: [u8; 3]) -> bool {
        around(at).any(|(x, y)| {
            let (on, off) = (self.on.pixel(x, y), self.off.pixel(x, y));
            is_mixed(on, off, color)
        })
    }

    fn was_there(&self, at: [f32; 2], color: [u8; 3]) -> bool {
        around(at).any(|(x, y)| apart(self.off.pixel(x, y), color) <= NEAR)
    }

    /// Nothing is drawn there.
    pub fn leaves(&self, areas: &[Area]) -> &Self {
        for area in areas {
            let changed = pixels(*area).filter(|&(x, y)| self.has_changed(x, y));
            let changed: Vec<_> = changed.collect();
            assert!(
                changed.len() * 200 <= pixels(*area).count(),
                "{}: {} pixels of {area:?} have changed, {:?} among them",
                self.name,
                changed.len(),
                changed[0]
            );
        }
        self
    }

    /// So many lines at least cross an area one pixel wide or high.
    pub fn is_crossed(&self, area: Area, least: usize) -> &Self {
        let changed: Vec<bool> = pixels(area).map(|(x, y)| self.has_changed(x, y)).collect();
        let starts = changed.windows(2).filter(|pair| !pair[0] && pair[1]);
        let lines = starts.count() + usize::from(changed[0]);
        assert!(
            lines >= least,
            "{}: {lines} lines cross {area:?}",
            self.name
        );
        self
    }

    pub fn has_changed(&self, x: u32, y: u32) -> bool {
        apart(self.on.pixel(x, y), self.off.pixel(x, y)) > CHANGED
    }
}

/// In levels of 255: what counts as the same colour, and as another one.
const NEAR: f32 = 22.0;
const CHANGED: f32 = 12.0;
/// A line that covers less of its pixels than this is none.
const COVERS: f32 = 0.2;

/// The largest difference of a channel.
pub(super) fn apart(a: [u8; 3], b: [u8; 3]) -> f32 {
    let channels = a.iter().zip(b).map(|(a, b)| f32::from(a.abs_diff(b)));
    channels.fold(0.0, f32::max)
}

/// Whether `on` is `off` with a line of `color` over it, mixed in linear light.
pub(super) fn is_mixed(on: [u8; 3], off: [u8; 3], color: [u8; 3]) -> bool {
    if apart(on, off) <= CHANGED {
        return false;
    }
    let linear = |c: [u8; 3]| c.map(|c| decoded(f32::from(c) / 255.0));
    let (a, b, c) = (linear(off), linear(color), linear(on));
    let dot = |u: [f32; 3], v: [f32; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let minus = |u: [f32; 3], v: [f32; 3]| [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
    let (whole, part) = (minus(b, a), minus(c, a));
    let share = (dot(part, whole) / dot(whole, whole).max(1e-9)).clamp(0.0, 1.0);
    let mixed = [0, 1, 2].map(|i| encoded(a[i] + share * whole[i]));
    share >= COVERS && apart(on, mixed.map(|c| (255.0 * c).round() as u8)) <= NEAR
}

fn decoded(c: f32) -> f32 {
    match c <= 0.04045 {
        true => c / 12.92,
        false => ((c + 0.055) / 1.055).powf(2.4),
    }
}

fn encoded(c: f32) -> f32 {
    match c <= 0.0031308 {
        true => 12.92 * c,
        false => 1.055 * c.powf(1.0 / 2.4) - 0.055,
    }
}

/// Along a line, every few pixels.
fn places(from: [f32; 2], to: [f32; 2]) -> Vec<[f32; 2]> {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let steps = (length / 6.0).ceil().max(1.0) as u32;
    let at = |i: u32, k: usize| from[k] + (to[k] - from[k]) * i as f32 / steps as f32;
    (0..=steps).map(|i| [at(i, 0), at(i, 1)]).collect()
}

/// Pixels within two of a place.
fn around([x, y]: [f32; 2]) -> impl Iterator<Item = (u32, u32)> {
    pixels([x - 2.0, y - 2.0, x + 3.0, y + 3.0])
}

pub(super) fn pixels([left, top, right, bottom]: Area) -> impl Iterator<Item = (u32, u32)> {
    let columns = left.max(0.0) as u32..(right as u32).min(640);
    (top.max(0.0) as u32..(bottom as u32).min(480))
        .flat_map(move |y| columns.clone().map(move |x| (x, y)))
}
