//! Light kept apart: which lights a picture has a plane of its own for, and what their colours multiply.
//!
//! Light adds up, and a light's colour is a factor of all that it adds. So a picture is
//! `own + Σ tint · plane`: one plane for what shines by itself (surfaces, the background), and one for what each light
//! adds at a tint of 1. Another tint is another sum of the same planes, without a ray.

use super::gains::times;
use super::{Gains, Lights, World};
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
    /// digit for digit, and chooses the same places. A light that shares a plane shines with its gain by itself, and so does
    /// each of many: how often one of those is asked for hangs on how bright it is.
    pub fn of(world: &World, own: usize, first: &[u64], gains: &Gains) -> Self {
        let planes = Planes::of(&world.lights, own, first);
        let mut taken = vec![Vec3::ONE; planes.count()];
        let mut tints = taken.clone();
        let mut lights = (*world.lights).clone();
        let gains: Vec<Vec3> = lights.all().map(|light| gains.of(light.id())).collect();
        let is_tinted: Vec<bool> = (0..planes.count())
            .map(|plane| world.needs.faint == 0.0 && planes.is_of_one(plane))
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
            let tint = if colors.iter().all(|color| *color == first) {
                first
            } else {
                let brightest = colors.iter().map(|color| color.max_element());
                Vec3::splat(brightest.fold(0.0, f32::max).log2().floor().exp2())
            };
            taken[plane] = tint;
            tints[plane] = times(tint, gain);
            for color in colors {
                *color = Vec3::select(tint.cmpgt(Vec3::ZERO), *color / tint, Vec3::ONE);
            }
        }
        Self {
            world: World {
                lights: Arc::new(lights),
                ..world.clone()
            },
            planes,
            colors: taken,
            tints,
        }
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
