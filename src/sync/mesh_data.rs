//! A Bevy mesh as the tracer keeps it: positions and triangles in a tree, normals, texture
//! coordinates, colours and tangents beside it.

use crate::bvh::{BuildOptions, MeshTree, Triangles};
use crate::trace;
use bevy::asset::RenderAssetUsages;
use bevy::math::{Vec2, Vec3, Vec4};
use bevy::mesh::{
    Indices, Mesh, MeshAccessError, MeshVertexAttributeId, PrimitiveTopology, VertexAttributeValues,
};
use std::sync::Arc;

/// Why a mesh cannot be traced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// The asset is not there: not loaded yet, failed to load, or removed.
    #[error("is not loaded")]
    Missing,
    /// The renderer takes the vertices away, or has taken them.
    #[error("is for the GPU alone; give its asset RenderAssetUsages::MAIN_WORLD too")]
    Extracted,
    /// It has no positions, or they are not three floats each.
    #[error("has no positions of three floats each")]
    NoPositions,
    /// It consists of points or lines.
    #[error("is made of {0:?}, not of triangles")]
    NotTriangles(PrimitiveTopology),
    /// It says more corners than an index can count, or an index that no vertex has.
    #[error("is broken: {0}")]
    Broken(String),
}

/// The mesh with its tree. An empty mesh is one without triangles, not a fault.
pub(super) fn trace_mesh(mesh: &Mesh, options: &BuildOptions) -> Result<trace::Mesh, MeshFault> {
    MeshCopy::of(mesh)?.build(options)
}

/// What the tracer needs of a Bevy mesh, so that its tree can be built while the asset is edited.
pub(super) struct MeshCopy {
    positions: Vec<Vec3>,
    indices: Vec<[u32; 3]>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    colors: Vec<Vec3>,
    alphas: Vec<f32>,
    tangents: Vec<Vec4>,
}

/// What can be read of a mesh at a glance.
fn positions_of(mesh: &Mesh) -> Result<&[[f32; 3]], MeshFault> {
    // Said at once, and not when an edit asks for vertices that are gone by then.
    if !mesh.asset_usage.contains(RenderAssetUsages::MAIN_WORLD) {
        return Err(MeshFault::Extracted);
    }
    match mesh.try_attribute(Mesh::ATTRIBUTE_POSITION) {
        Ok(VertexAttributeValues::Float32x3(values)) => Ok(values),
        Ok(_) | Err(MeshAccessError::NotFound) => Err(MeshFault::NoPositions),
        Err(MeshAccessError::ExtractedToRenderWorld) => Err(MeshFault::Extracted),
    }
}

impl MeshCopy {
    /// What it reads of a mesh, besides indices.
    pub const ATTRIBUTES: [MeshVertexAttributeId; 5] = [
        Mesh::ATTRIBUTE_POSITION.id,
        Mesh::ATTRIBUTE_NORMAL.id,
        Mesh::ATTRIBUTE_UV_0.id,
        Mesh::ATTRIBUTE_COLOR.id,
        Mesh::ATTRIBUTE_TANGENT.id,
    ];

    /// Why it could not be made of a mesh, as far as that is to be seen without a look at its vertices.
    pub fn fault(mesh: &Mesh) -> Option<MeshFault> {
        let topology = mesh.primitive_topology();
        let is_of_triangles = matches!(
            topology,
            PrimitiveTopology::TriangleList | PrimitiveTopology::TriangleStrip
        );
        match positions_of(mesh) {
            Err(fault) => Some(fault),
            Ok(_) if !is_of_triangles => Some(MeshFault::NotTriangles(topology)),
            Ok(_) => None,
        }
    }

