//! Wavefront OBJ and MTL. `tobj` parses; [`lines`] watches the lines go by, so that an error knows
//! its line, and [`blame`] finds the line of an error that shows only later.

mod blame;
mod lines;
mod mtl;
mod read;
mod write;
mod write_mtl;

pub(crate) use read::read_obj;
pub(crate) use write::{mtl_of, write_obj};
