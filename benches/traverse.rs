//! Time of a batch of rays through one mesh: our kernel, and obvhs' own two traversals, over a bumpy sphere and a knot.
//!
//! `cargo bench --bench traverse --no-default-features`
//!
//! Nothing that looks into a traversal slows it while nobody does: the walk with the empty visitor, ray by ray, is that of a
//! batch, but for what a call costs; in instructions, which are repeatable, it may take 5 % more. Valgrind knows no AVX-512;
//! the walk that it sees is that of AVX2.
//!
//! `cargo bench --bench traverse --no-default-features -- instructions`

#[path = "shared/instructions.rs"]
mod instructions;
#[path = "shared/surfaces.rs"]
mod surfaces;

use divan::{Bencher, black_box, counter::ItemsCount};
use glam::{Affine3A, Vec3, vec3};
use glassbox::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Ray, Triangles};
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

/// A mesh, and rays from its surface in all directions.
struct Subject {
    aggregate: Aggregate,
    rays: Vec<Ray>,
    bvh2: (Bvh2, Vec<RtTriangle>),
    cwbvh: (CwBvh, Vec<RtTriangle>),
}

static SPHERE: LazyLock<Subject> = LazyLock::new(|| subject(&patch(2, 15_000, sphere)));
static KNOT: LazyLock<Subject> = LazyLock::new(|| subject(&patch(16, 87_000, knot)));

const NAMES: [&str; 2] = ["sphere", "knot"];

fn of(name: &str) -> &'static Subject {
    match name {
        "sphere" => &SPHERE,
        _ => &KNOT,
    }
}

#[divan::bench(args = NAMES)]
fn closest_ours(bencher: Bencher, name: &str) {
    let Subject {
        aggregate, rays, ..
    } = of(name);
    let mut hits = Vec::new();
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| aggregate.closest_hits(black_box(rays), &mut hits));
}

#[divan::bench(args = NAMES)]
fn closest_obvhs_bvh2(bencher: Bencher, name: &str) {
    let Subject { rays, bvh2, .. } = of(name);
    let (tree, triangles) = bvh2;
    let hit = |ray: &Ray| {
        let mut hit = RayHit::none();
        tree.ray_traverse(theirs(ray), &mut hit, |ray, i| triangles[i].intersect(ray))
    };
    one_by_one(bencher, rays, hit);
}

#[divan::bench(args = NAMES)]
fn closest_obvhs_cwbvh(bencher: Bencher, name: &str) {
    let Subject { rays, cwbvh, .. } = of(name);
    let (tree, triangles) = cwbvh;
    let hit = |ray: &Ray| {
        let mut hit = RayHit::none();
        tree.ray_traverse(theirs(ray), &mut hit, |ray, i| triangles[i].intersect(ray))
    };
    one_by_one(bencher, rays, hit);
}

#[divan::bench(args = NAMES)]
fn any_ours(bencher: Bencher, name: &str) {
    let Subject {
        aggregate, rays, ..
    } = of(name);
    let mut occluded = Vec::new();
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| aggregate.occlusions(black_box(rays), &mut occluded));
}

#[divan::bench(args = NAMES)]
fn any_obvhs_bvh2(bencher: Bencher, name: &str) {
    let Subject { rays, bvh2, .. } = of(name);
    let (tree, triangles) = bvh2;
    let hit =
        |ray: &Ray| !tree.ray_traverse_miss(theirs(ray), |ray, i| triangles[i].intersect(ray));
    one_by_one(bencher, rays, hit);
}

#[divan::bench(args = NAMES)]
fn any_obvhs_cwbvh(bencher: Bencher, name: &str) {
    let Subject { rays, cwbvh, .. } = of(name);
    let (tree, triangles) = cwbvh;
    let hit =
        |ray: &Ray| !tree.ray_traverse_miss(theirs(ray), |ray, i| triangles[i].intersect(ray));
    one_by_one(bencher, rays, hit);
}

/// How long it takes to ask this of each ray.
fn one_by_one(bencher: Bencher, rays: &[Ray], hit: impl Fn(&Ray) -> bool) {
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| black_box(rays).iter().filter(|ray| hit(ray)).count());
}

fn theirs(ray: &Ray) -> obvhs::ray::Ray {
    let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
    obvhs::ray::Ray::new(origin.into(), direction.into(), 0.0, ray.t_max)
}

fn subject(corners: &[[Vec3; 3]]) -> Subject {
    let positions = corners.as_flattened().to_vec();
    let indices = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let triangles = Triangles::new(positions, indices.collect()).expect("indices in range");
    let options = BuildOptions::default();
    let mesh = Arc::new(MeshTree::build(triangles, &options));
    let instance = Instance::new(mesh, &Affine3A::IDENTITY).expect("the identity has an inverse");
    let mut random = random();
    let rays = (0..RAYS)
        .map(|_| {
            let [a, b, c] = corners[(random() * corners.len() as f32) as usize];
            let direction = vec3(random(), random(), random()) - 0.5;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            Ray::new((a + b + c) / 3.0 + normal * 1e-3, direction)
        })
        .collect();
    let theirs: Vec<Triangle> = corners
        .iter()
        .map(|[a, b, c]| Triangle {
            v0: a.to_array().into(),
            v1: b.to_array().into(),
            v2: c.to_array().into(),
        })
        .collect();
    let in_order = |indices: &[u32]| -> Vec<RtTriangle> {
        let triangles = indices.iter().map(|&i| &theirs[i as usize]);
        triangles.map(RtTriangle::from).collect()
    };
    let parameters = BvhBuildParams {
        pre_split: false,
        ..BvhBuildParams::medium_build()
    };
    let bvh2 = build_bvh2_from_tris(&theirs, parameters, &mut Duration::default());
    let cwbvh = build_cwbvh_from_tris(&theirs, parameters, &mut Duration::default());
    let (of_bvh2, of_cwbvh) = (
        in_order(&bvh2.primitive_indices),
        in_order(&cwbvh.primitive_indices),
    );
    Subject {
        aggregate: Aggregate::build(vec![instance], &options),
        rays,
        bvh2: (bvh2, of_bvh2),
        cwbvh: (cwbvh, of_cwbvh),
    }
}
