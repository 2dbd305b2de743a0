//! S13–S16: the debug rays of effects that shoot many for one, at points worked out by hand.

use super::lights_and_rays::{EYE, camera, floor, lamp, matt, rays, screen};
use super::{Scene, WHITE, expect, is_near, segment};
use crate::analytic::{object, world};
use glam::Vec3;
use glassbox::inspect::{
    Document, InspectSettings, Question, RayLine, System, answer, explanation,
};
use glassbox::scene::{PixelSampling, Projection};
use glassbox::trace::{Camera, Lights, Material, PointLight, RayEnd, Samples};
use std::collections::BTreeMap;
use std::sync::Arc;

#[test]
fn s13_all_camera_rays_of_the_pixel_are_drawn_one_in_each_cell_of_the_grid() {
    let world = world(vec![object(1, &floor(), 0)], vec![Material::default()]);
    // Straight down from 1 m, 4 m of floor in sight: place in the pixel = place on the floor.
    let camera = Camera {
        projection: Projection::Orthographic { height: 4.0 },
        ..Camera::looking_at(Vec3::Y, Vec3::ZERO, Vec3::NEG_Z, 0.5)
    };
    let mut scene = Scene::of(world, camera);
    scene.settings.pixel = PixelSampling::Area;
    scene.settings.jitter = 4;
    let set = rays(&scene);
    let mut cells: Vec<i32> = set
        .segments
        .iter()
        .map(|s| {
            assert!(s.ends[1].y.abs() < 1e-3);
            (s.ends[1].x + 2.0).floor() as i32 * 4 + (s.ends[1].z + 2.0).floor() as i32
        })
        .collect();
    cells.sort_unstable();
    cells.dedup();
    assert_eq!((set.segments.len(), cells.len()), (16, 16));
}

#[test]
fn s14_every_ray_of_a_blurred_reflection_passes_its_disc() {
    let shiny = Material {
        specular: Vec3::ONE,
        mirror: Vec3::ONE,
        shininess: 10.0,
        ..matt(Vec3::ZERO)
    };
    let mut scene = Scene::of(world(vec![object(1, &floor(), 0)], vec![shiny]), camera());
    scene.settings.features.glossy = true;
    scene.settings.gloss_samples = 32;
    assert_eq!(rays(&scene).segments.len(), 33);
    let set = scene.lines(System::Lobes, &InspectSettings::default());
    // The disc: perpendicular to (0, 1, -1), its radius a tenth of its distance from the hit.
    let axis = Vec3::new(0.0, 1.0, -1.0).normalize();
    let distance = 0.15 * EYE.length();
    let center = distance * axis;
    segment(&set, Vec3::ZERO, center);
    assert_eq!(set.points.len(), 32);
    for dot in &set.points {
        let offset = dot.at - center;
        assert!(
            offset.dot(axis).abs() < 1e-4,
            "{offset} is not in the disc's plane"
        );
        assert!(
            offset.length() <= 0.1 * distance + 1e-4,
            "{offset} is outside the disc"
        );
    }
    let farthest = set
        .points
        .iter()
        .map(|dot| (dot.at - center).length())
        .fold(0.0, f32::max);
    assert!(
        farthest > 0.08 * distance,
        "32 samples reach {farthest} of {distance}"
    );
}

#[test]
fn s15_rays_go_on_through_glass_and_shadow_rays_take_its_tint() {
    let glass = Material {
        opacity: 0.5,
        ..matt(Vec3::new(0.2, 0.6, 1.0))
    };
    let mut world = world(
        vec![object(1, &floor(), 0), object(2, &screen(0.5), 1)],
        vec![matt(Vec3::ONE), glass],
    );
    world.lights = Arc::new(Lights {
        points: vec![lamp(Vec3::Y * 2.0, Vec3::splat(40.0))],
        ..Lights::default()
    });
    let set = rays(&Scene::of(world, camera()));
    // The camera's ray passes the pane at (0, 0.5, 0.5) and goes on to the origin.
    let pane = Vec3::new(0.0, 0.5, 0.5);
    segment(&set, EYE, pane);
    segment(&set, pane, Vec3::ZERO);
    // (1 - d) · lerp(1, kd, d) = 0.5 · (0.6, 0.8, 1), from the pane down to the floor.
    let above = Vec3::Y * 0.5;
    expect(&set, Vec3::ZERO, above, [0.3, 0.4, 0.5]);
    expect(&set, above, Vec3::Y * 2.0, WHITE);
}

