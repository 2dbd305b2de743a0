//! Why a pixel is black, of surfaces that are seen through and mirror a little.

use super::Scene;
use super::lights_and_rays::{camera, floor, lamp, matt, screen};
use crate::analytic::{object, world};
use glam::Vec3;
use glassbox::inspect::{Question, answer, mirror_ray};
use glassbox::trace::{Lights, Material, RayKind, Samples};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A pane half-way between the camera and a floor, under a lamp.
fn pane(opacity: f32, mirror: f32, diffuse: f32, is_lit: bool) -> Scene {
    let pane = Material {
        opacity,
        mirror: Vec3::splat(mirror),
        shininess: 1e6,
        ..matt(Vec3::splat(diffuse))
    };
    let objects = vec![object(1, &floor(), 0), object(2, &screen(0.5), 1)];
    let mut world = world(objects, vec![matt(Vec3::splat(0.5)), pane]);
    // Below the pane it lights the floor alone.
    let height = if is_lit { 2.0 } else { 0.25 };
    world.lights = Arc::new(Lights {
        points: vec![lamp(Vec3::new(0.0, height, 0.2), Vec3::splat(10.0))],
        ..Lights::default()
    });
    Scene::of(world, camera())
}

#[test]
fn of_a_pane_that_mirrors_a_little_the_answer_is_what_most_of_its_light_comes_from() {
    let names = [(1, "Floor"), (2, "Pane"), (100, "Lamp")];
    let names: BTreeMap<u64, String> = names.map(|(id, name)| (id, name.into())).into();
    for (opacity, mirror, diffuse, is_lit, said) in [
        (
            0.1,
            0.05,
            0.8,
            true,
            "is transparent, and behind it is Floor, which is lit by Lamp.",
        ),
        (
            0.1,
            0.05,
            0.8,
            false,
            "is transparent, and behind it is Floor, which is lit by Lamp.",
        ),
        (0.9, 0.9, 0.1, true, "is a mirror that sees the background."),
        (
            0.9,
            0.9,
            0.1,
            false,
            "is a mirror that sees the background.",
        ),
        (0.9, 0.05, 0.8, true, "is lit by Lamp."),
    ] {
        let rays = pane(opacity, mirror, diffuse, is_lit).probe(Samples::All);
        let kinds: Vec<RayKind> = rays.rays.iter().map(|ray| ray.kind).collect();
        let both = [RayKind::Mirror, RayKind::Transmission];
        assert!(both.iter().all(|kind| kinds.contains(kind)), "{kinds:?}");
        let text = answer(Question::Black, &rays, &names);
        assert_eq!(
            text,
            format!("Pane {said}"),
            "{opacity}, {mirror}, {is_lit}"
        );
        assert_eq!(
            mirror_ray(&rays).is_some(),
            said.contains("mirror"),
            "{text}"
        );
    }
}
