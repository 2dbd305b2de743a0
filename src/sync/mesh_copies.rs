//! Large meshes on their way to the threads that build their trees: some of each is copied in every frame.

use super::mesh_data::{MeshCopy, MeshFault};
use bevy::asset::{AssetId, RenderAssetUsages};
use bevy::mesh::{Indices, Mesh, MeshVertexAttribute, VertexAttributeValues};
use std::collections::VecDeque;

/// Bytes of meshes that are copied within a frame: about a millisecond's.
pub(super) const AT_ONCE: usize = 4 << 20;

/// Meshes of which a part is copied. First come, first copied.
#[derive(Default)]
pub(super) struct MeshCopies(VecDeque<Partial>);

struct Partial {
    id: AssetId<Mesh>,
    attributes: Vec<(MeshVertexAttribute, VertexAttributeValues)>,
    indices: Option<Indices>,
}

impl MeshCopies {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Which they are.
    pub fn ids(&self) -> Vec<AssetId<Mesh>> {
        self.0.iter().map(|partial| partial.id).collect()
    }

    /// Begins with a mesh.
    pub fn begin(&mut self, id: AssetId<Mesh>) {
        self.0.push_back(Partial {
            id,
            attributes: Vec::new(),
            indices: None,
        });
    }

    /// Lets go of what was copied of a mesh: it is another now, or nobody wants it. Whether anything was.
    pub fn forget(&mut self, id: AssetId<Mesh>) -> bool {
        let before = self.0.len();
        self.0.retain(|partial| partial.id != id);
        self.0.len() < before
    }

    /// Goes on with the first of them, as far as what is `left` of the frame allows; the mesh when it is complete.
    pub fn go_on<'a>(
        &mut self,
        find: impl Fn(AssetId<Mesh>) -> Option<&'a Mesh>,
        left: &mut usize,
    ) -> Option<(AssetId<Mesh>, Result<Mesh, MeshFault>)> {
        let partial = self.0.front_mut()?;
        let id = partial.id;
        let copied = match find(id) {
            Some(mesh) => partial.go_on(mesh, left)?,
            None => Err(MeshFault::Missing),
        };
        self.0.pop_front();
        Some((id, copied))
    }
}

impl Partial {
    fn go_on(&mut self, mesh: &Mesh, left: &mut usize) -> Option<Result<Mesh, MeshFault>> {
        for (i, (attribute, values)) in parts(mesh).enumerate() {
            if self.attributes.len() == i {
                let empty = empty_like(values)?;
                self.attributes.push((*attribute, empty));
            }
            if !copy_some(&mut self.attributes[i].1, values, left) {
                return None;
            }
        }
        let Ok(indices) = mesh.try_indices_option() else {
            return Some(Err(MeshFault::Extracted));
        };
        if let Some(indices) = indices {
            let all = match indices {
                Indices::U16(from) => match self.indices.get_or_insert(Indices::U16(Vec::new())) {
                    Indices::U16(to) => extend(to, from, left),
                    Indices::U32(_) => true,
                },
                Indices::U32(from) => match self.indices.get_or_insert(Indices::U32(Vec::new())) {
                    Indices::U32(to) => extend(to, from, left),
                    Indices::U16(_) => true,
                },
            };
            if !all {
                return None;
            }
        }
        let usage = RenderAssetUsages::MAIN_WORLD;
        let mut copy = Mesh::new(mesh.primitive_topology(), usage);
        for (attribute, values) in self.attributes.drain(..) {
            copy.insert_attribute(attribute, values);
        }
        if let Some(indices) = self.indices.take() {
            copy.insert_indices(indices);
        }
        Some(Ok(copy))
    }
}

/// What is copied of a mesh, in bytes.
pub(super) fn cost(mesh: &Mesh) -> usize {
    let values: usize = parts(mesh)
        .map(|(_, values)| values.get_bytes().len())
        .sum();
    let indices = match mesh.try_indices_option() {
        Ok(Some(indices)) => indices.len() * size_of::<u32>(),
        _ => 0,
    };
    values + indices
}

