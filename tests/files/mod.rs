//! Scenes and models through files and back.

pub mod app;
mod gltf;
pub mod models;
mod names;
mod obj;
mod pictures;
mod ply;
mod round_trip;
mod sets;
mod stl;
