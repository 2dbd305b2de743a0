//! Watching [`radiance`](super::radiance()) at work. The batch tells a [`Recorder`] what it does, in
//! the order in which it does it; `()` listens to nothing, and compiles to nothing.

use super::radiance::Path;
use super::{LightPoint, Surface};
use crate::bvh::{Hit, Ray};
use glam::Vec3;

/// Which of the four arrays of [`Lights`](super::Lights) a light is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the names say it all")]
pub enum LightKind {
    Point,
    Directional,
    Segment,
    Parallelogram,
}

/// How a path goes on from a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    Mirror,
    Gloss,
    Straight,
    Translucent,
}

/// Told of every ray and of everything that is added to a sample. Every method has an empty body, so
/// that a batch without a recorder is the same code as one that knows none.
pub(super) trait Recorder {
    /// A path starts at the camera.
    #[inline(always)]
    fn camera_ray(&mut self, _path: &Path) {}
    /// The paths that were continued are traced next.
    #[inline(always)]
    fn next_bounce(&mut self) {}
    /// The next path of this bounce is being shaded.
    #[inline(always)]
    fn next_path(&mut self) {}
    /// It met nothing.
    #[inline(always)]
    fn met_background(&mut self, _radiance: Vec3) {}
    /// It met a visible light at `t`.
    #[inline(always)]
    fn met_light(&mut self, _id: u64, _t: f32, _radiance: Vec3) {}
    /// It met a surface.
    #[inline(always)]
    fn met_surface(&mut self, _hit: &Hit, _surface: &Surface) {}
    /// Radiance that the surface sends back by itself: its emission, or kd where shading is off.
    #[inline(always)]
    fn shines(&mut self, _radiance: Vec3) {}
    /// The following light samples are of this light, of its middle.
    #[inline(always)]
    fn light(&mut self, _kind: LightKind, _id: u64) {}
    /// The following light sample is of this point of the light, one of `count`.
    #[inline(always)]
    fn light_place(&mut self, _point: &LightPoint, _count: u32) {}
    /// A point of a light, as the surface sees it.
    #[inline(always)]
    fn light_sample(&mut self, _surface: &Surface, _point: &LightPoint) {}
    /// The light sample gets a shadow ray.
    #[inline(always)]
    fn shadow_ray(&mut self, _ray: &Ray) {}
    /// The path goes on as `next`, one of `count` that share what arrives; `weight` is one over the
    /// probability with which this way was taken.
    #[inline(always)]
    fn continued(&mut self, _next: &Path, _way: Way, _count: u32, _weight: f32) {}
    /// The next shadow ray of this bounce is being traced.
    #[inline(always)]
    fn next_shadow(&mut self) {}
    /// The shadow ray crosses a surface that may let light through.
    #[inline(always)]
    fn crossed(&mut self, _hit: &Hit, _surface: &Surface) {}
    /// That part of the light arrives. Not called where a shadow ray is blocked outright.
    #[inline(always)]
    fn arrived(&mut self, _transmittance: Vec3) {}
    /// A value was added to a sample: by the path that is being shaded, by its last light sample, or
    /// by the shadow ray that is being traced.
    #[inline(always)]
    fn added(&mut self, _value: Vec3) {}
}

impl Recorder for () {}
