use super::super::mesh_tree::MeshTree;
use super::*;
use crate::bvh::{BuildOptions, Triangles};
use glam::{Affine3A, Quat};
use std::sync::Arc;

#[test]
fn a_moved_coordinate_lies_one_float_beyond_the_sum() {
    let some = [
        0.0,
        -0.0,
        1e-45,
        -1e-45,
        1.0,
        -1.0,
        1e30,
        -3e38,
        f32::INFINITY,
        f32::NEG_INFINITY,
    ];
    for p in some {
        for d in some.into_iter().chain([f32::NAN]) {
            let sum = p + d;
            let expected = if d > 0.0 {
                sum.next_up()
            } else if d < 0.0 {
                sum.next_down()
            } else {
                sum
            };
            let found = moved_on(p, d);
            let same = found.to_bits() == expected.to_bits();
            assert!(
                same || found.is_nan() && expected.is_nan(),
                "{p} + {d}: {found}"
            );
        }
    }
}

#[test]
fn the_normal_of_a_tiny_triangle_or_a_sliver_has_unit_length() {
    for size in [1e-18_f32, 1e-6, 1.0, 1e12] {
        let n = Plane::exact_normal([Vec3::ZERO, Vec3::X * size, Vec3::NEG_Z * size]);
        assert!((n - Vec3::Y).length() < 1e-6, "size {size:e}: {n}");
    }
    let n = Plane::exact_normal([Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.0, -1e-7)]);
    assert!((n - Vec3::Y).length() < 1e-6, "sliver: {n}");
}

#[test]
fn a_narrow_wedge_elsewhere_in_the_mesh_is_no_matter_to_a_hit() {
    // Far from the origin a wedge of a thousandth asks for more than a triangle has.
    let at = Vec3::splat(300.0);
    let wedge = [Vec3::Y, Vec3::new(0.1, 1.0, 1e-3)].map(|third| [Vec3::ZERO, Vec3::X, third]);
    let alone = [Vec3::Z, Vec3::Z + Vec3::X, Vec3::Z + Vec3::Y].map(|p| 3.0 * p);
    let corners: Vec<Vec3> = wedge.into_iter().chain([alone]).flatten().collect();
    let corners = corners.into_iter().map(|p| at + 0.3 * p).collect();
    let indices = vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]];
    let triangles = Triangles::new(corners, indices).unwrap();
    let mesh = Arc::new(MeshTree::build(triangles, &BuildOptions::default()));
    let instance = Instance::new(mesh, &Affine3A::IDENTITY).unwrap();
    let is_near = |triangle| {
        let hit = Hit {
            t: 1.0,
            instance: 0,
            triangle,
            u: 0.3,
            v: 0.3,
        };
        let corners = instance.mesh.triangles().corners(triangle);
        let wedge = instance.mesh.wedge_of(triangle);
        let placed = (instance.placement()).of_hit(corners, wedge, [hit.u, hit.v], 0.0);
        let is_near = instance.surface_point(&hit, 0.0).near_edge.is_some();
        (placed.is_ordinary, is_near)
    };
    assert_eq!(
        [0, 1, 2].map(is_near),
        [(false, true), (false, true), (true, false)]
    );
}

#[test]
fn the_point_lies_within_its_error_of_the_exact_one() {
    let corners = vec![
        Vec3::new(0.1, 0.7, -0.3),
        Vec3::new(1.9, -0.2, 0.4),
        Vec3::new(-0.6, 0.3, 1.1),
    ];
    let triangles = Triangles::new(corners.clone(), vec![[0, 1, 2]]).unwrap();
    let mesh = Arc::new(MeshTree::build(triangles, &BuildOptions::default()));
    let transform = Affine3A::from_scale_rotation_translation(
        Vec3::new(2.0, -0.5, 30.0),
        Quat::from_rotation_y(0.7),
        Vec3::new(1000.0, -20.0, 3.0),
    );
    let instance = Instance::new(mesh, &transform).unwrap();
    for i in 0..100 {
        let (u, v) = (i as f32 * 0.004, 0.55 - i as f32 * 0.005);
        let hit = Hit {
            t: 1.0,
            instance: 0,
            triangle: 0,
            u,
            v,
        };
        let point = instance.surface_point(&hit, 0.0);
        let (u, v) = (f64::from(u), f64::from(v));
        let [a, b, c] = [0, 1, 2].map(|i: usize| corners[i].as_dvec3());
        let object = a * (1.0 - u - v) + b * u + c * v;
        let matrix = transform.matrix3;
        let exact = matrix.x_axis.as_dvec3() * object.x
            + matrix.y_axis.as_dvec3() * object.y
            + matrix.z_axis.as_dvec3() * object.z
            + transform.translation.as_dvec3();
        let off = (point.position.as_dvec3() - exact).abs();
        assert!(
            off.cmple(point.error.as_dvec3()).all(),
            "{off} is more than {}",
            point.error
        );
    }
}
