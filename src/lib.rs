//! Glassbox: a scene editor whose ray tracer you can see into.
//!
//! Bevy entities are the scene. Systems carry what changed of them to a CPU ray tracer; the tracer
//! draws a picture, and can show what it did to get there.
//!
//! The crate is divided into rooms, its modules, in layers: from the ground up, each uses only those
//! before it.
//!
//! | room | holds |
//! |---|---|
//! | [`scene`] | the components: plain reflected data, no systems |
//! | [`bvh`] | triangles, builders, traversal, statistics; knows no scene |
//! | [`trace`] | the world that rays read, camera, lights, textures, sampler, radiance |
//! | [`film`] | pixels: samples become a picture, the picture becomes a screen's |
//! | [`inspect`] | what the tracer did, as lines and figures: rays, nodes, normals, samples, motion |
//! | [`sync`] | entities to the tracer's world: what changed, and only that |
//! | [`io`] | scene files, OBJ, glTF, STL, PLY, pictures, shapes, built-in scenes |
//! | [`app`] | the rooms above as one app without a window |
//! | [`report`] | speed against error: kernels, sampling, features, hard cases |
//! | `view` | the traced picture in a Bevy camera, gizmos; the only room that knows Bevy's renderer |
//! | `editor` | the window: panels, gestures, undo, files; the only room that knows egui |
//! | [`cli`] | the command line: parses, calls, prints |
//!
//! [`bvh`] and [`trace`] need no ECS: see `examples/plain_rust.rs`. What a Bevy app mostly names is in
//! [`prelude`].

pub mod app;
pub mod bvh;
pub mod cli;
#[cfg(feature = "editor")]
pub mod editor;
pub mod film;
pub mod inspect;
mod instruction_sets;
pub mod io;
pub mod prelude;
pub mod report;
pub mod scene;
pub mod sync;
pub mod trace;
#[cfg(feature = "view")]
pub mod view;
