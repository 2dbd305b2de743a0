//! glTF 2.0. The `gltf` crate parses and checks the JSON; what it would trust, the bytes behind
//! accessors, is checked here before it is read.
//!
//! Nodes become entities with `ChildOf`, as deep as the file has them, so that a model stays
//! editable. A node's only content sits on its own entity, several contents on children of it.
//! How materials, lights and cameras are mapped: [`material`] and [`lamps`].

mod accessors;
mod document;
mod glb;
mod lamps;
mod material;
mod primitive;
mod read;
mod uri;
mod write;

pub(crate) use document::Document;
pub(crate) use read::{read_gltf, read_texture};
pub(crate) use write::write_glb;
