use super::InspectSettings;
use crate::scene::RenderSettings;
use crate::trace::{Camera, RayTree, World};
use glam::Vec3;

/// What is looked at, from where, and what of it is to be seen.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// What rays read.
    pub world: &'a World,
    /// The scene's camera, whose picture it is.
    pub photographer: &'a Camera,
    /// From where the lines are looked at. Lengths in pixels are this camera's.
    pub camera: &'a Camera,
    /// How the picture is rendered; its size is also that of what is looked at.
    pub settings: &'a RenderSettings,
    /// What is to be seen.
    pub inspect: &'a InspectSettings,
    /// The rays of a pixel, where one was picked.
    pub rays: Option<&'a RayTree>,
    middle: Vec3,
    size: f32,
}

impl<'a> Subject<'a> {
    /// Looked at through the scene's camera itself.
    pub fn new(
        world: &'a World,
        camera: &'a Camera,
        settings: &'a RenderSettings,
        inspect: &'a InspectSettings,
        rays: Option<&'a RayTree>,
    ) -> Self {
        let bounds = world.aggregate.tree().nodes.first();
        let (middle, size) = bounds.map_or((Vec3::ZERO, 1.0), |root| {
            let (min, max) = (root.min, root.max);
            (0.5 * (min + max), (max - min).length())
        });
        Self {
            world,
            photographer: camera,
            camera,
            settings,
            inspect,
            rays,
            middle,
            size,
        }
    }

    /// Looked at through another camera.
    pub fn seen_by(self, camera: &'a Camera) -> Self {
        Self { camera, ..self }
    }

    /// The middle of all objects.
    pub(super) fn middle(&self) -> Vec3 {
        self.middle
    }

    /// A distance that leads out of the scene from wherever it is looked at.
    pub(super) fn far(&self) -> f32 {
        self.size + (self.camera.position - self.middle).length()
    }

    /// The distance from which something is looked at: what is drawn as long as a part of it looks
    /// equally long everywhere.
    pub(super) fn distance(&self, to: Vec3) -> f32 {
        (to - self.camera.position).length()
    }
}
