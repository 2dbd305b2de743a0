//! What cannot be traced is left out and named, and the rest stays intact.

use super::*;
use crate::scene::{Lens, ParallelogramLamp, RenderSettings, SegmentLamp, TextureSource};
use bevy::ecs::name::Name;
use bevy::math::Vec3;

/// One object that is fine beside one that is not; the problem's text.
fn beside(break_it: impl FnOnce(&mut App, Entity)) -> (App, Vec<String>) {
    let mut small = Small::new();
    let [good, broken, gone] = small.objects;
    small.app.world_mut().despawn(gone);
    small
        .app
        .world_mut()
        .entity_mut(broken)
        .insert(Name::new("broken one"));
    small.app.update();
    assert!(problems(&small.app).is_empty());
    break_it(&mut small.app, broken);
    small.app.update();
    let problems = problems(&small.app);
    assert!(small.app.world().get_entity(good).is_ok());
    (small.app, problems)
}

#[test]
fn a_singular_transform_is_named_and_its_object_left_out() {
    for scale in [Vec3::new(1.0, 0.0, 1.0), Vec3::splat(f32::NAN)] {
        let (app, problems) = beside(|app, broken| {
            app.world_mut().get_mut::<Transform>(broken).unwrap().scale = scale;
        });
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert!(
            problems[0].starts_with("object 2 \"broken one\": "),
            "{}",
            problems[0]
        );
        assert_eq!(world(&app).objects.len(), 1);
    }
}

#[test]
fn a_mesh_that_cannot_be_traced_is_named_and_returns_when_it_is_repaired() {
    let mesh = fan(4).with_inserted_indices(Indices::U32(vec![0, 1, 99]));
    let mut handle = Handle::default();
    let (mut app, texts) = beside(|app, broken| {
        handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
        app.world_mut().get_mut::<Mesh3d>(broken).unwrap().0 = handle.clone();
    });
    assert_eq!(texts.len(), 1, "{texts:?}");
    assert!(texts[0].contains("99"), "{}", texts[0]);
    assert_eq!(world(&app).objects.len(), 1);

    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    *meshes.get_mut(&handle).unwrap() = fan(4);
    app.update();
    assert!(problems(&app).is_empty());
    assert_eq!(world(&app).objects.len(), 2);

    app.world_mut()
        .resource_mut::<Assets<Mesh>>()
        .remove(&handle);
    app.update();
    assert!(
        problems(&app)[0].contains("is not loaded"),
        "{:?}",
        problems(&app)
    );
    assert_eq!(world(&app).objects.len(), 1);
}

#[test]
fn triangles_with_corners_that_are_not_finite_are_counted_and_the_others_stay() {
    let mut mesh = fan(6);
    if let Some(bevy::mesh::VertexAttributeValues::Float32x3(positions)) =
        mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION)
    {
        positions[0][1] = f32::NAN;
    }
    let (app, problems) = beside(|app, broken| {
        let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
        app.world_mut().get_mut::<Mesh3d>(broken).unwrap().0 = handle;
    });
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(
        problems[0].contains("2 of its triangles"),
        "{}",
        problems[0]
    );
    assert_eq!(world(&app).objects.len(), 2);
}

#[test]
fn lights_that_are_nothing_or_not_a_number_are_named_and_left_out() {
    let mut app = app();
    app.world_mut().spawn(PointLamp {
        intensity: f32::NAN,
        ..PointLamp::default()
    });
    app.world_mut().spawn(SegmentLamp {
        ends: [Vec3::ONE; 2],
        ..SegmentLamp::default()
    });
    app.world_mut().spawn(ParallelogramLamp {
        edges: [Vec3::X, Vec3::X * 2.0],
        ..ParallelogramLamp::default()
    });
    app.world_mut().spawn((
        PointLamp::default(),
        Transform::from_xyz(f32::INFINITY, 0.0, 0.0),
    ));
    app.world_mut().spawn(PointLamp {
        intensity: -1.0,
        ..PointLamp::default()
    });
    app.update();
    assert_eq!(problems(&app).len(), 5, "{:#?}", problems(&app));
    let world = world(&app);
    // The negative one is black, the others are gone.
    assert_eq!(world.lights.points.len(), 1);
    assert_eq!(world.lights.points[0].color, Vec3::ZERO);
    assert!(world.lights.segments.is_empty() && world.lights.parallelograms.is_empty());
}

