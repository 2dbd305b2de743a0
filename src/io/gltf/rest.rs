//! Meshes that deform, as they are at rest: morph targets with the weights that the file starts with, skins with their
//! joints where its nodes are. Both are built once; animations are left out.

use super::super::error::Problem;
use super::accessors::{floats, joints};
use super::document::Document;
use super::json::Json;
use super::placement::turn_of;
use bevy::math::{Affine3A, Mat4};

/// How a mesh stands.
#[derive(Clone, Debug, Default)]
pub(super) struct Pose {
    /// Of the morph targets.
    pub weights: Vec<f32>,
    /// From the mesh's space to the world's, for each joint of its skin.
    pub joints: Vec<Affine3A>,
}

/// What moves with a mesh's vertices. Normals and tangents may be empty.
pub(super) struct Vertices<'a> {
    pub positions: &'a mut [[f32; 3]],
    pub normals: &'a mut [[f32; 3]],
    pub tangents: &'a mut [[f32; 4]],
}

impl Pose {
    /// Moves vertices to where they are at rest; true where a skin does it, and they are in the world's space then. What
    /// cannot be used is noted.
    ///
    /// # Errors
    /// There is not memory enough.
    pub fn apply(
        &self,
        document: &Document,
        primitive: Json,
        name: &str,
        vertices: &mut Vertices,
    ) -> Result<bool, Problem> {
        let targets = primitive.list("targets");
        if self.weights.len() > targets.len() {
            let what = "more weights than morph targets";
            document.note(name, what, "those that are too many are left out");
        }
        for (target, &weight) in targets.zip(&self.weights) {
            if weight == 0.0 {
                continue;
            }
            target.mark();
            morph(
                document,
                target,
                "POSITION",
                name,
                weight,
                vertices.positions,
            )?;
            morph(document, target, "NORMAL", name, weight, vertices.normals)?;
            morph(document, target, "TANGENT", name, weight, vertices.tangents)?;
        }
        if self.joints.is_empty() {
            return Ok(false);
        }
        match self.skin(document, primitive, name, vertices) {
            Ok(()) => Ok(true),
            Err(problem) => {
                document.do_without(name, "its skin", problem, "shown without")?;
                Ok(false)
            }
        }
    }

    fn skin(
        &self,
        document: &Document,
        primitive: Json,
        name: &str,
        vertices: &mut Vertices,
    ) -> Result<(), Problem> {
        let missing = || Problem::Malformed("it has no joints".to_owned());
        let attributes = primitive.get("attributes").ok_or_else(missing)?;
        let count = vertices.positions.len();
        let mut sums = vec![(Mat4::ZERO, 0.0_f32); count];
        let (mut of_nothing, mut is_odd) = (false, false);
        for set in 0.. {
            let joints_of = attributes.index(&format!("JOINTS_{set}"));
            let weights_of = attributes.index(&format!("WEIGHTS_{set}"));
            let (Some(joints_of), Some(weights_of)) = (joints_of, weights_of) else {
                break;
            };
            let joints = joints(document, joints_of)?;
            let weights = floats::<4>(document, weights_of)?;
            if joints.len() != count || weights.len() != count {
                let text = "it has not as many joints and weights as vertices";
                return Err(Problem::Malformed(text.to_owned()));
            }
            for ((sum, joints), weights) in sums.iter_mut().zip(joints).zip(weights) {
                for (joint, weight) in joints.into_iter().zip(weights) {
                    if weight == 0.0 {
                        continue;
                    }
                    let is_usable = weight > 0.0 && weight.is_finite();
                    is_odd |= !is_usable;
                    match self.joints.get(joint as usize).filter(|_| is_usable) {
                        Some(&matrix) => {
                            sum.0 += Mat4::from(matrix) * weight;
                            sum.1 += weight;
                        }
                        None => of_nothing |= is_usable,
                    }
                }
            }
        }
        if sums.iter().all(|(_, weight)| *weight == 0.0) {
            return Err(missing());
        }
        let is_unmoved = sums.iter().any(|(_, weight)| *weight == 0.0);
        for (is_so, what, instead) in [
            (
                is_odd,
                "weights of joints that are below 0 or no numbers",
                "left out",
            ),
            (
                of_nothing,
                "weights of joints that its skin does not have",
                "left out",
            ),
            (
                is_unmoved,
                "vertices that no joint moves",
                "where they are without the skin",
            ),
        ] {
            if is_so {
                document.note(name, what, instead);
            }
        }
        for (place, (matrix, weight)) in vertices.positions.iter_mut().zip(&sums) {
            if *weight > 0.0 {
                // Weights that do not add up to 1 would scale the mesh.
                let matrix = *matrix * weight.recip();
                *place = matrix.transform_point3((*place).into()).to_array();
            }
        }
        let turn = |direction: &mut [f32; 3], (matrix, weight): &(Mat4, f32)| {
            if *weight > 0.0 {
                let turned = matrix.transform_vector3((*direction).into());
                *direction = turned.normalize_or_zero().to_array();
            }
        };
        for (normal, sum) in vertices.normals.iter_mut().zip(&sums) {
            turn(normal, sum);
        }
        for (tangent, sum) in vertices.tangents.iter_mut().zip(&sums) {
            if let Some((direction, _)) = tangent.split_first_chunk_mut() {
                turn(direction, sum);
            }
        }
        Ok(())
    }
}

