//! Twenty things that people do in an editor. Each is one step, is undone and done again, and the
//! world is then the same as it was, component by component, and traces the same.

use super::scene_copy::{SceneCopy, traced};
use super::{act, editor, history, named};
use bevy::app::App;
use bevy::color::LinearRgba;
use bevy::math::{Quat, Vec3};
use bevy::prelude::{Entity, Mut, Transform};
use glassbox::editor::action::Addition;
use glassbox::editor::edits::{self, scene_entity};
use glassbox::editor::history::Gesture;
use glassbox::editor::{Action, Selection};
use glassbox::scene::{
    Environment, Lens, MeshSource, Motion, ParallelogramLamp, Phong, RenderSettings, SceneId,
    SegmentLamp, Shape, TextureSource, UsesMaterial, ViewTransform,
};

struct Task {
    name: &'static str,
    scene: &'static str,
    act: fn(&mut App),
}

/// Selects the entity with this name, and asks for something to be done with it.
fn act_on(app: &mut App, name: &str, action: Action) {
    let id = named(app, name);
    act(app, Action::Select(vec![id]));
    act(app, action);
}

const BOX: &str = "cornell-box-parallelogram-light";

const TASKS: &[Task] = &[
    Task {
        name: "drag an object in five frames",
        scene: BOX,
        act: |app| {
            let block = named(app, "Mirror block");
            app.world_mut()
                .resource_mut::<Gesture>()
                .begin("Move Mirror block");
            for step in 1..=5 {
                change(app, block, |place: Mut<Transform>| {
                    place.into_inner().translation.x += 0.01 * step as f32;
                });
                app.update();
            }
            app.world_mut().resource_mut::<Gesture>().end();
            app.update();
        },
    },
    Task {
        name: "turn two objects at once",
        scene: BOX,
        act: |app| {
            let ids = all(app);
            act(app, Action::Select(ids[1..3].to_vec()));
            for id in [ids[1], ids[2]] {
                change(app, id, |place: Mut<Transform>| {
                    place.into_inner().rotate_y(0.3);
                });
            }
            app.update();
        },
    },
    Task {
        name: "scale an object",
        scene: BOX,
        act: |app| {
            let block = named(app, "Short block");
            change(app, block, |place: Mut<Transform>| {
                place.into_inner().scale = Vec3::splat(0.5);
            });
            app.update();
        },
    },
    Task {
        name: "add a sphere",
        scene: BOX,
        act: |app| act(app, Action::Add(Addition::Shape("Sphere".into()))),
    },
    Task {
        name: "add each kind of light, a camera and a group at once",
        scene: BOX,
        act: |app| {
            let at = edits::AddAt::default();
            for what in [
                Addition::PointLamp,
                Addition::DirectionalLamp,
                Addition::SegmentLamp,
                Addition::ParallelogramLamp,
                Addition::Camera,
                Addition::Group,
                Addition::Material,
            ] {
                assert!(edits::add(app.world_mut(), &what, at).is_some());
            }
            app.update();
        },
    },
    Task {
        name: "delete an object",
        scene: BOX,
        act: |app| {
            act_on(app, "Mirror block", Action::run("edit.delete"));
        },
    },
    Task {
        name: "delete everything",
        scene: "spheres",
        act: |app| {
            act(app, Action::run("select.all"));
            act(app, Action::run("edit.delete"));
        },
    },
    Task {
        name: "duplicate an object",
        scene: BOX,
        act: |app| {
            act_on(app, "Mirror block", Action::run("edit.duplicate"));
        },
    },
    Task {
        name: "copy and paste everything",
        scene: "spheres",
        act: |app| {
            act(app, Action::run("select.all"));
            act(app, Action::run("edit.copy"));
            act(app, Action::run("edit.paste"));
        },
    },
    Task {
        name: "rename a light",
        scene: BOX,
        act: |app| {
            let id = all(app)[0];
            act(app, Action::Rename(id, "Something else".into()));
        },
    },
    Task {
        name: "hide three objects",
        scene: BOX,
        act: |app| {
            let ids = vec![
                named(app, "Mirror block"),
                named(app, "Short block"),
                named(app, "Floor"),
            ];
            act(app, Action::Select(ids));
            act(app, Action::run("edit.hide"));
        },
    },
    Task {
        name: "put an object below another that is turned and moved",
        scene: BOX,
        act: |app| {
            let (tall, short) = (named(app, "Mirror block"), named(app, "Short block"));
            act(app, Action::Reparent(vec![tall], Some(short)));
        },
    },
    Task {
        name: "make an object a mirror",
        scene: BOX,
        act: |app| {
            let block = named(app, "Short block");
            change(app, block, |phong: Mut<Phong>| {
                *phong.into_inner() = Phong {
                    diffuse: LinearRgba::BLACK,
                    specular: LinearRgba::rgb(0.9, 0.9, 0.9),
                    mirror: LinearRgba::rgb(0.9, 0.9, 0.9),
                    shininess: 100.0,
                    ..Phong::default()
                };
            });
            app.update();
        },
    },
    Task {
        name: "give an object a texture",
        scene: BOX,
        act: |app| {
            let floor = named(app, "Floor");
            change(app, floor, |phong: Mut<Phong>| {
                phong.into_inner().diffuse_map = Some(TextureSource::new("builtin:checker"));
            });
            app.update();
        },
    },
    Task {
        name: "share a material between two objects",
        scene: BOX,
        act: |app| {
            let at = edits::AddAt::default();
            let material = edits::add(app.world_mut(), &Addition::Material, at).unwrap();
            let material = scene_entity(app.world(), material).unwrap();
            for name in ["Mirror block", "Short block"] {
                let id = named(app, name);
                let entity = entity(app, id);
                app.world_mut()
                    .entity_mut(entity)
                    .insert(UsesMaterial(material));
            }
            app.update();
        },
    },
    Task {
        name: "replace an object's mesh",
        scene: BOX,
        act: |app| {
            let block = named(app, "Mirror block");
            change(app, block, |mesh: Mut<MeshSource>| {
                *mesh.into_inner() = MeshSource::Shape(Shape::Sphere {
                    radius: 0.2,
                    segments: 16,
                    rings: 8,
                });
            });
            app.update();
            app.update();
        },
    },
    Task {
        name: "drag a corner and a colour of an area light",
        scene: BOX,
        act: |app| {
            let mut lamps = app.world_mut().query::<&mut ParallelogramLamp>();
            let mut lamp = lamps.single_mut(app.world_mut()).unwrap();
            lamp.corner.y -= 0.1;
            lamp.colors[2] = LinearRgba::rgb(0.2, 0.4, 1.0);
            lamp.samples = 9;
            app.update();
        },
    },
    Task {
        name: "move an end of a segment light",
        scene: "cube-segment-light",
        act: |app| {
            let mut lamps = app.world_mut().query::<&mut SegmentLamp>();
            lamps.single_mut(app.world_mut()).unwrap().ends[1].z = 0.7;
            app.update();
        },
    },
    Task {
        name: "give the camera a lens, and an object motion",
        scene: BOX,
        act: |app| {
            let (camera, block) = (named(app, "Camera"), named(app, "Mirror block"));
            let (camera, block) = (entity(app, camera), entity(app, block));
            let world = app.world_mut();
            world.entity_mut(camera).insert(Lens {
                aperture_radius: 0.05,
                focus_distance: 2.0,
                samples: 16,
            });
            world.entity_mut(block).insert(Motion {
                velocity: Vec3::X,
                samples: 8,
            });
            app.update();
        },
    },
    Task {
        name: "change the environment and the settings",
        scene: BOX,
        act: |app| {
            let world = app.world_mut();
            world.resource_mut::<Environment>().background = LinearRgba::rgb(0.1, 0.2, 0.3);
            let mut settings = world.resource_mut::<RenderSettings>();
            settings.max_depth = 3;
            settings.features.shadows = false;
            settings.output.exposure = 1.5;
            settings.output.view_transform = ViewTransform::AgX;
            app.update();
        },
    },
];