/// The attributes that the tracer reads.
fn parts(mesh: &Mesh) -> impl Iterator<Item = (&MeshVertexAttribute, &VertexAttributeValues)> {
    let all = mesh.try_attributes().into_iter().flatten();
    all.filter(|(attribute, values)| {
        MeshCopy::ATTRIBUTES.contains(&attribute.id) && empty_like(values).is_some()
    })
}

/// None of the same kind; `None` where the tracer reads no such.
fn empty_like(values: &VertexAttributeValues) -> Option<VertexAttributeValues> {
    use VertexAttributeValues::{Float32x2, Float32x3, Float32x4, Unorm8x4};
    match values {
        Float32x2(_) => Some(Float32x2(Vec::new())),
        Float32x3(_) => Some(Float32x3(Vec::new())),
        Float32x4(_) => Some(Float32x4(Vec::new())),
        Unorm8x4(_) => Some(Unorm8x4(Vec::new())),
        _ => None,
    }
}

/// Whether that were all.
fn copy_some(
    to: &mut VertexAttributeValues,
    from: &VertexAttributeValues,
    left: &mut usize,
) -> bool {
    use VertexAttributeValues::{Float32x2, Float32x3, Float32x4, Unorm8x4};
    match (to, from) {
        (Float32x2(to), Float32x2(from)) => extend(to, from, left),
        (Float32x3(to), Float32x3(from)) => extend(to, from, left),
        (Float32x4(to), Float32x4(from)) => extend(to, from, left),
        (Unorm8x4(to), Unorm8x4(from)) => extend(to, from, left),
        _ => true,
    }
}

/// Whether that were all.
fn extend<T: Copy>(to: &mut Vec<T>, from: &[T], left: &mut usize) -> bool {
    if to.is_empty() {
        to.reserve_exact(from.len());
    }
    let start = to.len().min(from.len());
    let end = from.len().min(start + *left / size_of::<T>());
    to.extend_from_slice(&from[start..end]);
    *left -= (end - start) * size_of::<T>();
    end == from.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::BuildOptions;
    use bevy::mesh::Meshable;

    #[test]
    fn a_mesh_that_is_copied_in_parts_is_the_mesh() {
        let mut mesh: Mesh = bevy::math::primitives::Sphere::new(1.0).mesh().uv(40, 30);
        // By hand: only the renderer's part of Bevy generates them.
        let tangents: Vec<[f32; 4]> = (0..mesh.count_vertices())
            .map(|i| [1.0, 0.0, i as f32 / 2e3, 1.0])
            .collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_TANGENT, tangents);
        let colors: Vec<[f32; 4]> = (0..mesh.count_vertices())
            .map(|i| [0.1, 0.2, 0.3, i as f32 / 2e3])
            .collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
        let mut copies = MeshCopies::default();
        let id = AssetId::invalid();
        copies.begin(id);
        let mut frames = 0;
        let copy = loop {
            let mut left = 4096;
            frames += 1;
            if let Some((_, copy)) = copies.go_on(|_| Some(&mesh), &mut left) {
                break copy.unwrap();
            }
            assert!(left < 48, "{left}");
        };
        assert!(copies.is_empty());
        assert!(frames > 20, "{frames}");
        let [whole, copy] = [&mesh, &copy].map(|mesh| {
            let mesh = MeshCopy::of(mesh).unwrap();
            let mesh = mesh.build(&BuildOptions::default()).unwrap();
            let triangles = mesh.tree.triangles();
            let positions = format!("{:?} {:?}", triangles.positions(), triangles.indices());
            let rest = format!(
                "{:?} {:?} {:?} {:?} {:?}",
                mesh.normals, mesh.uvs, mesh.colors, mesh.alphas, mesh.tangents
            );
            (positions, rest)
        });
        assert!(whole == copy);
        assert!(!whole.1.contains("[] []"), "all of it is there");
        copies.begin(id);
        assert!(copies.forget(id) && !copies.forget(id));
    }
}
