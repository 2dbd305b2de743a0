//! Only what changed is redone, and the rest is shared with the snapshot before.

use super::*;
use crate::scene::{Builder, Environment, RenderSettings};
use bevy::math::Vec3;

/// Which parts of two snapshots are one and the same.
#[derive(Debug, PartialEq)]
struct Shared {
    top_level: bool,
    objects: bool,
    materials: bool,
    textures: bool,
    lights: bool,
}

const ALL: Shared = Shared {
    top_level: true,
    objects: true,
    materials: true,
    textures: true,
    lights: true,
};

fn shared(a: &trace::World, b: &trace::World) -> Shared {
    Shared {
        top_level: Arc::ptr_eq(&a.aggregate, &b.aggregate),
        objects: Arc::ptr_eq(&a.objects, &b.objects),
        materials: Arc::ptr_eq(&a.materials, &b.materials),
        textures: Arc::ptr_eq(&a.textures, &b.textures),
        lights: Arc::ptr_eq(&a.lights, &b.lights),
    }
}

/// Whether object `i` of both has the same tree, in the object list and in the top level.
fn same_tree(a: &trace::World, b: &trace::World, i: usize) -> bool {
    let instance = |world: &trace::World| world.aggregate.instances()[i].mesh.clone();
    Arc::ptr_eq(&a.objects[i].mesh, &b.objects[i].mesh)
        && Arc::ptr_eq(&instance(a), &instance(b))
        && Arc::ptr_eq(&a.objects[i].mesh.tree, &instance(a))
}

#[test]
fn a_frame_without_an_edit_keeps_the_snapshot() {
    let mut small = Small::new();
    let before = world(&small.app);
    for _ in 0..3 {
        assert_eq!(frame(&mut small.app), Changes::default());
        assert!(Arc::ptr_eq(&before, &world(&small.app)));
    }
}

#[test]
fn objects_of_one_mesh_share_its_tree() {
    let small = Small::new();
    let world = world(&small.app);
    assert!(Arc::ptr_eq(&world.objects[0].mesh, &world.objects[1].mesh));
    assert!(!Arc::ptr_eq(&world.objects[0].mesh, &world.objects[2].mesh));
}

#[test]
fn moving_a_light_rebuilds_no_tree() {
    let mut small = Small::new();
    let before = world(&small.app);
    small.edit::<Transform>(small.light, |t| t.translation.y = 4.0);
    let changes = frame(&mut small.app);
    let after = world(&small.app);
    assert_eq!(
        changes,
        Changes {
            lights: true,
            ..Changes::default()
        }
    );
    assert_eq!(
        shared(&before, &after),
        Shared {
            lights: false,
            ..ALL
        }
    );
    assert_eq!(after.lights.points[0].position, Vec3::Y * 4.0);
}

#[test]
fn moving_an_object_rebuilds_the_top_level_alone() {
    let mut small = Small::new();
    let before = world(&small.app);
    small.edit::<Transform>(small.objects[1], |t| t.translation.y = 4.0);
    let changes = frame(&mut small.app);
    let after = world(&small.app);
    assert_eq!(
        changes,
        Changes {
            top_level: true,
            ..Changes::default()
        }
    );
    assert_eq!(
        shared(&before, &after),
        Shared {
            top_level: false,
            ..ALL
        }
    );
    assert!((0..3).all(|i| same_tree(&before, &after, i)));
}

#[test]
fn editing_a_material_rebuilds_no_tree() {
    let mut small = Small::new();
    let before = world(&small.app);
    small.edit::<Phong>(small.objects[2], |phong| phong.shininess = 99.0);
    let changes = frame(&mut small.app);
    let after = world(&small.app);
    assert_eq!(
        changes,
        Changes {
            materials: true,
            ..Changes::default()
        }
    );
    assert_eq!(
        shared(&before, &after),
        Shared {
            materials: false,
            ..ALL
        }
    );
    assert_eq!(after.materials[2].shininess, 99.0);
}