fn all(app: &mut App) -> Vec<SceneId> {
    let world = app.world_mut();
    let mut ids: Vec<SceneId> = world.query::<&SceneId>().iter(world).copied().collect();
    ids.sort_unstable();
    ids
}

fn entity(app: &App, id: SceneId) -> Entity {
    scene_entity(app.world(), id).unwrap_or_else(|| panic!("{id:?} is gone"))
}

fn change<C: bevy::prelude::Component<Mutability = bevy::ecs::component::Mutable>>(
    app: &mut App,
    id: SceneId,
    change: impl FnOnce(Mut<C>),
) {
    let entity = entity(app, id);
    change(app.world_mut().get_mut::<C>(entity).unwrap());
}

#[test]
fn twenty_tasks_are_one_step_each_and_undo_leaves_nothing_of_them() {
    assert_eq!(TASKS.len(), 20);
    for task in TASKS {
        let name = task.name;
        let mut app = editor(task.scene);
        let before = SceneCopy::of(&mut app);
        let traced_before = traced(&app);
        (task.act)(&mut app);
        app.update();
        let after = SceneCopy::of(&mut app);
        let traced_after = traced(&app);
        assert_ne!(before, after, "{name} did nothing");
        let steps: Vec<&str> = history(&app).steps().collect();
        assert_eq!(steps.len(), 1, "{name} is {steps:?}");
        for round in 0..2 {
            act(&mut app, Action::run("edit.undo"));
            // Meshes are made of their sources in the next frame.
            app.update();
            SceneCopy::of(&mut app).assert_same(&before, &format!("{name}, undone, round {round}"));
            assert_eq!(traced(&app), traced_before, "{name}, undone, round {round}");
            act(&mut app, Action::run("edit.redo"));
            app.update();
            SceneCopy::of(&mut app).assert_same(&after, &format!("{name}, redone, round {round}"));
            assert_eq!(traced(&app), traced_after, "{name}, redone, round {round}");
        }
        assert_eq!(history(&app).steps().count(), 1, "{name} left other steps");
        assert_eq!(history(&app).position(), 1, "{name}");
    }
}