#[test]
fn s16_the_aperture_the_focus_plane_and_the_lens_rays_stand_where_the_formula_says() {
    let mut camera = camera();
    camera.optics.aperture_radius = 0.25;
    camera.optics.focus_distance = 2f32.sqrt();
    camera.optics.lens_samples = 8;
    let world = world(vec![object(1, &floor(), 0)], vec![Material::default()]);
    let scene = Scene::of(world, camera);
    let set = scene.lines(System::Lens, &InspectSettings::default());
    // The aperture's topmost point: along the camera's up, (0, 1, -1)/√2.
    let up = Vec3::new(0.0, 0.5, -0.5).normalize();
    for rim in [EYE + 0.25 * Vec3::X, EYE - 0.25 * Vec3::X, EYE + 0.25 * up] {
        let found = set
            .segments
            .iter()
            .any(|s| s.ends.iter().any(|end| is_near(*end, rim)));
        assert!(found, "no point of the aperture at {rim}");
    }
    // The plane passes the origin; a field of view of 0.5 makes it 2 · √2 · tan 0.25 high and wide.
    let half = 2f32.sqrt() * 0.25f32.tan();
    let corner = |x: f32, y: f32| half * (x * Vec3::X + y * up);
    segment(&set, corner(-1.0, -1.0), corner(1.0, -1.0));
    segment(&set, corner(1.0, 1.0), corner(-1.0, 1.0));
    segment(&set, EYE, corner(1.0, 1.0));
    // In focus, so all rays of the lens meet at the origin, from different places of the aperture.
    let rays = rays(&scene);
    assert_eq!(rays.segments.len(), 8);
    for ray in &rays.segments {
        assert!(is_near(ray.ends[1], Vec3::ZERO), "{}", ray.ends[1]);
        assert!((ray.ends[0] - EYE).length() <= 0.2501);
    }
    assert!(
        rays.segments
            .iter()
            .any(|ray| (ray.ends[0] - EYE).length() > 0.1)
    );
}

#[test]
fn rays_that_chance_leaves_out_are_named_in_the_tree_the_table_the_sentences_and_the_json() {
    let mut world = world(vec![object(1, &floor(), 0)], vec![matt(Vec3::ONE)]);
    // One bright lamp, and two hundred of which each would add 1/10,000 of what that one adds.
    let above = |id: u64, color: f32| PointLight {
        id,
        ..lamp(Vec3::Y * 2.0, Vec3::splat(color))
    };
    let mut points = vec![above(100, 100.0)];
    points.extend((101..=300).map(|id| above(id, 0.01)));
    world.lights = Arc::new(Lights {
        points,
        ..Lights::default()
    });
    let scene = Scene::of(world, camera());
    let tree = scene.probe(Samples::All);
    let names = BTreeMap::from([(1, "Floor".into()), (100, "Lamp".into())]);

    // All faint ones are alike, and so are their chances.
    let chance = tree.rays.last().unwrap().chance;
    assert!(chance > 0.1 && chance < 0.5, "{chance}");
    let left_out = |end: RayEnd| end == RayEnd::LeftOut;
    let count = tree.rays.iter().filter(|ray| left_out(ray.end)).count();
    let expected = 200.0 * (1.0 - chance);
    assert!(
        (count as f32 - expected).abs() < 30.0,
        "{count}, {expected}"
    );
    let lines = RayLine::of(&tree, 0, &names);
    let sentences = explanation(&tree, &names);
    for (index, ray) in tree.rays.iter().enumerate() {
        let Some(light) = ray.light else { continue };
        let [to, radiance, adds] = [1, 3, 4].map(|cell| &lines[index].cells[cell]);
        let sentence = |fate: &str| {
            let name = if light.id == 100 {
                "Lamp".into()
            } else {
                format!("#{}", light.id)
            };
            let text = format!("{name}: its sample {fate}");
            assert!(sentences.contains(&text), "{text} is not in {sentences:#?}");
        };
        match ray.end {
            RayEnd::Arrived => {
                assert_eq!(ray.chance, if light.id == 100 { 1.0 } else { chance });
                // One that was asked for stands for those that were not.
                assert!(
                    is_near(ray.weight * ray.chance, Vec3::ONE),
                    "{}",
                    ray.weight
                );
                sentence("arrives");
            }
            RayEnd::LeftOut => {
                assert_eq!((ray.chance, ray.weight), (chance, Vec3::ONE));
                assert_eq!((radiance.as_str(), adds.as_str()), ("0", "0"));
                assert_eq!(*to, format!("#{}, left-out", light.id));
                sentence("is so faint that chance left it out");
            }
            end => panic!("{end:?}"),
        }
    }
    // The camera's ray, and those that were asked for.
    assert_eq!(rays(&scene).segments.len(), tree.rays.len() - count);

    let document = Document::new(("", ""), &scene.world, &scene.settings, &tree, &names);
    let json = serde_json::to_value(&document).unwrap();
    for (ray, json) in tree.rays.iter().zip(json["rays"].as_array().unwrap()) {
        assert_eq!(json["end"], ray.end.name());
        assert_eq!(json["chance"].as_f64(), Some(f64::from(ray.chance)));
    }

    let text = answer(Question::Black, &tree, &names);
    assert!(text.starts_with("Floor is lit by Lamp and #1"), "{text}");
    // Had the sample asked for none of them:
    let mut none = tree;
    none.rays
        .retain(|ray| ray.light.is_none() || left_out(ray.end));
    assert_eq!(
        answer(Question::Black, &none, &names),
        "Floor could be lit by none but lights so faint that this sample asked for none of them."
    );
}
