//! Time to build a tree, for each builder, over meshes (a bumpy sphere, a knot) and soups of triangles.
//!
//! `cargo bench --bench build`

use divan::{Bencher, black_box, counter::ItemsCount};
use glam::{Vec3, vec3};
use glassbox::bvh::{BuildOptions, Builder, Preset, build_tree};
use obvhs::aabb::Aabb;
use std::f32::consts::{PI, TAU};

fn main() {
    divan::main();
}

/// A mesh and how many triangles it has: about as many as a teapot, and as a scanned dragon.
const MESHES: [(&str, usize); 4] = [
    ("sphere", 15_000),
    ("knot", 90_000),
    ("soup", 15_000),
    ("soup", 90_000),
];

#[divan::bench(args = MESHES, sample_count = 20)]
fn median(bencher: Bencher, mesh: (&str, usize)) {
    bench(bencher, mesh, Builder::Median, Preset::Medium);
}

#[divan::bench(args = MESHES, sample_count = 20)]
fn sah(bencher: Bencher, mesh: (&str, usize)) {
    bench(bencher, mesh, Builder::Sah, Preset::Medium);
}

#[divan::bench(args = MESHES, sample_count = 20)]
fn ploc_fastest(bencher: Bencher, mesh: (&str, usize)) {
    bench(bencher, mesh, Builder::Ploc, Preset::Fastest);
}

#[divan::bench(args = MESHES, sample_count = 20)]
fn ploc_medium(bencher: Bencher, mesh: (&str, usize)) {
    bench(bencher, mesh, Builder::Ploc, Preset::Medium);
}

#[divan::bench(args = MESHES, sample_count = 10)]
fn ploc_very_slow(bencher: Bencher, mesh: (&str, usize)) {
    bench(bencher, mesh, Builder::Ploc, Preset::VerySlow);
}

fn bench(bencher: Bencher, (mesh, count): (&str, usize), builder: Builder, preset: Preset) {
    let boxes = match mesh {
        "sphere" => patch(2, count, sphere),
        "knot" => patch(16, count, knot),
        _ => soup(count),
    };
    let options = BuildOptions {
        builder,
        preset,
        ..BuildOptions::default()
    };
    bencher
        .counter(ItemsCount::new(boxes.len()))
        .bench(|| build_tree(black_box(&boxes), &options));
}

/// The boxes of about `count` triangles on a surface over u and v in 0..1, `aspect` times as many along u.
fn patch(aspect: usize, count: usize, surface: fn(f32, f32) -> Vec3) -> Vec<Aabb> {
    let rows = ((count / (2 * aspect)) as f32).sqrt() as usize;
    let columns = aspect * rows;
    let point = |i: usize, j: usize| surface(i as f32 / columns as f32, j as f32 / rows as f32);
    let quads = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
    quads
        .flat_map(|(i, j)| {
            let (a, c) = (point(i, j), point(i + 1, j + 1));
            [
                box_of([a, point(i + 1, j), c]),
                box_of([a, c, point(i, j + 1)]),
            ]
        })
        .collect()
}

fn sphere(u: f32, v: f32) -> Vec3 {
    let (azimuth, polar) = (u * TAU, v * PI);
    let bumps = (7.0 * azimuth).sin() * (9.0 * polar).sin();
    let (sin, cos) = polar.sin_cos();
    vec3(azimuth.cos() * sin, cos, azimuth.sin() * sin) * (1.0 + 0.1 * bumps)
}

/// A tube along a trefoil.
fn knot(u: f32, v: f32) -> Vec3 {
    let centre = |t: f32| {
        let radius = 2.0 + (3.0 * t).cos();
        vec3(
            radius * (2.0 * t).cos(),
            (3.0 * t).sin(),
            radius * (2.0 * t).sin(),
        )
    };
    let t = u * TAU;
    let along = (centre(t + 1e-3) - centre(t - 1e-3)).normalize();
    let (side, up) = along.any_orthonormal_pair();
    let (sin, cos) = (v * TAU).sin_cos();
    centre(t) + (side * cos + up * sin) * 0.4
}

/// Triangles anywhere in the unit cube, of a size that fills it.
fn soup(count: usize) -> Vec<Aabb> {
    let mut state = 1u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u32 << 24) as f32
    };
    let mut point = move || vec3(random(), random(), random());
    let size = 1.0 / (count as f32).cbrt();
    (0..count)
        .map(|_| {
            let place = point();
            box_of([(); 3].map(|()| place + point() * size))
        })
        .collect()
}

fn box_of([a, b, c]: [Vec3; 3]) -> Aabb {
    Aabb::new(a.min(b).min(c).into(), a.max(b).max(c).into())
}
