use super::app::{app, opened, triangles, write};
use super::models::objects;
use bevy::asset::Assets;
use bevy::camera::visibility::Visibility;
use bevy::color::LinearRgba;
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::ecs::name::Name;
use bevy::image::Image;
use bevy::math::{Quat, UVec2, Vec3};
use bevy::mesh::{Mesh, Mesh3d};
use bevy::prelude::{Entity, World};
use bevy::transform::components::Transform;
use glassbox::io::{LoadProblems, OpenOptions, SceneFiles, SceneSource, open, save};
use glassbox::scene::*;
use std::fs;

/// One of everything, with numbers that do not look the same in another order.
fn rich_scene(world: &mut World, picture: &str) {
    let color = |r| LinearRgba::rgb(r, 0.1 + r, 1.0 / 3.0);
    let material = world
        .spawn((
            SceneId(7),
            Name::new("gold"),
            Phong {
                diffuse: color(0.25),
                specular: color(0.5),
                mirror: color(0.375),
                shininess: 33.3,
                opacity: 0.9,
                emission: color(2.0),
                alpha: Alpha::Mask { cutoff: 0.3 },
                normal_scale: 0.7,
                diffuse_map: Some(TextureSource::new(picture)),
                specular_map: Some(TextureSource {
                    wrap_u: Wrap::Clamp,
                    wrap_v: Wrap::Mirror,
                    filter: MapFilter::Nearest,
                    ..TextureSource::new(picture)
                }),
                mirror_map: Some(TextureSource::new("builtin:uv")),
                emission_map: Some(TextureSource::new("builtin:checker")),
                opacity_map: Some(TextureSource::new(picture)),
                normal_map: Some(TextureSource {
                    filter: MapFilter::Linear,
                    ..TextureSource::new(picture)
                }),
            },
        ))
        .id();
    let parent = world
        .spawn((
            SceneId(3),
            Name::new("parent \"quoted\""),
            Transform::from_xyz(0.1, 0.2, 0.3).with_rotation(Quat::from_rotation_y(0.7)),
            Visibility::Hidden,
        ))
        .id();
    world.spawn((
        SceneId(5),
        ChildOf(parent),
        UsesMaterial(material),
        Motion {
            velocity: Vec3::new(1.0, 0.0, -1e-7),
            samples: 3,
        },
        MeshSource::Shape(Shape::Triangle {
            corners: [Vec3::ZERO, Vec3::X, Vec3::Y * 1e-30],
        }),
    ));
    world.spawn((
        SceneId(1),
        PointLamp {
            cone: Some(Cone::default()),
            ..Default::default()
        },
    ));
    world.spawn((
        SceneId(2),
        DirectionalLamp {
            angular_diameter: 0.0093,
            ..Default::default()
        },
    ));
    world.spawn((
        SceneId(40),
        SegmentLamp {
            intensity: 1e9,
            ..Default::default()
        },
        Motion {
            velocity: Vec3::NEG_Y,
            samples: 7,
        },
    ));
    world.spawn((
        SceneId(41),
        ParallelogramLamp {
            two_sided: true,
            ..Default::default()
        },
    ));
    world.spawn((
        SceneId(1 << 40 | 1),
        SceneCamera {
            projection: Projection::Orthographic { height: 2.5 },
            ..Default::default()
        },
        Lens {
            focus_distance: f32::INFINITY,
            ..Default::default()
        },
    ));
    world.insert_resource(RenderSettings {
        size: UVec2::new(123, 45),
        lighting: Lighting::Classic,
        tree: TreeSettings::SIMPLE,
        ..Default::default()
    });
    world.insert_resource(Environment {
        rotation: 1.25,
        map: Some(TextureSource::new(picture)),
        lights: true,
        samples: 5,
        ..Default::default()
    });
}

pub(super) fn by_id(world: &mut World, id: u64) -> Entity {
    let mut query = world.query::<(Entity, &SceneId)>();
    let mut found = query.iter(world).filter(|(_, other)| other.0 == id);
    found.next().unwrap_or_else(|| panic!("no entity {id}")).0
}

