//! First hits and their views against closed forms.

use super::*;
use glam::Vec2;
use glassbox::bvh::Counters;
use glassbox::film::FirstHits;
use glassbox::film::views::{Shown, Sources, View, ViewError, object_color, show, viridis};
use glassbox::scene::{Output, SceneId};
use glassbox::trace::{FirstHit, Optics, central_ray, first_hits};

const SIZE: UVec2 = UVec2::new(40, 30);

fn settings() -> RenderSettings {
    RenderSettings {
        size: SIZE,
        spp: 4,
        ..RenderSettings::default()
    }
}

fn ahead() -> Camera {
    Camera::looking_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0)
}

fn shown(view: View, hits: &FirstHits, range: Option<[f32; 2]>) -> Result<Shown, ViewError> {
    let sources = Sources {
        first_hits: Some(hits),
        ..Sources::default()
    };
    show(view, &sources, &Output::default(), range)
}

/// A wall across the whole view at z = -5, its object's number 7, and a smaller one, number 9, before
/// its left half at z = -2.
fn walls() -> World {
    let far = quad(
        Vec3::new(-50.0, -50.0, -5.0),
        Vec3::X * 100.0,
        Vec3::Y * 100.0,
    );
    let near = quad(
        Vec3::new(-50.0, -50.0, -2.0),
        Vec3::X * 50.0,
        Vec3::Y * 100.0,
    );
    let material = |diffuse| Material {
        diffuse,
        ..Material::default()
    };
    let colors = [Vec3::new(0.5, 0.25, 0.125), Vec3::new(0.1, 0.9, 0.3)];
    world(
        vec![object(7, &far, 0), object(9, &near, 1)],
        colors.map(material).to_vec(),
    )
}

/// A sphere of radius 1 around (0, 0, -3) in 100 × 200 quads, with the sphere's own normals.
fn sphere() -> World {
    let center = Vec3::new(0.0, 0.0, -3.0);
    let at = |i: usize, j: usize| {
        let (across, around) = (i as f32 / 100.0, j as f32 / 100.0);
        let (sin, cos) = (across * std::f32::consts::PI).sin_cos();
        let (y, x) = (around * std::f32::consts::PI).sin_cos();
        Vec3::new(sin * x, cos, sin * y)
    };
    let mut normals = Vec::new();
    for i in 0..100 {
        for j in 0..200 {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            normals.extend([a, b, c, a, c, d]);
        }
    }
    let corners: Vec<Vec3> = normals.iter().map(|n| center + n).collect();
    let (instance, mut object) = object(1, &corners, 0);
    object.mesh = Arc::new(Mesh {
        normals,
        ..Mesh::of(object.mesh.tree.clone())
    });
    world(vec![(instance, object)], vec![Material::default()])
}

#[test]
fn the_depth_of_a_plane_is_its_distance_along_each_pixels_ray() {
    let hits = FirstHits::trace(&walls(), &ahead(), &settings());
    let mut worst = 0.0_f32;
    for (i, hit) in hits.centers.iter().enumerate() {
        let place = Vec2::new(i as f32 % 40.0 + 0.5, (i / 40) as f32 + 0.5);
        let at = (place - 0.5 * SIZE.as_vec2()) / 15.0 * 0.5_f32.tan();
        let distance = if place.x < 20.0 { 2.0 } else { 5.0 };
        let expected = distance * (1.0 + at.length_squared()).sqrt();
        worst = worst.max((hit.depth / expected - 1.0).abs());
    }
    assert!(worst < 1e-6, "off by {worst}");

    let range = Some([0.0, 10.0]);
    let view = shown(View::Depth, &hits, range).unwrap();
    let expected = viridis(1.0 - hits.centers[5].depth / 10.0);
    let off = Vec3::from(view.pixels[5]).distance(Vec3::from(expected));
    assert!(off < 1e-6, "{:?} for {expected:?}", view.pixels[5]);
    let bright = |p: [f32; 3]| p[0] + p[1];
    assert!(
        bright(view.pixels[5]) > bright(view.pixels[35]),
        "near is not bright"
    );
}

#[test]
fn the_normals_of_a_sphere_are_the_spheres() {
    // One sample at the middle of each pixel, so that the mean is the normal itself.
    let settings = RenderSettings {
        spp: 1,
        pixel: PixelSampling::Center,
        ..settings()
    };
    let hits = FirstHits::trace(&sphere(), &ahead(), &settings);
    let view = shown(View::Normal, &hits, None).unwrap();
    let (mut on, mut worst) = (0, 0.0_f32);
    for (i, color) in view.pixels.iter().enumerate() {
        let ray = central_ray(
            &ahead(),
            &settings,
            UVec2::new(i as u32 % 40, i as u32 / 40),
        );
        let to_center = Vec3::new(0.0, 0.0, -3.0);
        let along = to_center.dot(ray.direction);
        let reach = 1.0 - (to_center - along * ray.direction).length_squared();
        if reach < -0.01 {
            assert_eq!(*color, [0.0; 3], "pixel {i} meets nothing");
        } else if reach > 0.1 {
            let normal = (along - reach.sqrt()) * ray.direction - to_center;
            worst = worst.max((Vec3::from(*color) * 2.0 - 1.0).distance(normal));
            on += 1;
        }
    }
    // 100 quads from pole to pole: between vertices the surface lies up to 1.2e-4 inside the sphere.
    assert!(
        on > 200 && worst < 2e-3,
        "{on} pixels, off by up to {worst}"
    );
}

