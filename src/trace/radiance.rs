//! The value of samples: a batch at a time, bounce by bounce.

use super::light_frames::LightFrames;
use super::near_lights::NearLights;
use super::recorder::Recorder;
use super::sampler::{Purpose, Sampler};
use super::{Camera, Cone, ImagePlane, Surface, World};
use crate::bvh::{Hit, Ray};
use crate::scene::{Lighting, RenderSettings};
use glam::{UVec2, Vec3};

/// Names one sample of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleId {
    /// (0, 0) is the top left pixel.
    pub pixel: UVec2,
    /// Counts the pixel's samples from 0.
    pub index: u64,
}

impl SampleId {
    /// The random numbers of the sample's pixel.
    pub(super) fn sampler(self, settings: &RenderSettings) -> Sampler {
        let UVec2 { x, y } = self.pixel;
        Sampler::new(x, y, settings.seed, settings.sequence).on_grid(settings.jitter)
    }
}

/// The camera's ray of a sample: through its place in the pixel, from its place on the lens, at its
/// shutter time where anything moves.
pub(super) fn sample_ray(
    world: &World,
    plane: &ImagePlane,
    settings: &RenderSettings,
    sample: SampleId,
) -> Ray {
    let camera = plane.camera;
    let SampleId { pixel, index } = sample;
    let sampler = sample.sampler(settings);
    let moves = settings.features.motion
        && (camera.optics.velocity != Vec3::ZERO || world.needs.motion_samples > 0);
    let time = if moves {
        camera.time(sampler.block(index, Purpose::Time, 0)[0])
    } else {
        0.0
    };
    plane.sample_ray(pixel, index, sampler, settings.pixel, time)
}

/// Rays traced, by what they were for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[expect(missing_docs, reason = "the names say it all")]
pub struct RayCounts {
    pub camera: u64,
    pub mirror: u64,
    pub transmission: u64,
    pub shadow: u64,
}

impl RayCounts {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.camera + self.mirror + self.transmission + self.shadow
    }
}

impl std::ops::AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.mirror += other.mirror;
        self.transmission += other.transmission;
        self.shadow += other.shadow;
    }
}

/// The arrays that a batch fills. Kept from batch to batch, so that nothing is allocated once they
/// have grown to their size. One per thread.
#[derive(Default)]
pub struct Workspace {
    paths: Vec<Path>,
    pub(super) next: Vec<Path>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    pub(super) shadows: Vec<Shadow>,
    pub(super) shadow_rays: Vec<Ray>,
    pub(super) occluded: Vec<bool>,
    pub(super) near_lights: NearLights,
    pub(super) light_frames: LightFrames,
}

impl Workspace {
    /// Of which samples of the last batch the light of a lamp close by differs by how much from what it has
    /// to be on average, where that is known: the index into the batch and linear RGB. A sample may be
    /// named several times. The mean over a pixel's samples is the error that those lamps leave in it.
    pub fn deviations(&self) -> &[(u32, Vec3)] {
        self.near_lights.deviations()
    }

    /// Once it is known what is occluded.
    pub(super) fn compare_near_lights(&mut self) {
        self.near_lights.compare(&self.shadows, &self.occluded);
    }
}

/// A path on its way: its next ray, and what that ray's radiance will be multiplied by.
#[derive(Clone, Copy)]
pub(super) struct Path {
    pub origin: Vec3,
    pub direction: Vec3,
    pub throughput: Vec3,
    pub cone: Cone,
    /// In the shutter's interval.
    pub time: f32,
    /// Index into the batch.
    pub sample: u32,
    /// Names this path among those of its sample, for its random numbers: 0 from the camera on.
    pub name: u32,
    /// Mirror bounces so far.
    pub bounces: u32,
    /// Scatterings in translucent surfaces so far.
    pub scatterings: u32,
    /// True until the first hit.
    pub first: bool,
    /// A straight continuation behind this hit of the same ray, instead of a ray from its start.
    pub after: Option<Hit>,
}

