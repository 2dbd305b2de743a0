use super::environment::Environment;
use super::lights::Lights;
use super::material::Material;
use super::needs::Needs;
use crate::bvh::{Aggregate, MeshTree};
use crate::trace::Texture;
use glam::{Vec2, Vec3, Vec4};
use std::sync::Arc;

/// What rays read: flat arrays, indices instead of pointers, immutable while traced.
///
/// An edit makes a new `World` that shares everything that did not change. Arrays are sorted by
/// `SceneId`, so that the picture does not depend on the order in which entities were spawned.
#[derive(Clone, Default)]
pub struct World {
    /// The instances and their trees. `aggregate.instances()[i]` belongs to `objects[i]`.
    pub aggregate: Arc<Aggregate>,
    /// What the tree does not know of each instance.
    pub objects: Arc<Vec<Object>>,
    /// Named by [`Object::material`].
    pub materials: Arc<Vec<Material>>,
    /// Named by [`Material`].
    pub textures: Arc<Vec<Arc<Texture>>>,
    /// One array per kind.
    pub lights: Arc<Lights>,
    /// What a ray carries that meets nothing.
    pub environment: Environment,
    /// What of the model all this uses: [`Needs::of`], taken when the rest is set.
    pub needs: Needs,
}

impl World {
    /// This world with its needs looked up: the last step of putting one together.
    pub fn with_needs(mut self) -> Self {
        self.needs = Needs::of(&self, None);
        self
    }

    /// The same where it is that world edited: what both share is not looked through again where that takes long.
    pub fn with_needs_after(mut self, before: &Self) -> Self {
        self.needs = Needs::of(&self, Some(before));
        self
    }
}

/// One instance as shading sees it.
#[derive(Clone)]
pub struct Object {
    /// The entity's `SceneId`.
    pub id: u64,
    /// Index into [`World::materials`].
    pub material: u32,
    /// Samples of a pixel that its motion asks for; 0 where it does not move.
    pub motion_samples: u32,
    /// Normals and texture coordinates, shared by all instances of the mesh.
    pub mesh: Arc<Mesh>,
}

/// A mesh: its tree, and what shading interpolates over its triangles.
#[derive(Clone)]
pub struct Mesh {
    /// Positions, indices and the tree over them.
    pub tree: Arc<MeshTree>,
    /// One per vertex, not necessarily of unit length; empty where the mesh has none.
    pub normals: Vec<Vec3>,
    /// One per vertex, (0, 0) at the picture's top left as in glTF and Bevy; empty where the mesh has none.
    pub uvs: Vec<Vec2>,
    /// Linear RGB in [0, 1] that multiplies kd, one per vertex; empty where the mesh has none.
    pub colors: Vec<Vec3>,
    /// In [0, 1], multiplies opacity, one per vertex; empty where all are 1, and where there are no colours.
    pub alphas: Vec<f32>,
    /// Where the normal map's picture grows to the right, and in `w` the sign of the bitangent `w · normal × tangent`
    /// to its upper edge, as in glTF and Bevy. One per vertex, not necessarily of unit length; empty where the mesh has
    /// none, or no normals: then they follow from the triangles' texture coordinates.
    pub tangents: Vec<Vec4>,
}

impl Mesh {
    /// Triangles with flat normals, and nothing else to interpolate.
    pub fn of(tree: Arc<MeshTree>) -> Self {
        Self {
            tree,
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            alphas: Vec::new(),
            tangents: Vec::new(),
        }
    }

    /// Bytes of all of it, the tree included.
    pub fn bytes(&self) -> usize {
        let Self {
            tree,
            normals,
            uvs,
            colors,
            alphas,
            tangents,
        } = self;
        tree.bytes()
            + size_of_val(&**normals)
            + size_of_val(&**uvs)
            + size_of_val(&**colors)
            + size_of_val(&**alphas)
            + size_of_val(&**tangents)
    }
}
