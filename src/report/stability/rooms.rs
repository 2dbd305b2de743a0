//! Cases of closed rooms: whoever is inside sees nothing of the outside, wherever the room stands.

use super::parallel::pieces;
use super::scenes::{placed, quad, world};
use super::{Effort, Outcome};
use crate::bvh::hard_cases::meshes::{cube, mesh, moved};
use crate::bvh::hard_cases::spawned::{OUTSIDE_OF_THIN_PANES, SAFE_PANE, outside_of_panes};
use crate::bvh::{Aggregate, BuildOptions, Instance, Levels, Triangles};
use crate::film::render;
use crate::report::table::digits;
use crate::scene::RenderSettings;
use crate::trace::{Camera, DirectionalLight, Environment, Lights, Material, Object, World};
use glam::{Affine3A, DVec3, EulerRot, Quat, UVec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// How far from the origin rooms stand, in metres.
const DISTANCES: [f32; 4] = [0.0, 100.0, 12_345.678, 148_376.0];

/// A closed room around a place from which it is looked at.
struct Room {
    name: &'static str,
    triangles: Triangles,
    eye: Vec3,
    towards: Vec3,
    /// How far apart its walls are around the eye.
    height: f32,
    /// Pixels along each side of its pictures, where it is by its mesh; those of its variants are of the smallest.
    side: u32,
}

impl Room {
    /// Whether coordinates at that distance are fine enough for the eye to be in the room, whose corners are rounded too.
    fn holds_the_eye_at(&self, distance: f32) -> bool {
        self.height > 4.0 * (distance.next_up() - distance)
    }
}

/// A prism 2 m wide and 2 m deep: its floor and its ceiling meet at this angle.
fn wedge(name: &'static str, degrees: f32, side: u32) -> Room {
    let height = 2.0 * degrees.to_radians().tan();
    let profile = [[0.0, 0.0], [2.0, 0.0], [2.0, height]];
    let positions = (0..6).map(|i| {
        let [x, y] = profile[i % 3];
        Vec3::new(x - 1.0, y, 2.0 * (i / 3) as f32 - 1.0)
    });
    let indices = [
        [0, 1, 2],
        [3, 5, 4],
        [0, 3, 4],
        [0, 4, 1],
        [1, 4, 5],
        [1, 5, 2],
        [0, 2, 5],
        [0, 5, 3],
    ];
    Room {
        name,
        triangles: mesh(positions.collect(), indices.to_vec()),
        eye: Vec3::new(0.95, 0.4 * height, 0.1),
        towards: Vec3::new(-1.0, 0.0, -0.3),
        height,
        side,
    }
}

/// A pyramid 2 m high over a triangle of 5 cm.
fn spike() -> Room {
    let foot = [[0.05, 0.0], [-0.02, 0.04], [-0.03, -0.04]];
    let mut positions: Vec<Vec3> = foot.map(|[x, z]| Vec3::new(x, 0.0, z)).to_vec();
    positions.push(Vec3::new(0.0, 2.0, 0.0));
    Room {
        name: "spike",
        triangles: mesh(positions, vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]),
        eye: Vec3::new(0.0, 0.1, 0.0),
        towards: Vec3::new(0.02, 2.0, 0.01),
        height: 0.04,
        side: VARIANT,
    }
}

fn rooms() -> [Room; 5] {
    [
        Room {
            name: "box",
            triangles: cube(),
            eye: Vec3::new(0.3, 0.2, 0.6),
            towards: Vec3::new(-0.5, -0.4, -1.0),
            height: 2.0,
            side: 200,
        },
        wedge("wedge of 10°", 10.0, VARIANT),
        wedge("wedge of 1°", 1.0, 100),
        wedge("wedge of 0.1°", 0.1, VARIANT),
        spike(),
    ]
}

/// Where a room stands, and whether its mesh is there or its transform puts it there.
#[derive(Clone, Copy)]
struct Standing {
    turn: Quat,
    at: Vec3,
    in_the_mesh: bool,
    levels: Levels,
}

impl Room {
    fn placed(&self, standing: Standing, material: &Material) -> (World, Camera) {
        let Standing {
            turn,
            at,
            in_the_mesh,
            levels,
        } = standing;
        let place = |p: Vec3| (turn.as_dquat() * p.as_dvec3() + at.as_dvec3()).as_vec3();
        let (triangles, transform) = if in_the_mesh {
            (moved(&self.triangles, place), Affine3A::IDENTITY)
        } else {
            let transform = Affine3A::from_rotation_translation(turn, at);
            (self.triangles.clone(), transform)
        };
        let options = BuildOptions {
            levels,
            ..BuildOptions::default()
        };
        let object = placed(1, triangles, Vec::new(), &transform, 0);
        let mut world = world(vec![object], vec![material.clone()]);
        let instances = world.aggregate.instances().to_vec();
        world.aggregate = Arc::new(Aggregate::build(instances, &options));
        let eye = place(self.eye);
        let mut camera = Camera::looking_at(Vec3::ZERO, turn * self.towards, turn * Vec3::Y, 1.6);
        camera.position = eye;
        (world, camera)
    }
}

