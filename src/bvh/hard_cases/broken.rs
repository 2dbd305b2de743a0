//! Triangles that cannot be traced, among others that can.

use glam::Vec3;

use super::{
    meshes::{cube, joined, mesh, scatter},
    random::Random,
};
use crate::bvh::Triangles;

/// The same mesh with `extra` triangles in front, which no ray may ever hit.
pub(crate) fn with_extra(extra: &[[Vec3; 3]]) -> (Triangles, usize) {
    let mut positions: Vec<Vec3> = extra.iter().flatten().copied().collect();
    let mut indices: Vec<[u32; 3]> = (0..extra.len() as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    let base = positions.len() as u32;
    let whole = joined(&[cube(), scatter(60, 0.4, 2)]);
    positions.extend_from_slice(whole.positions());
    indices.extend(whole.indices().iter().map(|t| t.map(|i| i + base)));
    (mesh(positions, indices), extra.len())
}

/// 250 points and lines.
pub(crate) fn degenerate(random: &mut Random) -> Vec<[Vec3; 3]> {
    let mut extra = Vec::new();
    for _ in 0..50 {
        let (p, q) = (random.cube(), random.cube());
        // Eighths, so that the points lie on one line to the last bit.
        let (start, step) = ((p * 8.0).round() / 8.0, (q * 8.0).round() / 8.0);
        extra.extend([
            [p, p, p],
            [p, q, q],
            [p, q, p],
            [p, p, q],
            [start, start + step, start + step * 3.0],
        ]);
    }
    extra
}

/// A hundred triangles with a coordinate that is not finite or far too large.
pub(crate) fn not_finite(random: &mut Random) -> Vec<[Vec3; 3]> {
    const ODD: [f32; 6] = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        1e13,
        -3e38,
    ];
    (0..100)
        .map(|i| {
            let mut corners = [random.cube(), random.cube(), random.cube()];
            corners[i % 3][i / 3 % 3] = ODD[i % ODD.len()];
            corners
        })
        .collect()
}