    /// Of this mesh, as it is now.
    pub fn of(mesh: &Mesh) -> Result<Self, MeshFault> {
        let positions = positions_of(mesh)?;
        let positions: Vec<Vec3> = positions.iter().copied().map(Vec3::from).collect();
        let count = positions.len();
        let indices = triangle_indices(mesh, count)?;

        // Attributes that do not fit the positions are no use: shading then takes the flat normal.
        let normals: Vec<Vec3> = match mesh.try_attribute(Mesh::ATTRIBUTE_NORMAL) {
            Ok(VertexAttributeValues::Float32x3(values)) if values.len() == count => {
                values.iter().copied().map(Vec3::from).collect()
            }
            _ => Vec::new(),
        };
        let uvs: Vec<Vec2> = match mesh.try_attribute(Mesh::ATTRIBUTE_UV_0) {
            Ok(VertexAttributeValues::Float32x2(values)) if values.len() == count => {
                values.iter().copied().map(Vec2::from).collect()
            }
            _ => Vec::new(),
        };
        let (colors, alphas) = vertex_colors(mesh, count);
        let is_bent = !normals.is_empty() && !uvs.is_empty();
        let tangents = match mesh.try_attribute(Mesh::ATTRIBUTE_TANGENT) {
            Ok(VertexAttributeValues::Float32x4(values)) if is_bent && values.len() == count => {
                values.iter().copied().map(Vec4::from).collect()
            }
            _ => Vec::new(),
        };
        Ok(Self {
            positions,
            indices,
            normals,
            uvs,
            colors,
            alphas,
            tangents,
        })
    }

    /// The mesh with its tree.
    pub fn build(self, options: &BuildOptions) -> Result<trace::Mesh, MeshFault> {
        let triangles = Triangles::new(self.positions, self.indices)
            .map_err(|error| MeshFault::Broken(error.to_string()))?;
        Ok(trace::Mesh {
            tree: Arc::new(MeshTree::build(triangles, options)),
            normals: self.normals,
            uvs: self.uvs,
            colors: self.colors,
            alphas: self.alphas,
            tangents: self.tangents,
        })
    }
}

/// The colours and alphas of as many vertices, in [0, 1]; none where they would change nothing.
fn vertex_colors(mesh: &Mesh, count: usize) -> (Vec<Vec3>, Vec<f32>) {
    let colors: Vec<Vec4> = match mesh.try_attribute(Mesh::ATTRIBUTE_COLOR) {
        Ok(VertexAttributeValues::Float32x4(values)) => {
            values.iter().copied().map(Vec4::from).collect()
        }
        Ok(VertexAttributeValues::Unorm8x4(values)) => {
            let parts = values.iter().map(|value| value.map(f32::from));
            parts.map(|value| Vec4::from(value) / 255.0).collect()
        }
        _ => Vec::new(),
    };
    // What is no number is black, and in full.
    let number = |c: f32, otherwise: f32| {
        if c.is_nan() {
            otherwise
        } else {
            c.clamp(0.0, 1.0)
        }
    };
    let clean = |c: Vec4| {
        let rgb = c.truncate().to_array().map(|channel| number(channel, 0.0));
        Vec3::from(rgb).extend(number(c.w, 1.0))
    };
    let colors: Vec<Vec4> = colors.into_iter().map(clean).collect();
    if colors.len() != count || colors.iter().all(|&color| color == Vec4::ONE) {
        return (Vec::new(), Vec::new());
    }
    let alphas = if colors.iter().all(|color| color.w == 1.0) {
        Vec::new()
    } else {
        colors.iter().map(|color| color.w).collect()
    };
    (colors.into_iter().map(Vec4::truncate).collect(), alphas)
}

