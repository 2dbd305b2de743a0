//! Time to build a tree, for each builder, over meshes (a bumpy sphere, a knot) and soups of triangles.
//!
//! `cargo bench --bench build`

#[path = "shared/surfaces.rs"]
mod surfaces;

use divan::{Bencher, black_box, counter::ItemsCount};
use glam::{Vec3, vec3};
use glassbox::bvh::{BuildOptions, Builder, Preset, build_tree};
use obvhs::aabb::Aabb;
use surfaces::{knot, patch, random, sphere};

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
        "sphere" => boxes_of(&patch(2, count, sphere)),
        "knot" => boxes_of(&patch(16, count, knot)),
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

/// Triangles anywhere in the unit cube, of a size that fills it.
fn soup(count: usize) -> Vec<Aabb> {
    let mut random = random();
    let mut point = move || vec3(random(), random(), random());
    let size = 1.0 / (count as f32).cbrt();
    (0..count)
        .map(|_| {
            let place = point();
            box_of([(); 3].map(|()| place + point() * size))
        })
        .collect()
}

fn boxes_of(triangles: &[[Vec3; 3]]) -> Vec<Aabb> {
    triangles.iter().copied().map(box_of).collect()
}

fn box_of([a, b, c]: [Vec3; 3]) -> Aabb {
    Aabb::new(a.min(b).min(c).into(), a.max(b).max(c).into())
}
