//! What a surface is made of: every number times its map times the vertices' colours, and what becomes of opacity.

use super::{central_radiance, object, quad, world};
use glam::{Vec2, Vec3};
use glassbox::bvh::Ray;
use glassbox::scene::{
    Alpha, Features, Lighting, MapFilter, PhongMap, RenderSettings, TextureFilter, Wrap,
};
use glassbox::trace::{Camera, Environment, Map, Material, Mesh, Surface, Texels, Texture, World};
use std::sync::Arc;

/// A square of 2 m around the origin, facing up; its picture's right is x, its lower edge z.
fn square(
    material: Material,
    textures: Vec<Texture>,
    colors: Vec<Vec3>,
    alphas: Vec<f32>,
) -> World {
    let corners = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    let (instance, mut square) = object(1, &corners, 0);
    square.mesh = Arc::new(Mesh {
        uvs: corners.map(|c| (Vec2::new(c.x, c.z) + 1.0) / 2.0).to_vec(),
        colors,
        alphas,
        ..Mesh::of(square.mesh.tree.clone())
    });
    let mut world = world(vec![(instance, square)], vec![material]);
    world.textures = Arc::new(textures.into_iter().map(Arc::new).collect());
    world.with_needs()
}

pub(super) fn settings() -> RenderSettings {
    RenderSettings {
        texture_filter: TextureFilter::Nearest,
        ..RenderSettings::default()
    }
}

/// The surface at a place of the square, as seen along a direction.
pub(super) fn at(
    world: &World,
    settings: &RenderSettings,
    x: f32,
    z: f32,
    direction: Vec3,
) -> Surface {
    let target = Vec3::new(x, 0.0, z);
    let ray = Ray::new(target - direction, direction);
    let hit = world
        .aggregate
        .closest_hit(&ray)
        .expect("it aims at the square");
    Surface::at(world, settings, &ray, 0.0, &hit)
}

fn above(world: &World, settings: &RenderSettings, x: f32, z: f32) -> Surface {
    at(world, settings, x, z, Vec3::NEG_Y)
}

/// Two texels side by side.
fn pair(left: [f32; 4], right: [f32; 4]) -> Texture {
    Texture::new(2, 1, Texels::LinearAlpha32(vec![left, right])).unwrap()
}

#[test]
fn every_number_is_its_factor_times_its_map() {
    let factors = Material {
        diffuse: Vec3::new(0.5, 0.25, 1.0),
        specular: Vec3::new(0.25, 0.5, 0.75),
        mirror: Vec3::new(1.0, 0.5, 0.125),
        emission: Vec3::new(8.0, 4.0, 2.0),
        opacity: 0.5,
        ..Material::default()
    };
    let texture = || pair([0.5, 0.25, 0.125, 1.0], [1.0, 0.5, 0.75, 0.5]);
    let maps = |of: &[PhongMap]| Material {
        maps: of.iter().map(|&of| Map::new(of, 0)).collect(),
        ..factors.clone()
    };
    let numbers = |s: &Surface| {
        [
            s.diffuse,
            s.specular,
            s.mirror,
            s.emission,
            Vec3::splat(s.opacity),
        ]
    };
    let plain = [
        factors.diffuse,
        factors.specular,
        factors.mirror,
        factors.emission,
        Vec3::splat(factors.opacity),
    ];
    let settings = settings();
    let kinds = [
        PhongMap::Diffuse,
        PhongMap::Specular,
        PhongMap::Mirror,
        PhongMap::Emission,
        PhongMap::Opacity,
    ];
    for (x, color, opacity) in [
        (-0.5, Vec3::new(0.5, 0.25, 0.125), 0.5),
        (0.5, Vec3::new(1.0, 0.5, 0.75), 0.5),
    ] {
        for (i, kind) in kinds.into_iter().enumerate() {
            let world = square(maps(&[kind]), vec![texture()], Vec::new(), Vec::new());
            let found = numbers(&above(&world, &settings, x, 0.1));
            let mut expected = plain;
            // Opacity is alpha times the brightest channel.
            expected[i] *= if i == 4 { Vec3::splat(opacity) } else { color };
            assert_eq!(found, expected, "{kind:?} at {x}");
        }
        let world = square(maps(&kinds), vec![texture()], Vec::new(), Vec::new());
        let found = numbers(&above(&world, &settings, x, 0.1));
        let off = Features {
            textures: false,
            ..settings.features
        };
        let off = RenderSettings {
            features: off,
            ..settings.clone()
        };
        for (i, found) in found.into_iter().enumerate() {
            let by = if i == 4 { Vec3::splat(opacity) } else { color };
            assert_eq!(found, plain[i] * by, "all maps, number {i} at {x}");
        }
        assert_eq!(numbers(&above(&world, &off, x, 0.1)), plain, "textures off");
    }
}

