//! Rays that start where another ended.

use std::{
    f32::consts::{FRAC_PI_2, TAU},
    sync::Arc,
};

use glam::{Affine3A, DVec3, Quat, Vec3};

use super::{
    meshes::{alone, cube, placed, soup, sphere},
    random::Random,
};
use crate::bvh::{
    Aggregate, BuildOptions, Hit, Instance, MeshTree, Ray,
    hard_cases::spawned::{
        OUTSIDE_OF_THIN_PANES, SAFE_PANE, mirrored_inside, outside_of_panes, self_hits,
        triangles_of_all_sizes,
    },
};

#[test]
fn a_ray_that_leaves_a_triangle_of_any_size_does_not_meet_it_again() {
    let mut random = Random::new(17);
    let (scene, targets) = triangles_of_all_sizes(&mut random);
    let (spawned, same) = self_hits(&scene, &targets, 100_000, &mut random);
    assert!(spawned > 100_000, "only {spawned} rays");
    assert_eq!(same, 0, "{same} of {spawned} rays hit what they left");
}

#[test]
fn a_ray_that_leaves_an_instance_does_not_meet_its_triangle_again() {
    let mut random = Random::new(19);
    let mut meshes = Vec::new();
    let mut targets = Vec::new();
    for _ in 0..40 {
        let scale = Vec3::new(1.0, random.between(0.2, 2.0), -random.between(0.5, 2.0))
            * random.between(-8.0, 8.0).exp();
        let place = random.cube() * random.between(-8.0, 10.0).exp();
        let turn = Quat::from_axis_angle(random.direction(), random.between(0.0, TAU));
        meshes.push((
            sphere(1),
            Affine3A::from_scale_rotation_translation(scale, turn, place),
        ));
        targets.push(place);
    }
    let scene = placed(&meshes, &BuildOptions::default());
    let (spawned, same) = self_hits(&scene, &targets, 100_000, &mut random);
    assert!(spawned > 100_000, "only {spawned} rays");
    assert_eq!(same, 0, "{same} of {spawned} rays hit what they left");
}

#[test]
fn rays_that_leave_the_inside_of_a_closed_convex_mesh_stay_inside() {
    let mut random = Random::new(23);
    for (name, mesh) in [("cube", cube()), ("sphere", sphere(3))] {
        let scene = alone(mesh, &BuildOptions::default());
        let mut lost = 0;
        for _ in 0..1_000 {
            let mut ray = Ray::new(random.cube() * 0.3, random.direction());
            for _ in 0..50 {
                let Some(hit) = scene.closest_hit(&ray) else {
                    lost += 1;
                    break;
                };
                let surface = scene.instances()[0].surface_point(&hit, 0.0);
                let inwards = if surface.normal.dot(ray.direction) < 0.0 {
                    1.0
                } else {
                    -1.0
                };
                // Not so grazing that a flat corner between two facets is in the way.
                let direction = (surface.normal * inwards + random.direction() * 0.9).normalize();
                ray = Ray::new(scene.leave(&surface, direction), direction);
            }
        }
        assert_eq!(
            lost, 0,
            "{name}: {lost} of 1000 paths of 50 bounces left it"
        );
    }
}

#[test]
fn the_normal_is_on_the_side_that_the_winding_says_mirrored_or_not() {
    for scale in [Vec3::ONE, Vec3::new(-1.0, 2.0, 0.5), Vec3::splat(-3.0)] {
        let transform = Affine3A::from_scale(scale);
        let scene = placed(&[(sphere(2), transform)], &BuildOptions::default());
        let mut random = Random::new(1);
        for _ in 0..1_000 {
            let ray = Ray::new(Vec3::ZERO, random.direction());
            let hit = scene.closest_hit(&ray).expect("the sphere is closed");
            let surface = scene.instances()[0].surface_point(&hit, 0.0);
            let outwards = surface.normal.dot(ray.direction);
            assert!(
                outwards > 0.0,
                "scale {scale}: the outer side's normal points inwards: {surface:?}"
            );
            assert!((surface.normal.length() - 1.0).abs() < 1e-6, "{surface:?}");
            let apart = (surface.position - ray.at(hit.t)).length();
            assert!(
                apart < 1e-5,
                "scale {scale}: two ways to the same point differ by {apart}"
            );
        }
    }
}

/// Whether the line from `from` to `to` passes through a triangle, in f64.
fn passes(from: DVec3, to: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let volume = |p: DVec3, q: DVec3, r: DVec3, s: DVec3| (q - p).cross(r - p).dot(s - p);
    let (before, behind) = (volume(a, b, c, from), volume(a, b, c, to));
    let turns = [(a, b), (b, c), (c, a)].map(|(p, q)| volume(from, to, p, q));
    let one_way = turns.iter().all(|v| *v >= 0.0) || turns.iter().all(|v| *v <= 0.0);
    before * behind < 0.0 && one_way
}

