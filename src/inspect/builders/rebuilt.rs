//! A world with other trees.

use crate::bvh::{Aggregate, BuildOptions, Builder, Instance, Levels, MeshTree};
use crate::trace::{Mesh, Object, World};
use bevy::platform::collections::HashMap;
use std::sync::Arc;

/// The same world with other trees: its pictures are the same, bit for bit. It takes as long as building all trees.
pub fn rebuilt(world: &World, options: &BuildOptions) -> World {
    // One tree over all triangles needs none over those of a mesh.
    let mesh_options = match options.levels {
        Levels::One => BuildOptions {
            builder: Builder::None,
            ..*options
        },
        Levels::Two => *options,
    };
    let mut meshes: HashMap<*const Mesh, Arc<Mesh>> = HashMap::default();
    let objects: Vec<Object> = world
        .objects
        .iter()
        .map(|object| {
            let mesh = meshes.entry(Arc::as_ptr(&object.mesh)).or_insert_with(|| {
                let triangles = object.mesh.tree.triangles().clone();
                Arc::new(Mesh {
                    tree: Arc::new(MeshTree::build(triangles, &mesh_options)),
                    ..Mesh::clone(&object.mesh)
                })
            });
            Object {
                mesh: mesh.clone(),
                ..object.clone()
            }
        })
        .collect();
    let instances: Vec<Instance> = world
        .aggregate
        .instances()
        .iter()
        .zip(&objects)
        .map(|(instance, object)| {
            let mut instance = instance.clone();
            instance.mesh = object.mesh.tree.clone();
            instance
        })
        .collect();
    World {
        aggregate: Arc::new(Aggregate::build(instances, options)),
        objects: Arc::new(objects),
        ..world.clone()
    }
}

/// Whether trees of both are over the same triangles at the same places, as far as the worlds tell
/// without their corners being compared one by one: objects, transforms, velocities, counts and
/// bounds; and where the trees are of one kind, the very same meshes. Quick: one look at each object.
pub fn same_geometry(a: &World, b: &World) -> bool {
    let (of_a, of_b) = (&a.aggregate, &b.aggregate);
    if Arc::ptr_eq(of_a, of_b) {
        return true;
    }
    let one_kind = of_a.options() == of_b.options();
    let (left, right) = (of_a.instances(), of_b.instances());
    let ids_a = a.objects.iter().map(|object| object.id);
    let ids_b = b.objects.iter().map(|object| object.id);
    left.len() == right.len()
        && ids_a.eq(ids_b)
        && left.iter().zip(right).all(|(a, b)| {
            let (mesh_a, mesh_b) = (&a.mesh, &b.mesh);
            let corners = |mesh: &MeshTree| mesh.bounds().map(|b| [b.min, b.max]);
            let same_mesh = if one_kind {
                Arc::ptr_eq(mesh_a, mesh_b)
            } else {
                mesh_a.triangles().len() == mesh_b.triangles().len()
                    && corners(mesh_a) == corners(mesh_b)
            };
            same_mesh
                && a.world_from_object() == b.world_from_object()
                && a.velocity() == b.velocity()
        })
}