#[test]
fn vertex_colours_multiply_kd_and_their_alphas_opacity_linearly_between_the_corners() {
    let corners = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    // Linear in the place, so that interpolation is exact on both triangles.
    let color = |x: f32, z: f32| Vec3::new((x + 1.0) / 2.0, (z + 1.0) / 2.0, 0.5);
    let alpha = |x: f32| (x + 3.0) / 4.0;
    let material = Material {
        diffuse: Vec3::new(1.0, 0.5, 0.5),
        opacity: 0.5,
        ..Material::default()
    };
    let colors = corners.map(|c| color(c.x, c.z)).to_vec();
    let alphas = corners.map(|c| alpha(c.x)).to_vec();
    let world = square(material.clone(), Vec::new(), colors.clone(), alphas.clone());
    assert!(world.needs.transparency);
    for (x, z) in [(0.3, -0.7), (-0.9, 0.2), (0.0, 0.5), (0.75, 0.75)] {
        let found = above(&world, &settings(), x, z);
        let expected = material.diffuse * color(x, z);
        // Rounding of three products.
        assert!(found.diffuse.abs_diff_eq(expected, 1e-6), "{found:?}");
        assert!((found.opacity - 0.5 * alpha(x)).abs() < 1e-6, "{found:?}");
    }
    let opaque = Material {
        opacity: 1.0,
        alpha: Alpha::Opaque,
        ..material
    };
    let world = square(opaque, Vec::new(), colors, alphas);
    assert!(!world.needs.transparency);
    assert_eq!(above(&world, &settings(), 0.3, -0.7).opacity, 1.0);
}

#[test]
fn vertex_colours_multiply_what_a_surface_sends_out_only_where_its_body_is_black() {
    let colors = vec![Vec3::new(1.0, 0.5, 0.25); 6];
    for (diffuse, by) in [(Vec3::ZERO, colors[0]), (Vec3::splat(0.01), Vec3::ONE)] {
        let material = Material {
            diffuse,
            emission: Vec3::new(2.0, 4.0, 8.0),
            ..Material::default()
        };
        let emission = material.emission;
        let world = square(material, Vec::new(), colors.clone(), Vec::new());
        let found = above(&world, &settings(), 0.3, -0.7).emission;
        // Rounding of the corners' weights.
        assert!(
            found.abs_diff_eq(by * emission, 1e-5),
            "{found} at {diffuse}"
        );
    }
}

#[test]
fn a_mask_is_there_or_not_by_the_filtered_opacity() {
    let texture = || pair([1.0, 1.0, 1.0, 0.0], [1.0, 1.0, 1.0, 1.0]);
    let bilinear = RenderSettings {
        texture_filter: TextureFilter::Bilinear,
        ..settings()
    };
    // Between the texels' middles, at -0.5 and 0.5, the map grows from 0 to 1.
    for (factor, cutoff) in [(1.0, 0.5), (1.0, 0.25), (0.5, 0.25), (1.0, 0.9)] {
        let material = Material {
            opacity: factor,
            alpha: Alpha::Mask { cutoff },
            maps: vec![Map {
                wrap: [Wrap::Clamp; 2],
                ..Map::new(PhongMap::Opacity, 0)
            }],
            ..Material::default()
        };
        let world = square(material, vec![texture()], Vec::new(), Vec::new());
        assert!(world.needs.transparency);
        let edge = cutoff / factor - 0.5;
        for (x, expected) in [
            (-0.9, 0.0),
            (edge - 0.01, 0.0),
            (edge + 0.01, 1.0),
            (0.9, 1.0),
        ] {
            let found = above(&world, &bilinear, x, 0.1).opacity;
            assert_eq!(found, expected, "{factor} cut at {cutoff}, {x}");
        }
    }
    // Without a map: the factor alone.
    for (opacity, expected) in [(0.49, 0.0), (0.5, 1.0)] {
        let material = Material {
            opacity,
            alpha: Alpha::Mask { cutoff: 0.5 },
            ..Material::default()
        };
        let world = square(material, Vec::new(), Vec::new(), Vec::new());
        assert_eq!(above(&world, &settings(), 0.1, 0.2).opacity, expected);
    }
}