/// Adds a target's moves to vectors; a fourth number, a tangent's sign, stays.
fn morph<const N: usize>(
    document: &Document,
    target: Json,
    key: &str,
    name: &str,
    weight: f32,
    values: &mut [[f32; N]],
) -> Result<(), Problem> {
    let Some(accessor) = target.index(key).filter(|_| !values.is_empty()) else {
        return Ok(());
    };
    match floats::<3>(document, accessor) {
        Ok(moves) if moves.len() == values.len() => {
            for (value, by) in values.iter_mut().zip(moves) {
                for (value, by) in value.iter_mut().zip(by) {
                    *value += weight * by;
                }
            }
        }
        Ok(_) => document.note(
            name,
            format!("a morph target's {key} of another length"),
            "left out",
        ),
        Err(problem) => document.do_without(name, "a morph target", problem, "left out")?,
    }
    Ok(())
}

/// The nodes of a file and which stands below which.
pub(super) struct Nodes<'a> {
    document: &'a Document,
    parents: Vec<Option<usize>>,
}

impl<'a> Nodes<'a> {
    pub fn new(document: &'a Document) -> Self {
        let json = document.json();
        let count = json.list("nodes").len();
        let mut parents = vec![None; count];
        for (index, node) in json.list("nodes").enumerate() {
            for child in node.list("children").filter_map(Json::whole) {
                if let Some(parent) = parents.get_mut(child)
                    && parent.is_none()
                    && child != index
                {
                    *parent = Some(index);
                }
            }
        }
        Self { document, parents }
    }

    pub fn len(&self) -> usize {
        self.parents.len()
    }

    pub fn is_root(&self, node: usize) -> bool {
        self.parents.get(node).is_some_and(Option::is_none)
    }

    /// From a node's space to the world's. Above the limit of depth nothing is looked at: there are circles.
    fn world_from(&self, node: usize) -> Affine3A {
        let mut place = Affine3A::IDENTITY;
        let mut at = Some(node);
        for _ in 0..=self.document.limits.depth {
            let Some(node) = at else { break };
            if let Some(json) = self.document.json().element("nodes", node) {
                place = parent_from(json) * place;
            }
            at = self.parents.get(node).copied().flatten();
        }
        place
    }

    /// Where a skin's joints take its mesh at rest.
    pub fn joints(&self, skin: usize) -> Result<Vec<Affine3A>, Problem> {
        let missing = || Problem::Malformed(format!("there is no skin {skin}"));
        let json = self.document.json().element("skins", skin);
        let json = json.ok_or_else(missing)?;
        // Where a skin's own root is says nothing about where the joints are.
        json.get("skeleton");
        let bound = match json.index("inverseBindMatrices") {
            Some(accessor) => floats::<16>(self.document, accessor)?,
            None => Vec::new(),
        };
        let joints = json.list("joints");
        let note = |what: &str, instead: &'static str| {
            self.document.note(&format!("skins[{skin}]"), what, instead);
        };
        if (1..joints.len()).contains(&bound.len()) {
            let instead = "the last joints are taken without";
            note("fewer inverseBindMatrices than joints", instead);
        }
        let joints = joints.enumerate().map(|(index, joint)| {
            let node = joint.whole().filter(|&joint| joint < self.len());
            if node.is_none() {
                note("a joint that is no node", "it does not move");
            }
            let world_from_joint = node.map(|joint| self.world_from(joint));
            let joint_from_mesh = bound.get(index).map_or(Affine3A::IDENTITY, |matrix| {
                Affine3A::from_mat4(Mat4::from_cols_array(matrix))
            });
            world_from_joint.unwrap_or_default() * joint_from_mesh
        });
        Ok(joints.collect())
    }
}

/// From a node's space to that of the node above.
fn parent_from(node: Json) -> Affine3A {
    match node.numbers::<16>("matrix") {
        Some(matrix) => Affine3A::from_mat4(Mat4::from_cols_array(&matrix)),
        None => {
            let translation = node.numbers("translation").unwrap_or([0.0; 3]);
            let rotation = node.numbers("rotation").unwrap_or([0.0, 0.0, 0.0, 1.0]);
            // Noted where the node itself is read.
            let rotation = turn_of(rotation, &|_: &str, _: &'static str| {});
            let scale = node.numbers("scale").unwrap_or([1.0; 3]);
            Affine3A::from_scale_rotation_translation(scale.into(), rotation, translation.into())
        }
    }
}
