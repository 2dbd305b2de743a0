//! Scenes and models through files and back.

pub mod app;
mod gltf;
mod models;
mod names;
mod pictures;
mod round_trip;
mod sets;
