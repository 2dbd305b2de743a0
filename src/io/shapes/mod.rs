//! The shapes that Glassbox generates, and the pictures that it generates for them.
//!
//! Closed shapes are closed bit for bit: where two parts meet, both compute the same place from the
//! same numbers, so that no ray finds a gap.

mod flat;
mod grid;
mod head;
mod knot;
mod picture;
mod round;
mod surface;
mod teapot;

#[cfg(test)]
mod check;
#[cfg(test)]
mod tests;

pub use picture::{NAMES as PICTURES, PictureError, SUN, texture};

use crate::scene::Shape;
use bevy::math::{DVec2, DVec3};
use bevy::mesh::Mesh;
use thiserror::Error;

/// The most triangles that a shape may have: ten million and as much again; more would be a slip
/// of the keyboard, and take gigabytes.
pub const MOST_TRIANGLES: u64 = 20_000_000;

/// Why a shape cannot be made.
#[derive(Error, Debug, Clone, PartialEq)]
pub enum ShapeError {
    /// A number is NaN or infinite.
    #[error("{shape}: `{field}` is not a finite number")]
    NotFinite {
        /// The shape's name.
        shape: &'static str,
        /// Which of its numbers.
        field: &'static str,
    },
    /// A length is zero or negative.
    #[error("{shape}: `{field}` is {value}; it must be greater than 0")]
    NotPositive {
        /// The shape's name.
        shape: &'static str,
        /// Which of its numbers.
        field: &'static str,
        /// What it is.
        value: f64,
    },
    /// Too few divisions to enclose anything.
    #[error("{shape}: `{field}` is {count}; at least {least} are needed")]
    TooFew {
        /// The shape's name.
        shape: &'static str,
        /// Which of its numbers.
        field: &'static str,
        /// What it is.
        count: u64,
        /// What it must be.
        least: u64,
    },
    /// More than [`MOST_TRIANGLES`].
    #[error("{shape}: these divisions make {triangles} triangles; {MOST_TRIANGLES} are the most")]
    TooManyTriangles {
        /// The shape's name.
        shape: &'static str,
        /// How many it would have.
        triangles: u64,
    },
    /// All corners on one line.
    #[error("{shape}: its corners lie on one line, so it has no area and no normal")]
    NoArea {
        /// The shape's name.
        shape: &'static str,
    },
    /// Corners that do not go around a convex polygon.
    #[error("{shape}: its corners do not go once around a convex polygon")]
    NotConvex {
        /// The shape's name.
        shape: &'static str,
    },
    /// A knot that would run over itself.
    #[error("Knot: `p` = {p} and `q` = {q} have a common divisor; the knot would run over itself")]
    NotCoprime {
        /// Turns around the axis.
        p: u32,
        /// Turns through the hole.
        q: u32,
    },
    /// Places beyond the range of `f32`, or so small that they fall together.
    #[error("{shape}: its numbers are too large or too small for 32-bit coordinates")]
    OutOfRange {
        /// The shape's name.
        shape: &'static str,
    },
}

/// The mesh of a shape: a triangle list with `u32` indices, positions, unit normals that point
/// outwards, and texture coordinates (u right, v down). Triangles are counter-clockwise seen from
/// outside. The same shape gives the same mesh bit for bit.
pub fn mesh(shape: &Shape) -> Result<Mesh, ShapeError> {
    surface(shape)?.into_mesh(name(shape))
}

/// How many triangles a shape has, or what is wrong with its numbers, without making it.
pub fn triangle_count(shape: &Shape) -> Result<u64, ShapeError> {
    let name = name(shape);
    let at_least = |field, count: u32, least: u32| match count < least {
        true => Err(ShapeError::TooFew {
            shape: name,
            field,
            count: count.into(),
            least: least.into(),
        }),
        false => Ok(u64::from(count)),
    };
    let grid = |columns: (&'static str, u32), rows: (&'static str, u32, u32)| {
        let (columns, rows) = (
            at_least(columns.0, columns.1, 3)?,
            at_least(rows.0, rows.1, rows.2)?,
        );
        Ok::<_, ShapeError>((columns, rows))
    };
    let triangles = match *shape {
        Shape::Triangle { .. } => 1,
        Shape::Quad { .. } | Shape::Quadrilateral { .. } | Shape::Ground { .. } => 2,
        Shape::Cuboid { .. } => 12,
        Shape::Prism { ref base, .. } => {
            let corners = u32::try_from(base.len()).unwrap_or(u32::MAX);
            4 * at_least("base", corners, 3)? - 4
        }
        Shape::Sphere {
            segments, rings, ..
        }
        | Shape::Head { segments, rings } => {
            let (columns, rows) = grid(("segments", segments), ("rings", rings, 2))?;
            columns.saturating_mul(rows - 1).saturating_mul(2)
        }
        Shape::Cylinder { segments, .. } => 4 * at_least("segments", segments, 3)?,
        Shape::Torus {
            segments, sides, ..
        }
        | Shape::Knot {
            segments, sides, ..
        } => {
            let (columns, rows) = grid(("segments", segments), ("sides", sides, 3))?;
            columns.saturating_mul(rows).saturating_mul(2)
        }
        Shape::Teapot { divisions } => {
            let n = at_least("divisions", divisions, 1)?;
            // Eight patches end in a point, where a row of triangles is missing.
            n.saturating_mul(n).saturating_mul(64).saturating_sub(8 * n)
        }
    };
    match triangles > MOST_TRIANGLES {
        true => Err(ShapeError::TooManyTriangles {
            shape: name,
            triangles,
        }),
        false => Ok(triangles),
    }
}

