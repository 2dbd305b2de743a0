use super::super::StandardMappingPlugin;
use super::*;
use crate::app::headless_app_with;
use bevy::camera::CameraProjection;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::math::{EulerRot, Quat, Vec3};
use bevy::transform::components::Transform;
use bevy::utils::default;

#[test]
fn a_twin_shows_what_its_view_shows_and_nothing_once_that_shows_nothing() {
    let mut world = World::new();
    let mut images = Assets::<Image>::default();
    let screen = |images: &mut Assets<Image>, divider| Screen {
        picture: images.add(no_depth()),
        depth: images.add(no_depth()),
        divider,
        numbers: Vec3::X,
        keeps_shape: true,
    };
    let view = world.spawn_empty().id();
    let twin = world.spawn(ShowsPictureOf(view)).id();
    let show = world.register_system(show_twins);
    for shown in [
        Some(screen(&mut images, 0.0)),
        Some(screen(&mut images, 0.5)),
        None,
    ] {
        match shown.clone() {
            Some(screen) => world.entity_mut(view).insert(screen),
            None => world.entity_mut(view).remove::<Screen>(),
        };
        world.run_system(show).unwrap();
        assert_eq!(world.get::<Screen>(twin), shown.as_ref());
    }
    world.despawn(view);
    world.run_system(show).unwrap();
    assert!(world.get::<Screen>(twin).is_none());
}

#[test]
fn an_orthographic_picture_covers_what_bevys_camera_shows() {
    let size = UVec2::new(160, 90);
    let place = Transform::from_xyz(1.0, 2.0, 3.0)
        .with_rotation(Quat::from_euler(EulerRot::YXZ, 0.7, -0.3, 0.2))
        .with_scale(Vec3::splat(2.0))
        .into();
    for scaling_mode in [
        ScalingMode::WindowSize,
        ScalingMode::FixedVertical {
            viewport_height: 4.0,
        },
        ScalingMode::FixedHorizontal {
            viewport_width: 4.0,
        },
        ScalingMode::Fixed {
            width: 16.0,
            height: 9.0,
        },
    ] {
        let mut projection = OrthographicProjection {
            scaling_mode,
            scale: 0.5,
            viewport_origin: Vec2::new(0.25, 1.0),
            ..OrthographicProjection::default_3d()
        };
        projection.update(size.x as f32, size.y as f32);
        let world_from_ndc =
            GlobalTransform::to_matrix(&place) * projection.get_clip_from_view().inverse();
        let camera = traced_camera(&place, &Projection::Orthographic(projection), None).unwrap();
        let corners = [(Vec2::ZERO, [-1.0, 1.0]), (size.as_vec2(), [1.0, -1.0])];
        for (pixel, [x, y]) in corners {
            let from = camera.ray(pixel, size, [0.5; 2], 0.0).origin;
            let off = world_from_ndc.project_point3(Vec3::new(x, y, 0.5)) - from;
            let off = off.reject_from(camera.forward).length();
            assert!(off < 1e-3, "{scaling_mode:?}: {off} m at {pixel}");
        }
    }
}

#[test]
fn an_orthographic_camera_that_bevy_has_not_laid_out_is_as_high_as_it_says() {
    let projection = OrthographicProjection {
        scaling_mode: ScalingMode::FixedVertical {
            viewport_height: 4.0,
        },
        scale: 0.5,
        ..OrthographicProjection::default_3d()
    };
    let camera = traced_camera(&default(), &Projection::Orthographic(projection), None);
    let height = scene::Projection::Orthographic { height: 2.0 };
    assert_eq!(camera.unwrap().projection, height);
}

/// Of what a view was told that it cannot be rendered.
#[derive(Resource, Default)]
struct Told(Vec<String>);

#[test]
fn a_view_that_cannot_be_rendered_says_so_once_for_each_reason() {
    let mut app = headless_app_with((StandardMappingPlugin, TracedViewPlugin));
    app.init_resource::<Told>()
        .add_observer(|failed: On<Failed>, mut told: ResMut<Told>| {
            told.0.push(failed.problem.clone());
        });
    let view = app.world_mut().spawn(TracedView::default()).id();
    let told = |app: &mut App| {
        for _ in 0..3 {
            app.update();
        }
        std::mem::take(&mut app.world_mut().resource_mut::<Told>().0)
    };
    let of_size = |size| ViewSettings {
        size: Some(size),
        ..ViewSettings::default()
    };
    assert_eq!(told(&mut app), [""; 0]);
    for _ in 0..2 {
        let nowhere = Transform::from_xyz(f32::NAN, 0.0, 0.0);
        app.world_mut().entity_mut(view).insert(nowhere);
        let said = "its place is not a finite one; nothing is traced for it";
        assert_eq!(told(&mut app), [said]);
        let problems = &app.world().resource::<Traced>().problems;
        assert_eq!(problems.len(), 1, "{problems:#?}");
        let mut camera = app.world_mut().entity_mut(view);
        camera.insert((Transform::IDENTITY, of_size(UVec2::ZERO)));
        assert!(matches!(&told(&mut app)[..], [said] if said.contains("has none")));
        app.world_mut()
            .entity_mut(view)
            .insert(of_size(UVec2::splat(1 << 31)));
        assert!(matches!(&told(&mut app)[..], [said] if said.contains("of memory")));
        app.world_mut().entity_mut(view).remove::<ViewSettings>();
        assert_eq!(told(&mut app), [""; 0]);
        assert!(app.world().resource::<Traced>().problems.is_empty());
    }
}