#[test]
fn what_is_opaque_in_any_case_needs_no_transparency_and_shows_none() {
    let material = Material {
        opacity: 0.25,
        alpha: Alpha::Opaque,
        ..Material::default()
    };
    let world = square(material, Vec::new(), Vec::new(), Vec::new());
    assert!(!world.needs.transparency);
    assert_eq!(above(&world, &settings(), 0.1, 0.2).opacity, 1.0);
}

#[test]
fn a_map_wraps_and_is_filtered_in_its_own_way() {
    let corners = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    let texture = || pair([0.0, 0.0, 0.0, 1.0], [1.0, 1.0, 1.0, 1.0]);
    let found = |wrap, filter, setting, x: f32| {
        let material = Material {
            diffuse: Vec3::ONE,
            maps: vec![Map {
                wrap: [wrap; 2],
                filter,
                ..Map::new(PhongMap::Diffuse, 0)
            }],
            ..Material::default()
        };
        let mut world = square(material, vec![texture()], Vec::new(), Vec::new());
        // Four pictures side by side: u = 2 x + 2.
        let mut object = world.objects[0].clone();
        object.mesh = Arc::new(Mesh {
            uvs: corners.map(|c| Vec2::new(2.0 * c.x + 2.0, c.z)).to_vec(),
            ..Mesh::of(object.mesh.tree.clone())
        });
        world.objects = Arc::new(vec![object]);
        let settings = RenderSettings {
            texture_filter: setting,
            ..settings()
        };
        above(&world, &settings, x, 0.1).diffuse.x
    };
    use TextureFilter::{Bilinear, Nearest};
    // u = 0.25, 0.75, 1.25, 1.75: the middles of texels.
    let places = [-0.875, -0.625, -0.375, -0.125];
    for (wrap, expected) in [
        (Wrap::Repeat, [0.0, 1.0, 0.0, 1.0]),
        (Wrap::Clamp, [0.0, 1.0, 1.0, 1.0]),
        (Wrap::Mirror, [0.0, 1.0, 1.0, 0.0]),
    ] {
        let all = places.map(|x| found(wrap, MapFilter::Setting, Nearest, x));
        assert_eq!(all, expected, "{wrap:?}");
    }
    // u = 0.6: in the second texel, 0.7 of the way to it.
    let x = -0.7;
    let near = |found: f32, expected: f32| {
        assert!((found - expected).abs() < 1e-5, "{found}, not {expected}")
    };
    near(found(Wrap::Repeat, MapFilter::Nearest, Bilinear, x), 1.0);
    near(found(Wrap::Repeat, MapFilter::Setting, Bilinear, x), 0.7);
    near(found(Wrap::Repeat, MapFilter::Linear, Nearest, x), 0.7);
}

/// A normal map of one texel.
pub(super) fn bent(normal: Vec3, scale: f32) -> World {
    let [r, g, b] = ((normal + 1.0) / 2.0).to_array();
    let texture = Texture::new(1, 1, Texels::Linear32(vec![[r, g, b]])).unwrap();
    let material = Material {
        mirror: Vec3::ONE,
        normal_scale: scale,
        maps: vec![Map::new(PhongMap::Normal, 0)],
        ..Material::default()
    };
    square(material, vec![texture], Vec::new(), Vec::new())
}