/// The shape's triangles, its numbers checked.
fn surface(shape: &Shape) -> Result<surface::Surface, ShapeError> {
    let name = name(shape);
    triangle_count(shape)?;
    let finite = |field, values: &[f32]| match values.iter().all(|x| x.is_finite()) {
        true => Ok(()),
        false => Err(ShapeError::NotFinite { shape: name, field }),
    };
    let length = |field, value: f32| {
        finite(field, &[value])?;
        match value > 0.0 {
            true => Ok(f64::from(value)),
            false => Err(ShapeError::NotPositive {
                shape: name,
                field,
                value: value.into(),
            }),
        }
    };
    match *shape {
        Shape::Triangle { corners } => {
            corners
                .iter()
                .try_for_each(|c| finite("corners", &c.to_array()))?;
            flat::triangle(corners.map(|c| c.as_dvec3()))
        }
        Shape::Quad { corner, edges } => {
            finite("corner", &corner.to_array())?;
            edges
                .iter()
                .try_for_each(|e| finite("edges", &e.to_array()))?;
            flat::quad(corner.as_dvec3(), edges.map(|e| e.as_dvec3()))
        }
        Shape::Ground { size, tile } => {
            let size = DVec2::new(length("size.x", size.x)?, length("size.y", size.y)?);
            let tile = DVec2::new(length("tile.x", tile.x)?, length("tile.y", tile.y)?);
            Ok(flat::ground(size, tile))
        }
        Shape::Quadrilateral { corners } => {
            corners
                .iter()
                .try_for_each(|c| finite("corners", &c.to_array()))?;
            flat::quadrilateral(corners.map(|c| c.as_dvec3()))
        }
        Shape::Cuboid { size } => {
            let [x, y, z] = size.to_array();
            let size = DVec3::new(
                length("size.x", x)?,
                length("size.y", y)?,
                length("size.z", z)?,
            );
            Ok(flat::cuboid(size))
        }
        Shape::Prism { ref base, height } => {
            base.iter()
                .try_for_each(|c| finite("base", &c.to_array()))?;
            let base: Vec<DVec2> = base.iter().map(|c| c.as_dvec2()).collect();
            flat::prism(&base, length("height", height)?)
        }
        Shape::Sphere {
            radius,
            segments,
            rings,
        } => Ok(round::sphere(length("radius", radius)?, segments, rings)),
        Shape::Cylinder {
            radius,
            height,
            segments,
        } => {
            let (radius, height) = (length("radius", radius)?, length("height", height)?);
            Ok(round::cylinder(radius, height, segments))
        }
        Shape::Torus {
            major_radius,
            minor_radius,
            segments,
            sides,
        } => {
            let major = length("major_radius", major_radius)?;
            let minor = length("minor_radius", minor_radius)?;
            Ok(round::torus(major, minor, segments, sides))
        }
        Shape::Teapot { divisions } => Ok(teapot::teapot(divisions)),
        Shape::Head { segments, rings } => Ok(head::head(segments, rings)),
        Shape::Knot {
            p,
            q,
            tube_radius,
            displacement,
            segments,
            sides,
        } => {
            if p == 0 || q == 0 || divisor(p, q) != 1 {
                return Err(ShapeError::NotCoprime { p, q });
            }
            let radius = length("tube_radius", tube_radius)?;
            finite("displacement", &[displacement])?;
            Ok(knot::knot(
                [p, q],
                radius,
                displacement.into(),
                segments,
                sides,
            ))
        }
    }
}

/// The greatest common divisor.
fn divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { divisor(b, a % b) }
}

/// The variant's name, as a scene file writes it.
fn name(shape: &Shape) -> &'static str {
    match shape {
        Shape::Triangle { .. } => "Triangle",
        Shape::Quad { .. } => "Quad",
        Shape::Ground { .. } => "Ground",
        Shape::Quadrilateral { .. } => "Quadrilateral",
        Shape::Cuboid { .. } => "Cuboid",
        Shape::Prism { .. } => "Prism",
        Shape::Sphere { .. } => "Sphere",
        Shape::Cylinder { .. } => "Cylinder",
        Shape::Torus { .. } => "Torus",
        Shape::Teapot { .. } => "Teapot",
        Shape::Head { .. } => "Head",
        Shape::Knot { .. } => "Knot",
    }
}
