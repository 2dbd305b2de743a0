//! What is not there to be inspected: said, without a panic.

use super::{Scene, is_near};
use crate::analytic::{object, quad, world};
use glam::{UVec2, Vec3};
use glassbox::inspect::{
    BoxChoice, InspectPreset, InspectSettings, Subject, System, Traversal, explanation, lines,
    sources,
};
use glassbox::trace::{Camera, Material, ProbeError, Samples, World, probe};
use std::collections::BTreeMap;

fn everything() -> InspectSettings {
    let mut inspect = InspectPreset::WhereIsTheNoiseFrom.settings();
    inspect.boxes.on = true;
    inspect.boxes.split_planes = true;
    inspect.boxes.triangles = true;
    inspect.normals.on = true;
    inspect.rays.visited = true;
    inspect.rays.pruned = true;
    inspect.rays.hit_triangles = true;
    inspect.rays.hit_normals = true;
    inspect
}

fn camera() -> Camera {
    Camera::looking_at(Vec3::Z * 3.0, Vec3::ZERO, Vec3::Y, 0.8)
}

#[test]
fn a_pixel_outside_the_picture_and_a_sample_that_is_not_taken_are_named() {
    let scene = Scene::of(World::default(), camera());
    let ask = |pixel, samples| {
        probe(
            &scene.world,
            &scene.camera,
            &scene.settings,
            pixel,
            &samples,
        )
        .unwrap_err()
    };
    let outside = ask(UVec2::new(1, 0), Samples::All);
    assert!(matches!(outside, ProbeError::Outside { .. }));
    assert!(
        outside.to_string().contains("columns go from 0 to 0"),
        "{outside}"
    );
    let missing = ask(UVec2::ZERO, Samples::One(1));
    assert_eq!(missing, ProbeError::NoSuchSample { index: 1, count: 1 });
}

#[test]
fn a_ray_into_an_empty_scene_is_a_miss_and_every_system_says_what_is_missing() {
    let scene = Scene::of(World::default(), camera());
    let rays = scene.probe(Samples::All);
    assert_eq!(rays.rays.len(), 1);
    assert_eq!(
        (rays.rays[0].hit, rays.samples[0].value),
        (None, Vec3::ZERO)
    );
    assert!(
        Traversal::of(&scene.world, &scene.settings, &rays, 0)
            .steps
            .is_empty()
    );
    let inspect = everything();
    let (world, camera, settings) = (&scene.world, &scene.camera, &scene.settings);
    let subject = Subject::new(world, camera, settings, &inspect, Some(&rays));
    for system in System::ALL {
        let set = system.lines(&subject);
        let expected = matches!(system, System::Rays | System::Visits);
        assert!(expected || !set.notes.is_empty(), "{system:?} says nothing");
    }
    assert_eq!(sources(&rays).len(), 1);
    assert!(explanation(&rays, &BTreeMap::new())[0].contains("meet nothing"));
}

#[test]
fn rays_that_are_older_than_the_world_and_objects_that_are_gone_do_no_harm() {
    let pane = quad(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0);
    let glass = Material {
        opacity: 0.5,
        ..Material::default()
    };
    let before = Scene::of(world(vec![object(1, &pane, 0)], vec![glass]), camera());
    let rays = before.probe(Samples::All);
    assert_eq!(rays.rays.len(), 2);
    let after = Scene::of(World::default(), camera());
    let mut inspect = everything();
    inspect.boxes.object = 1;
    inspect.normals.object = 1;
    inspect.rays.nodes_of = 77;
    let (world, camera, settings) = (&after.world, &after.camera, &after.settings);
    let subject = Subject::new(world, camera, settings, &inspect, Some(&rays));
    let sets = lines(&subject);
    for system in [System::Boxes, System::Normals] {
        let set = sets.iter().find(|set| set.system == system).unwrap();
        assert!(set.is_empty() && set.notes[0].contains("object 1 is not in the scene"));
    }
    for index in 0..4 {
        let traversal = Traversal::of(&after.world, &after.settings, &rays, index);
        assert_eq!(traversal.steps.len(), 0);
    }
}

#[test]
fn a_tree_of_one_leaf_has_one_box_one_leaf_and_no_plane() {
    let scene = Scene::open("triangle", UVec2::new(9, 9));
    let mut inspect = everything();
    let rays = scene.probe(Samples::One(0));
    let (world, camera, settings) = (&scene.world, &scene.camera, &scene.settings);
    for choice in [BoxChoice::Levels, BoxChoice::Leaf, BoxChoice::Path] {
        inspect.boxes.choice = choice;
        inspect.boxes.object = match choice {
            BoxChoice::Path => scene.world.objects[0].id,
            _ => 0,
        };
        let subject = Subject::new(world, camera, settings, &inspect, Some(&rays));
        let set = System::Boxes.lines(&subject);
        assert!(!set.segments.is_empty(), "{choice:?}: {:?}", set.notes);
        assert!(set.planes.is_empty(), "{choice:?}");
    }
}

#[test]
fn the_master_switch_hides_everything() {
    let scene = Scene::open("triangle", UVec2::new(9, 9));
    let rays = scene.probe(Samples::One(0));
    let inspect = InspectSettings {
        on: false,
        ..everything()
    };
    let (world, camera, settings) = (&scene.world, &scene.camera, &scene.settings);
    let subject = Subject::new(world, camera, settings, &inspect, Some(&rays));
    assert!(lines(&subject).is_empty());
}

#[test]
fn another_camera_sees_the_same_lines_from_elsewhere() {
    let scene = Scene::open("triangle", UVec2::new(9, 9));
    let rays = scene.probe(Samples::One(0));
    let inspect = InspectSettings::default();
    let (world, settings) = (&scene.world, &scene.settings);
    let watching = Camera::looking_at(Vec3::splat(9.0), Vec3::ZERO, Vec3::Y, 0.8);
    let own = Subject::new(world, &scene.camera, settings, &inspect, Some(&rays));
    let (own, other) = (
        System::Rays.lines(&own),
        System::Rays.lines(&own.seen_by(&watching)),
    );
    for (a, b) in own.segments.iter().zip(&other.segments) {
        assert!(is_near(a.ends[0], b.ends[0]));
    }
}
