//! Skinned and morphed meshes, as they stand in a frame.

use super::{add, app, object, problems};
use crate::bvh::Ray;
use crate::sync::{PosedMesh, Traced};
use bevy::asset::RenderAssetUsages;
use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes, MorphWeights};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::mesh::{PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;

/// A square of two metres around the origin, which faces +Z.
fn square() -> Mesh {
    let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0]];
    let others = [[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let positions = [corners, others].concat();
    let normals = vec![[0.0, 0.0, 1.0]; positions.len()];
    let usage = RenderAssetUsages::default();
    Mesh::new(PrimitiveTopology::TriangleList, usage)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
}

/// All of it hangs on its first joint.
fn skinned() -> Mesh {
    let joints = VertexAttributeValues::Uint16x4(vec![[0, 0, 0, 0]; 6]);
    square()
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints)
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[1.0, 0.0, 0.0, 0.0]; 6])
}

/// How far below (x, y, 10) something is met.
fn below(app: &App, x: f32, y: f32) -> Option<f32> {
    let traced = app.world().resource::<Traced>();
    let ray = Ray::new(Vec3::new(x, y, 10.0), Vec3::NEG_Z);
    traced.world.aggregate.closest_hit(&ray).map(|hit| hit.t)
}

/// An object that hangs on a joint, and the joint.
fn with_joint(app: &mut App, bind_pose: Mat4) -> (Entity, Entity) {
    let object = object(app);
    let mesh = add::<Mesh>(app, skinned());
    let bind_poses = vec![bind_pose];
    let inverse_bindposes = add::<SkinnedMeshInverseBindposes>(app, bind_poses);
    let joint = app.world_mut().spawn(Transform::default()).id();
    let skin = SkinnedMesh {
        inverse_bindposes,
        joints: vec![joint],
    };
    app.world_mut()
        .entity_mut(object)
        .insert((Mesh3d(mesh), skin));
    (object, joint)
}

fn put(app: &mut App, entity: Entity, place: Transform) {
    *app.world_mut().get_mut::<Transform>(entity).unwrap() = place;
    app.update();
}

#[test]
fn a_skinned_mesh_is_traced_where_its_joints_are_in_every_frame() {
    let mut app = app();
    // At rest the joint stands five metres to the right of the mesh's origin.
    let (object, joint) = with_joint(&mut app, Mat4::from_translation(Vec3::NEG_X * 5.0));
    put(&mut app, joint, Transform::from_xyz(5.0, 0.0, 0.0));
    assert_eq!(below(&app, 0.0, 0.0), Some(10.0));
    for z in [1.0, 2.0] {
        put(&mut app, joint, Transform::from_xyz(8.0, 0.0, z));
        assert_eq!(below(&app, 3.0, 0.0), Some(10.0 - z));
        assert_eq!(below(&app, 0.0, 0.0), None);
    }
    // Wherever it stands itself, it is where its joints are.
    put(
        &mut app,
        object,
        Transform::from_xyz(50.0, 7.0, 0.0).with_scale(Vec3::splat(2.0)),
    );
    let hit = below(&app, 3.0, 0.0).unwrap();
    assert!((hit - 8.0).abs() < 1e-4, "{hit} m");
    let upright = Transform::from_xyz(5.0, 0.0, 0.0).with_rotation(Quat::from_rotation_y(3.0));
    put(&mut app, joint, upright);
    let traced = app.world().resource::<Traced>();
    let instance = &traced.world.aggregate.instances()[0];
    let turned = instance.mesh.triangles().corners(0).map(|corner| corner.z);
    assert!(turned.iter().any(|z| z.abs() > 0.01), "{turned:?}");
    assert_eq!(problems(&mut app), Vec::<String>::new());
}

#[test]
fn a_pose_is_made_where_another_one_is_wanted_and_goes_with_its_skin() {
    let mut app = app();
    let (object, joint) = with_joint(&mut app, Mat4::IDENTITY);
    put(&mut app, joint, Transform::from_xyz(0.0, 0.0, 1.0));
    app.update();
    let world = |app: &App| app.world().resource::<Traced>().world.clone();
    let before = world(&app);
    app.update();
    assert!(
        std::sync::Arc::ptr_eq(&before, &world(&app)),
        "it stands still"
    );
    let meshes = app.world().resource::<Assets<Mesh>>().len();
    app.world_mut().entity_mut(object).remove::<SkinnedMesh>();
    app.update();
    app.update();
    assert_eq!(below(&app, 0.0, 0.0), Some(10.0));
    assert!(app.world().get::<PosedMesh>(object).is_none());
    let left = app.world().resource::<Assets<Mesh>>().len();
    assert_eq!(left, meshes - 1, "the posed mesh is left");
}

#[test]
fn a_skin_that_cannot_be_followed_is_named_and_its_mesh_stands_at_rest() {
    let mut app = app();
    let (object, joint) = with_joint(&mut app, Mat4::IDENTITY);
    put(&mut app, joint, Transform::from_xyz(0.0, 0.0, 1.0));
    assert_eq!(below(&app, 0.0, 0.0), Some(9.0));
    app.world_mut().despawn(joint);
    let named = problems(&mut app);
    assert_eq!(named.len(), 1, "{named:#?}");
    assert!(
        named[0].contains("a joint of its skin is gone"),
        "{named:#?}"
    );
    assert_eq!(below(&app, 0.0, 0.0), Some(10.0));
    app.world_mut().entity_mut(object).remove::<SkinnedMesh>();
    assert_eq!(problems(&mut app), Vec::<String>::new());
}

#[test]
fn a_morphed_mesh_has_the_weights_of_this_frame_its_own_or_anothers() {
    let mut app = app();
    let lift = |z: f32| MorphAttributes::new(Vec3::Z * z, Vec3::ZERO, Vec3::ZERO);
    let mut mesh = square();
    mesh.set_morph_targets([[lift(1.0); 6], [lift(4.0); 6]].concat());
    let mesh = add::<Mesh>(&mut app, mesh);
    let object = object(&mut app);
    let weigh = |app: &mut App, weights: MeshMorphWeights| {
        app.world_mut().entity_mut(object).insert(weights);
        app.update();
        below(app, 0.0, 0.0)
    };
    app.world_mut().entity_mut(object).insert(Mesh3d(mesh));
    let own = |weights: &[f32]| MeshMorphWeights::Value {
        weights: weights.to_vec(),
    };
    assert_eq!(weigh(&mut app, own(&[1.0, 0.0])), Some(9.0));
    assert_eq!(weigh(&mut app, own(&[1.0, 0.5])), Some(7.0));
    assert_eq!(weigh(&mut app, own(&[0.0, 0.0])), Some(10.0));
    let holder = MorphWeights::new(vec![0.0, 1.0], None).unwrap();
    let holder = app.world_mut().spawn(holder).id();
    assert_eq!(
        weigh(&mut app, MeshMorphWeights::Reference(holder)),
        Some(6.0)
    );
    let mut held = app.world_mut().get_mut::<MorphWeights>(holder).unwrap();
    held.weights_mut()[0] = 1.0;
    app.update();
    assert_eq!(below(&app, 0.0, 0.0), Some(5.0));
    app.world_mut().despawn(holder);
    let named = problems(&mut app);
    assert!(named[0].contains("morph weights is gone"), "{named:#?}");
}
