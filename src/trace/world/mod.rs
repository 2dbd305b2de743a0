//! What rays read, and nothing that traces: flat arrays of objects, materials, lights.
//!
//! [`arrays`] is the whole of it, [`material`], [`environment`] and [`lights`] (all kinds, with [`spot_cone`] and [`sun_disc`]) what
//! it is made of. [`needs`] tells what of the model it uses at all, [`digest`] names it in a number.

mod arrays;
mod digest;
pub(super) mod environment;
pub mod lights;
mod material;
mod needs;
mod spot_cone;
pub(super) mod sun_disc;

pub use arrays::{Mesh, Object, World};
pub use digest::{Digest, digest};
pub use environment::{Environment, direction_at};
pub use lights::{
    DirectionalLight, LightPoint, Lights, MovingLight, ParallelogramLight, PointLight, SegmentLight,
};
pub use material::{Map, Material, MaterialSet};
pub use needs::{Needs, samples_per_pixel};
pub use spot_cone::SpotCone;
pub use sun_disc::SunDisc;
