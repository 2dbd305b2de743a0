//! Wavefront OBJ and MTL. `tobj` parses; [`lines`] watches the lines go by, so that an error knows
//! its line, and [`blame`] finds the line of an error that shows only later.

mod blame;
mod lines;
mod mtl;
mod read;
mod write;
mod write_mtl;

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
