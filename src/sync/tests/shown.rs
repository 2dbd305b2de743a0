//! What is there to be seen, as entities come, go and name one another.

use super::*;
use crate::scene::{EnvironmentMap, PhongMap, PhongMaps, RenderSettings, UsesMaterial};
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::hierarchy::ChildOf;
use bevy::math::Vec3;

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