#[test]
fn a_scene_that_is_saved_opened_and_saved_again_gives_the_same_bytes_and_components() {
    let folder = tempfile::tempdir().unwrap();
    glassbox::io::write_picture(&folder.path().join("a.png"), 2, 1, &[[0.5; 3]; 2]).unwrap();
    let first = folder.path().join("first.scn.ron");
    let second = folder.path().join("second.scn.ron");
    let mut original = app();
    rich_scene(original.world_mut(), "a.png");
    original
        .world_mut()
        .resource_mut::<SceneFiles>()
        .folder
        .path = folder.path().into();
    let notes = save(original.world_mut(), &first).unwrap_or_else(|error| panic!("{error}"));
    assert!(notes.is_empty(), "{notes:?}");
    let (mut reopened, opened) = opened(&first);
    assert!(opened.notes.is_empty(), "{:?}", opened.notes);
    save(reopened.world_mut(), &second).unwrap();
    let (a, b) = (
        fs::read_to_string(&first).unwrap(),
        fs::read_to_string(&second).unwrap(),
    );
    assert_eq!(a, b, "the bytes differ");

    let (before, after) = (original.world_mut(), reopened.world_mut());
    macro_rules! same {
        ($id:expr, $($component:ty),*) => {{
            let (x, y) = (by_id(before, $id), by_id(after, $id));
            $(
                assert!(before.get::<$component>(x).is_some(), "the test compares nothing");
                assert_eq!(before.get::<$component>(x), after.get::<$component>(y), "entity {}", $id);
            )*
        }};
    }
    same!(7, Name, Phong);
    same!(3, Name, Transform, Visibility);
    same!(5, MeshSource, Motion, Transform);
    same!(1, PointLamp);
    same!(2, DirectionalLamp);
    same!(40, SegmentLamp, Motion);
    same!(41, ParallelogramLamp);
    same!(1_u64 << 40 | 1, SceneCamera, Lens);
    assert_eq!(
        before.resource::<RenderSettings>(),
        after.resource::<RenderSettings>()
    );
    assert_eq!(
        before.resource::<Environment>(),
        after.resource::<Environment>()
    );

    let (parent, child) = (by_id(after, 3), by_id(after, 5));
    let material = by_id(after, 7);
    assert_eq!(after.get::<ChildOf>(child), Some(&ChildOf(parent)));
    assert_eq!(
        after.get::<Children>(parent).map(|c| c.to_vec()),
        Some(vec![child])
    );
    assert_eq!(
        after.get::<UsesMaterial>(child),
        Some(&UsesMaterial(material))
    );
    let maps = after
        .get::<PhongMaps>(material)
        .expect("the picture was not loaded");
    let images = after.resource::<Assets<Image>>();
    let size = maps
        .diffuse
        .as_ref()
        .and_then(|handle| images.get(handle))
        .map(Image::size);
    assert_eq!(size, Some(UVec2::new(2, 1)));
    assert!(
        after.resource::<EnvironmentMap>().0.is_some(),
        "the map was not loaded"
    );
    assert_eq!(triangles(after, child).len(), 1);
}

const OBJ: &str = "# two objects, three materials
mtllib box.mtl
o first
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
vn 0 0.6 0.8
usemtl red
f 1/1/1 2/2/1 3/3/2 4/4/2
usemtl blue
f 1/1/1 2/2/1 5/3/2
o second
usemtl red
f -5/1/1 -4/2/1 -1/3/2
";

const MTL: &str = "newmtl red
Kd 1 0.5 0.25
Ks 0.1 0.2 0.3
Ns 20
d 0.75
Ke 1 2 3
map_Kd a.png
newmtl blue
Kd 0 0 1
Tr 0.25
";

fn obj_folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    glassbox::io::write_picture(&folder.path().join("a.png"), 2, 1, &[[0.5; 3]; 2]).unwrap();
    write(folder.path(), "box.mtl", MTL);
    write(folder.path(), "box.obj", OBJ);
    folder
}

#[test]
fn an_obj_becomes_an_object_for_each_name_and_material() {
    let folder = obj_folder();
    let (mut app, opened) = opened(&folder.path().join("box.obj"));
    let objects = objects(app.world_mut());
    let names: Vec<_> = objects.iter().map(|o| (o.0.as_str(), o.2.len())).collect();
    assert_eq!(names, [("first/blue", 1), ("first/red", 2), ("second", 1)]);
    let red = &objects[1].1;
    assert_eq!(red.diffuse, LinearRgba::rgb(1.0, 0.5, 0.25));
    assert_eq!(red.emission, LinearRgba::rgb(1.0, 2.0, 3.0));
    assert_eq!((red.shininess, red.opacity), (20.0, 0.75));
    assert_eq!(
        red.diffuse_map.as_ref().map(|t| t.path.as_str()),
        Some("a.png")
    );
    assert_eq!(objects[0].1.opacity, 0.75, "Tr is 1 - d");
    assert_eq!(
        objects[2].2[0],
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    );
    assert_eq!(
        opened.notes.len(),
        2,
        "a camera and lights: {:?}",
        opened.notes
    );
    let world = app.world_mut();
    let cameras = world.query::<&SceneCamera>().iter(world).count();
    let lamps = world.query::<&DirectionalLamp>().iter(world).count();
    assert_eq!((cameras, lamps), (1, 2));
}

