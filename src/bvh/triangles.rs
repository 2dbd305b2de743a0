//! The triangles of one mesh: positions and indices, checked once.

use glam::Vec3;
use thiserror::Error;

/// Coordinates up to this size (about 1e12) are traced. Beyond it the products of the triangle test, three
/// coordinates long, could overflow f32: such triangles are left out and counted, such rays miss.
pub const REACH: f32 = (1u64 << 40) as f32;

/// Why a mesh is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TrianglesError {
    /// An index points behind the last position.
    #[error(
        "triangle {triangle}: index {index} is out of range, the mesh has {positions} positions"
    )]
    IndexOutOfRange {
        /// Which triangle, from 0.
        triangle: usize,
        /// The index it holds.
        index: u32,
        /// How many positions there are.
        positions: usize,
    },
    /// More triangles than 32 bits number.
    #[error("a mesh of {triangles} triangles is too large: at most 2^31 are numbered; split it")]
    TooMany {
        /// How many there are.
        triangles: usize,
    },
}

/// Positions in object space, and three of them for each triangle.
#[derive(Clone, Debug, Default)]
pub struct Triangles {
    positions: Vec<Vec3>,
    indices: Vec<[u32; 3]>,
    left_out: u32,
    degenerate: u32,
}

impl Triangles {
    /// Checks the indices, and counts what cannot be traced. Triangles keep their numbers.
    pub fn new(positions: Vec<Vec3>, indices: Vec<[u32; 3]>) -> Result<Self, TrianglesError> {
        if indices.len() > 1 << 31 {
            return Err(TrianglesError::TooMany {
                triangles: indices.len(),
            });
        }
        let mut triangles = Self {
            positions,
            indices,
            left_out: 0,
            degenerate: 0,
        };
        for (number, corners) in triangles.indices.iter().enumerate() {
            for &index in corners {
                if index as usize >= triangles.positions.len() {
                    return Err(TrianglesError::IndexOutOfRange {
                        triangle: number,
                        index,
                        positions: triangles.positions.len(),
                    });
                }
            }
        }
        for triangle in 0..triangles.indices.len() as u32 {
            match triangles.fate(triangle) {
                Fate::Traced => {}
                Fate::LeftOut => triangles.left_out += 1,
                Fate::Degenerate => triangles.degenerate += 1,
            }
        }
        Ok(triangles)
    }

    /// Positions, in object space.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Three positions for each triangle.
    pub fn indices(&self) -> &[[u32; 3]] {
        &self.indices
    }

    /// How many triangles there are, traced or not.
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// How many triangles have a corner that is not finite or beyond [`REACH`]. They are never hit.
    pub fn left_out(&self) -> u32 {
        self.left_out
    }

    /// How many triangles are points or lines: repeated corners, or corners on one line. They are never hit.
    pub fn degenerate(&self) -> u32 {
        self.degenerate
    }

    /// The corners of a triangle, in object space. Panics when `triangle` is no triangle's number.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.indices[triangle as usize].map(|index| self.positions[index as usize])
    }

    /// One of them. Panics when either is no number of one.
    #[inline]
    pub(crate) fn corner(&self, triangle: u32, corner: usize) -> Vec3 {
        self.positions[self.indices[triangle as usize][corner] as usize]
    }

    /// Whether the triangle is in the tree.
    pub(crate) fn is_traced(&self, triangle: u32) -> bool {
        matches!(self.fate(triangle), Fate::Traced)
    }

    fn fate(&self, triangle: u32) -> Fate {
        let [a, b, c] = self.corners(triangle);
        if ![a, b, c]
            .iter()
            .all(|p| p.abs().max_element() <= REACH && p.is_finite())
        {
            return Fate::LeftOut;
        }
        // Edges are exact in f64 but for one rounding, so only a true line, or one within 1e-16 of it, has area zero.
        let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
        if (b - a).cross(c - a) == glam::DVec3::ZERO {
            Fate::Degenerate
        } else {
            Fate::Traced
        }
    }
}

enum Fate {
    Traced,
    LeftOut,
    Degenerate,
}
