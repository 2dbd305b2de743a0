//! A small scene far from the origin, against the same at the origin.
//!
//! Coordinates in f32 are `step` apart at that distance: 1/128 m at 1e5 m, 1/16 m at 1e6 m. All positions of the scene
//! are multiples of 1/8 m, so that each is the same place wherever the scene stands. What follows from them alone, and
//! all that is told relative to a camera or an instance, has the same bits. What has a position of its own does not:
//! a hit, and the start of a ray that leaves a lens, a moving camera or one of an orthographic camera's pixels. It is
//! off by up to half a step in each coordinate.

use super::scenes::quad;
use super::{Effort, Outcome};
use crate::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Triangles};
use crate::film::render;
use crate::report::table::digits;
use crate::scene::{PhongMap, PixelSampling, Projection, RenderSettings, TextureFilter};
use crate::trace::{
    Camera, Lights, Map, Material, Mesh, Object, Optics, ParallelogramLight, PointLight,
    SegmentLight, SpotCone, Texels, Texture, World,
};
use glam::{Affine3A, UVec2, Vec2, Vec3};
use std::f32::consts::{SQRT_2, TAU};
use std::sync::Arc;

/// Pixels in each direction: with a picture of 8 m one is 1/8 m.
const SIZE: u32 = 64;
/// Texels of the floor in each direction, and its edge in metres.
const TEXELS: u32 = 64;
const EDGE: f32 = 8.0;
/// By how much a colour of the floor changes on a metre, at most: a wave of height 1 and of 4 m.
const SLOPE: f32 = 0.5 * TAU / 4.0;
const SQRT_3: f32 = 1.732_050_8;

/// A floor of 8 m with a picture on it, around `at`, moving by `velocity`, and lamps above it.
fn scene(at: Vec3, velocity: Vec3) -> World {
    let corner = Vec3::new(-0.5 * EDGE, 0.0, -0.5 * EDGE);
    let corners = quad(corner, Vec3::Z * EDGE, Vec3::X * EDGE).to_vec();
    let uvs = corners.iter().map(|p| Vec2::new(p.x, p.z) / EDGE).collect();
    let triangles = Triangles::new(corners, vec![[0, 1, 2], [3, 4, 5]]);
    let triangles = triangles.expect("every index has its position");
    let tree = Arc::new(MeshTree::build(triangles, &BuildOptions::default()));
    let mesh = Mesh {
        uvs,
        ..Mesh::of(tree.clone())
    };
    let instance = Instance::new(tree, &Affine3A::from_translation(at))
        .and_then(|instance| instance.moving(velocity))
        .expect("a translation has an inverse");
    let object = Object {
        id: 1,
        material: 0,
        motion_samples: u32::from(velocity != Vec3::ZERO),
        mesh: Arc::new(mesh),
    };
    let wave = |i: u32, waves: f32| 0.5 + 0.5 * (i as f32 * waves * TAU / TEXELS as f32).sin();
    let texels = (0..TEXELS * TEXELS).map(|i| {
        let (x, y) = (i % TEXELS, i / TEXELS);
        [wave(x, 2.0), wave(y, 2.0), wave(x + y, 1.0)]
    });
    let map = Texture::new(TEXELS, TEXELS, Texels::Linear32(texels.collect()));
    World {
        aggregate: Arc::new(Aggregate::build(vec![instance], &BuildOptions::default())),
        objects: Arc::new(vec![object]),
        materials: Arc::new(vec![Material {
            diffuse: Vec3::ONE,
            maps: vec![Map::new(PhongMap::Diffuse, 0)],
            ..Material::default()
        }]),
        textures: Arc::new(map.into_iter().map(Arc::new).collect()),
        lights: Arc::new(lamps(at)),
        ..World::default()
    }
    .with_needs()
}

/// One of each kind that has a place, 3 m up.
fn lamps(at: Vec3) -> Lights {
    Lights {
        points: vec![PointLight {
            id: 2,
            position: at + Vec3::new(-2.0, 3.0, 1.0),
            color: Vec3::new(6.0, 2.0, 1.0),
            cone: Some(SpotCone::new(Vec3::NEG_Y, 0.3, 0.9)),
        }],
        segments: vec![SegmentLight {
            id: 3,
            ends: [Vec3::new(-1.0, 3.0, -2.0), Vec3::new(2.0, 3.25, -2.0)].map(|end| at + end),
            colors: [Vec3::new(1.0, 3.0, 1.0), Vec3::ONE],
            samples: 4,
        }],
        parallelograms: vec![ParallelogramLight {
            id: 4,
            corner: at + Vec3::new(1.0, 3.0, 0.5),
            edges: [Vec3::new(1.5, 0.25, 0.0), Vec3::new(0.0, 0.0, 1.125)],
            colors: [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE].map(|color| 4.0 * color),
            two_sided: false,
            visible: true,
            samples: 4,
        }],
        ..Lights::default()
    }
}

