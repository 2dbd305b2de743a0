//! The tracer: what rays read, and what they carry.
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
mod camera_rays;
mod crossings;
mod cut_out;
mod digest;
mod direct;
mod disc;
mod dome;
mod dome_table;
mod emitters;
mod environment;
mod faint;
mod first_hit;
mod footprint;
mod gains;
mod in_view;
mod known;
mod lamp;
mod light_columns;
mod light_frames;
pub mod lights;
mod material;
mod mipmap;
mod nearest;
mod needs;
mod normal_map;
mod numbers;
mod parallelogram_frame;
mod parallelogram_warp;
mod paths;
mod piecewise;
pub mod planes;
mod polynomials;
mod probe;
mod questions;
mod radiance;
mod ray_counts;
mod ray_tree;
mod receiver;
mod recorder;
mod replies;
mod sampler;
mod scatter;
mod second_hits;
mod segment_warp;
pub mod shading;
mod shadow_rays;
mod sobol;
mod spot_cone;
pub mod srgb;
mod sun_disc;
mod surface;
#[cfg(test)]
mod test_scene;
mod texels;
mod texture;
mod transmittance;
mod vectors;
mod vertices;
mod visibility;
mod visible_lights;
mod world;
mod wrap;

pub use camera::{Camera, ImagePlane, Optics};
pub use crossings::Crossings;
pub use digest::{Digest, digest};
pub use dome::{DOME, Dome};
pub use emitters::emitters;
pub use environment::{Environment, direction_at};
pub use faint::FEW as FEW_LIGHTS;
pub use first_hit::{FirstHit, central_hits, central_ray, first_hits, first_surface};
pub use footprint::Cone;
pub use gains::Gains;
pub use in_view::in_view;
pub use known::Known;
pub use lamp::Lamp;
pub use lights::{
    DirectionalLight, LightPoint, Lights, MovingLight, ParallelogramLight, PointLight, SegmentLight,
};
pub use material::{Map, Material, MaterialSet};
pub use needs::{Needs, samples_per_pixel};
pub use parallelogram_frame::ParallelogramFrame;
pub use parallelogram_warp::Places;
pub use planes::{PlaneSet, Planes, Untinted};
pub use probe::{MOST_RAYS, ProbeError, Samples, probe, probe_while};
pub use radiance::{SampleId, Workspace, radiance, radiance_in_planes};
pub use ray_counts::RayCounts;
pub use ray_tree::{
    Crossing, LightSample, ProbedSample, RayCost, RayEnd, RayHit, RayKind, RayTree, TracedRay,
};
pub use receiver::Receivers;
pub use recorder::LightKind;
pub use sampler::{Purpose, Sampler};
pub use second_hits::SecondHit;
pub use segment_warp::{SegmentFrame, SegmentPlaces};
pub use spot_cone::SpotCone;
pub use sun_disc::SunDisc;
pub use surface::Surface;
pub use texels::Texels;
pub use texture::{Texture, TextureError};
pub use visibility::{Visibility, other_points};
pub use world::{Mesh, Object, World};
pub use wrap::Reading;