#[test]
fn what_was_deleted_is_selected_again_when_it_comes_back() {
    let mut app = editor(BOX);
    let block = named(&mut app, "Mirror block");
    act(&mut app, Action::Select(vec![block]));
    act(&mut app, Action::run("edit.delete"));
    assert!(app.world().resource::<Selection>().is_empty());
    act(&mut app, Action::run("edit.undo"));
    assert_eq!(app.world().resource::<Selection>().ids(), [block]);
}

#[test]
fn an_object_that_gets_another_parent_stays_where_it_is() {
    let mut app = editor(BOX);
    let (tall, short) = (
        named(&mut app, "Mirror block"),
        named(&mut app, "Short block"),
    );
    change(&mut app, short, |place: Mut<Transform>| {
        let place = place.into_inner();
        place.scale = Vec3::splat(2.0);
        place.rotation = Quat::from_rotation_y(0.7);
    });
    app.update();
    let place = |app: &App| {
        let entity = entity(app, tall);
        let place = app.world().get::<bevy::prelude::GlobalTransform>(entity);
        place.unwrap().affine()
    };
    let before = place(&app);
    act(&mut app, Action::Reparent(vec![tall], Some(short)));
    app.update();
    assert!(
        place(&app).abs_diff_eq(before, 1e-5),
        "{before} became {}",
        place(&app)
    );
    // Nobody becomes a child of its own child.
    let scene = SceneCopy::of(&mut app);
    act(&mut app, Action::Reparent(vec![short], Some(tall)));
    SceneCopy::of(&mut app).assert_same(&scene, "a circle");
    act(&mut app, Action::Reparent(vec![tall], None));
    app.update();
    assert!(
        place(&app).abs_diff_eq(before, 1e-5),
        "{before} became {}",
        place(&app)
    );
}
