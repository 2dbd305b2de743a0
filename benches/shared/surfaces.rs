//! Meshes and random numbers of the benches.

use glam::{Vec3, vec3};
use std::f32::consts::{PI, TAU};

/// Numbers in [0, 1): Knuth's 64-bit linear congruential generator, upper bits.
pub fn random() -> impl FnMut() -> f32 {
    let mut state = 1u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u32 << 24) as f32
    }
}

/// About `count` triangles on a surface over u and v in 0..1, `aspect` times as many along u.
pub fn patch(aspect: usize, count: usize, surface: fn(f32, f32) -> Vec3) -> Vec<[Vec3; 3]> {
    let rows = ((count / (2 * aspect)) as f32).sqrt() as usize;
    let columns = aspect * rows;
    let point = |i: usize, j: usize| surface(i as f32 / columns as f32, j as f32 / rows as f32);
    let quads = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
    quads
        .flat_map(|(i, j)| {
            let (a, c) = (point(i, j), point(i + 1, j + 1));
            [[a, point(i + 1, j), c], [a, c, point(i, j + 1)]]
        })
        .collect()
}

/// A bumpy sphere.
pub fn sphere(u: f32, v: f32) -> Vec3 {
    let (azimuth, polar) = (u * TAU, v * PI);
    let bumps = (7.0 * azimuth).sin() * (9.0 * polar).sin();
    let (sin, cos) = polar.sin_cos();
    vec3(azimuth.cos() * sin, cos, azimuth.sin() * sin) * (1.0 + 0.1 * bumps)
}

/// A tube along a trefoil.
pub fn knot(u: f32, v: f32) -> Vec3 {
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
