//! Wavefront OBJ and MTL, each line read once: [`super::text`] makes lines of bytes, [`statements`] and [`mtl`] say what they
//! mean, [`parts`] makes meshes, [`phong`] materials. What cannot be used is noted, with its line, and the rest is
//! shown.

mod content;
mod mtl;
mod parts;
mod phong;
mod read;
mod statements;
mod write;
mod write_mtl;
mod written_pictures;

use super::text;
use std::path::Path;

pub(crate) use read::read_obj;
pub(crate) use write::{mtl_of, write_obj};

/// The longest start, in bytes, of the names of files that an OBJ brings along: what comes behind it has to fit into the
/// 255 that most systems take.
const LONGEST_STEM: usize = 200;

/// How the names of files begin that are written beside an MTL: as its own, without the extension.
fn stem_of(mtl: &Path) -> String {
    let stem = mtl.file_stem().unwrap_or_default().to_string_lossy();
    stem[..stem.floor_char_boundary(LONGEST_STEM)].to_owned()
}
