//! Time of a batch of rays: through one mesh, through trees over instances, alone and in packets; and through obvhs' own two
//! traversals. `glassbox report kernels` measures the same against Embree.
//!
//! `cargo bench --bench rays --no-default-features`
//!
//! Nothing that looks into a walk slows it while nobody does, since it is the same walk: the instructions of a batch, and of
//! single rays with the empty visitor, which are repeatable. Valgrind knows no AVX-512; what it sees are the lanes of AVX2.
//!
//! `cargo bench --bench rays --no-default-features -- instructions`

#[path = "shared/instructions.rs"]
mod instructions;
#[path = "shared/surfaces.rs"]
mod surfaces;

use divan::{Bencher, black_box, counter::ItemsCount};
use glam::{Affine3A, EulerRot, Quat, Vec3, vec3};
use glassbox::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Order, Ray, Triangles};
use obvhs::{
    BvhBuildParams, bvh2::Bvh2, bvh2::builder::build_bvh2_from_tris, cwbvh::CwBvh,
    cwbvh::builder::build_cwbvh_from_tris, ray::RayHit, rt_triangle::RtTriangle,
    triangle::Triangle,
};
use std::{
    process::ExitCode,
    sync::{Arc, LazyLock},
    time::Duration,
};
use surfaces::{knot, patch, random, sphere};

fn main() -> ExitCode {
    instructions::main().unwrap_or_else(|| {
        divan::main();
        ExitCode::SUCCESS
    })
}

/// Rays of a batch.
const RAYS: usize = 20_000;

/// What rays are shot at, with rays from its surface in all directions, and from a camera, tile by tile.
struct Subject {
    aggregate: Aggregate,
    scattered: Vec<Ray>,
    primary: Vec<Ray>,
}

static SPHERE: LazyLock<Subject> = LazyLock::new(|| subject(&patch(2, 15_000, sphere), 1));
static KNOT: LazyLock<Subject> = LazyLock::new(|| subject(&patch(16, 87_000, knot), 1));
static LARGE: LazyLock<Subject> = LazyLock::new(|| subject(&patch(2, 2_000_000, sphere), 1));
static FEW: LazyLock<Subject> = LazyLock::new(|| subject(&patch(2, 8_000, sphere), 1_000));
static MANY: LazyLock<Subject> = LazyLock::new(|| subject(&patch(2, 8_000, sphere), 100_000));

const NAMES: [&str; 5] = [
    "sphere",
    "knot",
    "2 million triangles",
    "1000 instances",
    "100000 instances",
];

fn of(name: &str) -> &'static Subject {
    match name {
        "sphere" => &SPHERE,
        "knot" => &KNOT,
        "2 million triangles" => &LARGE,
        "1000 instances" => &FEW,
        _ => &MANY,
    }
}

#[divan::bench(args = NAMES)]
fn closest_scattered(bencher: Bencher, name: &str) {
    let Subject {
        aggregate,
        scattered,
        ..
    } = of(name);
    closest(bencher, aggregate, Order::None, scattered);
}

#[divan::bench(args = NAMES)]
fn closest_primary(bencher: Bencher, name: &str) {
    let Subject {
        aggregate, primary, ..
    } = of(name);
    closest(bencher, aggregate, Order::None, primary);
}

#[divan::bench(args = NAMES)]
fn closest_primary_in_packets(bencher: Bencher, name: &str) {
    let Subject {
        aggregate, primary, ..
    } = of(name);
    closest(bencher, aggregate, Order::Tile, primary);
}

fn closest(bencher: Bencher, aggregate: &Aggregate, order: Order, rays: &[Ray]) {
    let mut hits = Vec::new();
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| aggregate.closest_hits_in(order, black_box(rays), &mut hits));
}

#[divan::bench(args = NAMES)]
fn any_scattered(bencher: Bencher, name: &str) {
    let Subject {
        aggregate,
        scattered,
        ..
    } = of(name);
    any(bencher, aggregate, Order::None, scattered);
}

#[divan::bench(args = NAMES)]
fn any_primary_in_packets(bencher: Bencher, name: &str) {
    let Subject {
        aggregate, primary, ..
    } = of(name);
    any(bencher, aggregate, Order::Light, primary);
}

fn any(bencher: Bencher, aggregate: &Aggregate, order: Order, rays: &[Ray]) {
    let mut occluded = Vec::new();
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| aggregate.occlusions_in(order, black_box(rays), &mut occluded));
}

/// obvhs' trees over the knot.
struct Theirs {
    bvh2: (Bvh2, Vec<RtTriangle>),
    cwbvh: (CwBvh, Vec<RtTriangle>),
}

static THEIRS: LazyLock<Theirs> = LazyLock::new(|| theirs(&patch(16, 87_000, knot)));

