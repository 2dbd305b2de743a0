//! Meshes for the tests.

use std::{f32::consts::TAU, sync::Arc};

use glam::{Affine3A, Vec3};

use super::random::Random;
use crate::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Triangles};

pub(crate) fn mesh(positions: Vec<Vec3>, indices: Vec<[u32; 3]>) -> Triangles {
    Triangles::new(positions, indices).expect("the tests' meshes have indices in range")
}

/// Triangles that share no vertex.
pub(crate) fn soup(corners: impl IntoIterator<Item = [Vec3; 3]>) -> Triangles {
    let positions: Vec<Vec3> = corners.into_iter().flatten().collect();
    let indices = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let indices = indices.collect();
    mesh(positions, indices)
}

/// The same mesh with every position mapped.
pub(crate) fn moved(triangles: &Triangles, map: impl Fn(Vec3) -> Vec3) -> Triangles {
    let positions = triangles.positions().iter().map(|&p| map(p)).collect();
    mesh(positions, triangles.indices().to_vec())
}

/// Several meshes as one.
pub(crate) fn joined(meshes: &[Triangles]) -> Triangles {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let base = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        indices.extend(mesh.indices().iter().map(|t| t.map(|i| i + base)));
    }
    mesh(positions, indices)
}

/// A grid of squares over (0..rows) x (0..columns), both wrapped around: closed without a seam.
fn closed_grid(rows: u32, columns: u32, at: impl Fn(f32, f32) -> Vec3) -> Triangles {
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            positions.push(at(row as f32 / rows as f32, column as f32 / columns as f32));
            let index = |r: u32, c: u32| (r % rows) * columns + c % columns;
            let [a, b] = [index(row, column), index(row + 1, column)];
            let [c, d] = [index(row, column + 1), index(row + 1, column + 1)];
            indices.extend([[a, b, c], [c, b, d]]);
        }
    }
    mesh(positions, indices)
}

/// The curve that [`knot`]'s tube follows; it stays well inside the tube.
pub(crate) fn knot_centre(turn: f32) -> Vec3 {
    let angle = turn * TAU;
    let (s2, c2) = (2.0 * angle).sin_cos();
    let (s3, c3) = (3.0 * angle).sin_cos();
    Vec3::new((2.0 + c3) * c2, (2.0 + c3) * s2, s3)
}

/// A trefoil knot of 2 · rows · columns triangles; closed.
pub(crate) fn knot(rows: u32, columns: u32) -> Triangles {
    closed_grid(rows, columns, |u, v| {
        let ahead = (knot_centre(u + 1e-3) - knot_centre(u - 1e-3)).normalize();
        let side = ahead.cross(Vec3::Z).normalize();
        let (sin, cos) = (v * TAU).sin_cos();
        knot_centre(u) + 0.4 * (side * cos + ahead.cross(side) * sin)
    })
}

/// A sphere of radius 1 around the origin, closed: an octahedron, `levels` times subdivided. 8 · 4^levels triangles.
pub(crate) fn sphere(levels: u32) -> Triangles {
    let mut positions = vec![Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for octant in 0..8u32 {
        let pick = |axis: u32| axis + 3 * (octant >> axis & 1);
        let face = [pick(0), pick(1), pick(2)];
        let even = octant.count_ones() % 2 == 0;
        faces.push(if even {
            face
        } else {
            [face[0], face[2], face[1]]
        });
    }
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let point = (positions[a as usize] + positions[b as usize]).normalize();
                positions.push(point);
                positions.len() as u32 - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    mesh(positions, faces)
}

/// The box [-1, 1]³: twelve triangles, closed.
pub(crate) fn cube() -> Triangles {
    let positions = (0..8)
        .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0)
        .collect();
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let indices = faces
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    mesh(positions, indices.collect())
}

/// Random triangles of a given size in [-1, 1]³.
pub(crate) fn scatter(count: usize, size: f32, seed: u64) -> Triangles {
    let mut random = Random::new(seed);
    soup((0..count).map(|_| {
        let centre = random.cube();
        [(); 3].map(|()| centre + random.cube() * size)
    }))
}

/// One instance of a mesh, where it stands.
pub(crate) fn alone(triangles: Triangles, options: &BuildOptions) -> Aggregate {
    placed(&[(triangles, Affine3A::IDENTITY)], options)
}

/// Each mesh placed by its transform.
pub(crate) fn placed(meshes: &[(Triangles, Affine3A)], options: &BuildOptions) -> Aggregate {
    let instances = meshes.iter().map(|(triangles, transform)| {
        let mesh = Arc::new(MeshTree::build(triangles.clone(), options));
        Instance::new(mesh, transform).expect("the tests' transforms have an inverse")
    });
    Aggregate::build(instances.collect(), options)
}
