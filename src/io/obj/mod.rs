//! Wavefront OBJ and MTL, each line read once: [`text`] makes lines of bytes, [`statements`] and [`mtl`] say what they
//! mean, [`parts`] makes meshes, [`phong`] materials. What cannot be used is noted, with its line, and the rest is
//! shown.

mod content;
mod mtl;
mod parts;
mod phong;
mod read;
mod statements;
mod text;
mod write;
mod write_mtl;

pub(crate) use read::read_obj;
pub(crate) use write::write_obj;
