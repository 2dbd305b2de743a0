//! Only what changed is redone, and the rest is shared with the snapshot before.

use super::*;
use crate::scene::{
    Builder, Environment, EnvironmentMap, PhongMap, PhongMaps, RenderSettings, UsesMaterial,
};
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::hierarchy::ChildOf;
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

fn ids(app: &App) -> Vec<u64> {
    world(app).objects.iter().map(|object| object.id).collect()
}

#[test]
fn an_object_that_is_enabled_brings_its_mesh_and_its_picture_along() {
    let mut small = Small::new();
    let mesh = add_mesh(&mut small.app, 9);
    let maps = PhongMaps {
        diffuse: Some(add_image(&mut small.app, 7)),
        ..PhongMaps::default()
    };
    let place = Transform::default();
    let object = (Mesh3d(mesh), place, grey(0.4), maps, Disabled);
    let object = small.app.world_mut().spawn(object).id();
    small.app.update();
    assert_eq!(ids(&small.app).len(), 3);
    let is_there = |app: &App| {
        let last = world(app).objects.last().cloned().unwrap();
        assert_eq!(last.mesh.tree.triangles().len(), 9);
        assert_eq!(world(app).textures.len(), 1);
        assert!(problems(app).is_empty(), "{:?}", problems(app));
    };
    // What was made disabled Bevy shows when it is told to.
    let mut entity = small.app.world_mut().entity_mut(object);
    entity.remove::<Disabled>();
    entity.insert(Visibility::Visible);
    small.app.update();
    is_there(&small.app);

    // Nobody uses them meanwhile, and other meshes and pictures come.
    small.app.world_mut().entity_mut(object).insert(Disabled);
    small.app.update();
    let mesh = add_mesh(&mut small.app, 4);
    let mut second = small.app.world_mut().entity_mut(small.objects[1]);
    second.insert((Mesh3d(mesh), PhongMaps::default()));
    small.app.update();
    assert_eq!(ids(&small.app).len(), 3);
    small
        .app
        .world_mut()
        .entity_mut(object)
        .remove::<Disabled>();
    small.app.update();
    is_there(&small.app);
}

#[test]
fn hidden_disabled_and_deleted_objects_vanish_and_come_back() {
    let mut small = Small::new();
    let [first, second, third] = small.objects;
    let before = world(&small.app);
    assert_eq!(ids(&small.app), [1, 2, 3]);

    small
        .app
        .world_mut()
        .entity_mut(first)
        .insert(Visibility::Hidden);
    assert!(frame(&mut small.app).top_level);
    assert_eq!(ids(&small.app), [2, 3]);

    small.app.world_mut().entity_mut(second).insert(Disabled);
    assert!(frame(&mut small.app).top_level);
    assert_eq!(ids(&small.app), [3]);

    small.app.world_mut().entity_mut(third).remove::<Mesh3d>();
    assert!(frame(&mut small.app).top_level);
    assert_eq!(ids(&small.app), [0; 0]);

    small
        .app
        .world_mut()
        .entity_mut(first)
        .insert(Visibility::Inherited);
    small
        .app
        .world_mut()
        .entity_mut(second)
        .remove::<Disabled>();
    frame(&mut small.app);
    assert_eq!(ids(&small.app), [1, 2]);
    // The trees of hidden and disabled objects: the first stayed in use throughout.
    assert_eq!(
        world(&small.app).materials.len(),
        before.materials.len() - 1
    );

    small.app.world_mut().despawn(first);
    small.app.world_mut().despawn(second);
    assert!(frame(&mut small.app).top_level);
    assert!(world(&small.app).aggregate.instances().is_empty());
}

