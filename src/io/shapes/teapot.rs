//! Newell's teapot.
//!
//! The 32 bicubic Bézier patches of M. Newell, "The Utilization of Procedure Models in Digital Image
//! Synthesis", PhD thesis, University of Utah, 1975, as published in F. Crow, "The Origins of the
//! Teapot", IEEE Computer Graphics and Applications 7(1), 1987, with the bottom that was added
//! later. Its 306 control points are 290 different ones that patches use, and those follow from the
//! symmetry of the pot: the lists below hold one quarter of its round parts and one half of handle
//! and spout.

use super::surface::Surface;
use bevy::math::{DVec2, DVec3};

/// A ring of control points around the z axis: its radius, the third coordinate of the points
/// between the axes (0.56 radii, nearly a circle), its height.
struct Ring(f64, f64, f64);

/// From the rim's inner edge down to the middle of the bottom; patches share their border rings.
const BODY: [Ring; 13] = [
    Ring(1.4, 0.784, 2.4),
    Ring(1.3375, 0.749, 2.53125),
    Ring(1.4375, 0.805, 2.53125),
    Ring(1.5, 0.84, 2.4),
    Ring(1.75, 0.98, 1.875),
    Ring(2.0, 1.12, 1.35),
    Ring(2.0, 1.12, 0.9),
    Ring(2.0, 1.12, 0.45),
    Ring(1.5, 0.84, 0.225),
    Ring(1.5, 0.84, 0.15),
    Ring(1.5, 0.84, 0.075),
    Ring(1.425, 0.798, 0.0),
    Ring(0.0, 0.0, 0.0),
];

/// From the knob's top to the lid's edge.
const LID: [Ring; 7] = [
    Ring(0.0, 0.0, 3.15),
    Ring(0.8, 0.45, 3.15),
    Ring(0.0, 0.0, 2.85),
    Ring(0.2, 0.112, 2.7),
    Ring(0.4, 0.224, 2.55),
    Ring(1.3, 0.728, 2.55),
    Ring(1.3, 0.728, 2.4),
];

/// A row of control points across a half tube: (x, z) at one edge, (x, z) at the other, both in the
/// plane y = 0, and how far the two points between them stand off it.
struct Bow([f64; 2], [f64; 2], f64);

/// From its upper end to its lower one, inner edge first.
const HANDLE: [Bow; 7] = [
    Bow([-1.6, 2.025], [-1.5, 2.25], 0.3),
    Bow([-2.3, 2.025], [-2.5, 2.25], 0.3),
    Bow([-2.7, 2.025], [-3.0, 2.25], 0.3),
    Bow([-2.7, 1.8], [-3.0, 1.8], 0.3),
    Bow([-2.7, 1.575], [-3.0, 1.35], 0.3),
    Bow([-2.5, 1.125], [-2.65, 0.9375], 0.3),
    Bow([-2.0, 0.9], [-1.9, 0.6], 0.3),
];

/// From the body to the inside of the mouth, upper edge first.
const SPOUT: [Bow; 7] = [
    Bow([1.7, 1.425], [1.7, 0.6], 0.66),
    Bow([2.6, 1.425], [3.1, 0.825], 0.66),
    Bow([2.3, 2.1], [2.4, 2.025], 0.25),
    Bow([2.7, 2.4], [3.3, 2.4], 0.25),
    Bow([2.8, 2.475], [3.525, 2.49375], 0.25),
    Bow([2.9, 2.475], [3.45, 2.5125], 0.15),
    Bow([2.8, 2.4], [3.2, 2.4], 0.15),
];

/// Height of the published pot; ours is two units high.
const PUBLISHED_HEIGHT: f64 = 3.15;

/// Four rows of four control points, in Newell's coordinates: z up, the spout at +x, y ≤ 0.
type Patch = [[DVec3; 4]; 4];

