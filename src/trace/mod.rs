//! The tracer: what rays read, and what they carry.
//!
//! ```text
//! math ── random, textures ── world ── surfaces ── light_sampling ── stages ── survey
//! ```
//! `world` is what rays read, with its `textures`; `surfaces` what they meet there, `light_sampling` where on a light a surface
//! looks for it; `stages` give samples their values, and `survey` answers other questions. Each uses those left of it (but for
//! [`Needs`], which look at how much lights add), and all may use [`camera`].
//!
//! [`World`] is everything a ray may ask for, as flat arrays. [`Camera`] turns a place in the
//! picture into a ray. [`radiance`](radiance()) takes a batch of [`SampleId`]s and gives each its
//! value, going bounce by bounce, and in each stage by stage: all rays are handed to the trees together, all hits become
//! vertices, and for one light after another all of them get points of it, and the trees their shadow rays together.
//! Where a stage costs much it is a loop over columns, compiled for each instruction set.
//!
//! A sample's randomness depends on its pixel, its index and the seed alone ([`Sampler`]), so a
//! sample can be evaluated again by itself, in any order, on any thread, with the same result.
//!
//! [`probe`](probe()) evaluates samples again and keeps every ray of theirs, for those who want to see why
//! a pixel has its colour.
//!
//! Formulas: the module docs of [`lights`], [`shading`] and [`camera`].
//!
//! # Far from the origin
//! Positions are f32: at 1e5 m from the origin they are 8 mm apart, at 1e6 m 6 cm. What two of them are to each other is
//! therefore taken before anything is added: a lamp's corner from the shading point and then its edges, the corner from
//! a ray's start and then the way along the ray, a triangle's edges and not its corners in the world. So a scene looks
//! at 1e6 m as it does at 0, with two exceptions. What the scene itself puts between two such positions (an entity
//! there, the corner of a turned lamp) stands at the nearer of them; and a place that is found or made while tracing (a
//! hit, the start of a ray on a lens, in an orthographic picture or of a moving camera) is off by up to half of their
//! distance in each coordinate: light and what is out of focus shift by that much, what is in focus stays sharp.

pub mod camera;
mod light_sampling;
mod math;
mod random;
mod stages;
mod surfaces;
mod survey;
#[cfg(test)]
mod test_scene;
mod textures;
mod world;

pub use camera::{Camera, ImagePlane, Optics};
pub use light_sampling::{
    DOME, Dome, FEW_LIGHTS, Gains, Lamp, LightKind, ParallelogramFrame, Places, PlaneSet, Planes,
    Receivers, SegmentFrame, SegmentPlaces, Untinted, planes,
};
pub use random::{Purpose, SampleId, Sampler};
pub use stages::{
    Known, RayCounts, SecondHit, Visibility, Workspace, other_points, radiance, radiance_in_planes,
};
pub use surfaces::{Cone, Surface, shading};
pub use survey::{
    Crossing, Crossings, FirstHit, LightSample, MOST_RAYS, ProbeError, ProbedSample, RayCost,
    RayEnd, RayHit, RayKind, RayTree, Samples, TracedRay, central_hits, central_ray, emitters,
    first_hits, first_surface, in_view, probe, probe_while,
};
pub use textures::{Reading, Texels, Texture, TextureError, srgb};
pub use world::{
    Digest, DirectionalLight, Environment, LightPoint, Lights, Map, Material, MaterialSet, Mesh,
    MovingLight, Needs, Object, ParallelogramLight, PointLight, SegmentLight, SpotCone, SunDisc,
    World, digest, direction_at, lights, samples_per_pixel,
};