#[test]
fn the_object_view_names_each_pixels_object_and_its_colour_depends_on_the_number_alone() {
    let hits = FirstHits::trace(&walls(), &ahead(), &settings());
    let view = shown(View::Object, &hits, None).unwrap();
    for (i, (hit, color)) in hits.centers.iter().zip(&view.pixels).enumerate() {
        let id = SceneId(if i % 40 < 20 { 9 } else { 7 });
        assert_eq!(hit.object, Some(id), "pixel {i}");
        assert_eq!(*color, object_color(id));
    }
    let empty = FirstHits::trace(&World::default(), &ahead(), &settings());
    let view = shown(View::Object, &empty, None).unwrap();
    assert!(view.pixels.iter().all(|p| *p == [0.0; 3]));
}

#[test]
fn nodes_and_triangles_are_those_of_the_single_ray_traversal() {
    let world = sphere();
    let hits = FirstHits::trace(&world, &ahead(), &settings());
    for (i, hit) in hits.centers.iter().enumerate() {
        let pixel = UVec2::new(i as u32 % 40, i as u32 / 40);
        let mut cost = Counters::default();
        let ray = central_ray(&ahead(), &settings(), pixel);
        world.aggregate.closest_hit_with(&ray, &mut cost);
        assert_eq!(hit.cost, cost, "pixel {pixel}");
        if hit.object.is_some() {
            assert!(cost.nodes > 0 && cost.triangles > 0, "{cost:?}");
        }
    }
    let nodes = shown(View::Nodes, &hits, None).unwrap();
    let most = hits.centers.iter().map(|hit| hit.cost.nodes).max();
    let scale = nodes.scale.unwrap();
    assert!(scale.low == 0.0 && scale.high > 5.0 && scale.high <= most.unwrap() as f32);
}

#[test]
fn first_hits_are_those_of_the_rays_that_radiance_begins_with() {
    // Without shading a sample's value is the kd of what its ray meets: the same at every sample,
    // through a lens, in motion, at a random place in the pixel.
    let mut settings = settings();
    settings.features.shading = false;
    settings.seed = 5;
    let camera = Camera {
        optics: Optics {
            aperture_radius: 0.3,
            focus_distance: 4.0,
            velocity: Vec3::new(0.8, 0.1, 0.0),
            ..Optics::default()
        },
        ..ahead()
    };
    let samples: Vec<SampleId> = (0..SIZE.element_product())
        .flat_map(|i| {
            let pixel = UVec2::new(i % 40, i / 40);
            (0..4).map(move |index| SampleId { pixel, index })
        })
        .collect();
    let world = walls();
    let mut hits = vec![FirstHit::MISS; samples.len()];
    first_hits(&world, &camera, &settings, &samples, &mut hits);
    let mut values = vec![Vec3::ZERO; samples.len()];
    let workspace = &mut Workspace::default();
    radiance(&world, &camera, &settings, &samples, &mut values, workspace);
    for ((sample, hit), value) in samples.iter().zip(&hits).zip(&values) {
        assert_eq!(hit.albedo, *value, "{sample:?}");
    }
    let left = hits
        .iter()
        .filter(|hit| hit.object == Some(SceneId(9)))
        .count();
    assert!(
        left > 500 && left < samples.len() - 500,
        "{left} of {}",
        samples.len()
    );
}

#[test]
fn albedo_is_the_mean_over_the_samples() {
    let settings = settings();
    let hits = FirstHits::trace(&walls(), &ahead(), &settings);
    assert!(hits.coverage.iter().all(|&part| part == 1.0));
    // Pixels on one wall have its kd, as the sRGB curve encodes it.
    let view = shown(View::Albedo, &hits, None).unwrap();
    let expected = Vec3::new(0.735_357, 0.537_099, 0.388_573);
    let off = Vec3::from(view.pixels[35]).distance(expected);
    assert!(off < 1e-4, "{:?}", view.pixels[35]);
    // Each pixel's mean lies between the two.
    let pixel = UVec2::new(20, 15);
    let samples: Vec<_> = (0..4).map(|index| SampleId { pixel, index }).collect();
    let mut each = [FirstHit::MISS; 4];
    first_hits(&walls(), &ahead(), &settings, &samples, &mut each);
    let mean = each.iter().map(|hit| hit.albedo).sum::<Vec3>() / 4.0;
    assert_eq!(hits.albedo[15 * 40 + 20], mean);
}
