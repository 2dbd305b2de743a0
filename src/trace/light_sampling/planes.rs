//! Light kept apart: which lights a picture has a plane of its own for, and what their colours multiply.
//!
//! Light adds up, and a light's colour is a factor of all that it adds. So a picture is
//! `own + Σ tint · plane`: one plane for what shines by itself (surfaces, the background), and one for what each light
//! adds at a tint of 1. Another tint is another sum of the same planes, without a ray.

use super::gains::{Gains, times};
use crate::trace::{Lights, World};
use glam::Vec3;
use std::sync::Arc;

/// The plane of what shines by itself, and of all where nothing is kept apart.
pub const OWN: usize = 0;

/// Which plane takes what each light adds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Planes {
    /// Of each light, in the order of [`Lights::all`]; none where everything is one plane.
    of_light: Vec<u8>,
    /// All planes but [`OWN`].
    apart: u8,
}

/// Some of a picture's planes; by default none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlaneSet(u64);

/// A world whose lights that have a plane of their own shine at a tint of 1, and the tints that make it the world that it
/// was.
#[derive(Clone)]
pub struct Untinted {
    /// Its lights without their tints.
    pub world: World,
    /// Which plane is whose.
    pub planes: Planes,
    /// Of each plane what was taken off its light: linear RGB, 1 of those that hold what is not tinted.
    pub colors: Vec<Vec3>,
    /// Of each plane what it is multiplied by: that colour, and the light's gain.
    pub tints: Vec<Vec3>,
}

impl Planes {
    /// Planes of lights in a picture, at the most, that of those who share one among them.
    pub const MOST: usize = 31;
    /// Planes of a picture, at the most: those, and [`OWN`].
    pub const MOST_OF_PICTURE: usize = 1 + Self::MOST;

    /// All in one.
    pub fn together() -> Self {
        Self::default()
    }

    /// `own` lights get a plane each: those in `first`, by their `SceneId`s, and then the first of the others. What is left
    /// shares the last one.
    pub fn of(lights: &Lights, own: usize, first: &[u64]) -> Self {
        let own = own.min(Self::MOST - 1);
        let ids: Vec<u64> = lights.all().map(|light| light.id()).collect();
        let wanted = first
            .iter()
            .flat_map(|id| (0..ids.len()).filter(|light| ids[*light] == *id));
        let mut is_alone = vec![false; ids.len()];
        let mut left = own;
        for light in wanted.chain(0..ids.len()) {
            if left > 0 && !std::mem::replace(&mut is_alone[light], true) {
                left -= 1;
            }
        }
        let mut last = 0;
        let of_light = is_alone.into_iter().map(|is_alone| {
            last += u8::from(is_alone);
            if is_alone { last } else { 1 + own as u8 }
        });
        Self {
            of_light: of_light.collect(),
            apart: ids.len().min(own + 1) as u8,
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        1 + usize::from(self.apart)
    }

    /// The plane of the light with this place in [`Lights::all`].
    #[inline(always)]
    pub fn of_light(&self, light: usize) -> usize {
        self.of_light
            .get(light)
            .map_or(OWN, |plane| usize::from(*plane))
    }

    /// Whether a plane is one light's alone.
    pub fn is_of_one(&self, plane: usize) -> bool {
        self.of_light
            .iter()
            .filter(|of| usize::from(**of) == plane)
            .count()
            == 1
    }
}

impl PlaneSet {
    /// None of them.
    pub const NONE: Self = Self(0);
    /// Every plane of any picture.
    pub const ALL: Self = Self(u64::MAX);

    /// With this plane.
    pub fn with(self, plane: usize) -> Self {
        Self(self.0 | 1 << plane)
    }

    /// Whether a plane is one of them.
    #[inline(always)]
    pub fn has(self, plane: usize) -> bool {
        self.0 >> plane & 1 == 1
    }

    /// The only one, where they are one.
    pub fn only(self) -> Option<usize> {
        (self.0.count_ones() == 1).then_some(self.0.trailing_zeros() as usize)
    }

    /// Which of them a plane is, in their order; `None` where it is none of them.
    #[inline(always)]
    pub fn row(self, plane: usize) -> Option<usize> {
        let below = self.0 & ((1 << plane) - 1);
        self.has(plane).then_some(below.count_ones() as usize)
    }

    /// Those of a picture with so many planes, in order.
    pub fn of(self, planes: usize) -> impl Iterator<Item = usize> + Clone {
        (0..planes).filter(move |plane| self.has(*plane))
    }

    /// How many those are.
    pub fn rows(self, planes: usize) -> usize {
        (self.0 & ((1 << planes) - 1)).count_ones() as usize
    }
}

impl Untinted {
    /// The world with these gains, in one plane.
    pub fn together(world: &World, gains: &Gains) -> Self {
        Self {
            world: gains.applied(world),
            planes: Planes::together(),
            colors: vec![Vec3::ONE],
            tints: vec![Vec3::ONE],
        }
    }

