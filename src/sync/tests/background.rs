//! Trees that are built in the background: the frame does not wait, and what was there before stays.
//!
//! A mesh's tree is taken at the earliest in the frame after the one that began it, so that what the tests
//! say of that frame does not depend on the threads' speed.

use super::*;
use crate::bvh::Aggregate;
use crate::scene::{Builder, Levels, RenderSettings};
use crate::sync::finish;
use crate::sync::tree_building::TopLevelThread;
use std::sync::mpsc::{Sender, channel};
use std::thread;
use std::time::Duration;

fn small() -> Small {
    let mut small = Small::new();
    small.app.insert_resource(TreeBuilding::InBackground);
    small
}

pub(super) fn pending(app: &App) -> usize {
    app.world().resource::<Traced>().pending
}

fn triangles(app: &App) -> Vec<usize> {
    let world = world(app);
    let objects = world.objects.iter();
    objects.map(|o| o.mesh.tree.triangles().len()).collect()
}

fn edit_mesh(small: &mut Small, mesh: usize, sides: u32) {
    let mut meshes = small.app.world_mut().resource_mut::<Assets<Mesh>>();
    *meshes.get_mut(&small.meshes[mesh]).unwrap() = fan(sides);
}

/// Frames until this is so.
pub(super) fn until(app: &mut App, is_so: impl Fn(&App) -> bool) {
    let mut frames = 0;
    while !is_so(app) {
        app.update();
        frames += 1;
        assert!(frames < 60_000, "it never is");
        thread::sleep(Duration::from_millis(1));
    }
}

/// Of the first object.
fn height(app: &App) -> f32 {
    let place = *world(app).aggregate.instances()[0].world_from_object();
    place.translation.y
}

/// The thread that builds the tree over the objects is busy with one that nobody wants any more, until
/// something is sent.
fn busy(small: &mut Small) -> Sender<()> {
    let (release, gate) = channel();
    let mut thread = small.app.world_mut().resource_mut::<TopLevelThread>();
    thread.start(move || {
        let _ = gate.recv();
        (u64::MAX, Aggregate::default())
    });
    release
}

#[test]
fn an_edited_mesh_is_traced_as_it_was_until_its_tree_is_there() {
    let mut small = small();
    let before = world(&small.app);
    edit_mesh(&mut small, 0, 7);
    assert_eq!(frame(&mut small.app), Changes::default());
    assert_eq!(pending(&small.app), 1);
    assert!(Arc::ptr_eq(&before, &world(&small.app)));
    finish(&mut small.app);
    let changes = small.app.world().resource::<Traced>().changes;
    assert!(changes.meshes && changes.top_level && !changes.materials);
    assert_eq!(pending(&small.app), 0);
    assert_eq!(triangles(&small.app), [7, 7, 5]);
    assert_eq!(frame(&mut small.app), Changes::default());
}

#[test]
fn it_appears_by_itself_in_some_later_frame() {
    let mut small = small();
    edit_mesh(&mut small, 0, 7);
    until(&mut small.app, |app| triangles(app) == [7, 7, 5]);
    until(&mut small.app, |app| pending(app) == 0);
}

#[test]
fn an_object_with_another_mesh_keeps_its_old_one_and_a_new_object_appears_with_its_mesh() {
    let mut small = small();
    let mesh = add_mesh(&mut small.app, 9);
    small.edit::<Mesh3d>(small.objects[0], |mesh3d| mesh3d.0 = mesh.clone());
    let new = small.app.world_mut().spawn(Mesh3d(mesh)).id();
    small.app.update();
    assert_eq!(triangles(&small.app), [3, 3, 5]);
    assert!(problems(&small.app).is_empty());
    // Moving it meanwhile moves what is there.
    small.edit::<Transform>(small.objects[0], |t| t.translation.y = 4.0);
    until(&mut small.app, |app| height(app) == 4.0);
    finish(&mut small.app);
    assert_eq!(triangles(&small.app), [9, 3, 5, 9]);
    assert!(small.app.world().get_entity(new).is_ok());
}