/// A tetrahedron, whose first two faces share an edge at an angle of a right one to a thousandth of that.
fn wedge(random: &mut Random) -> Vec<[Vec3; 3]> {
    let angle = FRAC_PI_2 * random.between(-7.0, 0.0).exp();
    let along = Vec3::new(1.0, random.between(-0.3, 0.3), 0.0);
    let across = along.normalize().cross(Vec3::NEG_Z);
    let away = angle.cos() * across + angle.sin() * Vec3::Z;
    let third = |across: Vec3, random: &mut Random| {
        random.between(0.1, 0.9) * along + random.between(0.5, 1.2) * across
    };
    let [one, other] = [third(across, random), third(away, random)];
    vec![
        [Vec3::ZERO, along, one],
        [Vec3::ZERO, along, other],
        [Vec3::ZERO, one, other],
        [along, one, other],
    ]
}

/// A pyramid, closed, 1 high and down to a thousandth as wide: opposite faces share no more than its tip, each face's
/// first corner.
fn spike(random: &mut Random) -> Vec<[Vec3; 3]> {
    let width = random.between(-7.0, 0.0).exp();
    let sides = 3 + random.below(4);
    let foot: Vec<Vec3> = (0..sides)
        .map(|i| {
            let (sin, cos) =
                ((i as f32 + random.between(-0.3, 0.3)) * TAU / sides as f32).sin_cos();
            Vec3::new(width * cos, width * sin, -1.0)
        })
        .collect();
    let faces = (0..sides).map(|i| [Vec3::ZERO, foot[i], foot[(i + 1) % sides]]);
    let floor = (2..sides).map(|i| [foot[0], foot[i], foot[i - 1]]);
    faces.chain(floor).collect()
}

#[test]
fn a_ray_that_leaves_beside_an_edge_or_a_corner_starts_on_the_right_side_of_all_that_meet_there() {
    let mut random = Random::new(29);
    let (mut near, mut wrong, mut cases) = (0, Vec::new(), 0);
    for case in 0..40_000 {
        let mesh = if case % 3 == 0 {
            spike(&mut random)
        } else {
            wedge(&mut random)
        };
        let size = random.between(-3.0, 3.0).exp();
        let turn = Quat::from_axis_angle(random.direction(), random.between(0.0, TAU));
        let place = random.direction() * random.between(-6.0, 9.0).exp();
        let scale = match case % 4 {
            0 => Vec3::ONE,
            1 => Vec3::splat(size),
            _ => size * Vec3::new(1.0, -random.between(0.5, 2.0), random.between(0.5, 2.0)),
        };
        let transform = Affine3A::from_scale_rotation_translation(scale, turn, place);
        // In one case of two the mesh itself stands there.
        let (mesh, transform) = if case % 2 == 0 {
            let moved = |p: Vec3| transform.transform_point3(p);
            let mesh: Vec<_> = mesh.into_iter().map(|corners| corners.map(moved)).collect();
            (mesh, Affine3A::IDENTITY)
        } else {
            (mesh, transform)
        };
        let velocity = random.cube() * if case % 5 == 0 { 3.0 } else { 0.0 };
        let time = random.unit();
        let tree = Arc::new(MeshTree::build(
            soup(mesh.clone()),
            &BuildOptions::default(),
        ));
        let instance = Instance::new(tree, &transform).and_then(|i| i.moving(velocity));
        let instance = instance.expect("nothing flattens it");
        let scene = Aggregate::build(vec![instance], &BuildOptions::default());
        let instance = &scene.instances()[0];
        let matrix = instance.world_from_object().matrix3;
        let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|c| c.as_dvec3());
        let stands = Vec3::from(instance.world_from_object().translation) + velocity * time;
        let in_world = |p: Vec3| {
            columns[0] * f64::from(p.x)
                + columns[1] * f64::from(p.y)
                + columns[2] * f64::from(p.z)
                + stands.as_dvec3()
        };
        let mesh: Vec<_> = mesh.iter().map(|corners| corners.map(in_world)).collect();
        let middle = |corners: &[DVec3; 3]| (corners[0] + corners[1] + corners[2]) / 3.0;
        let (floor, others) = (mesh[0], &mesh[1..]);
        // Over its middle there has to be room for some steps of the coordinates; more for what is not where its mesh is:
        // rays go into its space, and are rounded there.
        let room = |other: &[DVec3; 3]| {
            let normal = (other[1] - other[0]).cross(other[2] - other[0]).normalize();
            (middle(&floor) - other[0]).dot(normal).abs()
        };
        let room = others.iter().map(room).fold(f64::INFINITY, f64::min);
        let step = f64::from(
            stands
                .abs()
                .max(middle(&floor).as_vec3().abs())
                .max_element(),
        ) * f64::from(f32::EPSILON);
        let steps = if velocity == Vec3::ZERO { 16.0 } else { 128.0 };
        if room < steps * step {
            continue;
        }
        cases += 1;
        let small = random.between(-18.0, -1.0).exp();
        let (u, v) = match case % 7 {
            // Beside the first corner.
            0..3 => (random.between(-16.0, -1.0).exp(), small),
            // Beside the edge to the second one.
            3..5 => (random.unit() * (1.0 - small), small),
            _ => (small, random.unit() * (1.0 - small)),
        };
        let hit = Hit {
            t: 1.0,
            instance: 0,
            triangle: 0,
            u,
            v,
        };
        let point = instance.surface_point(&hit, time);
        near += usize::from(point.near_edge.is_some());
        let upwards = (floor[1] - floor[0]).cross(floor[2] - floor[0]).normalize();
        let inside = mesh.iter().map(middle).sum::<DVec3>() / mesh.len() as f64;
        for side in [point.normal, -point.normal] {
            let start = scene.leave(&point, side).as_dvec3();
            let upwards = upwards * upwards.dot(side.as_dvec3()).signum();
            let height = upwards.dot(start - floor[0]);
            // Outside of the closed mesh there is nothing that it could be behind.
            let behind = upwards.dot(inside - floor[0]) > 0.0
                && others.iter().any(|other| passes(inside, start, *other));
            if height <= 0.0 || behind {
                wrong.push(format!(
                    "case {case}: u {u:e}, v {v:e}, room for {:.1} steps, {height:e} high",
                    room / step
                ));
            }
        }
    }
    assert!(
        cases > 25_000 && near > 3_000,
        "{cases} cases, {near} near an edge"
    );
    assert!(
        wrong.is_empty(),
        "{} of {cases} starts are behind a neighbour, among them {:?}",
        wrong.len(),
        &wrong[..wrong.len().min(8)]
    );
}

