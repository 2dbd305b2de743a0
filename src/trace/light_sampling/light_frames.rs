//! Points of lights that are chosen for the surface that sees them: what is known of each light, and one point at a time.

use super::parallelogram_frame::ParallelogramFrame;
use super::receiver::Receivers;
use super::segment_warp::SegmentFrame;
use crate::trace::world::lights::{MIDDLE, inverse_square, towards};
use crate::trace::{LightPoint, ParallelogramLight, SegmentLight, Surface};
use glam::Vec3;

/// What choosing points of a light for the surfaces that see it needs to know of it.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) enum Frame {
    Segment(SegmentFrame),
    Parallelogram(ParallelogramFrame),
}

impl SegmentLight {
    /// What choosing its points for a surface needs to know of it; `None` where it is so short that its points are chosen evenly.
    pub fn frame(&self) -> Option<SegmentFrame> {
        SegmentFrame::new(self.ends, &self.colors)
    }

    /// The point that the number `u` in [0, 1) chooses for a surface at `from`, Physical; `None` where nothing can
    /// arrive. The frame is the light's own.
    pub fn point_for(
        &self,
        frame: &SegmentFrame,
        surface: &Surface,
        from: Vec3,
        u: f32,
    ) -> Option<LightPoint> {
        let receivers = Receivers::of(surface, from);
        let chosen = if surface.specular == Vec3::ZERO {
            frame.matt_places(&receivers, &[u])
        } else {
            frame.glossy_places(&receivers, &[u])
        };
        self.chosen(from, chosen.u[0], chosen.arriving[0])
    }

    /// The point at that place, of which so much arrives at `from` per unit of its colour, for its density.
    pub(in crate::trace) fn chosen(&self, from: Vec3, u: f32, arriving: f32) -> Option<LightPoint> {
        if !(arriving > 0.0 && arriving < f32::INFINITY) {
            return None;
        }
        let (direction, distance) = towards(self.offset(from, u))?;
        let length = (self.ends[1] - self.ends[0]).length();
        Some(LightPoint {
            direction,
            distance,
            arriving: self.color(u) * arriving,
            place: [u, MIDDLE[1]],
            density: length * inverse_square(distance) / arriving,
        })
    }
}

impl ParallelogramLight {
    /// What choosing its points for a place needs to know of it; `None` where it is so thin that its points are chosen
    /// evenly.
    pub fn frame(&self) -> Option<ParallelogramFrame> {
        ParallelogramFrame::new(self.corner, self.edges, &self.colors, self.two_sided)
    }

    /// The point that the numbers `u` in [0, 1)² choose for a surface at `from`, Physical; `None` where nothing can arrive.
    /// The frame is the light's own.
    pub fn point_for(
        &self,
        frame: &ParallelogramFrame,
        surface: &Surface,
        from: Vec3,
        u: [f32; 2],
    ) -> Option<LightPoint> {
        let receivers = Receivers::of(surface, from);
        let numbers = u.map(|number| [number]);
        let chosen = if surface.specular == Vec3::ZERO {
            frame.matt_places(&receivers, &numbers)
        } else {
            frame.glossy_places(&receivers, &numbers)
        };
        self.chosen(from, chosen.uv.map(|[place]| place), chosen.solid_angle[0])
    }

    /// The point at that place, chosen with a density of one in `solid_angle` sr as `from` sees it.
    pub(in crate::trace) fn chosen(
        &self,
        from: Vec3,
        [u, v]: [f32; 2],
        solid_angle: f32,
    ) -> Option<LightPoint> {
        if !(solid_angle > 0.0 && solid_angle < f32::INFINITY) {
            return None;
        }
        let (direction, distance) = towards(self.offset(from, [u, v]))?;
        let facing = direction.dot(self.area_normal()).abs();
        Some(LightPoint {
            direction,
            distance,
            arriving: self.color(u, v) * solid_angle,
            place: [u, v],
            density: facing * inverse_square(distance) / solid_angle,
        })
    }
}
