//! Triangles with normals and texture coordinates, as the shapes build them up.

use super::ShapeError;
use bevy::asset::RenderAssetUsages;
use bevy::math::{DVec2, DVec3};
use bevy::mesh::{Indices, Mesh, PrimitiveTopology};
use std::collections::HashMap;

/// A shape smaller than this in metres has too few digits left in `f32`, whose smallest normal
/// number is 1.2e-38.
const SMALLEST_EXTENT: f32 = 1e-30;

/// One entry per vertex, three indices per triangle, counter-clockwise seen from outside.
///
/// Places are computed in f64 and rounded once, so that equal expressions give equal bits: that is
/// what makes a closed shape closed.
#[derive(Default)]
pub(super) struct Surface {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub indices: Vec<u32>,
}

impl Surface {
    /// Adds a vertex and returns its index. `normal` may have any length.
    pub fn vertex(&mut self, position: DVec3, normal: DVec3, uv: DVec2) -> u32 {
        let index = self.positions.len() as u32;
        self.positions.push(rounded(position));
        self.normals.push(rounded(normal.normalize_or_zero()));
        self.uvs.push(uv.as_vec2().to_array());
        index
    }

    /// Adds the triangle of three vertices that exist.
    pub fn triangle(&mut self, corners: [u32; 3]) {
        self.indices.extend_from_slice(&corners);
    }

    /// Adds a triangle of its own three vertices, flat.
    pub fn flat_triangle(&mut self, corners: [DVec3; 3], uvs: [DVec2; 3]) {
        let normal = normal_of(corners);
        let indices = [0, 1, 2].map(|k| self.vertex(corners[k], normal, uvs[k]));
        self.triangle(indices);
    }

    /// Adds a flat parallelogram: its normal along `edges[0] × edges[1]`, the whole texture on it,
    /// the texture's lower left at `corner`, its right along `edges[0]`, its top along `edges[1]`.
    pub fn flat_parallelogram(&mut self, corner: DVec3, edges: [DVec3; 2]) {
        let [right, up] = edges;
        let normal = normal_of([corner, corner + right, corner + up]);
        let [a, b, c, d] = [
            (corner, DVec2::new(0.0, 1.0)),
            (corner + right, DVec2::new(1.0, 1.0)),
            (corner + right + up, DVec2::new(1.0, 0.0)),
            (corner + up, DVec2::new(0.0, 0.0)),
        ]
        .map(|(position, uv)| self.vertex(position, normal, uv));
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// Replaces the normals by the mean of the triangles around each place, weighted by their
    /// angle there (Thürmer and Wüthrich, "Computing vertex normals from polygonal facets", 1998).
    /// Vertices at the same place get the same normal, so that a texture's seam is not seen.
    pub fn smooth_normals(&mut self) {
        let mut place_at = HashMap::with_capacity(self.positions.len());
        let places: Vec<usize> = self
            .positions
            .iter()
            .map(|position| {
                let next = place_at.len();
                *place_at.entry(position.map(f32::to_bits)).or_insert(next)
            })
            .collect();
        let mut sums = vec![DVec3::ZERO; place_at.len()];
        for corners in self.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|k| corners[k] as usize);
            let at = corners.map(|i| bevy::math::Vec3::from(self.positions[i]).as_dvec3());
            let normal = normal_of(at);
            for k in 0..3 {
                let to_next = (at[(k + 1) % 3] - at[k]).normalize_or_zero();
                let to_last = (at[(k + 2) % 3] - at[k]).normalize_or_zero();
                let angle = to_next.dot(to_last).clamp(-1.0, 1.0).acos();
                sums[places[corners[k]]] += normal * angle;
            }
        }
        for (normal, &place) in self.normals.iter_mut().zip(&places) {
            *normal = rounded(sums[place].normalize_or_zero());
        }
    }

    /// The finished mesh, unless its numbers left the range of `f32`.
    pub fn into_mesh(self, shape: &'static str) -> Result<Mesh, ShapeError> {
        let coordinates = || self.positions.iter().flatten();
        let mut numbers = coordinates().chain(self.uvs.iter().flatten());
        let finite = numbers.all(|x| x.is_finite());
        let extent = coordinates().fold(0.0_f32, |extent, x| extent.max(x.abs()));
        if !finite || extent < SMALLEST_EXTENT {
            return Err(ShapeError::OutOfRange { shape });
        }
        Ok(Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::default(),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, self.normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, self.uvs)
        .with_inserted_indices(Indices::U32(self.indices)))
    }
}

/// The unit normal on the counter-clockwise side, zero for three corners on one line.
pub(super) fn normal_of([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// To `f32`; adding zero turns -0 into +0, so that equal places have equal bits.
fn rounded(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array().map(|x| x + 0.0)
}