    /// Takes the tints off the lights of a world that get a plane each ([`Planes::of`]). The tint of a light that is of one
    /// colour is that colour. Of one with a gradient it is a power of two, so that what is left of it is the same gradient,
    /// digit for digit, and chooses the same places. What is very bright or very dim keeps a power of two to itself. A light that shares a plane shines with its gain by itself, and so does each of many: how often
    /// one of those is asked for hangs on how bright it is, and they are many only where the gains leave many.
    pub fn of(world: &World, own: usize, first: &[u64], gains: &Gains) -> Self {
        let needs = gains.applied(world).needs;
        let planes = Planes::of(&world.lights, own, first);
        let mut taken = vec![Vec3::ONE; planes.count()];
        let mut tints = taken.clone();
        let mut lights = (*world.lights).clone();
        let gains: Vec<Vec3> = lights.all().map(|light| gains.of(light.id())).collect();
        let is_tinted: Vec<bool> = (0..planes.count())
            .map(|plane| needs.faint == 0.0 && planes.is_of_one(plane))
            .collect();
        for (light, colors) in lights.colors_mut().enumerate() {
            let (plane, gain) = (planes.of_light(light), gains[light]);
            if !is_tinted[plane] {
                for color in colors {
                    *color = times(*color, gain);
                }
                continue;
            }
            let first = colors[0];
            let brightest = colors.iter().map(|color| color.max_element());
            let octave = brightest.fold(0.0, f32::max).log2().floor();
            let left = left_in_light(octave);
            let tint = if colors.iter().all(|color| *color == first) {
                colors.fill(Vec3::splat(left));
                first / left
            } else {
                let tint = octave.exp2() / left;
                for color in colors {
                    *color /= tint;
                }
                Vec3::splat(tint)
            };
            taken[plane] = tint;
            tints[plane] = times(tint, gain);
        }
        Self {
            world: World {
                lights: Arc::new(lights),
                needs,
                ..world.clone()
            },
            planes,
            colors: taken,
            tints,
        }
    }
}

/// A light's plane is kept in numbers of the range that pictures have. So what a light adds
/// there may be no more than some powers of two brighter or darker than in the picture.
const MOST_TAKEN: f32 = 48.0;
/// Powers of two that are left in a light, and what is left to be taken, are numbers that f32 has.
const MOST_LEFT: f32 = 96.0;

/// What stays of a colour in its light, a power of two: 1 of those between 2^-24 and 2^24, and steps as wide, so that a light
/// that is edited is seldom another.
fn left_in_light(octave: f32) -> f32 {
    let steps = (octave / MOST_TAKEN).round();
    let octaves = (MOST_TAKEN * steps).clamp(-MOST_LEFT, MOST_LEFT);
    // Black has no octave.
    if octave.is_finite() {
        octaves.exp2()
    } else {
        1.0
    }
}

impl Lights {
    /// The colours of every light, in the order of [`Self::all`].
    pub(super) fn colors_mut(&mut self) -> impl Iterator<Item = &mut [Vec3]> {
        use std::slice::from_mut;
        let points = self
            .points
            .iter_mut()
            .map(|light| from_mut(&mut light.color));
        let directionals = (self.directionals.iter_mut()).map(|light| from_mut(&mut light.color));
        let segments = self.segments.iter_mut().map(|light| &mut light.colors[..]);
        let parallelograms = (self.parallelograms.iter_mut()).map(|light| &mut light.colors[..]);
        (points.chain(directionals))
            .chain(segments)
            .chain(parallelograms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::{PointLight, SegmentLight};

    fn untinted(colors: &[Vec3]) -> Untinted {
        let point = |(id, color): (u64, &Vec3)| PointLight {
            id,
            position: Vec3::ZERO,
            color: *color,
            cone: None,
        };
        let lights = Lights {
            points: (0..).zip(colors).map(point).collect(),
            segments: vec![SegmentLight {
                id: 99,
                ends: [Vec3::ZERO, Vec3::X],
                colors: [Vec3::new(3e25, 1.0, 0.0), Vec3::ONE],
                samples: 1,
            }],
            ..Lights::default()
        };
        let world = World {
            lights: Arc::new(lights),
            ..World::default()
        };
        Untinted::of(&world, 8, &[], &Gains::default())
    }

    #[test]
    fn the_colours_of_usual_lights_are_taken_whole_and_of_others_what_leaves_a_usual_value() {
        let usual = [
            Vec3::ZERO,
            Vec3::new(4e4, 0.0, 3.0),
            Vec3::splat(4e-5),
            Vec3::new(1.0, 1e-30, 0.0),
        ];
        let found = untinted(&usual);
        for (plane, color) in (1..).zip(usual) {
            assert_eq!(found.world.lights.points[plane - 1].color, Vec3::ONE);
            assert_eq!(found.tints[plane], color);
        }
        let unusual = [Vec3::new(1e20, 1e3, 0.0), Vec3::splat(1e-12), Vec3::MAX];
        let found = untinted(&unusual);
        for (plane, color) in (1..).zip(unusual) {
            let (light, tint) = (
                found.world.lights.points[plane - 1].color,
                found.tints[plane],
            );
            assert_eq!(light * tint, color);
            assert!(light.x.log2().fract() == 0.0 && light == Vec3::splat(light.x));
            assert!((5e-8..5e9).contains(&tint.x), "{color}: {tint}");
        }
        let [first, second] = found.world.lights.segments[0].colors;
        let tint = found.tints[4];
        assert_eq!(
            [first * tint, second * tint],
            [Vec3::new(3e25, 1.0, 0.0), Vec3::ONE]
        );
    }
}
