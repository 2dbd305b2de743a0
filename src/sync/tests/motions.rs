//! What moves moves what hangs below it, and every change above is noticed.

use super::*;
use crate::scene::{DirectionalLamp, Motion, ParallelogramLamp, RenderSettings, SegmentLamp};
use crate::sync::TracedCameras;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::hierarchy::ChildOf;
use bevy::math::{Quat, Vec3};
use bevy::transform::components::GlobalTransform;

fn moving(velocity: Vec3) -> Motion {
    Motion {
        velocity,
        samples: 1,
    }
}

/// A group above a group above an object, a camera and a lamp of each kind.
struct Family {
    app: App,
    above: Entity,
    parent: Entity,
    /// The object first, the camera second.
    children: Vec<Entity>,
}

impl Family {
    fn new() -> Self {
        let mut app = app();
        let mesh = add_mesh(&mut app, 4);
        let world = app.world_mut();
        let above = world.spawn(Transform::from_scale(Vec3::splat(2.0))).id();
        let parent = Transform::from_scale(Vec3::new(-1.0, 1.0, 4.0));
        let parent = world.spawn((parent, ChildOf(above))).id();
        let children = vec![
            world.spawn((Mesh3d(mesh), grey(0.5))).id(),
            world.spawn(SceneCamera::default()).id(),
            world.spawn(PointLamp::default()).id(),
            world.spawn(SegmentLamp::default()).id(),
            world.spawn(ParallelogramLamp::default()).id(),
            world.spawn(DirectionalLamp::default()).id(),
        ];
        for &child in &children {
            world.entity_mut(child).insert(ChildOf(parent));
        }
        app.update();
        assert!(problems(&app).is_empty(), "{:?}", problems(&app));
        Self {
            app,
            above,
            parent,
            children,
        }
    }

    fn set(&mut self, entity: Entity, velocity: Vec3) {
        self.app
            .world_mut()
            .entity_mut(entity)
            .insert(moving(velocity));
    }

    /// The velocity that everything below the parent has.
    fn velocity(&self) -> Vec3 {
        let world = world(&self.app);
        let velocity = world.aggregate.instances()[0].velocity();
        let needed = u32::from(velocity != Vec3::ZERO);
        let camera = &self.app.world().resource::<TracedCameras>().0[0].camera;
        assert_eq!(camera.optics.velocity, velocity, "of the camera");
        assert_eq!(camera.optics.motion_samples, needed, "of the camera");
        assert_eq!(world.objects[0].motion_samples, needed, "of the object");
        let lights = &world.lights;
        let ids = [
            lights.points[0].id,
            lights.segments[0].id,
            lights.parallelograms[0].id,
        ];
        for id in ids {
            assert_eq!(lights.velocity(id), velocity, "of light {id}");
        }
        assert_eq!(
            lights.moving.len(),
            3 * needed as usize,
            "{:?}",
            lights.moving
        );
        assert_eq!(lights.velocity(lights.directionals[0].id), Vec3::ZERO);
        assert_eq!(world.needs.motion_samples, needed);
        velocity
    }

    /// After a frame.
    fn next(&mut self) -> Vec3 {
        self.app.update();
        self.velocity()
    }
}