/// The two traversals have the same calls, but no trait for them.
macro_rules! of_obvhs {
    ($closest:ident, $any:ident, $tree:ident) => {
        #[divan::bench]
        fn $closest(bencher: Bencher) {
            let (tree, triangles) = &THEIRS.$tree;
            one_by_one(bencher, &KNOT.scattered, |ray| {
                let mut hit = RayHit::none();
                tree.ray_traverse(as_theirs(ray), &mut hit, |ray, i| {
                    triangles[i].intersect(ray)
                })
            });
        }

        #[divan::bench]
        fn $any(bencher: Bencher) {
            let (tree, triangles) = &THEIRS.$tree;
            one_by_one(bencher, &KNOT.scattered, |ray| {
                !tree.ray_traverse_miss(as_theirs(ray), |ray, i| triangles[i].intersect(ray))
            });
        }
    };
}

of_obvhs!(
    closest_scattered_knot_obvhs_bvh2,
    any_scattered_knot_obvhs_bvh2,
    bvh2
);
of_obvhs!(
    closest_scattered_knot_obvhs_cwbvh,
    any_scattered_knot_obvhs_cwbvh,
    cwbvh
);

/// How long it takes to ask this of each ray.
fn one_by_one(bencher: Bencher, rays: &[Ray], hit: impl Fn(&Ray) -> bool) {
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| black_box(rays).iter().filter(|ray| hit(ray)).count());
}

fn as_theirs(ray: &Ray) -> obvhs::ray::Ray {
    let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
    obvhs::ray::Ray::new(origin.into(), direction.into(), 0.0, ray.t_max)
}

/// The mesh as it is, or so many times all over a cube.
fn subject(corners: &[[Vec3; 3]], count: usize) -> Subject {
    let positions = corners.as_flattened().to_vec();
    let indices = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let triangles = Triangles::new(positions, indices.collect()).expect("indices in range");
    let options = BuildOptions::default();
    let mesh = Arc::new(MeshTree::build(triangles, &options));
    let mut random = random();
    let side = 2.0 * (count as f32).cbrt();
    let places: Vec<Affine3A> = (0..count)
        .map(|_| {
            if count == 1 {
                return Affine3A::IDENTITY;
            }
            let [x, y, z] = [(); 3].map(|()| random() * std::f32::consts::TAU);
            let turn = Quat::from_euler(EulerRot::XYZ, x, y, z);
            let at = (vec3(random(), random(), random()) - 0.5) * side;
            Affine3A::from_rotation_translation(turn, at)
        })
        .collect();
    let instance = |place| Instance::new(mesh.clone(), place).expect("it has an inverse");
    let instances = places.iter().map(instance).collect();
    let scattered = (0..RAYS)
        .map(|_| {
            let [a, b, c] = corners[(random() * corners.len() as f32) as usize];
            let place = places[(random() * count as f32) as usize];
            let direction = vec3(random(), random(), random()) - 0.5;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let from = place.transform_point3((a + b + c) / 3.0 + normal * 1e-3);
            Ray::new(from, direction)
        })
        .collect();
    // 4 × 4 pixels in a row.
    let tiles = (0..36).flat_map(|y| (0..36).map(move |x| (4 * x, 4 * y)));
    let pixels = tiles.flat_map(|(x, y)| (0..16).map(move |i| (x + i % 4, y + i / 4)));
    let eye = Vec3::splat(side + 2.0);
    let (right, up) = (vec3(0.7, 0.0, -0.7) * side, vec3(-0.4, 0.8, -0.4) * side);
    let primary = pixels
        .map(|(x, y)| {
            let [x, y] = [x, y].map(|i| i as f32 / 72.0 - 1.0);
            Ray::new(eye, x * right + y * up - eye)
        })
        .collect();
    Subject {
        aggregate: Aggregate::build(instances, &options),
        scattered,
        primary,
    }
}

fn theirs(corners: &[[Vec3; 3]]) -> Theirs {
    let triangles: Vec<Triangle> = corners
        .iter()
        .map(|[a, b, c]| Triangle {
            v0: a.to_array().into(),
            v1: b.to_array().into(),
            v2: c.to_array().into(),
        })
        .collect();
    let in_order = |indices: &[u32]| -> Vec<RtTriangle> {
        let triangles = indices.iter().map(|&i| &triangles[i as usize]);
        triangles.map(RtTriangle::from).collect()
    };
    let parameters = BvhBuildParams {
        pre_split: false,
        ..BvhBuildParams::medium_build()
    };
    let bvh2 = build_bvh2_from_tris(&triangles, parameters, &mut Duration::default());
    let cwbvh = build_cwbvh_from_tris(&triangles, parameters, &mut Duration::default());
    let (of_bvh2, of_cwbvh) = (
        in_order(&bvh2.primitive_indices),
        in_order(&cwbvh.primitive_indices),
    );
    Theirs {
        bvh2: (bvh2, of_bvh2),
        cwbvh: (cwbvh, of_cwbvh),
    }
}
