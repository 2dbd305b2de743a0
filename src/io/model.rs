//! What an importer found in a file, before it becomes entities.

use super::notes::Notes;
use crate::scene::{DirectionalLamp, Environment, Phong, PointLamp, SceneCamera};
use bevy::asset::RenderAssetUsages;
use bevy::color::LinearRgba;
use bevy::mesh::{Indices, Mesh, PrimitiveTopology};
use bevy::transform::components::Transform;
use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;

/// The content of a model file.
#[derive(Default)]
pub(crate) struct Model {
    /// Materials with their names; objects refer to them by index.
    pub materials: Vec<(String, Phong)>,
    /// Parents before their children.
    pub nodes: Vec<Node>,
    /// By the name that `MeshSource::File` carries.
    pub meshes: BTreeMap<String, Mesh>,
    /// What is around it, where the file says so.
    pub environment: Option<Environment>,
    /// What could not be taken over.
    pub notes: Notes,
    /// Every file that it was read from.
    pub files: Vec<PathBuf>,
}

/// One entity to be.
#[derive(Clone, Default)]
pub(crate) struct Node {
    pub name: String,
    /// Index of its parent, smaller than its own.
    pub parent: Option<usize>,
    pub transform: Transform,
    /// Name of its mesh.
    pub mesh: Option<String>,
    /// Index of its material.
    pub material: Option<usize>,
    pub point_lamp: Option<PointLamp>,
    pub directional_lamp: Option<DirectionalLamp>,
    pub camera: Option<SceneCamera>,
}

/// The material of meshes that have no other, and whose vertices have colours: those are shown as they are.
#[derive(Default)]
pub(crate) struct ColoredMaterial(Option<usize>);

impl ColoredMaterial {
    /// Its place among the materials, where it is put when first asked for.
    pub fn place(&mut self, materials: &mut Vec<(String, Phong)>) -> usize {
        *self.0.get_or_insert_with(|| {
            let phong = Phong {
                diffuse: LinearRgba::WHITE,
                ..Phong::default()
            };
            materials.push(("vertex colours".to_owned(), phong));
            materials.len() - 1
        })
    }
}

/// Gives names that no mesh has yet; the search for one goes on where the last of the same name ended.
#[derive(Default)]
pub(crate) struct FreeNames {
    next: HashMap<String, u64>,
}

impl FreeNames {
    /// The name, or with a number where another mesh has it.
    pub fn free(&mut self, name: String, taken: &BTreeMap<String, Mesh>) -> String {
        if !taken.contains_key(&name) {
            return name;
        }
        let next = self.next.entry(name.clone()).or_insert(2);
        loop {
            let numbered = format!("{name}#{next}");
            *next += 1;
            if !taken.contains_key(&numbered) {
                return numbered;
            }
        }
    }
}

/// A triangle mesh as Bevy keeps it. Normals and texture coordinates may be empty.
///
/// Texture coordinates count from the picture's top left corner, v downwards, as in glTF and Bevy.
pub(crate) fn triangle_mesh(
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    indices: Vec<u32>,
) -> Mesh {
    let mut mesh = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    );
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, positions);
    if !normals.is_empty() {
        mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, normals);
    }
    if !uvs.is_empty() {
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
    }
    mesh.insert_indices(Indices::U32(indices));
    mesh
}

/// Takes out the vertices that no triangle has. Parts of a model often share one list of them, and each would hold all
/// of it; and what is not seen would count where it is asked how large something is.
pub(crate) fn drop_unused(mesh: &mut Mesh) {
    const UNUSED: u32 = u32::MAX;
    let mut places = vec![UNUSED; mesh.count_vertices()];
    let Ok(Some(indices)) = mesh.try_indices_mut_option() else {
        return;
    };
    let Indices::U32(corners) = indices else {
        return;
    };
    for &corner in &*corners {
        if let Some(place) = places.get_mut(corner as usize) {
            *place = 0;
        }
    }
    if !places.contains(&UNUSED) {
        return;
    }
    let used = places.iter_mut().filter(|place| **place != UNUSED);
    for (number, place) in (0..).zip(used) {
        *place = number;
    }
    for corner in corners {
        *corner = places.get(*corner as usize).copied().unwrap_or(0);
    }
    fn keep<T>(values: &mut Vec<T>, places: &[u32]) {
        let mut places = places.iter();
        values.retain(|_| places.next().is_some_and(|&place| place != UNUSED));
        values.shrink_to_fit();
    }
    use bevy::mesh::VertexAttributeValues as Values;
    for (_, values) in mesh.attributes_mut() {
        match values {
            Values::Float32x2(values) => keep(values, &places),
            Values::Float32x3(values) => keep(values, &places),
            Values::Float32x4(values) => keep(values, &places),
            // No reader makes others.
            _ => {}
        }
    }
}

/// What a mesh of triangles holds, borrowed.
pub(crate) struct MeshParts<'a> {
    pub positions: &'a [[f32; 3]],
    /// As many as positions, or none.
    pub normals: &'a [[f32; 3]],
    /// As many as positions, or none.
    pub uvs: &'a [[f32; 2]],
    /// As many as positions, or none: linear, with alpha.
    pub colors: &'a [[f32; 4]],
    /// As many as positions, or none: with the bitangent's sign.
    pub tangents: &'a [[f32; 4]],
    pub indices: &'a Indices,
}

impl<'a> MeshParts<'a> {
    /// `None` where the mesh is not an indexed triangle list with positions in this program's memory.
    pub fn of(mesh: &'a Mesh) -> Option<Self> {
        use bevy::mesh::VertexAttributeValues as Values;
        if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
            return None;
        }
        let three = |id| match mesh.try_attribute_option(id) {
            Ok(Some(Values::Float32x3(values))) => Some(values.as_slice()),
            _ => None,
        };
        let positions = three(Mesh::ATTRIBUTE_POSITION)?;
        let whole = |length: usize| length == positions.len();
        let uvs = match mesh.try_attribute_option(Mesh::ATTRIBUTE_UV_0) {
            Ok(Some(Values::Float32x2(values))) if whole(values.len()) => values.as_slice(),
            _ => &[],
        };
        let four = |id| match mesh.try_attribute_option(id) {
            Ok(Some(Values::Float32x4(values))) if whole(values.len()) => values.as_slice(),
            _ => &[],
        };
        Some(Self {
            positions,
            normals: three(Mesh::ATTRIBUTE_NORMAL)
                .filter(|values| whole(values.len()))
                .unwrap_or(&[]),
            uvs,
            colors: four(Mesh::ATTRIBUTE_COLOR),
            tangents: four(Mesh::ATTRIBUTE_TANGENT),
            indices: mesh.try_indices_option().ok().flatten()?,
        })
    }

    /// Whole triangles whose corners exist.
    pub fn triangles(&self) -> impl Iterator<Item = [usize; 3]> {
        let count = self.positions.len();
        (0..self.indices.len() / 3)
            .map(|t| {
                [0, 1, 2].map(|corner| match self.indices {
                    Indices::U16(indices) => usize::from(indices[3 * t + corner]),
                    Indices::U32(indices) => indices[3 * t + corner] as usize,
                })
            })
            .filter(move |corners| corners.iter().all(|&corner| corner < count))
    }
}