/// A mirror that swallows nothing, before a white sky.
fn mirrors(mut world: World) -> World {
    world.environment = Environment {
        background: Vec3::ONE,
        ..Environment::default()
    };
    world.with_needs()
}

/// Many strong suns, whose light has to come through a wall.
fn suns(mut world: World) -> World {
    let directions = (0..12).map(|i| {
        // Nearly even over the sphere (a Fibonacci lattice).
        let y = 1.0 - (2 * i + 1) as f64 / 12.0;
        let (sin, cos) = (i as f64 * 2.399_963).sin_cos();
        let across = (1.0 - y * y).sqrt();
        DVec3::new(across * cos, y, across * sin).as_vec3()
    });
    let lights = directions
        .enumerate()
        .map(|(i, to_light)| DirectionalLight {
            id: 100 + i as u64,
            to_light,
            color: Vec3::splat(1000.0),
            disc: None,
            samples: 1,
        });
    world.lights = Arc::new(Lights {
        directionals: lights.collect(),
        ..Lights::default()
    });
    world.with_needs()
}

/// A material, and what is outside.
type Kind = (&'static str, Material, fn(World) -> World);

fn kinds() -> [Kind; 2] {
    let mirror = Material {
        diffuse: Vec3::ZERO,
        specular: Vec3::ONE,
        mirror: Vec3::ONE,
        shininess: 1e6,
        ..Material::default()
    };
    [
        ("mirrors", mirror, mirrors),
        ("matt", Material::default(), suns),
    ]
}

/// Pixels along each side of the pictures of a room's variants.
const VARIANT: u32 = 50;

fn settings(effort: &Effort, side: u32) -> RenderSettings {
    let side = match effort.rays > 1_000_000 {
        true => side,
        false => 24,
    };
    RenderSettings {
        size: UVec2::splat(side),
        spp: 16,
        max_depth: 50,
        ..RenderSettings::default()
    }
}

/// How many pixels see something, of how many.
fn seen(world: &World, camera: &Camera, settings: &RenderSettings) -> (usize, usize) {
    let pixels = render(world, camera, settings, &|_, _| {}).picture.pixels;
    let seen = pixels.iter().filter(|p| **p != Vec3::ZERO).count();
    (seen, pixels.len())
}

fn turned() -> Quat {
    Quat::from_euler(EulerRot::XYZ, 0.4, 1.1, -0.7)
}

/// Every room of every kind, at every distance, upright and turned, by its mesh and by its transform: how many pixels see
/// something of the outside.
pub(super) fn closed(effort: &Effort) -> Outcome {
    let (mut counted, mut rooms_seen, mut faults) = (0, 0, Vec::new());
    for room in rooms() {
        for (kind, material, outside) in kinds() {
            for (index, distance) in DISTANCES.into_iter().enumerate() {
                if !room.holds_the_eye_at(distance) {
                    continue;
                }
                for (turn, in_the_mesh) in [
                    (Quat::IDENTITY, true),
                    (turned(), true),
                    (Quat::IDENTITY, false),
                    (turned(), false),
                ] {
                    let standing = Standing {
                        turn,
                        at: Vec3::new(distance, 0.25 * distance, -0.5 * distance),
                        in_the_mesh,
                        levels: [Levels::Two, Levels::One][index % 2],
                    };
                    let (world, camera) = room.placed(standing, &material);
                    let side = if in_the_mesh { room.side } else { VARIANT };
                    let settings = settings(effort, side);
                    let (leaks, pixels) = seen(&outside(world), &camera, &settings);
                    counted += pixels;
                    rooms_seen += 1;
                    if leaks > 0 {
                        faults.push(format!(
                            "{} ({kind}) at {distance} m, {} by its {}: {leaks} of {pixels} pixels see the outside",
                            room.name,
                            if turn == Quat::IDENTITY { "upright" } else { "turned" },
                            if in_the_mesh { "mesh" } else { "transform" },
                        ));
                    }
                }
            }
        }
    }
    let leaking = faults.len();
    let panes = |steps: [f32; 2], seed: u64| {
        // A pane is some thousand rays.
        let panes = (effort.rays / 500).clamp(100, 20_000);
        let found = pieces(panes, effort.seed + seed, |random, count| {
            outside_of_panes(count, steps, random)
        });
        let add = |sum: (usize, usize), found: (usize, usize)| (sum.0 + found.0, sum.1 + found.1);
        found.into_iter().fold((0, 0), add)
    };
    let (thick, thick_outside) = panes([SAFE_PANE, 12.0], 36);
    let (thin, thin_outside) = panes([2.0, SAFE_PANE], 37);
    let share = thin_outside as f64 / thin.max(1) as f64;
    let figures = format!(
        "{leaking} of {rooms_seen} rooms leak; in panes of 6 to 12 steps of the coordinates {thick_outside} of {thick} rays \
         start outside, in thinner ones {thin_outside} of {thin}",
    );
    Outcome {
        faults,
        ..Outcome::new(counted + thick + thin, figures)
    }
    .require(
        thick_outside == 0,
        format!("{thick_outside} rays start outside of a pane"),
    )
    .require(
        share <= OUTSIDE_OF_THIN_PANES,
        format!("{share:.1e} of the rays start outside of thin panes"),
    )
}

/// The walls of a box of 2 m, an object each, placed by its transform.
#[derive(Clone, Copy)]
enum Walls {
    /// So much wider than the box.
    Thin(f32),
    /// Cuboids of 10 cm that fill the corners, all of them.
    Thick,
}

fn six_walls(turn: Quat, at: Vec3, walls: Walls) -> Vec<(Instance, Object)> {
    let wall = match walls {
        Walls::Thin(wider) => {
            let half = 1.0 + wider;
            let corner = Vec3::new(-half, 0.0, -half);
            let wall = quad(corner, Vec3::Z * 2.0 * half, Vec3::X * 2.0 * half);
            mesh(wall.to_vec(), vec![[0, 1, 2], [3, 4, 5]])
        }
        Walls::Thick => moved(&cube(), |p| p * Vec3::new(1.1, 0.05, 1.1) - 0.05 * Vec3::Y),
    };
    let turns = [
        Quat::IDENTITY,
        Quat::from_rotation_x(PI),
        Quat::from_rotation_x(FRAC_PI_2),
        Quat::from_rotation_x(-FRAC_PI_2),
        Quat::from_rotation_z(FRAC_PI_2),
        Quat::from_rotation_z(-FRAC_PI_2),
    ];
    let walls = turns.iter().zip(1u64..).map(|(own, id)| {
        let turn = turn * *own;
        let transform = Affine3A::from_rotation_translation(turn, at - turn * Vec3::Y);
        placed(id, wall.clone(), Vec::new(), &transform, 0)
    });
    walls.collect()
}

/// Rooms whose walls are objects of their own. Nothing is promised of sheets: where two objects touch, each is rounded by
/// its own transform, so there are cracks, and a start beside the edge of one knows nothing of the other. Walls that are
/// thick and fill the corners hold: a start in another wall is still before its outer side.
pub(super) fn of_objects(effort: &Effort) -> Outcome {
    let settings = settings(effort, 100);
    let (mut counted, mut figures, mut through_thick) = (0, Vec::new(), 0);
    for (name, walls) in [
        ("edge to edge", Walls::Thin(0.0)),
        ("walls that go on behind each other", Walls::Thin(0.25)),
        ("walls of 10 cm", Walls::Thick),
    ] {
        for (turn, way) in [(Quat::IDENTITY, "upright"), (turned(), "turned")] {
            let parts = [0.0, 100.0, 12_345.678].map(|distance| {
                let at = Vec3::new(distance, 0.25 * distance, -0.5 * distance);
                let [(_, mirror, outside), _] = kinds();
                let world = outside(world(six_walls(turn, at, walls), vec![mirror]));
                let mut camera = Camera::looking_at(
                    Vec3::ZERO,
                    turn * Vec3::new(-0.5, -0.4, -1.0),
                    turn * Vec3::Y,
                    1.6,
                );
                camera.position = at + turn * Vec3::new(0.3, 0.2, 0.6);
                let (leaks, pixels) = seen(&world, &camera, &settings);
                counted += pixels;
                if matches!(walls, Walls::Thick) {
                    through_thick += leaks;
                }
                format!("{} %", digits(100.0 * leaks as f64 / pixels as f64, 2))
            });
            figures.push(format!("{name}, {way}: {}", parts.join(", ")));
        }
    }
    Outcome::new(
        counted,
        format!(
            "pixels that see the outside at 0, 100 and 12,346 m: {}",
            figures.join("; ")
        ),
    )
    .require(
        through_thick == 0,
        format!("{through_thick} pixels see the outside through thick walls"),
    )
}
