//! glTF 2.0. [`json`] reads the document with tolerance and knows in the end what nobody asked for; [`accessors`] the
//! bytes behind it, with every offset checked.
//!
//! Nodes become entities with `ChildOf`, as deep as the file has them, so that a model stays
//! editable. A node's only content sits on its own entity, several contents on children of it.
//! How materials, lights and cameras are mapped: [`material`] and [`lamps`], with the environment in [`environment`]; what deforms: [`rest`].

mod accessors;
mod document;
mod environment;
mod glb;
mod json;
mod json_text;
mod lamps;
mod material;
mod nodes;
mod not_finite;
mod pictures;
mod placement;
mod primitive;
mod read;
mod rest;
mod texture;
mod uri;
mod write;

pub(crate) use document::Document;
pub(crate) use read::{read_gltf, read_texture};
pub(crate) use write::write_glb;
