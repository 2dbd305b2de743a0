//! Lights of all kinds as one list: what a stage that goes from light to light wants to know of each.

use super::dome::{DOME, Dome};
use super::light_frames::Frame;
use crate::scene::{Lighting, RenderSettings};
use crate::trace::world::lights::{
    DirectionalLight, LightPoint, MIDDLE, ParallelogramLight, PointLight, SegmentLight,
    sample_count,
};
use crate::trace::{Lights, Surface, World};
use glam::Vec3;

/// Which of the four arrays of [`Lights`](crate::trace::Lights) a light is in, or that it is the environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the names say it all")]
pub enum LightKind {
    Point,
    Directional,
    Segment,
    Parallelogram,
    Dome,
}

/// A light of any kind.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Lamp<'a> {
    Point(&'a PointLight),
    Directional(&'a DirectionalLight),
    Segment(&'a SegmentLight),
    Parallelogram(&'a ParallelogramLight),
    /// The environment, where it lights.
    Dome(Dome<'a>),
}

impl Lamp<'_> {
    pub(in crate::trace) fn kind(self) -> LightKind {
        match self {
            Self::Point(_) => LightKind::Point,
            Self::Directional(_) => LightKind::Directional,
            Self::Segment(_) => LightKind::Segment,
            Self::Parallelogram(_) => LightKind::Parallelogram,
            Self::Dome(_) => LightKind::Dome,
        }
    }

    /// The entity's `SceneId`, or [`DOME`].
    pub fn id(self) -> u64 {
        match self {
            Self::Point(light) => light.id,
            Self::Directional(light) => light.id,
            Self::Segment(light) => light.id,
            Self::Parallelogram(light) => light.id,
            Self::Dome(_) => DOME,
        }
    }

    /// What tells it from all other lights: an entity may be lamps of several kinds.
    pub fn name(self) -> (LightKind, u64) {
        (self.kind(), self.id())
    }

    /// Shadow rays at a first hit; `None` of a light without extent, and of one that is taken for its middle, which gets
    /// one. A dome has no middle that could stand for it.
    pub fn samples(self, settings: &RenderSettings) -> Option<u32> {
        let features = &settings.features;
        let (samples, size) = match self {
            Self::Dome(dome) => (dome.samples(), dome.solid_angle()),
            Self::Point(_) => return None,
            _ if !features.soft_shadows => return None,
            Self::Directional(light) => {
                light.disc.as_ref()?;
                (light.samples, light.solid_angle())
            }
            Self::Segment(light) => (light.samples, (light.ends[1] - light.ends[0]).length()),
            Self::Parallelogram(light) => (light.samples, light.area_normal().length()),
        };
        Some(sample_count(samples, size, features.scale_light_samples))
    }

    /// What choosing its points for a surface needs to know of it; nothing where all points are alike.
    pub(in crate::trace) fn frame(self) -> Option<Frame> {
        match self {
            Self::Point(_) | Self::Directional(_) | Self::Dome(_) => None,
            Self::Segment(light) => light.frame().map(Frame::Segment),
            Self::Parallelogram(light) => light.frame().map(Frame::Parallelogram),
        }
    }

    /// The point that the numbers choose for a surface at `from`, in the frame that moves with the light.
    pub(in crate::trace) fn point_for(
        self,
        frame: &Frame,
        surface: &Surface,
        from: Vec3,
        u: [f32; 2],
    ) -> Option<LightPoint> {
        match (self, frame) {
            (Self::Segment(light), Frame::Segment(frame)) => {
                light.point_for(frame, surface, from, u[0])
            }
            (Self::Parallelogram(light), Frame::Parallelogram(frame)) => {
                light.point_for(frame, surface, from, u)
            }
            _ => None,
        }
    }

    /// The point that the numbers choose where it has no frame.
    #[inline(always)]
    pub(in crate::trace) fn point(
        self,
        surface: &Surface,
        from: Vec3,
        u: [f32; 2],
        lighting: Lighting,
    ) -> Option<LightPoint> {
        match self {
            Self::Dome(dome) => dome.point_for(surface, u),
            Self::Point(light) => light.point(from, lighting),
            Self::Directional(light) => Some(light.point(u, lighting)),
            Self::Segment(light) => light.point(from, u[0], lighting),
            Self::Parallelogram(light) => light.point(from, u, lighting),
        }
    }

    /// The point that stands for the whole light where there are no soft shadows.
    pub(in crate::trace) fn middle(
        self,
        surface: &Surface,
        from: Vec3,
        lighting: Lighting,
    ) -> Option<LightPoint> {
        match self {
            Self::Directional(light) => Some(light.middle()),
            _ => self.point(surface, from, MIDDLE, lighting),
        }
    }

    /// Whether it is the same light in another world.
    pub fn is_same(self, other: Lamp) -> bool {
        match (self, other) {
            (Self::Point(a), Lamp::Point(b)) => a == b,
            (Self::Directional(a), Lamp::Directional(b)) => a == b,
            (Self::Segment(a), Lamp::Segment(b)) => a == b,
            (Self::Parallelogram(a), Lamp::Parallelogram(b)) => a == b,
            _ => false,
        }
    }

    /// Whether camera and mirror rays see it, and so end at it.
    pub fn is_seen(self) -> bool {
        matches!(self, Self::Parallelogram(light) if light.visible)
    }
}

impl Lights {
    /// All of them, kind by kind. A dome is not among them: it belongs to the environment.
    pub fn all(&self) -> impl Iterator<Item = Lamp<'_>> {
        let points = self.points.iter().map(Lamp::Point);
        let directionals = self.directionals.iter().map(Lamp::Directional);
        let segments = self.segments.iter().map(Lamp::Segment);
        let parallelograms = self.parallelograms.iter().map(Lamp::Parallelogram);
        (points.chain(directionals))
            .chain(segments)
            .chain(parallelograms)
    }

    /// How many there are of all kinds.
    pub fn count(&self) -> usize {
        self.points.len()
            + self.directionals.len()
            + self.segments.len()
            + self.parallelograms.len()
    }

    /// The place in [`Self::all`] of the first parallelogram.
    pub(in crate::trace) fn first_parallelogram(&self) -> usize {
        self.count() - self.parallelograms.len()
    }
}

impl World {
    /// All lights, and the dome where the environment lights.
    pub fn lamps(&self, settings: &RenderSettings) -> impl Iterator<Item = Lamp<'_>> {
        let dome = Dome::of(&self.environment, settings).map(Lamp::Dome);
        self.lights.all().chain(dome)
    }
}