#[test]
fn a_normal_map_bends_to_the_right_of_its_picture_and_to_its_upper_edge() {
    for (texel, scale, expected) in [
        (Vec3::Z, 1.0, Vec3::Y),
        (Vec3::new(0.28, 0.0, 0.96), 1.0, Vec3::new(0.28, 0.96, 0.0)),
        (Vec3::new(0.0, 0.28, 0.96), 1.0, Vec3::new(0.0, 0.96, -0.28)),
        (Vec3::new(0.28, 0.0, 0.96), 0.0, Vec3::Y),
        (
            Vec3::new(0.28, 0.0, 0.96),
            -1.0,
            Vec3::new(-0.28, 0.96, 0.0),
        ),
    ] {
        let world = bent(texel, scale);
        let from_above = above(&world, &settings(), 0.1, 0.2);
        assert!(
            from_above.normal.abs_diff_eq(expected, 1e-5),
            "{texel}: {}",
            from_above.normal
        );
        let from_below = at(&world, &settings(), 0.1, 0.2, Vec3::Y);
        assert!(
            from_below.normal.abs_diff_eq(-expected, 1e-5),
            "{texel}: {}",
            from_below.normal
        );
        // The mirror direction of what comes from straight above, turned by twice the angle.
        let mirrored = 2.0 * expected.y * expected - Vec3::Y;
        assert!(
            from_above.mirrored().abs_diff_eq(mirrored, 1e-5),
            "{}",
            from_above.mirrored()
        );
    }
}

#[test]
fn no_normal_map_turns_a_reflection_below_the_surface() {
    for lighting in [Lighting::Physical, Lighting::Classic] {
        let settings = RenderSettings {
            lighting,
            ..settings()
        };
        for i in 0..64_u8 {
            let (s, c) = (f32::from(i) / 64.0 * std::f32::consts::TAU).sin_cos();
            let world = bent(Vec3::new(0.95 * c, 0.95 * s, 0.3122), 1.0);
            for elevation in [0.01_f32, 0.1, 0.5, 1.2] {
                for side in [1.0, -1.0] {
                    let direction = Vec3::new(elevation.cos(), -side * elevation.sin(), 0.0);
                    let surface = at(&world, &settings, 0.1, 0.2, direction);
                    let rise = surface.mirrored().dot(surface.geometric_normal);
                    assert!(rise > 0.0, "{lighting:?}, {i}, from {direction}: {rise}");
                }
            }
        }
    }
}

#[test]
fn an_emission_map_is_seen_and_a_mirror_map_reflects_only_where_it_is_bright() {
    let emission = Material {
        diffuse: Vec3::ZERO,
        emission: Vec3::new(2.0, 1.0, 0.5),
        maps: vec![Map::new(PhongMap::Emission, 0)],
        ..Material::default()
    };
    let mirror = Material {
        diffuse: Vec3::ZERO,
        mirror: Vec3::new(1.0, 0.5, 0.25),
        maps: vec![Map::new(PhongMap::Mirror, 0)],
        ..Material::default()
    };
    let highlight = Material {
        mirror: Vec3::ZERO,
        specular: Vec3::ONE,
        ..mirror.clone()
    };
    let texture = || pair([0.5, 0.5, 0.5, 1.0], [0.0, 0.0, 0.0, 1.0]);
    let seen = |material: Material, x: f32| {
        let mut world = square(material, vec![texture()], Vec::new(), Vec::new());
        world.environment = Environment {
            background: Vec3::ONE,
            ..Environment::default()
        };
        let eye = Vec3::new(x, 3.0, 0.1);
        let camera = Camera::looking_at(eye, Vec3::new(x, 0.0, 0.1), Vec3::X, 0.5);
        central_radiance(&world, &camera, &settings()).0
    };
    let near = |found: Vec3, expected: Vec3| {
        assert!(found.abs_diff_eq(expected, 1e-5), "{found}, not {expected}")
    };
    near(seen(emission.clone(), -0.5), Vec3::new(1.0, 0.5, 0.25));
    near(seen(emission, 0.5), Vec3::ZERO);
    near(seen(mirror.clone(), -0.5), Vec3::new(0.5, 0.25, 0.125));
    near(seen(mirror, 0.5), Vec3::ZERO);
    // A highlight reflects lights, not surroundings.
    near(seen(highlight, -0.5), Vec3::ZERO);
}
