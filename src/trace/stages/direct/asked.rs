//! What vertices are to know of a light before they are given points of it.

use crate::scene::Lighting;
use crate::trace::Surface;
use crate::trace::light_sampling::faint::mean;
use crate::trace::light_sampling::lamp::Lamp;
use crate::trace::light_sampling::light_frames::Frame;
use crate::trace::random::numbers::Pairs;
use crate::trace::world::lights::{LightPoint, MIDDLE};
use glam::Vec3;

/// A light as it is asked for points.
pub(super) struct Asked<'a> {
    pub lamp: Lamp<'a>,
    /// What choosing its points for a surface takes, where they are not all alike.
    pub frame: Option<&'a Frame>,
    /// Whether more than its middle is asked for.
    pub has_extent: bool,
    /// What adds less is asked for by chance; 0 where nothing is.
    pub faint: f32,
    /// Its first one among the points of all lights that a first hit asks for.
    pub first: u32,
}

impl Asked<'_> {
    /// How likely a point is asked for that adds so much if nothing is in the way.
    #[inline(always)]
    pub fn chance(&self, value: Vec3) -> f32 {
        let brightness = mean(value);
        if brightness < self.faint {
            brightness / self.faint
        } else {
            1.0
        }
    }

    /// Whether the point of a question is.
    #[inline(always)]
    pub fn is_asked(&self, value: Vec3, chances: &[f32], question: usize) -> bool {
        if self.faint == 0.0 {
            return true;
        }
        let chance = self.chance(value);
        // A number tells no smaller chances.
        chance >= f32::EPSILON && chances[question] < chance
    }

    /// The point that numbers choose for a surface at `from`, by itself.
    pub fn point(
        &self,
        surface: &Surface,
        from: Vec3,
        numbers: [f32; 2],
        lighting: Lighting,
    ) -> Option<LightPoint> {
        match self.frame {
            _ if !self.has_extent => self.lamp.middle(surface, from, lighting),
            None => self.lamp.point(surface, from, numbers, lighting),
            Some(frame) => self.lamp.point_for(frame, surface, from, numbers),
        }
    }
}

/// The numbers that choose the point of a question, where any do.
pub(super) fn numbers_of(asked: &Asked, numbers: &Pairs, question: usize) -> [f32; 2] {
    if asked.has_extent {
        numbers.get(question)
    } else {
        MIDDLE
    }
}