/// Straight above the floor, 5 m up.
fn above(at: Vec3, optics: Optics) -> Camera {
    let eye = at + Vec3::Y * 5.0;
    Camera {
        optics,
        ..Camera::looking_at(eye, eye - Vec3::Y, Vec3::NEG_Z, 0.9)
    }
}

/// Between the floor and the lamps, which it sees beside each other.
fn below(at: Vec3) -> Camera {
    let eye = at + Vec3::new(-3.0, 1.0, -3.0);
    Camera::looking_at(eye, eye + Vec3::new(4.0, 0.5, 3.5), Vec3::Y, 1.2)
}

/// One of the pictures that are compared.
struct View {
    name: &'static str,
    camera: fn(Vec3) -> Camera,
    velocity: Vec3,
    settings: RenderSettings,
    /// How far a pixel may be off for each metre of a step, as a share of the brightest pixel.
    slope: f32,
}

fn views() -> [View; 6] {
    let mut flat = RenderSettings {
        size: UVec2::splat(SIZE),
        spp: 1,
        pixel: PixelSampling::Center,
        texture_filter: TextureFilter::Mipmap,
        ..RenderSettings::default()
    };
    flat.features.shading = false;
    let several = RenderSettings {
        spp: 16,
        texture_filter: TextureFilter::Bilinear,
        ..flat.clone()
    };
    let mut lit = several.clone();
    lit.features.shading = true;
    let view = |name, camera, slope| View {
        name,
        camera,
        velocity: Vec3::ZERO,
        settings: flat.clone(),
        slope,
    };
    // Half a step in x and in z.
    let moved = 0.5 * SQRT_2 * SLOPE;
    // Half a step in all three coordinates of a hit. From 3 m away a distance squared and two cosines change by at most
    // 4/3 on a metre, and the smoothstep of the spot by 1.5 / (cos 0.3 - cos 0.9) / 3.
    let lit_otherwise = 0.5 * SQRT_3 * (4.0 / 3.0 + 1.5);
    [
        view("lamp and mip levels", below, 0.0),
        view(
            "orthographic",
            |at| Camera {
                projection: Projection::Orthographic { height: EDGE },
                ..above(at, Optics::default())
            },
            0.0,
        ),
        View {
            settings: several.clone(),
            ..view(
                "in focus",
                |at| {
                    let optics = Optics {
                        aperture_radius: 0.25,
                        focus_distance: 5.0,
                        ..Optics::default()
                    };
                    above(at, optics)
                },
                0.0,
            )
        },
        View {
            settings: several.clone(),
            ..view(
                "out of focus",
                |at| {
                    let optics = Optics {
                        aperture_radius: 0.25,
                        focus_distance: 2.5,
                        ..Optics::default()
                    };
                    above(at, optics)
                },
                moved,
            )
        },
        View {
            settings: several,
            velocity: Vec3::new(0.5, 0.0, 0.25),
            ..view(
                "motion",
                |at| {
                    let optics = Optics {
                        velocity: Vec3::new(-0.75, 0.0, 0.5),
                        ..Optics::default()
                    };
                    above(at, optics)
                },
                // The camera's place and the floor's.
                2.0 * moved,
            )
        },
        View {
            settings: lit,
            ..view("light", |at| above(at, Optics::default()), lit_otherwise)
        },
    ]
}

pub(super) fn far(_: &Effort) -> Outcome {
    let mut pixels = 0;
    let mut figures = Vec::new();
    let mut faults = Vec::new();
    let views = views();
    let picture = |view: &View, at: Vec3| {
        let (world, camera) = (scene(at, view.velocity), (view.camera)(at));
        render(&world, &camera, &view.settings, &|_, _| {}).picture
    };
    for view in &views {
        let here = picture(view, Vec3::ZERO);
        let brightest =
            (here.pixels.iter()).fold(0.0_f32, |most, pixel| most.max(pixel.max_element()));
        let mut offs = Vec::new();
        for distance in [1e4_f32, 1e5, 131_072.0, 1e6] {
            let there = picture(view, distance * Vec3::new(1.0, 1.0, -1.0));
            let off = (here.pixels.iter().zip(&there.pixels))
                .map(|(a, b)| (*a - *b).abs().max_element())
                .fold(0.0_f32, f32::max);
            let step = distance.next_up() - distance;
            // Beside the step: directions and weights of several samples are rounded in another way.
            let rounding = if view.settings.spp > 1 { 1e-5 } else { 0.0 };
            let most = (view.slope * step + rounding) * brightest;
            if off > most || !there.pixels.iter().all(|pixel| pixel.is_finite()) {
                faults.push(format!(
                    "{} at {distance:e} m is off by {off:e}, more than {most:e}",
                    view.name
                ));
            }
            offs.push(digits(f64::from(off), 2));
            pixels += there.pixels.len();
        }
        figures.push(format!("{}: {}", view.name, offs.join(", ")));
    }
    Outcome {
        faults,
        ..Outcome::new(
            pixels,
            format!("off by, at 1e4, 1e5, 2^17, 1e6 m: {}", figures.join("; ")),
        )
    }
}