#[test]
fn a_child_follows_its_parents_place_and_visibility() {
    let mut small = Small::new();
    let [parent, child, _] = small.objects;
    small
        .app
        .world_mut()
        .entity_mut(child)
        .insert(ChildOf(parent));
    small.edit::<Transform>(parent, |t| t.translation.z = 5.0);
    small.app.update();
    let place = |app: &App| {
        let world = world(app);
        Vec3::from(
            world.aggregate.instances()[1]
                .world_from_object()
                .translation,
        )
    };
    assert_eq!(place(&small.app), Vec3::new(3.0, 0.0, 5.0));

    small
        .app
        .world_mut()
        .entity_mut(parent)
        .insert(Visibility::Hidden);
    small.app.update();
    assert_eq!(ids(&small.app), [3]);

    small.app.world_mut().entity_mut(child).remove::<ChildOf>();
    small.app.update();
    assert_eq!(ids(&small.app), [2, 3]);
}

#[test]
fn a_shared_material_colours_all_that_name_it_and_its_own_returns_when_it_goes() {
    let mut small = Small::new();
    let shared = small.app.world_mut().spawn(grey(0.9)).id();
    for object in [small.objects[0], small.objects[2]] {
        small
            .app
            .world_mut()
            .entity_mut(object)
            .insert(UsesMaterial(shared));
    }
    let changes = frame(&mut small.app);
    assert!(changes.materials && changes.objects && !changes.top_level);
    let value = |app: &App, i: usize| {
        let world = world(app);
        world.materials[world.objects[i].material as usize]
            .diffuse
            .x
    };
    let values = |app: &App| [0, 1, 2].map(|i| value(app, i));
    assert_eq!(values(&small.app), [0.9, 0.2, 0.9]);
    assert_eq!(world(&small.app).materials.len(), 2);

    small
        .app
        .world_mut()
        .entity_mut(small.objects[0])
        .remove::<UsesMaterial>();
    small.app.update();
    assert_eq!(values(&small.app), [0.1, 0.2, 0.9]);

    small.app.world_mut().despawn(shared);
    small.app.update();
    assert_eq!(values(&small.app), [0.1, 0.2, 0.3]);
    assert_eq!(problems(&small.app).len(), 1, "{:?}", problems(&small.app));
}

#[test]
fn an_object_without_a_material_gets_the_default_one() {
    let mut app = app();
    let mesh = add_mesh(&mut app, 3);
    app.world_mut().spawn(Mesh3d(mesh));
    app.update();
    let world = world(&app);
    assert_eq!(*world.materials, [trace::Material::default()]);
    assert_eq!(world.objects[0].material, 0);
}

#[test]
fn a_picture_is_shared_by_materials_and_environment_and_follows_its_asset() {
    let mut small = Small::new();
    let picture = add_image(&mut small.app, 10);
    for object in small.objects {
        let maps = PhongMaps {
            diffuse: Some(picture.clone()),
            ..PhongMaps::default()
        };
        small.app.world_mut().entity_mut(object).insert(maps);
    }
    small
        .app
        .world_mut()
        .insert_resource(EnvironmentMap(Some(picture.clone())));
    let changes = frame(&mut small.app);
    assert!(changes.textures && changes.materials && changes.environment && !changes.top_level);
    let before = world(&small.app);
    assert_eq!(before.textures.len(), 1);
    let texture = |m: &crate::trace::Material| m.map(PhongMap::Diffuse).map(|map| map.texture);
    assert!(before.materials.iter().all(|m| texture(m) == Some(0)));
    assert!(Arc::ptr_eq(
        before.environment.map.as_ref().unwrap(),
        &before.textures[0]
    ));

    let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
    *images.get_mut(&picture).unwrap() = image(77);
    let changes = frame(&mut small.app);
    assert!(changes.textures && changes.environment && !changes.materials && !changes.objects);
    assert_eq!(
        world(&small.app).textures[0].texel(0, 0, true).x,
        77.0 / 255.0
    );

    small
        .app
        .world_mut()
        .resource_mut::<RenderSettings>()
        .features
        .environment = false;
    let changes = frame(&mut small.app);
    assert_eq!(
        changes,
        Changes {
            environment: true,
            ..Changes::default()
        }
    );
    assert!(world(&small.app).environment.map.is_none());
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
