//! An app lets the systems rest, and much happens meanwhile.

use super::*;
use crate::scene::{PhongMaps, SceneId};
use crate::sync::{SyncSystems, TracedCameras};
use bevy::app::PostUpdate;
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::Res;

#[derive(Resource)]
struct Rests(bool);

/// A scene with a picture, whose systems rest where [`Rests`] says so; they do not yet.
fn that_may_rest() -> (Small, Handle<Image>) {
    let mut small = Small::new();
    let picture = add_image(&mut small.app, 10);
    let maps = PhongMaps {
        diffuse: Some(picture.clone()),
        ..PhongMaps::default()
    };
    let object = small.objects[0];
    small.app.world_mut().entity_mut(object).insert(maps);
    let awake = |rests: Res<Rests>| !rests.0;
    small
        .app
        .insert_resource(Rests(false))
        .configure_sets(PostUpdate, SyncSystems.run_if(awake));
    small.app.update();
    (small, picture)
}

#[test]
fn what_went_and_what_was_edited_during_a_rest_is_known_after_it() {
    let (mut small, picture) = that_may_rest();
    assert_eq!(world(&small.app).objects.len(), 3);
    small.app.insert_resource(Rests(true));
    let rest = |small: &mut Small| {
        for _ in 0..4 {
            small.app.update();
        }
    };
    rest(&mut small);
    small.app.world_mut().despawn(small.objects[1]);
    small
        .app
        .world_mut()
        .entity_mut(small.objects[2])
        .remove::<Phong>();
    small.app.world_mut().despawn(small.light);
    small.app.world_mut().despawn(small.camera);
    rest(&mut small);
    let world_mut = small.app.world_mut();
    *world_mut
        .resource_mut::<Assets<Image>>()
        .get_mut(&picture)
        .unwrap() = image(77);
    let mesh = &small.meshes[0];
    *world_mut
        .resource_mut::<Assets<Mesh>>()
        .get_mut(mesh)
        .unwrap() = fan(8);
    // What a rest hides is not forgotten by whoever gets a number afterwards.
    world_mut.spawn((SceneId(2), Phong::default()));
    rest(&mut small);
    small.app.insert_resource(Rests(false));
    small.app.update();
    let world = world(&small.app);
    let found: Vec<_> = (world.objects.iter())
        .map(|object| (object.id, object.mesh.tree.triangles().len()))
        .collect();
    assert_eq!(found, [(1, 8), (3, 5)]);
    assert_eq!(world.aggregate.instances().len(), 2);
    assert_eq!(world.lights.points.len(), 0);
    assert_eq!(small.app.world().resource::<TracedCameras>().0, []);
    assert_eq!(world.textures[0].texel(0, 0, true).x, 77.0 / 255.0);
    let material = |i: usize| &world.materials[world.objects[i].material as usize];
    assert_eq!(*material(1), trace::Material::default());
}

#[test]
fn a_rest_in_which_nothing_happened_replaces_nothing() {
    let (mut small, _) = that_may_rest();
    let before = world(&small.app).clone();
    for rests in [true, true, true, true, false, false] {
        small.app.insert_resource(Rests(rests)).update();
    }
    let after = world(&small.app);
    assert!(Arc::ptr_eq(&before.aggregate, &after.aggregate));
    assert!(Arc::ptr_eq(&before.objects, &after.objects));
    assert!(Arc::ptr_eq(&before.textures, &after.textures));
}
