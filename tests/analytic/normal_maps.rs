//! What a normal map means where a mesh has tangents of its own.

use super::materials::{at, bent, settings};
use glam::{Affine3A, Vec3, Vec4};
use glassbox::bvh::{Aggregate, BuildOptions, Instance};
use glassbox::scene::{Lighting, RenderSettings};
use glassbox::trace::{Mesh, World};
use std::sync::Arc;

/// A texel's normal, of unit length.
const TEXEL: Vec3 = Vec3::new(0.48, 0.36, 0.8);

/// The square of [`bent`] with one tangent at all of its corners, placed by a transform.
fn with_tangent(tangent: Vec4, world_from_object: &Affine3A) -> World {
    let mut world = bent(TEXEL, 1.0);
    let mut object = world.objects[0].clone();
    object.mesh = Arc::new(Mesh {
        normals: vec![Vec3::Y; 6],
        tangents: vec![tangent; 6],
        ..Mesh::clone(&object.mesh)
    });
    let instance = Instance::new(object.mesh.tree.clone(), world_from_object).unwrap();
    let options = BuildOptions::default();
    world.aggregate = Arc::new(Aggregate::build(vec![instance], &options));
    world.objects = Arc::new(vec![object]);
    world
}

/// A tangent in the square's plane.
fn along(turn: f32, side: f32) -> Vec4 {
    Vec3::new(turn.cos(), 0.0, turn.sin()).extend(side)
}

#[test]
fn a_given_tangent_says_where_the_map_s_right_is_and_its_sign_where_its_upper_edge_is() {
    let turned = Affine3A::from_rotation_x(0.3);
    let mirrored = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let upside_down = Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0));
    for transform in [Affine3A::IDENTITY, turned, mirrored, upside_down] {
        for (turn, side) in [
            (0.0, 1.0),
            (0.7, 1.0),
            (0.7, -1.0),
            (2.5, 1.0),
            (-1.0, -1.0),
        ] {
            let tangent = along(turn, side);
            let right = tangent.truncate();
            let up = side * Vec3::Y.cross(right);
            let expected = TEXEL.x * right + TEXEL.y * up + TEXEL.z * Vec3::Y;
            let expected = transform.transform_vector3(expected);
            let world = with_tangent(tangent, &transform);
            let front = transform.transform_vector3(Vec3::Y);
            for (from, sign) in [(front, 1.0), (-front, -1.0)] {
                let found = at(&world, &settings(), 0.0, 0.0, -from).normal;
                assert!(
                    found.abs_diff_eq(sign * expected, 1e-5),
                    "{turn} {side} from {from}: {found}, not {}",
                    sign * expected
                );
            }
            let classic = RenderSettings {
                lighting: Lighting::Classic,
                ..settings()
            };
            let found = at(&world, &classic, 0.0, 0.0, front).normal;
            assert!(
                found.abs_diff_eq(expected, 1e-5),
                "{turn} {side}, Classic from behind: {found}, not {expected}"
            );
        }
    }
}

#[test]
fn a_tangent_is_made_perpendicular_to_the_normal_and_its_length_is_no_matter() {
    let expected = at(
        &with_tangent(along(0.7, 1.0), &Affine3A::IDENTITY),
        &settings(),
        0.1,
        0.2,
        Vec3::NEG_Y,
    );
    let leaning = (5.0 * along(0.7, 1.0).truncate() + 3.0 * Vec3::Y).extend(1.0);
    let world = with_tangent(leaning, &Affine3A::IDENTITY);
    let found = at(&world, &settings(), 0.1, 0.2, Vec3::NEG_Y);
    assert!(
        found.normal.abs_diff_eq(expected.normal, 1e-6),
        "{} and {}",
        found.normal,
        expected.normal
    );
}

#[test]
fn a_tangent_without_a_direction_leaves_the_texture_coordinates_to_say_it() {
    let expected = at(&bent(TEXEL, 1.0), &settings(), 0.1, 0.2, Vec3::NEG_Y).normal;
    for useless in [
        Vec4::ZERO,
        Vec3::Y.extend(1.0),
        Vec4::splat(f32::NAN),
        Vec4::splat(f32::INFINITY),
    ] {
        let world = with_tangent(useless, &Affine3A::IDENTITY);
        let found = at(&world, &settings(), 0.1, 0.2, Vec3::NEG_Y).normal;
        assert_eq!(found, expected, "{useless}");
    }
}

#[test]
fn tangents_are_part_of_what_tells_pictures_apart() {
    let camera = glassbox::trace::Camera::looking_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0);
    let digest = |tangent| {
        let world = with_tangent(tangent, &Affine3A::IDENTITY);
        glassbox::trace::digest(&world, &camera, &settings())
    };
    assert_ne!(digest(along(0.0, 1.0)), digest(along(0.0, -1.0)));
}
