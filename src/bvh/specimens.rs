//! Meshes that the tests build trees over. Triangles as corners; `count` is approximate but for soups.

use glam::{Vec3, vec3};
use obvhs::aabb::Aabb;
use std::f32::consts::{PI, TAU};

/// The box of each triangle.
pub(super) fn boxes(triangles: &[[Vec3; 3]]) -> Vec<Aabb> {
    triangles
        .iter()
        .map(|[a, b, c]| Aabb::new(a.min(*b).min(*c).into(), a.max(*b).max(*c).into()))
        .collect()
}

/// A patch of `columns` × `rows` quads, two triangles each, over u and v in 0..1.
fn patch(columns: usize, rows: usize, surface: impl Fn(f32, f32) -> Vec3) -> Vec<[Vec3; 3]> {
    let point = |i: usize, j: usize| surface(i as f32 / columns as f32, j as f32 / rows as f32);
    let quads = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
    quads
        .flat_map(|(i, j)| {
            let corners = [
                point(i, j),
                point(i + 1, j),
                point(i + 1, j + 1),
                point(i, j + 1),
            ];
            [[0, 1, 2], [0, 2, 3]].map(|triangle| triangle.map(|corner: usize| corners[corner]))
        })
        .collect()
}

/// A sphere with bumps of a tenth of its radius.
pub(super) fn bumpy_sphere(count: usize) -> Vec<[Vec3; 3]> {
    let rows = ((count / 4) as f32).sqrt() as usize;
    patch(2 * rows, rows, |u, v| {
        let (azimuth, polar) = (u * TAU, v * PI);
        let (sin, cos) = polar.sin_cos();
        let radius = 1.0 + 0.1 * (7.0 * azimuth).sin() * (9.0 * polar).sin();
        vec3(azimuth.cos() * sin, cos, azimuth.sin() * sin) * radius
    })
}

/// A tube along a trefoil knot.
pub(super) fn knot(count: usize) -> Vec<[Vec3; 3]> {
    let centre = |t: f32| {
        let radius = 2.0 + (3.0 * t).cos();
        vec3(
            radius * (2.0 * t).cos(),
            (3.0 * t).sin(),
            radius * (2.0 * t).sin(),
        )
    };
    let around = ((count / 32) as f32).sqrt() as usize;
    patch(16 * around, around, |u, v| {
        let t = u * TAU;
        let along = (centre(t + 1e-3) - centre(t - 1e-3)).normalize();
        let (side, up) = along.any_orthonormal_pair();
        let (sin, cos) = (v * TAU).sin_cos();
        centre(t) + (side * cos + up * sin) * (0.35 + 0.05 * (40.0 * t).sin())
    })
}

/// Triangles with corners anywhere in a cube of side `size`, the cube anywhere in the unit cube.
pub(super) fn soup(count: usize, size: f32, seed: u64) -> Vec<[Vec3; 3]> {
    let mut random = Random(seed);
    (0..count)
        .map(|_| {
            let place = random.point();
            [(); 3].map(|()| place + (random.point() - 0.5) * size)
        })
        .collect()
}

/// Long thin triangles, 1 : 2000, in all directions.
pub(super) fn needles(count: usize, seed: u64) -> Vec<[Vec3; 3]> {
    let mut random = Random(seed);
    (0..count)
        .map(|_| {
            let (root, tip) = (random.point(), (random.point() - 0.5) * 0.3);
            let width = vec3(1e-4, 1e-4, 0.0);
            [root, root + tip, root + tip * 0.5 + width]
        })
        .collect()
}

/// Knuth's 64-bit linear congruential generator: the upper bits are good enough to scatter triangles.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u32 << 24) as f32
    }

    fn point(&mut self) -> Vec3 {
        vec3(self.next(), self.next(), self.next())
    }
}
