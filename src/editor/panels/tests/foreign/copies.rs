//! Copies of them, and files that keep them.

use super::super::desk::{Desk, LARGE};
use super::{Fence, Growing, Hidden, Plant, garden, growing};
use crate::editor::edits::{duplicate, scene_entity};
use crate::io::{KeepInSceneFiles, OpenOptions, SceneSource, open, save};
use bevy::asset::Assets;
use bevy::ecs::component::Component;
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::math::primitives::Cuboid;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::{Mesh, Mesh3d};

/// Neither cloned nor reflected.
#[derive(Component)]
struct Opaque;

#[test]
fn a_copy_has_all_that_can_be_cloned_or_reflected_and_says_what_it_lacks() {
    let (mut desk, entity, id) = garden(Opaque);
    let flower = Mesh3d(
        desk.world()
            .resource_mut::<Assets<Mesh>>()
            .add(Cuboid::default()),
    );
    // Below it, and no part of the scene.
    let below = desk.world().spawn((Hidden { depth: 3.0 }, ChildOf(entity)));
    let below = below.id();
    let named = MeshMorphWeights::Reference(below);
    desk.world()
        .entity_mut(entity)
        .insert((flower.clone(), named));
    let copies = duplicate(desk.world(), &[id]);
    assert_eq!(copies.lost.len(), 1, "{:?}", copies.lost);
    let said = &copies.lost[0];
    assert!(
        said.contains("Opaque") && said.contains("Mirror block"),
        "{said}"
    );
    let world = desk.world();
    let twin = scene_entity(world, copies.roots[0]).unwrap();
    assert_eq!(world.get::<Mesh3d>(twin), Some(&flower));
    let children = world.get::<Children>(twin).unwrap();
    let copied = children[0];
    assert!(children.len() == 1 && copied != below);
    assert_eq!(world.get::<Hidden>(copied).unwrap().depth, 3.0);
    let names = world.get::<MeshMorphWeights>(twin).unwrap();
    assert!(
        matches!(names, MeshMorphWeights::Reference(named) if *named == copied),
        "{names:?}"
    );
}

#[test]
fn what_an_app_keeps_in_files_comes_back_from_them_and_nothing_else_does() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("garden.scn.ron");
    let odd = Growing {
        girth: 3.5,
        kind: Plant::Vine(2.0, 9),
        since: Some(f32::INFINITY),
        ..Growing::default()
    };
    let (mut desk, _, _) = garden((odd.clone(), Fence { posts: 4 }, Hidden { depth: 2.0 }));
    desk.app
        .keep_in_scene_files::<Growing>()
        .keep_in_scene_files::<Hidden>();
    save(desk.world(), &file).unwrap();
    let source = SceneSource::File(file.clone());
    open(desk.world(), &source, OpenOptions::default()).unwrap();
    desk.settle();
    let (entity, _) = desk.named("Mirror block");
    assert_eq!(growing(&mut desk, entity), odd);
    assert_eq!(desk.world().get(entity), Some(&Hidden { depth: 2.0 }));
    assert!(desk.world().get::<Fence>(entity).is_none());
    let again = folder.path().join("again.scn.ron");
    save(desk.world(), &again).unwrap();
    assert!(
        std::fs::read(&file).unwrap() == std::fs::read(&again).unwrap(),
        "the same scene gives the same bytes"
    );
    // An app that does not know it says so.
    let mut other = Desk::empty(LARGE);
    let error = open(other.world(), &source, OpenOptions::default()).unwrap_err();
    assert!(error.to_string().contains("garden::Growing"), "{error}");
}
