//! What hangs below something that moves, and lights that move.

use super::{Effort, Outcome};
use crate::app::headless_app;
use crate::film::{Picture, render};
use crate::scene::{
    DirectionalLamp, MeshSource, Motion, ParallelogramLamp, Phong, PointLamp, RenderSettings,
    SceneCamera, SceneId, SegmentLamp, Shape,
};
use crate::sync::{Traced, TracedCameras};
use bevy::app::App;
use bevy::camera::visibility::Visibility;
use bevy::ecs::bundle::Bundle;
use bevy::ecs::hierarchy::ChildOf;
use bevy::math::{UVec2, Vec2, Vec3};
use bevy::transform::components::Transform;

const FLOOR: u64 = 1;
const BALL: u64 = 2;
const POINT: u64 = 3;
const SEGMENT: u64 = 4;
const PANEL: u64 = 5;
const SUN: u64 = 6;
const CAMERA: u64 = 7;

/// Which entity moves, and by how much: its grandparent, its parent and itself, each in the space of its own parent.
#[derive(Clone, Copy)]
struct Moves {
    id: u64,
    velocities: [Vec3; 3],
}

const STILL: Moves = Moves {
    id: 0,
    velocities: [Vec3::ZERO; 3],
};

/// An entity below a parent and a grandparent, which stretch space to twice and back to once its size.
fn spawn(app: &mut App, moves: Moves, id: u64, bundle: impl Bundle) {
    let world = app.world_mut();
    let group = |scale: f32| {
        (
            Visibility::default(),
            Transform::from_scale(Vec3::splat(scale)),
        )
    };
    let above = world.spawn((SceneId(100 + id), group(2.0))).id();
    let parent = (SceneId(200 + id), group(0.5), ChildOf(above));
    let parent = world.spawn(parent).id();
    let child = world.spawn((SceneId(id), bundle, ChildOf(parent))).id();
    for (entity, velocity) in [above, parent, child].into_iter().zip(moves.velocities) {
        if id == moves.id && velocity != Vec3::ZERO {
            let samples = 1;
            world
                .entity_mut(entity)
                .insert(Motion { velocity, samples });
        }
    }
}

/// A ball over a floor, lit by a lamp of each kind.
fn picture(moves: Moves) -> Picture {
    let mut app = headless_app();
    let at = Transform::from_xyz;
    let ground = Shape::Ground {
        size: Vec2::splat(8.0),
        tile: Vec2::ONE,
    };
    let ball = Shape::Sphere {
        radius: 0.5,
        segments: 16,
        rings: 8,
    };
    for (id, shape, y) in [(FLOOR, ground, 0.0), (BALL, ball, 0.75)] {
        let object = (MeshSource::Shape(shape), Phong::default(), at(0.0, y, 0.0));
        spawn(&mut app, moves, id, object);
    }
    let point = PointLamp {
        intensity: 4.0,
        ..PointLamp::default()
    };
    spawn(&mut app, moves, POINT, (point, at(1.0, 2.0, 0.0)));
    let segment = (SegmentLamp::default(), at(-1.0, 1.5, 0.5));
    spawn(&mut app, moves, SEGMENT, segment);
    let panel = ParallelogramLamp {
        two_sided: true,
        ..ParallelogramLamp::default()
    };
    spawn(&mut app, moves, PANEL, (panel, at(0.5, 1.5, -1.0)));
    let down = at(0.0, 3.0, 0.0).looking_to(Vec3::NEG_Y, Vec3::X);
    spawn(&mut app, moves, SUN, (DirectionalLamp::default(), down));
    let eye = at(0.0, 2.0, 5.0).looking_at(Vec3::Y * 0.75, Vec3::Y);
    spawn(&mut app, moves, CAMERA, (SceneCamera::default(), eye));
    app.update();
    let traced = &app.world().resource::<Traced>().world;
    let camera = &app.world().resource::<TracedCameras>().0[0].camera;
    render(traced, camera, &settings(), &|_, _| {}).picture
}

fn settings() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(48, 36),
        spp: 4,
        ..RenderSettings::default()
    }
}

fn differing(a: &Picture, b: &Picture) -> usize {
    let pairs = a.pixels.iter().zip(&b.pixels);
    pairs.filter(|(a, b)| a != b).count()
}

pub(super) fn inherited(_: &Effort) -> Outcome {
    let still = picture(STILL);
    let velocities = [
        Vec3::new(0.5, 0.25, -0.5),
        Vec3::new(-0.125, 0.25, 0.5),
        Vec3::new(0.25, -0.25, 0.125),
    ];
    let [above, parent, own] = velocities;
    // The grandparent's space is twice as large as the world's, the parent's as large.
    let sum = above + 2.0 * parent + own;
    let (mut pictures, mut differ, mut least) = (1, 0, usize::MAX);
    for id in [FLOOR, BALL, POINT, SEGMENT, PANEL, CAMERA] {
        for velocities in [[sum, Vec3::ZERO, Vec3::ZERO], velocities] {
            let alone = [Vec3::ZERO, Vec3::ZERO, sum];
            let carried = picture(Moves { id, velocities });
            differ += differing(
                &carried,
                &picture(Moves {
                    id,
                    velocities: alone,
                }),
            );
            least = least.min(differing(&carried, &still));
            pictures += 2;
        }
    }
    let sun = picture(Moves {
        id: SUN,
        velocities,
    });
    let sun = differing(&sun, &still);
    let pixels = still.pixels.len();
    Outcome::new(
        pictures * pixels,
        format!(
            "a parent's and a grandparent's motion instead of their child's own: {differ} pixels differ, where at least \
             {least} of {pixels} show it; below a sun that moves: {sun}"
        ),
    )
    .require(differ == 0, format!("{differ} pixels differ"))
    .require(sun == 0, format!("{sun} pixels differ below a sun that moves"))
    .require(least > 20, format!("a motion shows in {least} pixels only"))
}