/// What a shadow ray adds to which sample, if the light arrives.
#[derive(Clone, Copy)]
pub(super) struct Shadow {
    pub sample: u32,
    pub value: Vec3,
}

/// A visible light that lies in a surface wins against it within this fraction of the distance:
/// 64 units of rounding; t itself is good to a few.
const LIGHT_BEFORE_SURFACE: f32 = 1.0 + 64.0 * f32::EPSILON;

/// Gives each sample of a batch its radiance: `values[i]` becomes that of `samples[i]`, linear RGB.
///
/// The value of a sample depends on nothing but the sample, the world, the camera and the settings;
/// not on what else is in the batch.
///
/// # Panics
/// If there is not exactly one value for each sample.
pub fn radiance(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    samples: &[SampleId],
    values: &mut [Vec3],
    workspace: &mut Workspace,
) -> RayCounts {
    radiance_with(world, camera, settings, samples, values, workspace, &mut ())
}

/// The same, watched: what [`probe`](super::probe()) reads is what happened.
pub(super) fn radiance_with<R: Recorder>(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    samples: &[SampleId],
    values: &mut [Vec3],
    workspace: &mut Workspace,
    recorder: &mut R,
) -> RayCounts {
    assert_eq!(samples.len(), values.len(), "one value for each sample");
    values.fill(Vec3::ZERO);
    workspace.near_lights.begin(&world.lights, settings);
    workspace.light_frames.begin(&world.lights, settings);
    let mut batch = Batch {
        world,
        settings,
        samples,
        values,
        counts: RayCounts::default(),
        recorder,
    };
    batch.start(camera, workspace);
    while !workspace.paths.is_empty() {
        batch.trace(workspace);
        batch.shade(workspace);
        batch.add_arriving_light(workspace);
        std::mem::swap(&mut workspace.paths, &mut workspace.next);
        batch.recorder.next_bounce();
    }
    batch.counts
}

/// What the steps of a batch share.
pub(super) struct Batch<'a, R> {
    pub world: &'a World,
    pub settings: &'a RenderSettings,
    samples: &'a [SampleId],
    pub values: &'a mut [Vec3],
    pub counts: RayCounts,
    pub recorder: &'a mut R,
}

