//! Scenes and models through files and back.

pub mod app;
mod exports;
mod framing;
pub mod gltf;
mod gltf_materials;
mod gltf_pictures;
mod gltf_rest;
mod gltf_tangents;
mod materials;
pub mod models;
mod names;
mod obj;
mod obj_unusual;
mod opacity;
mod pictures;
mod ply;
mod round_trip;
mod sets;
mod stl;
mod versions;