#[test]
fn objects_with_the_same_source_share_one_mesh() {
    let mut app = app();
    let source = MeshSource::Shape(Shape::Triangle {
        corners: [Vec3::ZERO, Vec3::X, Vec3::Y],
    });
    let a = app.world_mut().spawn(source.clone()).id();
    app.update();
    let b = app.world_mut().spawn(source).id();
    app.update();
    let world = app.world();
    let mesh = |entity| world.get::<Mesh3d>(entity).expect("no mesh").0.id();
    assert_eq!(mesh(a), mesh(b));
    assert_eq!(world.resource::<Assets<Mesh>>().len(), 1);
}

#[test]
fn a_source_that_cannot_be_loaded_keeps_what_was_there_and_says_so_until_it_can() {
    let folder = obj_folder();
    let (mut app, _) = opened(&folder.path().join("box.obj"));
    let world = app.world_mut();
    let mut query = world.query::<(Entity, &MeshSource)>();
    let (entity, source) = query
        .iter(world)
        .map(|(e, s)| (e, s.clone()))
        .next()
        .unwrap();
    let before = world.get::<Mesh3d>(entity).cloned();
    assert!(before.is_some());
    world.entity_mut(entity).insert(MeshSource::File {
        path: "gone.obj".into(),
        name: String::new(),
    });
    app.update();
    assert_eq!(app.world().get::<Mesh3d>(entity).cloned(), before);
    let problems = app.world().resource::<glassbox::io::LoadProblems>();
    let lines: Vec<_> = problems
        .problems
        .iter()
        .map(|p| p.error.to_string())
        .collect();
    assert!(
        lines.len() == 1 && lines[0].contains("gone.obj"),
        "{lines:?}"
    );
    app.world_mut().entity_mut(entity).insert(source);
    app.update();
    let problems = app.world().resource::<glassbox::io::LoadProblems>();
    assert!(problems.problems.is_empty(), "{problems:?}");
}

#[test]
fn an_error_leaves_the_open_scene_as_it_was() {
    let folder = obj_folder();
    let (mut app, _) = opened(&folder.path().join("box.obj"));
    let before = objects(app.world_mut());
    let bad = write(folder.path(), "bad.obj", "v 0 0 0\nf 1 2 3\n");
    let result = open(
        app.world_mut(),
        &SceneSource::File(bad),
        OpenOptions::default(),
    );
    assert!(result.is_err());
    assert_eq!(objects(app.world_mut()), before);
}

#[test]
fn opening_a_scene_replaces_the_one_before_it() {
    let folder = obj_folder();
    let (mut app, _) = opened(&folder.path().join("box.obj"));
    let count = |world: &mut World| world.query::<&SceneId>().iter(world).count();
    let before = count(app.world_mut());
    let source = SceneSource::File(folder.path().join("box.obj"));
    open(app.world_mut(), &source, OpenOptions::default()).unwrap();
    assert_eq!(count(app.world_mut()), before);
    app.update();
    assert_eq!(
        app.world().resource::<Assets<Mesh>>().len(),
        3,
        "meshes of the old scene stayed"
    );
}

#[test]
fn every_built_in_scene_can_be_saved_and_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    for scene in glassbox::io::builtin::SCENES {
        let mut first = app();
        open(
            first.world_mut(),
            &SceneSource::named(scene.name),
            OpenOptions::default(),
        )
        .unwrap();
        let problems = first.world().resource::<LoadProblems>();
        assert!(problems.problems.is_empty(), "{}: {problems:?}", scene.name);
        let file = folder.path().join(format!("{}.scn.ron", scene.name));
        save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
        let (mut again, _) = opened(&file);
        let copy = folder.path().join("copy.scn.ron");
        save(again.world_mut(), &copy).unwrap_or_else(|error| panic!("{error}"));
        let same = fs::read(&file).unwrap() == fs::read(&copy).unwrap();
        assert!(same, "{} changed on the way", scene.name);
        let count = |world: &mut World| world.query::<&Mesh3d>().iter(world).count();
        assert_eq!(
            count(first.world_mut()),
            count(again.world_mut()),
            "{}",
            scene.name
        );
    }
}
