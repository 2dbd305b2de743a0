//! A mesh as its skeleton and its morph weights bend it.

use bevy::asset::RenderAssetUsages;
use bevy::math::{Mat3, Mat4, Vec3, Vec4};
use bevy::mesh::{Mesh, VertexAttributeValues};

/// All that bends a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Bend {
    /// From the mesh as its asset has it to the object's own space, one for each joint; none where the
    /// object has no skin.
    pub joints: Vec<Mat4>,
    /// How much of each morph target is added.
    pub weights: Vec<f32>,
}

impl Bend {
    /// Whether a mesh that is bent so is as its asset has it.
    pub fn is_none(&self) -> bool {
        self.joints.is_empty() && self.weights.iter().all(|weight| *weight == 0.0)
    }
}

/// The mesh bent as Bevy's vertex shader does it: morph targets first, then the joints, whose weights
/// are taken as they are. It is no mesh for the renderer. An error where it cannot be.
pub(super) fn bent(mesh: &Mesh, bend: &Bend) -> Result<Mesh, &'static str> {
    let of_the_gpu = "its mesh is for the GPU alone";
    let mut result = Mesh::new(mesh.primitive_topology(), RenderAssetUsages::MAIN_WORLD);
    for (attribute, values) in mesh.try_attributes().map_err(|_| of_the_gpu)? {
        let is_of_skin =
            [Mesh::ATTRIBUTE_JOINT_INDEX, Mesh::ATTRIBUTE_JOINT_WEIGHT].contains(attribute);
        if !is_of_skin {
            result.insert_attribute(*attribute, values.clone());
        }
    }
    if let Some(indices) = mesh.try_indices_option().map_err(|_| of_the_gpu)? {
        result.insert_indices(indices.clone());
    }
    morph(mesh, &bend.weights, &mut result);
    skin(mesh, &bend.joints, &mut result)?;
    Ok(result)
}

fn morph(mesh: &Mesh, weights: &[f32], result: &mut Mesh) {
    let vertices = mesh.count_vertices();
    let targets = mesh.get_morph_targets().unwrap_or_default();
    if vertices == 0 {
        return;
    }
    let weighted = targets.chunks_exact(vertices).zip(weights);
    for (target, &weight) in weighted.filter(|(_, weight)| **weight != 0.0) {
        if let Some(positions) = triples(result, Mesh::ATTRIBUTE_POSITION.id) {
            for (position, change) in positions.iter_mut().zip(target) {
                *position = (Vec3::from(*position) + weight * change.position).into();
            }
        }
        if let Some(normals) = triples(result, Mesh::ATTRIBUTE_NORMAL.id) {
            for (normal, change) in normals.iter_mut().zip(target) {
                *normal = (Vec3::from(*normal) + weight * change.normal).into();
            }
        }
        if let Some(tangents) = quadruples(result) {
            for (tangent, change) in tangents.iter_mut().zip(target) {
                let change = (weight * change.tangent).extend(0.0);
                *tangent = (Vec4::from(*tangent) + change).into();
            }
        }
    }
}

/// A mesh that names no joints is not bent by them, as in Bevy.
fn skin(mesh: &Mesh, joints: &[Mat4], result: &mut Mesh) -> Result<(), &'static str> {
    let attribute = |attribute| mesh.try_attribute_option(attribute).ok().flatten();
    let (
        Some(VertexAttributeValues::Uint16x4(which)),
        Some(VertexAttributeValues::Float32x4(weights)),
        false,
    ) = (
        attribute(Mesh::ATTRIBUTE_JOINT_INDEX),
        attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT),
        joints.is_empty(),
    )
    else {
        return Ok(());
    };
    let at_vertex = |(which, weights): (&[u16; 4], &[f32; 4])| {
        let mut sum = Mat4::ZERO;
        for (&joint, &weight) in which.iter().zip(weights) {
            if weight != 0.0 {
                sum += *joints.get(usize::from(joint))? * weight;
            }
        }
        Some(sum)
    };
    let bends = which.iter().zip(weights).map(at_vertex);
    let bends: Option<Vec<Mat4>> = bends.collect();
    let bends = bends.ok_or("its mesh names a joint that its skin does not have")?;
    if let Some(positions) = triples(result, Mesh::ATTRIBUTE_POSITION.id) {
        for (position, bend) in positions.iter_mut().zip(&bends) {
            *position = bend.transform_point3(Vec3::from(*position)).into();
        }
    }
    if let Some(normals) = triples(result, Mesh::ATTRIBUTE_NORMAL.id) {
        for (normal, bend) in normals.iter_mut().zip(&bends) {
            let [x, y, z] = [bend.x_axis, bend.y_axis, bend.z_axis].map(Vec4::truncate);
            // The inverse's transpose, but for its length; that of a flat bend is none, and there the
            // triangle's own normal counts.
            let upright = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
            let side = x.cross(y).dot(z).signum();
            let turned = (side * (upright * Vec3::from(*normal))).normalize_or_zero();
            *normal = turned.into();
        }
    }
    if let Some(tangents) = quadruples(result) {
        for (tangent, bend) in tangents.iter_mut().zip(&bends) {
            let [x, y, z, w] = *tangent;
            let turned = bend.transform_vector3(Vec3::new(x, y, z));
            *tangent = turned.normalize_or_zero().extend(w).into();
        }
    }
    Ok(())
}

fn triples(
    mesh: &mut Mesh,
    attribute: bevy::mesh::MeshVertexAttributeId,
) -> Option<&mut Vec<[f32; 3]>> {
    match mesh.attribute_mut(attribute) {
        Some(VertexAttributeValues::Float32x3(values)) => Some(values),
        _ => None,
    }
}

fn quadruples(mesh: &mut Mesh) -> Option<&mut Vec<[f32; 4]>> {
    match mesh.attribute_mut(Mesh::ATTRIBUTE_TANGENT) {
        Some(VertexAttributeValues::Float32x4(values)) => Some(values),
        _ => None,
    }
}