impl<R: Recorder> Batch<'_, R> {
    /// The random numbers of a sample of the batch, and its index in its pixel.
    pub(super) fn sampler(&self, sample: u32) -> (Sampler, u64) {
        let sample = self.samples[sample as usize];
        (sample.sampler(self.settings), sample.index)
    }

    /// One path per sample, at the camera.
    fn start(&mut self, camera: &Camera, workspace: &mut Workspace) {
        workspace.paths.clear();
        let cone = Cone::of_pixel(camera, self.settings.size);
        let plane = camera.image_plane(self.settings.size);
        for (i, &sample) in self.samples.iter().enumerate() {
            let ray = sample_ray(self.world, &plane, self.settings, sample);
            let path = Path {
                origin: ray.origin,
                direction: ray.direction,
                throughput: Vec3::ONE,
                cone,
                time: ray.time,
                sample: i as u32,
                name: 0,
                bounces: 0,
                scatterings: 0,
                first: true,
                after: None,
            };
            self.recorder.camera_ray(&path);
            workspace.paths.push(path);
        }
        self.counts.camera += self.samples.len() as u64;
    }

    /// What every path's ray hits.
    fn trace(&self, workspace: &mut Workspace) {
        let aggregate = &self.world.aggregate;
        workspace.rays.clear();
        workspace
            .rays
            .extend(workspace.paths.iter().map(|path| Ray {
                origin: path.origin,
                direction: path.direction,
                t_max: f32::INFINITY,
                time: path.time,
            }));
        if workspace.paths.iter().all(|path| path.after.is_none()) {
            aggregate.closest_hits(&workspace.rays, &mut workspace.hits);
            return;
        }
        workspace.hits.clear();
        for (path, ray) in workspace.paths.iter().zip(&workspace.rays) {
            workspace.hits.push(match &path.after {
                Some(after) => aggregate.next_crossing(ray, after),
                None => aggregate.closest_hit(ray),
            });
        }
    }

    /// Turns every hit into what it adds by itself, shadow rays, and the paths of the next bounce.
    fn shade(&mut self, workspace: &mut Workspace) {
        workspace.next.clear();
        workspace.shadows.clear();
        workspace.shadow_rays.clear();
        // Taken out, so that the paths can be read while the rest is written; no array is lost.
        let paths = std::mem::take(&mut workspace.paths);
        let hits = std::mem::take(&mut workspace.hits);
        let rays = std::mem::take(&mut workspace.rays);
        for ((path, ray), hit) in paths.iter().zip(&rays).zip(&hits) {
            self.recorder.next_path();
            if let Some(light) = self.visible_light(path, hit.as_ref()) {
                self.add(path.sample, path.throughput * light);
            } else if let Some(hit) = hit {
                let width = path.cone.width_at(hit.t);
                let surface = Surface::at(self.world, self.settings, ray, width, hit);
                self.recorder.met_surface(hit, &surface);
                if surface.opacity == 0.0 {
                    self.pass(path, hit, workspace);
                } else {
                    self.shade_surface(path, hit, &surface, workspace);
                }
            } else {
                let background = self.background(path.direction);
                self.recorder.met_background(background);
                self.add(path.sample, path.throughput * background);
            }
        }
        workspace.paths = paths;
        workspace.hits = hits;
        workspace.rays = rays;
    }

    fn shade_surface(
        &mut self,
        path: &Path,
        hit: &Hit,
        surface: &Surface,
        workspace: &mut Workspace,
    ) {
        let opaque = path.throughput * surface.opacity;
        if self.settings.features.shading {
            if self.settings.lighting == Lighting::Physical {
                self.recorder.shines(surface.opacity * surface.emission);
                self.add(path.sample, opaque * surface.emission);
            }
            self.gather_direct_light(path, surface, opaque, workspace);
            self.continue_paths(path, hit, surface, workspace);
        } else {
            self.recorder.shines(surface.opacity * surface.diffuse);
            self.add(path.sample, opaque * surface.diffuse);
            self.transmit(path, hit, surface, 1.0, workspace);
        }
    }

    pub(super) fn add(&mut self, sample: u32, value: Vec3) {
        self.values[sample as usize] += value;
        self.recorder.added(value);
    }

    fn background(&self, direction: Vec3) -> Vec3 {
        if self.settings.features.environment {
            self.world.environment.radiance(direction)
        } else {
            self.world.environment.background
        }
    }

    /// Radiance of the nearest visible light that the path's ray meets before its hit.
    fn visible_light(&mut self, path: &Path, hit: Option<&Hit>) -> Option<Vec3> {
        // Classic lights are nowhere to be seen, as in simple Phong ray tracers.
        if !self.world.needs.visible_lights || self.settings.lighting == Lighting::Classic {
            return None;
        }
        let behind = path.after.map_or(0.0, |hit| hit.t);
        let mut nearest = hit.map_or(f32::INFINITY, |hit| hit.t * LIGHT_BEFORE_SURFACE);
        let mut met = None;
        let lights = &self.world.lights;
        for light in lights.parallelograms.iter().filter(|l| l.visible) {
            let origin = lights.in_rest_frame(light.id, path.origin, path.time);
            if let Some((t, value)) = light.meet(origin, path.direction)
                && t > behind
                && t < nearest
            {
                nearest = t;
                met = Some((light.id, value));
            }
        }
        let (id, radiance) = met?;
        self.recorder.met_light(id, nearest, radiance);
        Some(radiance)
    }
}