#[test]
fn a_write_that_changes_nothing_redoes_nothing_of_the_geometry() {
    let mut small = Small::new();
    let before = world(&small.app);
    small.edit::<Transform>(small.objects[0], |t| t.translation.x += 0.0);
    small.edit::<Phong>(small.objects[0], |phong| phong.opacity = 1.0);
    small.edit::<Transform>(small.light, |t| t.translation.x += 0.0);
    assert_eq!(frame(&mut small.app), Changes::default());
    assert!(Arc::ptr_eq(&before, &world(&small.app)));
}

#[test]
fn editing_a_mesh_rebuilds_its_tree_and_no_other() {
    let mut small = Small::new();
    let before = world(&small.app);
    let mut meshes = small.app.world_mut().resource_mut::<Assets<Mesh>>();
    *meshes.get_mut(&small.meshes[0]).unwrap() = fan(7);
    let changes = frame(&mut small.app);
    let after = world(&small.app);
    assert!(changes.meshes && changes.top_level && !changes.materials && !changes.lights);
    assert!(!same_tree(&before, &after, 0) && !same_tree(&before, &after, 1));
    assert!(same_tree(&before, &after, 2));
    assert_eq!(after.objects[1].mesh.tree.triangles().len(), 7);
    assert_eq!(frame(&mut small.app), Changes::default());
}

#[test]
fn swapping_the_mesh_of_an_object_for_one_in_use_builds_no_tree_but_the_top_level() {
    let mut small = Small::new();
    let before = world(&small.app);
    let mesh = small.meshes[1].clone();
    small.edit::<Mesh3d>(small.objects[0], |mesh3d| mesh3d.0 = mesh);
    let changes = frame(&mut small.app);
    let after = world(&small.app);
    assert!(changes.top_level && !changes.meshes);
    assert!(Arc::ptr_eq(&after.objects[0].mesh, &before.objects[2].mesh));
}

#[test]
fn tree_settings_rebuild_every_tree_and_other_settings_none() {
    let mut small = Small::new();
    let before = world(&small.app);
    let mut settings = small.app.world_mut().resource_mut::<RenderSettings>();
    settings.spp = 99;
    settings.features.shadows = false;
    assert_eq!(frame(&mut small.app), Changes::default());
    assert!(Arc::ptr_eq(&before, &world(&small.app)));

    let mut settings = small.app.world_mut().resource_mut::<RenderSettings>();
    settings.tree.builder = Builder::Ploc;
    let changes = frame(&mut small.app);
    let after = world(&small.app);
    assert!(changes.meshes && changes.top_level && !changes.materials && !changes.lights);
    assert!((0..3).all(|i| !same_tree(&before, &after, i)));
    assert_eq!(after.aggregate.options().builder, crate::bvh::Builder::Ploc);
}

#[test]
fn a_mesh_that_no_object_uses_any_more_is_dropped() {
    let mut small = Small::new();
    let mesh = Arc::downgrade(&world(&small.app).objects[2].mesh);
    small.app.world_mut().despawn(small.objects[2]);
    small.app.update();
    assert_eq!(world(&small.app).objects.len(), 2);
    assert_eq!(mesh.strong_count(), 0, "the tree is still in memory");
}

#[test]
fn the_background_and_the_camera_are_no_part_of_the_geometry() {
    let mut small = Small::new();
    let before = world(&small.app);
    small.edit::<Transform>(small.camera, |t| t.translation.z = 9.0);
    let changes = frame(&mut small.app);
    assert!(changes.cameras && !changes.any_in_world());
    assert!(Arc::ptr_eq(&before, &world(&small.app)));
    let cameras = small.app.world().resource::<crate::sync::TracedCameras>();
    assert_eq!(cameras.0[0].camera.position, Vec3::Z * 9.0);

    small
        .app
        .world_mut()
        .resource_mut::<Environment>()
        .background = LinearRgba::RED;
    assert!(frame(&mut small.app).environment);
    assert_eq!(shared(&before, &world(&small.app)), ALL);
    assert_eq!(world(&small.app).environment.background, Vec3::X);
}
