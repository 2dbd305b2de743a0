//! What every shape keeps.

use super::check::{Edges, edges, triangles, volume};
use super::surface::normal_of;
use super::*;
use bevy::math::{Vec2, Vec3};
use bevy::mesh::{PrimitiveTopology, VertexAttributeValues};
use std::f64::consts::PI;

fn shapes() -> Vec<Shape> {
    vec![
        Shape::Triangle {
            corners: [Vec3::ZERO, Vec3::X, Vec3::Y],
        },
        Shape::Quad {
            corner: Vec3::ZERO,
            edges: [Vec3::X, Vec3::Z],
        },
        Shape::Ground {
            size: Vec2::new(3.0, 2.0),
            tile: Vec2::new(3.0, 2.0),
        },
        Shape::Quadrilateral {
            corners: [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.1), Vec3::Y],
        },
        Shape::Teapot { divisions: 16 },
    ]
}

/// Closed shapes, with the volume that each would have were it not made of triangles.
fn closed_shapes() -> Vec<(Shape, f64)> {
    let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let backwards = square.into_iter().rev().collect();
    vec![
        (
            Shape::Cuboid {
                size: Vec3::new(1.0, 2.0, 3.0),
            },
            6.0,
        ),
        (
            Shape::Prism {
                base: square.to_vec(),
                height: 2.0,
            },
            2.0,
        ),
        (
            Shape::Prism {
                base: backwards,
                height: 2.0,
            },
            2.0,
        ),
        (
            Shape::Sphere {
                radius: 0.3,
                segments: 3,
                rings: 2,
            },
            4.0 / 3.0 * PI * 0.027,
        ),
        (
            Shape::Sphere {
                radius: 2.0,
                segments: 64,
                rings: 33,
            },
            4.0 / 3.0 * PI * 8.0,
        ),
        (
            Shape::Cylinder {
                radius: 0.5,
                height: 3.0,
                segments: 31,
            },
            PI * 0.75,
        ),
        (
            Shape::Torus {
                major_radius: 2.0,
                minor_radius: 0.5,
                segments: 48,
                sides: 17,
            },
            2.0 * PI * PI * 0.5,
        ),
        (
            Shape::Head {
                segments: 24,
                rings: 22,
            },
            1.6,
        ),
        (
            Shape::Head {
                segments: 101,
                rings: 67,
            },
            1.6,
        ),
        (
            Shape::Knot {
                p: 2,
                q: 3,
                tube_radius: 0.18,
                displacement: 0.12,
                segments: 720,
                sides: 40,
            },
            // Its length times the tube's section.
            15.38 * PI * 0.0324,
        ),
    ]
}

#[test]
fn every_shape_has_the_counted_triangles_unit_normals_and_texture_coordinates() {
    let closed = closed_shapes().into_iter().map(|(shape, _)| shape);
    for shape in shapes().into_iter().chain(closed) {
        let mesh = mesh(&shape).unwrap();
        assert_eq!(mesh.primitive_topology(), PrimitiveTopology::TriangleList);
        let count = mesh.indices().unwrap().len() as u64 / 3;
        assert_eq!(count, triangle_count(&shape).unwrap(), "{shape:?}");
        let vertices = mesh.count_vertices();
        let Some(VertexAttributeValues::Float32x3(normals)) =
            mesh.attribute(Mesh::ATTRIBUTE_NORMAL)
        else {
            panic!("{shape:?} has no normals");
        };
        let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0)
        else {
            panic!("{shape:?} has no texture coordinates");
        };
        assert_eq!(
            (normals.len(), uvs.len()),
            (vertices, vertices),
            "{shape:?}"
        );
        for normal in normals {
            let length = Vec3::from(*normal).length();
            assert!(
                (length - 1.0).abs() < 1e-6,
                "{shape:?}: a normal of length {length}"
            );
        }
        let outside = uvs.iter().flatten().find(|x| !(0.0..=1.0).contains(*x));
        assert_eq!(outside, None, "{shape:?}");
        assert!(
            mesh.indices().unwrap().iter().all(|i| i < vertices),
            "{shape:?}"
        );
    }
}

#[test]
fn closed_shapes_are_closed_and_turned_outwards() {
    for (shape, volume_of_the_ideal) in closed_shapes() {
        let surface = surface(&shape).unwrap();
        let closed = Edges {
            open: 0,
            crowded: 0,
        };
        assert_eq!(edges(&surface), closed, "{shape:?}");
        let ratio = volume(&surface) / volume_of_the_ideal;
        let least = if triangle_count(&shape).unwrap() < 100 {
            0.1
        } else {
            0.9
        };
        assert!(
            ratio > least && ratio < 1.06,
            "{shape:?}: volume ratio {ratio:.4}"
        );
    }
}