/// Three indices a triangle. A list's surplus indices are no triangle, as in Bevy; every other
/// triangle of a strip is turned over, so that all of them face the same way.
fn triangle_indices(mesh: &Mesh, vertices: usize) -> Result<Vec<[u32; 3]>, MeshFault> {
    let topology = mesh.primitive_topology();
    if vertices > u32::MAX as usize {
        return Err(MeshFault::Broken(format!("{vertices} vertices")));
    }
    let in_order: Vec<u32>;
    let wide: Vec<u32>;
    let indices: &[u32] = match mesh.try_indices_option() {
        Ok(Some(Indices::U32(indices))) => indices,
        Ok(Some(Indices::U16(indices))) => {
            wide = indices.iter().copied().map(u32::from).collect();
            &wide
        }
        Ok(None) => {
            in_order = (0..vertices as u32).collect();
            &in_order
        }
        Err(_) => return Err(MeshFault::Extracted),
    };
    match topology {
        PrimitiveTopology::TriangleList => Ok(indices.as_chunks().0.to_vec()),
        PrimitiveTopology::TriangleStrip => Ok(indices
            .array_windows()
            .enumerate()
            .map(|(i, &[a, b, c])| if i % 2 == 0 { [a, b, c] } else { [b, a, c] })
            .collect()),
        other => Err(MeshFault::NotTriangles(other)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(topology: PrimitiveTopology) -> Mesh {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
        ];
        Mesh::new(topology, RenderAssetUsages::MAIN_WORLD)
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    }

    fn indices_of(mesh: &Mesh) -> Vec<[u32; 3]> {
        let traced = trace_mesh(mesh, &BuildOptions::default()).unwrap();
        traced.tree.triangles().indices().to_vec()
    }

    #[test]
    fn lists_and_strips_with_wide_narrow_and_no_indices_give_the_same_triangles() {
        let strip = mesh(PrimitiveTopology::TriangleStrip);
        assert_eq!(indices_of(&strip), [[0, 1, 2], [2, 1, 3]]);
        let list = mesh(PrimitiveTopology::TriangleList);
        // The fourth vertex is half a triangle.
        assert_eq!(indices_of(&list), [[0, 1, 2]]);
        for indices in [
            Indices::U16(vec![0, 1, 2, 2, 1, 3]),
            Indices::U32(vec![0, 1, 2, 2, 1, 3, 3]),
        ] {
            let list = list.clone().with_inserted_indices(indices);
            assert_eq!(indices_of(&list), [[0, 1, 2], [2, 1, 3]]);
        }
    }

    fn fault(mesh: &Mesh) -> MeshFault {
        match trace_mesh(mesh, &BuildOptions::default()) {
            Ok(_) => panic!("a broken mesh was taken"),
            Err(fault) => fault,
        }
    }

    #[test]
    fn a_mesh_that_is_none_is_refused_with_the_reason() {
        let lines = mesh(PrimitiveTopology::LineList);
        assert_eq!(
            fault(&lines),
            MeshFault::NotTriangles(PrimitiveTopology::LineList)
        );
        let empty = Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::MAIN_WORLD,
        );
        assert_eq!(fault(&empty), MeshFault::NoPositions);
        let mut of_the_gpu = mesh(PrimitiveTopology::TriangleList);
        of_the_gpu.asset_usage = RenderAssetUsages::RENDER_WORLD;
        assert_eq!(fault(&of_the_gpu), MeshFault::Extracted);
        let beyond = mesh(PrimitiveTopology::TriangleList)
            .with_inserted_indices(Indices::U32(vec![0, 1, 4]));
        assert!(matches!(fault(&beyond), MeshFault::Broken(_)));
    }

    #[test]
    fn a_mesh_without_triangles_is_empty_and_no_fault() {
        let none =
            mesh(PrimitiveTopology::TriangleList).with_inserted_indices(Indices::U32(Vec::new()));
        assert!(indices_of(&none).is_empty());
    }

    #[test]
    fn colours_and_alphas_are_kept_where_they_change_something() {
        let of = |colors: [[f32; 4]; 4]| {
            let mesh = mesh(PrimitiveTopology::TriangleList)
                .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors.to_vec());
            let traced = trace_mesh(&mesh, &BuildOptions::default()).unwrap();
            (traced.colors, traced.alphas)
        };
        assert_eq!(of([[1.0; 4]; 4]), (vec![], vec![]));
        let mut colors = [[1.0; 4]; 4];
        colors[1] = [0.5, f32::NAN, 2.0, 1.0];
        let (found, alphas) = of(colors);
        assert_eq!(found[1], Vec3::new(0.5, 0.0, 1.0));
        assert!(alphas.is_empty());
        colors[2][3] = 0.25;
        assert_eq!(of(colors).1, [1.0, 1.0, 0.25, 1.0]);
        assert!(
            of([[1.0, 1.0, 1.0, 0.5]; 4]).0.len() == 4,
            "white that fades"
        );
    }
}
