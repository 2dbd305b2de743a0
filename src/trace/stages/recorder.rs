//! Watching [`radiance`](super::radiance::radiance()) at work. The batch tells a [`Recorder`] what it does, in
//! the order in which it does it; `()` listens to nothing, and compiles to nothing.

use super::paths::Path;
use crate::bvh::{Hit, Ray};
use crate::trace::{LightKind, LightPoint, Surface};
use glam::Vec3;

/// How a path goes on from a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::trace) enum Way {
    Mirror,
    Gloss,
    Straight,
    Translucent,
}

/// Whatever adds a value to a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::trace) enum Adding {
    /// The path with this number of the bounce.
    Path(u32),
    /// The light's point with this number of the bounce.
    Light(u32),
}

/// A point of a light, as a surface sees it.
pub(in crate::trace) struct LitPoint<'a> {
    /// Number of the path that met the surface.
    pub path: u32,
    pub kind: LightKind,
    pub id: u64,
    /// How many such points share the light; `None` where it is taken for a single point.
    pub count: Option<u32>,
    pub surface: &'a Surface,
    pub point: LightPoint,
}

/// Told of every ray and of everything that is added to a sample. Paths have their numbers in the bounce, in the order in
/// which they were continued; points of lights have theirs. Every method has an empty body, so that a batch without a
/// recorder is the same code as one that knows none.
pub(in crate::trace) trait Recorder {
    /// Whether anything is done with what it is told: what only it wants to know is else not looked up.
    const LISTENS: bool = true;

    /// The next path starts at the camera.
    #[inline(always)]
    fn camera_ray(&mut self, _ray: &Ray) {}
    /// The paths that were continued are traced next.
    #[inline(always)]
    fn next_bounce(&mut self) {}
    /// A path met nothing.
    #[inline(always)]
    fn met_background(&mut self, _path: u32, _radiance: Vec3) {}
    /// It met a visible light at `t`.
    #[inline(always)]
    fn met_light(&mut self, _path: u32, _id: u64, _t: f32, _radiance: Vec3) {}
    /// It met a surface.
    #[inline(always)]
    fn met_surface(&mut self, _path: u32, _hit: &Hit, _surface: &Surface) {}
    /// Radiance that the surface sends back by itself: its emission, or kd where shading is off.
    #[inline(always)]
    fn shines(&mut self, _path: u32, _radiance: Vec3) {}
    /// A point of a light that may shine on a surface.
    #[inline(always)]
    fn light_sample(&mut self, _point: u32, _lit: &LitPoint) {}
    /// So little comes from it that it gets a shadow ray with this probability, and whether it does.
    #[inline(always)]
    fn left_to_chance(&mut self, _point: u32, _chance: f32, _is_asked: bool) {}
    /// It gets a shadow ray.
    #[inline(always)]
    fn shadow_ray(&mut self, _point: u32, _ray: &Ray) {}
    /// That part of the light arrives. Not called where a shadow ray is blocked outright.
    #[inline(always)]
    fn arrived(&mut self, _point: u32, _transmittance: Vec3) {}
    /// The path goes on as `next` along `ray`, one of `count` that share what arrives; `weight` is one over the
    /// probability with which this way was taken.
    #[inline(always)]
    fn continued(
        &mut self,
        _path: u32,
        _ray: &Ray,
        _next: &Path,
        _way: Way,
        _count: u32,
        _weight: f32,
    ) {
    }
    /// A value was added to a sample.
    #[inline(always)]
    fn added(&mut self, _by: Adding, _value: Vec3) {}
}

impl Recorder for () {
    const LISTENS: bool = false;
}