#[test]
fn no_triangle_is_degenerate_and_normals_point_to_its_outer_side() {
    let closed = closed_shapes().into_iter().map(|(shape, _)| shape);
    for shape in shapes().into_iter().chain(closed) {
        let surface = surface(&shape).unwrap();
        let corners = surface.indices.chunks_exact(3);
        for (triangle, indices) in triangles(&surface).zip(corners) {
            let flat = normal_of(triangle);
            assert_ne!(flat, DVec3::ZERO, "{shape:?}: {triangle:?}");
            for &i in indices {
                let agreement = Vec3::from(surface.normals[i as usize]).as_dvec3().dot(flat);
                assert!(agreement > 0.0, "{shape:?}: {agreement:.3} at {triangle:?}");
            }
        }
    }
}

#[test]
fn textures_are_not_mirrored_on_the_outside() {
    let closed = closed_shapes().into_iter().map(|(shape, _)| shape);
    for shape in shapes().into_iter().chain(closed) {
        let surface = surface(&shape).unwrap();
        for corners in surface.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| Vec2::from(surface.uvs[corners[k] as usize]));
            // v runs down, so counter-clockwise places have clockwise coordinates.
            let area = (b - a).perp_dot(c - a);
            assert!(area < 0.0, "{shape:?}: {area} at {a} {b} {c}");
        }
    }
}

#[test]
fn the_teapot_of_the_built_in_scene_is_as_fine_as_the_usual_one() {
    assert_eq!(triangle_count(&Shape::Teapot { divisions: 16 }), Ok(16_256));
}

#[test]
fn bad_numbers_are_refused_with_the_field_they_are_in() {
    let sphere = |radius, segments, rings| Shape::Sphere {
        radius,
        segments,
        rings,
    };
    let knot = |p, q| Shape::Knot {
        p,
        q,
        tube_radius: 0.1,
        displacement: 0.0,
        segments: 9,
        sides: 3,
    };
    let prism = |base: &[[f32; 2]]| Shape::Prism {
        base: base.iter().map(|&c| c.into()).collect(),
        height: 1.0,
    };
    let cases = [
        (sphere(f32::NAN, 8, 8), "radius"),
        (sphere(f32::INFINITY, 8, 8), "radius"),
        (sphere(0.0, 8, 8), "radius"),
        (sphere(-1.0, 8, 8), "radius"),
        (sphere(1.0, 0, 8), "segments"),
        (sphere(1.0, 3, 1), "rings"),
        (sphere(1.0, u32::MAX, u32::MAX), "20000000"),
        (sphere(1e-45, 8, 8), "too small"),
        (Shape::Teapot { divisions: 0 }, "divisions"),
        (
            Shape::Teapot {
                divisions: u32::MAX,
            },
            "20000000",
        ),
        (
            Shape::Head {
                segments: 2,
                rings: 9,
            },
            "segments",
        ),
        (knot(2, 4), "common divisor"),
        (knot(0, 1), "common divisor"),
        (prism(&[]), "base"),
        (prism(&[[0.0, 0.0], [1.0, 0.0]]), "base"),
        (prism(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), "convex"),
        (
            prism(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]),
            "convex",
        ),
        (prism(&[[0.0, f32::NAN], [1.0, 1.0], [1.0, 0.0]]), "base"),
        (
            Shape::Cuboid {
                size: Vec3::new(1.0, 0.0, 1.0),
            },
            "size.y",
        ),
        (
            Shape::Cuboid {
                size: Vec3::splat(f32::MAX),
            },
            "",
        ),
        (
            Shape::Quad {
                corner: Vec3::ZERO,
                edges: [Vec3::X, Vec3::X * 2.0],
            },
            "area",
        ),
        (
            Shape::Quad {
                corner: Vec3::MAX,
                edges: [Vec3::MAX, Vec3::Y],
            },
            "too large",
        ),
        (
            Shape::Triangle {
                corners: [Vec3::ZERO; 3],
            },
            "area",
        ),
        (
            Shape::Quadrilateral {
                corners: [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE],
            },
            "convex",
        ),
    ];
    for (shape, part) in cases {
        match mesh(&shape) {
            Err(error) => assert!(error.to_string().contains(part), "{shape:?}: {error}"),
            Ok(_) => assert_eq!(part, "", "{shape:?} was made"),
        }
    }
}

#[test]
fn the_same_shape_is_the_same_mesh_bit_for_bit() {
    for (shape, _) in closed_shapes() {
        let [a, b] = [0, 1].map(|_| surface(&shape).unwrap());
        assert_eq!(a.positions, b.positions, "{shape:?}");
        assert_eq!(a.normals, b.normals, "{shape:?}");
    }
}