#[test]
fn an_entity_moves_with_the_sum_over_itself_and_its_ancestors_each_in_its_parents_space() {
    let mut family = Family::new();
    assert_eq!(family.velocity(), Vec3::ZERO);
    family.set(family.above, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(family.next(), Vec3::new(1.0, 2.0, 3.0));
    // In the space of what is above, which is twice as large.
    family.set(family.parent, Vec3::new(1.0, 0.0, 0.5));
    assert_eq!(family.next(), Vec3::new(3.0, 2.0, 4.0));
    // In the parent's, which is mirrored in x and stretched in z as well.
    for child in family.children.clone() {
        family.set(child, Vec3::new(1.0, 1.0, -1.0));
    }
    assert_eq!(family.next(), Vec3::new(1.0, 4.0, -4.0));
    // What adds up to nothing stands still.
    family.set(family.above, Vec3::new(0.0, -2.0, 7.0));
    assert_eq!(family.next(), Vec3::ZERO);
}

#[test]
fn whatever_changes_above_an_entity_changes_its_motion_in_the_same_frame() {
    let mut family = Family::new();
    let (above, parent) = (family.above, family.parent);
    family.set(above, Vec3::X);
    assert_eq!(family.next(), Vec3::X);
    family.set(parent, Vec3::X);
    assert_eq!(family.next(), Vec3::X * 3.0);
    let edit = |family: &mut Family, entity, edit: &dyn Fn(&mut Transform)| {
        edit(&mut family.app.world_mut().get_mut::<Transform>(entity).unwrap());
    };
    edit(&mut family, above, &|transform| {
        transform.scale = Vec3::splat(4.0)
    });
    assert_eq!(family.next(), Vec3::X * 5.0);

    // The parent keeps its place in the world, and so do all below it.
    let placed = *family.app.world().get::<GlobalTransform>(parent).unwrap();
    edit(&mut family, above, &|transform| transform.scale.x = -4.0);
    edit(&mut family, parent, &|transform| transform.scale.x = 1.0);
    assert_eq!(family.next(), Vec3::X * -3.0);
    assert_eq!(
        family.app.world().get::<GlobalTransform>(parent),
        Some(&placed)
    );

    let other = family
        .app
        .world_mut()
        .spawn((Transform::default(), moving(Vec3::Y)));
    let other = other.id();
    family
        .app
        .world_mut()
        .entity_mut(parent)
        .insert(ChildOf(other));
    assert_eq!(family.next(), Vec3::X + Vec3::Y);
    family.app.world_mut().entity_mut(other).remove::<Motion>();
    assert_eq!(family.next(), Vec3::X);
    family
        .app
        .world_mut()
        .entity_mut(above)
        .insert(ChildOf(other));
    family
        .app
        .world_mut()
        .entity_mut(parent)
        .insert(ChildOf(above));
    assert_eq!(family.next(), Vec3::X * -3.0);
    family
        .app
        .world_mut()
        .entity_mut(parent)
        .remove::<ChildOf>();
    assert_eq!(family.next(), Vec3::X);
    family.app.world_mut().entity_mut(parent).remove::<Motion>();
    assert_eq!(family.next(), Vec3::ZERO);

    family.set(above, Vec3::Z);
    family
        .app
        .world_mut()
        .entity_mut(parent)
        .insert(ChildOf(above));
    assert_eq!(family.next(), Vec3::Z);
    let mut settings = family.app.world_mut().resource_mut::<RenderSettings>();
    settings.features.motion = false;
    assert_eq!(family.next(), Vec3::ZERO);
    let mut settings = family.app.world_mut().resource_mut::<RenderSettings>();
    settings.features.motion = true;
    assert_eq!(family.next(), Vec3::Z);
    family.app.world_mut().entity_mut(above).insert(Disabled);
    assert_eq!(family.next(), Vec3::ZERO);
    family
        .app
        .world_mut()
        .entity_mut(above)
        .remove::<Disabled>();
    assert_eq!(family.next(), Vec3::Z);
}

#[test]
fn who_is_spawned_below_something_that_moves_moves_and_a_frame_without_a_change_redoes_nothing() {
    let mut family = Family::new();
    family.set(family.above, Vec3::X);
    family.app.update();
    let lamp = (PointLamp::default(), ChildOf(family.children[2]));
    family.app.world_mut().spawn(lamp);
    family.app.update();
    let lights = world(&family.app).lights.clone();
    assert_eq!(lights.moving.len(), 4, "{:?}", lights.moving);
    for light in &lights.moving {
        assert_eq!((light.velocity, light.samples), (Vec3::X, 1));
    }
    assert!(lights.moving.is_sorted_by_key(|light| light.id));
    assert!(!frame(&mut family.app).any());
    // What has no parent moves in the world, however it is turned.
    let turned = Transform::from_scale(Vec3::splat(2.0)).with_rotation(Quat::from_rotation_y(1.0));
    *family.app.world_mut().get_mut(family.above).unwrap() = turned;
    let changes = frame(&mut family.app);
    assert!(changes.lights && changes.top_level, "{changes:?}");
    assert_eq!(world(&family.app).lights.moving, lights.moving);
}

#[test]
fn the_motion_of_one_thing_redoes_nothing_that_does_not_hang_below_it() {
    let mut family = Family::new();
    let [object, camera, lamp] = [0, 1, 2].map(|child| family.children[child]);
    family.set(object, Vec3::X);
    let changes = frame(&mut family.app);
    assert!(
        changes.top_level && !changes.lights && !changes.cameras,
        "{changes:?}"
    );
    family.set(camera, Vec3::X);
    let changes = frame(&mut family.app);
    assert!(
        !changes.top_level && !changes.lights && changes.cameras,
        "{changes:?}"
    );
    family.set(lamp, Vec3::X);
    let changes = frame(&mut family.app);
    assert!(
        !changes.top_level && changes.lights && !changes.cameras,
        "{changes:?}"
    );
    family.app.world_mut().entity_mut(lamp).remove::<Motion>();
    let changes = frame(&mut family.app);
    assert!(
        !changes.top_level && changes.lights && !changes.cameras,
        "{changes:?}"
    );
    assert!(world(&family.app).lights.moving.is_empty());
}

#[test]
fn the_largest_number_of_samples_of_all_that_add_to_a_motion_is_taken() {
    let mut family = Family::new();
    let motion = |samples| Motion {
        velocity: Vec3::X,
        samples,
    };
    let world_mut = family.app.world_mut();
    world_mut.entity_mut(family.above).insert(motion(7));
    world_mut.entity_mut(family.parent).insert(motion(5));
    world_mut.entity_mut(family.children[2]).insert(motion(9));
    family.app.update();
    let world = world(&family.app);
    assert_eq!(world.objects[0].motion_samples, 7);
    let samples = world.lights.moving.iter().map(|light| light.samples);
    assert_eq!(samples.collect::<Vec<_>>(), [9, 7, 7]);
    assert_eq!(world.needs.motion_samples, 9);
}

#[test]
fn velocities_that_cannot_be_traced_are_named_at_whom_they_move_and_come_back_when_repaired() {
    for bad in [f32::NAN, f32::INFINITY, 1e38, 2e12] {
        let mut family = Family::new();
        family.set(family.above, Vec3::new(0.0, bad, 0.0));
        family.app.update();
        let named = problems(&family.app);
        // The object, the camera and three lamps; the directional lamp cares for none.
        assert_eq!(named.len(), 5, "{bad}: {named:#?}");
        for problem in &named {
            assert!(problem.contains("velocity, together with"), "{problem}");
        }
        let traced = world(&family.app);
        assert!(traced.objects.is_empty() && traced.lights.moving.is_empty());
        assert_eq!(traced.lights.count(), 1);
        family.set(family.above, Vec3::Y);
        assert_eq!(family.next(), Vec3::Y);
        assert!(problems(&family.app).is_empty());
    }
    // Each alone is finite, and the sum is not.
    let mut family = Family::new();
    family.set(family.above, Vec3::splat(3e38));
    family.set(family.parent, Vec3::splat(3e38));
    family.app.update();
    assert_eq!(
        problems(&family.app).len(),
        5,
        "{:#?}",
        problems(&family.app)
    );
}

#[test]
fn a_chain_of_four_thousand_parents_that_all_move_adds_up() {
    let mut app = app();
    let mesh = add_mesh(&mut app, 3);
    let mut last: Option<Entity> = None;
    for _ in 0..4_000 {
        let parts = (Mesh3d(mesh.clone()), moving(Vec3::X));
        let mut entity = app.world_mut().spawn(parts);
        if let Some(last) = last {
            entity.insert(ChildOf(last));
        }
        last = Some(entity.id());
    }
    app.update();
    let world = world(&app);
    let speeds: Vec<f32> = (world.aggregate.instances().iter())
        .map(|i| i.velocity().x)
        .collect();
    let expected: Vec<f32> = (1..=4_000).map(|depth| depth as f32).collect();
    assert_eq!(speeds, expected);
}
