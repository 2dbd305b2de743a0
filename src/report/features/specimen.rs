//! A scene to bring effects into: the head between its point lights, matt, opaque, still, without textures.

use super::{shown, through_lens};
use crate::app::headless_app;
use crate::bvh::{Aggregate, BuildOptions, Instance, MeshTree};
use crate::film::{Picture, Rendered, develop, render};
use crate::io::builtin;
use crate::scene::{PhongMap, RenderSettings};
use crate::sync::{Traced, TracedCameras};
use crate::trace::{
    Camera, Lights, Map, Material, Mesh, Object, ParallelogramLight, Texels, Texture, World,
};
use glam::Vec3;
use std::sync::Arc;

/// What rays read, from where, and how.
#[derive(Clone)]
#[expect(missing_docs, reason = "the types say it all")]
pub struct Specimen {
    pub world: World,
    pub camera: Camera,
    pub settings: RenderSettings,
}

impl Specimen {
    /// The head.
    pub fn plain() -> Self {
        let mut app = headless_app();
        (builtin::find("head").expect("a built-in scene").spawn)(app.world_mut());
        app.update();
        let cameras = app.world().resource::<TracedCameras>();
        Self {
            world: World::clone(&app.world().resource::<Traced>().world),
            camera: cameras.0[0].camera.clone(),
            settings: app.world().resource::<RenderSettings>().clone(),
        }
    }

    /// The picture as a screen shows it, with all that comes after tracing.
    pub fn picture(&self) -> Vec<[f32; 3]> {
        let rendered = self.rendered();
        develop(&rendered.picture, &self.settings.output)
    }

    /// The same as a picture.
    pub(super) fn developed(&self) -> Picture {
        let rendered = self.rendered();
        shown(&rendered.picture, &self.settings)
    }

    fn rendered(&self) -> Rendered {
        let camera = through_lens(&self.camera, &self.settings);
        render(&self.world, &camera, &self.settings, &|_, _| {})
    }

    fn needs_again(&mut self) {
        self.world = self.world.clone().with_needs();
    }

    /// Changes every material.
    pub fn material(&mut self, change: impl Fn(&mut Material)) {
        let mut materials = Vec::clone(&self.world.materials);
        materials.iter_mut().for_each(change);
        self.world.materials = Arc::new(materials);
        self.needs_again();
    }

    /// One of the point lights becomes an area.
    pub fn area_light(&mut self) {
        let Some((point, others)) = self.world.lights.points.split_first() else {
            return;
        };
        let light = ParallelogramLight {
            id: point.id,
            corner: point.position,
            edges: [Vec3::X * 0.5, Vec3::Z * 0.5],
            colors: [4.0 * point.color; 4],
            two_sided: true,
            visible: true,
            samples: 1,
        };
        let lights = Lights {
            points: others.to_vec(),
            parallelograms: vec![light],
            ..Lights::clone(&self.world.lights)
        };
        self.world.lights = Arc::new(lights);
        self.needs_again();
    }

    /// A chequered picture of 16 × 16 texels.
    fn checks() -> Arc<Texture> {
        let texel = |i: u32| {
            if (i + i / 16).is_multiple_of(2) {
                0.9
            } else {
                0.2
            }
        };
        let texels = (0..256).map(|i| [texel(i), 0.6, 1.0 - texel(i)]).collect();
        let texture = Texture::new(16, 16, Texels::Linear32(texels));
        Arc::new(texture.expect("256 texels make 16 x 16"))
    }

    /// Every material wears a picture.
    pub fn texture(&mut self) {
        self.world.textures = Arc::new(vec![Self::checks()]);
        self.material(|material| {
            material.maps = vec![Map::new(PhongMap::Diffuse, 0)];
        });
    }

    /// Every mesh's vertices have colours.
    pub fn vertex_colors(&mut self) {
        let painted = |object: &Object| {
            let count = object.mesh.tree.triangles().positions().len();
            let color = |i: usize| Vec3::new(0.5, 1.0 / (1 + i % 3) as f32, 0.75);
            Object {
                mesh: Arc::new(Mesh {
                    colors: (0..count).map(color).collect(),
                    alphas: Vec::new(),
                    ..Mesh::clone(&object.mesh)
                }),
                ..object.clone()
            }
        };
        self.world.objects = Arc::new(self.world.objects.iter().map(painted).collect());
        self.needs_again();
    }

    /// A map around the scene.
    pub fn environment_map(&mut self) {
        self.world.environment.map = Some(Self::checks());
        self.world.environment.intensity = 0.5;
    }

    /// Every object moves.
    pub fn moving(&mut self, velocity: Vec3, samples: u32) {
        let instances = self.world.aggregate.instances().iter().cloned();
        let moved = instances.filter_map(|instance| instance.moving(velocity).ok());
        let options = *self.world.aggregate.options();
        self.world.aggregate = Arc::new(Aggregate::build(moved.collect(), &options));
        let mut objects = Vec::clone(&self.world.objects);
        objects
            .iter_mut()
            .for_each(|object| object.motion_samples = samples);
        self.world.objects = Arc::new(objects);
        self.needs_again();
    }

    /// Meshes without normals of their own.
    pub fn without_normals(&mut self) {
        let flat = |object: &Object| Object {
            mesh: Arc::new(Mesh {
                normals: Vec::new(),
                ..Mesh::clone(&object.mesh)
            }),
            ..object.clone()
        };
        self.world.objects = Arc::new(self.world.objects.iter().map(flat).collect());
    }

    /// The same scene with other trees.
    pub fn rebuilt(&self, options: &BuildOptions) -> Self {
        let (mut instances, mut objects) = (Vec::new(), Vec::new());
        let before = self
            .world
            .aggregate
            .instances()
            .iter()
            .zip(&*self.world.objects);
        for (instance, object) in before {
            let triangles = object.mesh.tree.triangles().clone();
            let tree = Arc::new(MeshTree::build(triangles, options));
            let placed = Instance::new(tree.clone(), instance.world_from_object());
            instances.push(placed.expect("its transform had an inverse before"));
            objects.push(Object {
                mesh: Arc::new(Mesh {
                    tree,
                    ..Mesh::clone(&object.mesh)
                }),
                ..object.clone()
            });
        }
        let mut rebuilt = self.clone();
        rebuilt.world.aggregate = Arc::new(Aggregate::build(instances, options));
        rebuilt.world.objects = Arc::new(objects);
        rebuilt
    }
}
