//! What hangs below something that moves: entities in, pictures out.

use bevy::app::App;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::ChildOf;
use bevy::transform::components::Transform;
use glam::{UVec2, Vec2, Vec3};
use glassbox::app::headless_app;
use glassbox::film::{Picture, render};
use glassbox::scene::{
    Cone, DirectionalLamp, MeshSource, Motion, ParallelogramLamp, Phong, PointLamp, RenderSettings,
    SceneCamera, SceneId, SegmentLamp, Shape,
};
use glassbox::sync::{Traced, TracedCameras};

const SUN: u64 = 6;

/// A floor, a ball above it, a lamp of each kind, and a camera that sees all of it, each below a parent and a
/// grandparent of its own that stretch space to twice and back to once its size. Those three of the entity with this
/// number move by these velocities, each in the space of its own parent: grandparent, parent, itself.
fn picture_of(mover: u64, velocities: [Vec3; 3]) -> Picture {
    let mut app = headless_app();
    let at = |x, y, z| Transform::from_xyz(x, y, z);
    let object = |app: &mut App, id, shape, place| {
        let bundle = (MeshSource::Shape(shape), Phong::default(), place);
        family(app, id, mover, velocities, bundle);
    };
    object(
        &mut app,
        1,
        Shape::Ground {
            size: Vec2::splat(8.0),
            tile: Vec2::ONE,
        },
        at(0.0, 0.0, 0.0),
    );
    object(
        &mut app,
        2,
        Shape::Sphere {
            radius: 0.5,
            segments: 16,
            rings: 8,
        },
        at(0.0, 0.75, 0.0),
    );
    let spot = PointLamp {
        intensity: 4.0,
        cone: Some(Cone::default()),
        ..PointLamp::default()
    };
    let down = at(1.0, 2.0, 0.0).looking_to(Vec3::NEG_Y, Vec3::X);
    family(&mut app, 3, mover, velocities, (spot, down));
    let segment = SegmentLamp {
        intensity: 1.0,
        ..SegmentLamp::default()
    };
    family(
        &mut app,
        4,
        mover,
        velocities,
        (segment, at(-1.0, 1.5, 0.5)),
    );
    let panel = ParallelogramLamp {
        intensity: 2.0,
        two_sided: true,
        visible: true,
        ..ParallelogramLamp::default()
    };
    family(&mut app, 5, mover, velocities, (panel, at(0.5, 1.5, -1.0)));
    let sun = DirectionalLamp {
        intensity: 0.5,
        ..DirectionalLamp::default()
    };
    family(&mut app, SUN, mover, velocities, (sun, down));
    let eye = at(0.0, 2.0, 5.0).looking_at(Vec3::Y * 0.75, Vec3::Y);
    family(
        &mut app,
        7,
        mover,
        velocities,
        (SceneCamera::default(), eye),
    );
    app.update();
    let traced = app.world().resource::<Traced>();
    assert!(traced.problems.is_empty(), "{:?}", traced.problems);
    let settings = RenderSettings {
        size: UVec2::new(48, 36),
        spp: 4,
        ..RenderSettings::default()
    };
    let camera = &app.world().resource::<TracedCameras>().0[0].camera;
    render(&traced.world, camera, &settings, &|_, _| {}).picture
}

/// An entity with its parent and grandparent.
fn family(
    app: &mut App,
    id: u64,
    mover: u64,
    velocities: [Vec3; 3],
    bundle: impl bevy::ecs::bundle::Bundle,
) {
    let world = app.world_mut();
    let twice = Transform::from_scale(Vec3::splat(2.0));
    let half = Transform::from_scale(Vec3::splat(0.5));
    let above = world.spawn((SceneId(100 + id), twice)).id();
    let parent = world.spawn((SceneId(200 + id), half, ChildOf(above))).id();
    let child = world.spawn((SceneId(id), bundle, ChildOf(parent))).id();
    let members: [Entity; 3] = [above, parent, child];
    for (entity, velocity) in members.into_iter().zip(velocities) {
        if id == mover && velocity != Vec3::ZERO {
            let samples = 1;
            world
                .entity_mut(entity)
                .insert(Motion { velocity, samples });
        }
    }
}

/// How many pixels differ.
fn differing(a: &Picture, b: &Picture) -> usize {
    let pairs = a.pixels.iter().zip(&b.pixels);
    pairs.filter(|(a, b)| a != b).count()
}

#[test]
fn the_motion_of_a_parent_and_of_a_grandparent_is_drawn_as_if_it_were_their_child_s_own() {
    let still = picture_of(0, [Vec3::ZERO; 3]);
    let (a, b, c) = (
        Vec3::new(0.5, 0.25, -0.5),
        Vec3::new(-0.125, 0.25, 0.5),
        Vec3::new(0.25, -0.25, 0.125),
    );
    for mover in [1, 2, 3, 4, 5, 7] {
        for [above, parent, own] in [
            [a, Vec3::ZERO, Vec3::ZERO],
            [Vec3::ZERO, b, Vec3::ZERO],
            [a, b, c],
        ] {
            let inherited = picture_of(mover, [above, parent, own]);
            // The grandparent's space is twice as large as the world, the parent's as large.
            let all_own = [Vec3::ZERO, Vec3::ZERO, above + 2.0 * parent + own];
            let differ = differing(&inherited, &picture_of(mover, all_own));
            assert_eq!(differ, 0, "entity {mover}: {differ} pixels differ");
            let moved = differing(&inherited, &still);
            assert!(moved > 20, "entity {mover}: only {moved} pixels changed");
        }
    }
}

#[test]
fn a_directional_lamp_shines_alike_whatever_moves_it() {
    let still = picture_of(0, [Vec3::ZERO; 3]);
    let moving = picture_of(SUN, [Vec3::X, Vec3::Y, Vec3::Z]);
    assert_eq!(differing(&moving, &still), 0);
}