#[test]
fn of_edits_that_follow_one_another_the_last_one_counts() {
    let mut small = small();
    for sides in 6..30 {
        edit_mesh(&mut small, 0, sides);
        small.app.update();
        // The mesh's, and the one over the objects.
        assert!(pending(&small.app) <= 2, "{} builds", pending(&small.app));
    }
    finish(&mut small.app);
    assert_eq!(triangles(&small.app), [29, 29, 5]);
}

#[test]
fn trees_of_other_settings_are_shown_all_at_once() {
    let mut small = small();
    let before = world(&small.app);
    let mut settings = small.app.world_mut().resource_mut::<RenderSettings>();
    settings.tree.builder = Builder::Ploc;
    small.app.update();
    assert_eq!(pending(&small.app), 2);
    assert!(Arc::ptr_eq(&before, &world(&small.app)));
    // Meanwhile the edits of other parts are shown, with the trees as they were.
    small.edit::<Transform>(small.objects[0], |t| t.translation.y = 4.0);
    edit_mesh(&mut small, 1, 8);
    small.app.update();
    let builder = |app: &App| world(app).aggregate.options().builder;
    if pending(&small.app) > 0 {
        assert_eq!(builder(&small.app), crate::bvh::Builder::Sah);
    }
    finish(&mut small.app);
    assert_eq!(builder(&small.app), crate::bvh::Builder::Ploc);
    assert_eq!(triangles(&small.app), [3, 3, 8]);
}

#[test]
fn an_edit_made_under_other_settings_is_kept_when_they_go_back() {
    let mut small = small();
    // One that takes long, so that the other is ready first.
    edit_mesh(&mut small, 1, 200_000);
    small.app.update();
    let set = |small: &mut Small, builder| {
        let mut settings = small.app.world_mut().resource_mut::<RenderSettings>();
        settings.tree.builder = builder;
        small.app.update();
    };
    edit_mesh(&mut small, 0, 7);
    set(&mut small, Builder::Ploc);
    until(&mut small.app, |app| pending(app) < 2);
    set(&mut small, Builder::Sah);
    finish(&mut small.app);
    assert_eq!(triangles(&small.app), [7, 7, 200_000]);
}

#[test]
fn what_cannot_be_traced_is_named_without_waiting_and_a_mesh_that_went_is_not_shown() {
    let mut small = small();
    let mut meshes = small.app.world_mut().resource_mut::<Assets<Mesh>>();
    *meshes.get_mut(&small.meshes[1]).unwrap() =
        Mesh::new(PrimitiveTopology::LineList, RenderAssetUsages::MAIN_WORLD)
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0; 3]; 2]);
    // At the latest when the small tree over the other objects is there.
    until(&mut small.app, |app| !problems(app).is_empty());
    assert_eq!(problems(&small.app).len(), 1, "{:?}", problems(&small.app));

    edit_mesh(&mut small, 0, 7);
    small.app.update();
    let mesh = small.meshes[0].clone();
    let mut meshes = small.app.world_mut().resource_mut::<Assets<Mesh>>();
    meshes.remove(&mesh);
    finish(&mut small.app);
    assert_eq!(problems(&small.app).len(), 3, "{:?}", problems(&small.app));
    assert!(world(&small.app).objects.is_empty());
}

#[test]
fn while_the_tree_over_the_objects_is_built_no_frame_waits_and_what_is_shown_fits_together() {
    let mut small = small();
    let before = world(&small.app);
    let release = busy(&mut small);
    small.edit::<Transform>(small.objects[0], |t| t.translation.y = 4.0);
    assert_eq!(frame(&mut small.app), Changes::default());
    assert!(Arc::ptr_eq(&before, &world(&small.app)));
    assert_eq!(pending(&small.app), 1);
    // The objects are the same ones: what else is edited shows, with the tree as it was.
    small.edit::<Phong>(small.objects[1], |phong| phong.shininess = 99.0);
    assert!(frame(&mut small.app).materials && height(&small.app) == 0.0);
    // One goes: what is left of it, its material, is not shown on another until the tree is there.
    let shown = world(&small.app);
    small.app.world_mut().despawn(small.objects[1]);
    small.edit::<Phong>(small.objects[2], |phong| phong.shininess = 77.0);
    assert_eq!(frame(&mut small.app), Changes::default());
    assert!(Arc::ptr_eq(&shown, &world(&small.app)));
    release.send(()).unwrap();
    until(&mut small.app, |app| pending(app) == 0);
    assert_eq!(
        (triangles(&small.app), height(&small.app)),
        (vec![3, 5], 4.0)
    );
    let world = world(&small.app);
    assert_eq!(
        world.materials[world.objects[1].material as usize].shininess,
        77.0
    );
    assert_eq!(world.aggregate.instances().len(), 2);
}

