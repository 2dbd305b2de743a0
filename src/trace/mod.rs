//! The tracer: what rays read, and what they carry.
//!
//! [`World`] is everything a ray may ask for, as flat arrays. [`Camera`] turns a place in the
//! picture into a ray. [`radiance`](radiance()) takes a batch of [`SampleId`]s and gives each its
//! value, going bounce by bounce: all rays of a bounce are handed to the trees together, then all
//! hits are shaded, then all their shadow rays are handed over together.
//!
//! A sample's randomness depends on its pixel, its index and the seed alone ([`Sampler`]), so a
//! sample can be evaluated again by itself, in any order, on any thread, with the same result.
//!
//! [`probe`](probe()) evaluates samples again and keeps every ray of theirs, for those who want to see why
//! a pixel has its colour.
//!
//! Formulas: the module docs of [`lights`], [`shading`] and [`camera`].

pub mod camera;
mod digest;
mod direct;
mod disc;
mod emitters;
mod environment;
mod first_hit;
mod footprint;
pub mod lights;
mod material;
mod mipmap;
mod near_lights;
mod needs;
mod probe;
mod radiance;
mod ray_tree;
mod recorder;
mod sampler;
mod scatter;
pub mod shading;
pub mod srgb;
mod surface;
mod texture;
mod world;

pub use camera::{Camera, ImagePlane, Optics};
pub use digest::{Digest, digest};
pub use emitters::emitters;
pub use environment::Environment;
pub use first_hit::{FirstHit, central_hits, central_ray, first_hits};
pub use footprint::Cone;
pub use lights::{
    DirectionalLight, LightPoint, Lights, ParallelogramLight, PointLight, SegmentLight, SpotCone,
};
pub use material::Material;
pub use needs::{Needs, samples_per_pixel};
pub use probe::{MOST_RAYS, ProbeError, Samples, probe};
pub use radiance::{RayCounts, SampleId, Workspace, radiance};
pub use ray_tree::{
    Crossing, LightSample, ProbedSample, RayCost, RayEnd, RayHit, RayKind, RayTree, TracedRay,
};
pub use recorder::LightKind;
pub use sampler::{Purpose, Sampler};
pub use surface::Surface;
pub use texture::{Texels, Texture, TextureError};
pub use world::{Mesh, Object, World};
