//! Scenes and models through files and back.

pub mod app;
mod gltf;
pub mod models;
mod obj;
mod round_trip;