/// Copies of a patch: signs of x and y.
const FOUR: &[[f64; 2]] = &[[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
const TWO: &[[f64; 2]] = &[[1.0, 1.0], [1.0, -1.0]];

pub(super) fn teapot(divisions: u32) -> Surface {
    let mut surface = Surface::default();
    for (patch, copies) in patches() {
        let grid = evaluated(&patch, divisions);
        for &mirror in copies {
            add_copy(&mut surface, &grid, divisions, mirror);
        }
    }
    surface
}

/// The stored patches, each with its copies.
fn patches() -> Vec<(Patch, &'static [[f64; 2]])> {
    let ring = |&Ring(r, w, z): &Ring| {
        [
            DVec3::new(r, 0.0, z),
            DVec3::new(r, -w, z),
            DVec3::new(w, -r, z),
            DVec3::new(0.0, -r, z),
        ]
    };
    let bow = |&Bow([x0, z0], [x1, z1], w): &Bow| {
        [
            DVec3::new(x0, 0.0, z0),
            DVec3::new(x0, -w, z0),
            DVec3::new(x1, -w, z1),
            DVec3::new(x1, 0.0, z1),
        ]
    };
    let round = [
        BODY.iter().map(ring).collect(),
        LID.iter().map(ring).collect(),
    ];
    let tubes = [
        HANDLE.iter().map(bow).collect(),
        SPOUT.iter().map(bow).collect(),
    ];
    let split = |rows: Vec<[DVec3; 4]>, copies| {
        (0..rows.len() - 1)
            .step_by(3)
            .map(|first| ([0, 1, 2, 3].map(|k| rows[first + k]), copies))
            .collect::<Vec<_>>()
    };
    let round = round.into_iter().flat_map(|rows| split(rows, FOUR));
    let tubes = tubes.into_iter().flat_map(|rows| split(rows, TWO));
    round.chain(tubes).collect()
}

/// Place, outward normal and texture place of `(divisions + 1)²` points, row by row.
fn evaluated(patch: &Patch, divisions: u32) -> Vec<(DVec3, DVec3, DVec2)> {
    let at = |k: u32| f64::from(k) / f64::from(divisions);
    let mut points = Vec::new();
    for row in 0..=divisions {
        let (down, down_slope) = bernstein(at(row));
        for column in 0..=divisions {
            let (along, along_slope) = bernstein(at(column));
            let sum = |rows: [f64; 4], columns: [f64; 4]| {
                let mut sum = DVec3::ZERO;
                for (j, points) in patch.iter().enumerate() {
                    for (k, &point) in points.iter().enumerate() {
                        sum += rows[j] * columns[k] * point;
                    }
                }
                sum
            };
            let position = sum(down, along);
            let normal = sum(down, along_slope).cross(sum(down_slope, along));
            // On the axis a whole row is one point, and has no direction along it.
            let normal = if normal.length() > 1e-9 {
                normal
            } else if position.z > PUBLISHED_HEIGHT / 2.0 {
                DVec3::Z
            } else {
                DVec3::NEG_Z
            };
            points.push((position, normal, DVec2::new(at(column), at(row))));
        }
    }
    points
}

/// Adds one mirrored copy of an evaluated patch, y up and two units high.
fn add_copy(
    surface: &mut Surface,
    grid: &[(DVec3, DVec3, DVec2)],
    divisions: u32,
    [sign_x, sign_y]: [f64; 2],
) {
    let is_mirrored = sign_x * sign_y < 0.0;
    let upright = |v: DVec3| DVec3::new(sign_x * v.x, v.z, -sign_y * v.y);
    let first = surface.positions.len() as u32;
    for &(position, normal, uv) in grid {
        let u = if is_mirrored { uv.x } else { 1.0 - uv.x };
        let position = upright(position) * (2.0 / PUBLISHED_HEIGHT);
        surface.vertex(position, upright(normal), DVec2::new(u, uv.y));
    }
    let at = |row: u32, column: u32| first + row * (divisions + 1) + column;
    for row in 0..divisions {
        for column in 0..divisions {
            let [a, b, c, d] = [
                at(row, column),
                at(row, column + 1),
                at(row + 1, column + 1),
                at(row + 1, column),
            ];
            for [p, q, r] in [[a, b, c], [a, c, d]] {
                let [at_p, at_q, at_r] = [p, q, r].map(|i| surface.positions[i as usize]);
                // At the knob's top and the middle of the bottom an edge has no length.
                if at_p != at_q && at_q != at_r && at_r != at_p {
                    surface.triangle(if is_mirrored { [p, r, q] } else { [p, q, r] });
                }
            }
        }
    }
}

/// The cubic Bernstein polynomials at `t` and their derivatives.
fn bernstein(t: f64) -> ([f64; 4], [f64; 4]) {
    let s = 1.0 - t;
    (
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [
            -3.0 * s * s,
            3.0 * s * (s - 2.0 * t),
            3.0 * t * (2.0 * s - t),
            3.0 * t * t,
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::shapes::check::{bounds, edges};
    use std::collections::HashSet;

    #[test]
    fn the_control_points_are_the_published_ones() {
        let mut points = HashSet::new();
        let mut patch_count = 0;
        for (patch, copies) in patches() {
            patch_count += copies.len();
            for [x, y] in copies {
                let mirrored = patch
                    .as_flattened()
                    .iter()
                    .map(|p| *p * DVec3::new(*x, *y, 1.0));
                points.extend(mirrored.map(|p| (p + 0.0).to_array().map(f64::to_bits)));
            }
        }
        assert_eq!(patch_count, 32);
        // Of the published 306, twelve are listed twice (the ring between body and bottom) and four
        // near the knob's top are in no patch.
        assert_eq!(points.len(), 306 - 12 - 4);
    }

    #[test]
    fn its_bounding_box_is_the_published_one() {
        let (low, high) = bounds(&teapot(64));
        let published = (low * 1.575, high * 1.575);
        let low_error = (published.0 - DVec3::new(-3.0, 0.0, -2.0))
            .abs()
            .max_element();
        let high_error = (published.1 - DVec3::new(3.434, 3.15, 2.0))
            .abs()
            .max_element();
        assert!(low_error < 1e-3 && high_error < 1e-3, "{published:?}");
    }

    #[test]
    fn it_is_open_only_where_newell_left_it_open() {
        for divisions in [2, 7, 16] {
            let edges = edges(&teapot(divisions));
            // Rim and lid edge: four patches each. Both ends of handle and spout: two patches each.
            assert_eq!(edges.open, 16 * divisions as usize, "{divisions} divisions");
            assert_eq!(edges.crowded, 0, "{divisions} divisions");
        }
    }

    #[test]
    fn it_is_symmetric_bit_for_bit() {
        let surface = teapot(9);
        let places: HashSet<_> = surface
            .positions
            .iter()
            .map(|p| p.map(f32::to_bits))
            .collect();
        let lonely = surface
            .positions
            .iter()
            .filter(|&&[x, y, z]| !places.contains(&[x, y, 0.0 - z].map(f32::to_bits)));
        assert_eq!(lonely.count(), 0);
    }

    #[test]
    fn no_triangle_is_degenerate_and_normals_agree_with_them() {
        let surface = teapot(16);
        assert_eq!(surface.indices.len() / 3, 32 * 16 * 16 * 2 - 8 * 16);
        for corners in surface.indices.chunks_exact(3) {
            let at = [0, 1, 2].map(|k| surface.positions[corners[k] as usize]);
            let flat = crate::io::shapes::surface::normal_of(
                at.map(|p| bevy::math::Vec3::from(p).as_dvec3()),
            );
            let smooth = corners.iter().map(|&i| surface.normals[i as usize]);
            for normal in smooth.map(|n| bevy::math::Vec3::from(n).as_dvec3()) {
                assert!(normal.dot(flat) > 0.3, "{:.3} at {at:?}", normal.dot(flat));
            }
        }
    }
}
