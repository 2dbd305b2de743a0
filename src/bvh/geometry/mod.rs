//! What rays meet: meshes, their places, and where on them a hit lies.
//!
//! [`mesh_tree`] is a mesh with its tree, [`instance`] a mesh in the world, [`aggregate`] all of them. [`support`] tells how far a mesh
//! reaches, [`wedges`] how narrow the spaces between its triangles are; [`surface_point`] where a hit lies, [`leave`] where a ray
//! starts that leaves it.

pub(super) mod aggregate;
pub(super) mod instance;
mod leave;
pub(super) mod mesh_tree;
mod support;
mod surface_point;
mod wedges;

pub use aggregate::{Aggregate, Primitive};
pub use instance::{Instance, SingularTransform};
pub use mesh_tree::MeshTree;
pub use surface_point::{NearEdge, SurfacePoint};
pub(crate) use surface_point::{Placement, beyond_error};