#[test]
fn a_picture_that_is_not_there_is_named_and_the_object_drawn_without_it() {
    let (app, problems) = beside(|app, broken| {
        app.world_mut()
            .get_mut::<Phong>(broken)
            .unwrap()
            .diffuse_map = Some(TextureSource::new("wood.png"));
    });
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(problems[0].contains("`wood.png`"), "{}", problems[0]);
    assert_eq!(world(&app).objects.len(), 2);
}

#[test]
fn settings_out_of_range_are_named() {
    let mut app = app();
    app.world_mut().resource_mut::<RenderSettings>().tree.bins = 1;
    app.update();
    assert_eq!(
        problems(&app),
        ["settings: tree.bins is 1, and must be 2 to 64"]
    );
    app.world_mut().resource_mut::<RenderSettings>().tree.bins = 2;
    app.update();
    assert!(problems(&app).is_empty());
}

#[test]
fn lens_and_motion_count_only_where_the_settings_switch_them_on() {
    use crate::scene::Motion;
    let mut small = Small::new();
    let lens = Lens {
        aperture_radius: 0.5,
        focus_distance: 4.0,
        samples: 1,
    };
    let motion = Motion {
        velocity: Vec3::X,
        samples: 1,
    };
    for entity in [small.camera, small.objects[0]] {
        let components = (lens.clone(), motion.clone());
        small.app.world_mut().entity_mut(entity).insert(components);
    }
    small.app.update();
    let optics = |app: &App| {
        let cameras = app.world().resource::<crate::sync::TracedCameras>();
        cameras.0[0].camera.optics
    };
    assert_eq!(optics(&small.app).aperture_radius, 0.5);
    assert_eq!(optics(&small.app).velocity, Vec3::X);
    let velocity = |app: &App| world(app).aggregate.instances()[0].velocity();
    assert_eq!(velocity(&small.app), Vec3::X);
    assert_eq!(world(&small.app).objects[0].motion_samples, 1);
    let mut settings = small.app.world_mut().resource_mut::<RenderSettings>();
    settings.features.lens = false;
    settings.features.motion = false;
    let changes = frame(&mut small.app);
    assert!(changes.cameras && changes.top_level && changes.objects);
    assert_eq!(velocity(&small.app), Vec3::ZERO);
    assert_eq!(optics(&small.app).aperture_radius, 0.0);
    assert_eq!(optics(&small.app).velocity, Vec3::ZERO);
}

#[test]
fn an_empty_scene_an_empty_mesh_and_the_last_object_deleted_leave_a_clean_background() {
    use crate::bvh::Ray;
    let mut app = app();
    app.update();
    let ray = Ray::new(Vec3::Z * 5.0, Vec3::NEG_Z);
    assert!(world(&app).aggregate.closest_hit(&ray).is_none());

    let empty = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::MAIN_WORLD,
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, Vec::<[f32; 3]>::new());
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(empty);
    let object = app.world_mut().spawn(Mesh3d(handle)).id();
    app.update();
    assert!(problems(&app).is_empty(), "{:?}", problems(&app));
    assert!(world(&app).aggregate.closest_hit(&ray).is_none());

    let full = add_mesh(&mut app, 3);
    app.world_mut().entity_mut(object).insert(Mesh3d(full));
    app.update();
    assert!(world(&app).aggregate.closest_hit(&ray).is_some());

    app.world_mut().despawn(object);
    app.update();
    assert!(world(&app).aggregate.closest_hit(&ray).is_none());
    assert!(world(&app).objects.is_empty());
}
