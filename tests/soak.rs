//! Ten thousand edits of a scene that is being rendered: what they allocate is given back.

use crate::{ALONE, bytes_at_rest};
use bevy::app::App;
use bevy::asset::Assets;
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::math::{UVec2, Vec3};
use bevy::mesh::{Mesh, Mesh3d};
use bevy::transform::components::Transform;
use glassbox::app::headless_app;
use glassbox::film::{Progressive, Snapshot, develop_rgba8};
use glassbox::io::shapes::mesh;
use glassbox::scene::{Builder, Phong, PointLamp, RenderSettings, SceneCamera, Shape};
use glassbox::sync::{Traced, TracedCameras, TreeBuilding, finish};
use glassbox::trace::{Gains, World};
use std::sync::PoisonError;

const SIZE: UVec2 = UVec2::splat(32);
/// What may be left after 10,000 edits: a leak of seven bytes an edit is found.
const TOLERANCE: isize = 64 << 10;

struct Edited {
    app: App,
    objects: Vec<Entity>,
    light: Entity,
    camera: Entity,
    shapes: [Mesh; 2],
    render: Option<Progressive>,
    /// Edits of lights and materials that the render under way took in.
    taken_in: usize,
    snapshot: Snapshot,
}

impl Edited {
    fn new() -> Self {
        let shapes = [6, 7].map(|segments| {
            let sphere = Shape::Sphere {
                radius: 0.5,
                segments,
                rings: 5,
            };
            mesh(&sphere).unwrap()
        });
        let mut app = headless_app();
        let world = app.world_mut();
        world.resource_mut::<RenderSettings>().size = SIZE;
        world.insert_resource(TreeBuilding::InBackground);
        let handle = world.resource_mut::<Assets<Mesh>>().add(shapes[0].clone());
        let objects = (0..4)
            .map(|i| {
                let place = Transform::from_xyz(i as f32 - 1.5, 0.0, 0.0);
                world
                    .spawn((Mesh3d(handle.clone()), Phong::default(), place))
                    .id()
            })
            .collect();
        let light = (PointLamp::default(), Transform::from_xyz(0.0, 2.0, 2.0));
        let light = world.spawn(light).id();
        let camera = (SceneCamera::default(), Transform::from_xyz(0.0, 0.0, 5.0));
        let camera = world.spawn(camera).id();
        finish(&mut app);
        Self {
            app,
            objects,
            light,
            camera,
            shapes,
            render: None,
            taken_in: 0,
            snapshot: Snapshot::black(SIZE),
        }
    }

    fn edit(&mut self, i: usize) {
        let back = i / 10 % 2;
        let by = 0.1 * back as f32;
        let object = self.objects[i % 4];
        let world = self.app.world_mut();
        match i % 10 {
            0 => {
                world
                    .get_mut::<Transform>(self.light)
                    .unwrap()
                    .translation
                    .x = by
            }
            1 => {
                world.get_mut::<PointLamp>(self.light).unwrap().color =
                    LinearRgba::rgb(1.0, by, 0.0);
            }
            2 => world.get_mut::<Phong>(object).unwrap().mirror = LinearRgba::rgb(by, by, by),
            3 => world.get_mut::<Transform>(object).unwrap().translation.y = by,
            4 => {
                world.get_mut::<Transform>(self.camera).unwrap().translation =
                    Vec3::new(by, 0.0, 5.0)
            }
            5 => {
                let handle = world.get::<Mesh3d>(object).unwrap().0.clone();
                let mut meshes = world.resource_mut::<Assets<Mesh>>();
                meshes
                    .insert(handle.id(), self.shapes[back].clone())
                    .unwrap();
            }
            6 => {
                let gone = self.objects.remove(0);
                let twin = (
                    world.get::<Mesh3d>(gone).unwrap().clone(),
                    *world.get::<Transform>(gone).unwrap(),
                );
                world.despawn(gone);
                self.objects
                    .push(world.spawn(twin).insert(Phong::default()).id());
            }
            7 => world.resource_mut::<RenderSettings>().output.exposure = by,
            8 => {
                world.resource_mut::<RenderSettings>().tree.builder =
                    [Builder::Ploc, Builder::Sah][back];
            }
            _ => {
                let mesh = self.shapes[back].clone();
                let handle = world.resource_mut::<Assets<Mesh>>().add(mesh);
                world.get_mut::<Mesh3d>(object).unwrap().0 = handle;
            }
        }
        self.app.update();
        let world = self.app.world();
        let settings = world.resource::<RenderSettings>().clone();
        let output = settings.output;
        let camera = world.resource::<TracedCameras>().0[0].camera.clone();
        let traced = world.resource::<Traced>();
        let (changes, traced) = (traced.changes, World::clone(&traced.world));
        let running = self
            .render
            .take()
            .filter(|render| !changes.cameras && render.edit(traced.clone(), &Gains::default()));
        self.taken_in += usize::from(running.is_some() && i % 10 < 3);
        let render =
            running.unwrap_or_else(|| Progressive::start(traced, camera, settings).unwrap());
        // Most are cancelled on their way; some end.
        if i.is_multiple_of(7) {
            render.wait();
            render.refresh(&mut self.snapshot);
            assert_eq!(develop_rgba8(&self.snapshot.picture, &output).len(), 4096);
        }
        self.render = Some(render);
    }

    /// Bytes that are allocated when all has come to rest.
    fn at_rest(&mut self) -> isize {
        self.render = None;
        finish(&mut self.app);
        bytes_at_rest()
    }
}

#[test]
fn ten_thousand_edits_and_renders_leave_no_memory_behind() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut edited = Edited::new();
    // Arrays, queues and threads' scratch memory have grown to their size after some.
    for i in 0..1_000 {
        edited.edit(i);
    }
    let before = edited.at_rest();
    for i in 0..10_000 {
        edited.edit(i);
    }
    let taken_in = edited.taken_in;
    assert!(
        taken_in > 100,
        "{taken_in} edits were of a render under way"
    );
    let grown = edited.at_rest() - before;
    assert!(
        grown < TOLERANCE,
        "{grown} bytes more than {before} after 10,000 edits"
    );
}