/// A closed convex body, as wide as 1 : 20 and a few steps of the coordinates thick, turned twice and far away; how many
/// steps that is.
fn thin_body(case: usize, random: &mut Random) -> (Aggregate, f32) {
    let mesh = match case % 3 {
        0 => sphere(3),
        1 => cube(),
        _ => sphere(1),
    };
    let distance = [148_376.0_f32, 12_345.678, 1e6][case % 3];
    let step = distance.next_up() - distance;
    let place = match case % 2 {
        0 => distance * Vec3::new(1.0, 0.25, -0.5),
        _ => distance * random.cube(),
    };
    let mut turn = || Quat::from_axis_angle(random.direction(), random.between(0.0, TAU));
    let (outer, inner) = (turn(), turn());
    let outer_scale = [
        Vec3::ONE,
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(1.0, 1.5, 1.0),
    ][case % 3];
    let steps = random.between(2.0, 40.0);
    let side = if case % 4 < 2 { 1.0 } else { -1.0 };
    let transform = Affine3A::from_scale_rotation_translation(outer_scale, outer, place)
        * Affine3A::from_quat(inner)
        * Affine3A::from_scale(Vec3::new(side, 20.0, 0.5 * steps * step));
    let velocity = random.cube() * if case.is_multiple_of(5) { 0.0 } else { 3.0 };
    let tree = Arc::new(MeshTree::build(mesh, &BuildOptions::default()));
    let instance = Instance::new(tree, &transform).and_then(|i| i.moving(velocity));
    let instance = instance.expect("nothing flattens it");
    let options = BuildOptions::default();
    (Aggregate::build(vec![instance], &options), steps)
}

#[test]
fn rays_that_leave_the_inside_of_a_far_thin_moving_body_stay_inside_down_to_two_steps() {
    let mut random = Random::new(31);
    let (mut left, mut outside) = (0, Vec::new());
    for case in 0..300 {
        let (scene, steps) = thin_body(case, &mut random);
        for _ in 0..20 {
            let (rays, ends_outside) = mirrored_inside(&scene, 50, &mut random);
            left += rays;
            if ends_outside {
                outside.push(format!("case {case}, {steps:.1} steps thick"));
            }
        }
    }
    assert!(left > 200_000, "only {left} rays");
    assert!(
        outside.is_empty(),
        "{} of {left} rays start outside, among them {:?}",
        outside.len(),
        &outside[..outside.len().min(8)]
    );
}

#[test]
fn rays_that_leave_the_sides_of_a_far_pane_stay_in_it_from_six_steps_on_and_mostly_below() {
    let mut random = Random::new(37);
    let (left, outside) = outside_of_panes(150, [SAFE_PANE, 12.0], &mut random);
    assert!(left > 100_000, "only {left} rays");
    assert_eq!(outside, 0, "of {left} rays start outside");
    let (left, outside) = outside_of_panes(150, [2.0, SAFE_PANE], &mut random);
    assert!(left > 100_000, "only {left} rays");
    let most = OUTSIDE_OF_THIN_PANES * left as f64;
    assert!(
        outside as f64 <= most,
        "{outside} of {left} rays start outside"
    );
}