#[test]
fn who_waits_for_all_trees_waits_for_none_that_nobody_wants() {
    let mut small = small();
    let release = busy(&mut small);
    small.app.world_mut().despawn(small.objects[0]);
    finish(&mut small.app);
    assert_eq!(
        (triangles(&small.app), pending(&small.app)),
        (vec![3, 5], 0)
    );
    // Nor does it come back.
    release.send(()).unwrap();
    small.edit::<Transform>(small.objects[1], |t| t.translation.y = 4.0);
    until(&mut small.app, |app| height(app) == 4.0);
    assert_eq!(triangles(&small.app), [3, 5]);
}

#[test]
fn objects_that_come_and_go_in_every_frame_are_traced_all_the_same() {
    let mut small = small();
    let mesh = add_mesh(&mut small.app, 3);
    let thing = |mesh: &Handle<Mesh>, i: usize| {
        let place = Transform::from_xyz(i as f32, 0.0, 0.0);
        (Mesh3d(mesh.clone()), Phong::default(), place)
    };
    // So many that the tree over them is not there when the frame ends.
    let many: Vec<_> = (0..20_000).map(|i| thing(&mesh, i)).collect();
    small.app.world_mut().spawn_batch(many);
    let mut newest = None;
    let mut traced = 0;
    // A frame may be far shorter than a tree takes.
    for i in 0..60_000 {
        let world = small.app.world_mut();
        if let Some(before) = newest.replace(world.spawn(thing(&mesh, i)).id()) {
            world.despawn(before);
        }
        frame(&mut small.app);
        traced = self::world(&small.app).aggregate.instances().len();
        if traced > 20_000 {
            break;
        }
        thread::sleep(Duration::from_millis(1));
    }
    assert!(traced > 20_000, "{traced} objects are traced");
}

#[test]
fn no_frame_waits_for_a_tree_that_takes_long_and_all_that_comes_and_goes_shows_in_turn() {
    let mut small = small();
    let mut settings = small.app.world_mut().resource_mut::<RenderSettings>();
    // Over all triangles: far more than a tenth of a second.
    settings.tree.levels = Levels::One;
    let mesh = add_mesh(&mut small.app, 400);
    let thing = |i: usize, color: f32| {
        let phong = Phong {
            emission: LinearRgba::rgb(color, 0.0, 0.0),
            ..Phong::default()
        };
        let place = Transform::from_xyz(i as f32, 0.0, 0.0);
        (Mesh3d(mesh.clone()), phong, place)
    };
    let many: Vec<_> = (0..1000).map(|i| thing(i, 0.0)).collect();
    small.app.world_mut().spawn_batch(many);
    finish(&mut small.app);
    // In each frame another one, in a colour of its own.
    let mut newest = None;
    let mut seen = Vec::new();
    for frame in 1..60_000 {
        let world = small.app.world_mut();
        let next = world.spawn(thing(frame, frame as f32)).id();
        if let Some(before) = newest.replace(next) {
            world.despawn(before);
        }
        small.app.update();
        let traced = self::world(&small.app);
        let instances = traced.aggregate.instances();
        assert_eq!(instances.len(), traced.objects.len(), "frame {frame}");
        let last = traced.objects.iter().zip(instances).next_back();
        let (object, instance) = last.expect("there are a thousand");
        let place = instance.world_from_object().translation.x;
        let color = traced.materials[object.material as usize].emission.x;
        if color > 0.0 {
            assert_eq!(
                color, place,
                "frame {frame}: of one the place, of another the colour"
            );
            if seen.last() != Some(&place) {
                seen.push(place);
            }
        }
        if seen.len() == 4 {
            break;
        }
        thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(seen.len(), 4, "of those that came {seen:?} were seen");
    assert!(seen.is_sorted(), "{seen:?}");
}
