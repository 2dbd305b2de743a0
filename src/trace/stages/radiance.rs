//! The value of samples: a batch at a time, bounce by bounce, stage by stage.
//!
//! ```text
//! camera     samples  -> rays                         camera_rays
//! nearest    rays     -> hits                         nearest
//! vertices   hits     -> vertices                     vertices
//!            what shines by itself -> values          here
//! lights     vertices -> shadow rays, of one light    direct
//!            what arrives -> values
//! continue   vertices -> the next bounce's rays       scatter
//! ```

use super::camera_rays::CameraRays;
use super::known::{Known, KnownNow};
use super::nearest::Behind;
use super::paths::{Path, Paths};
use super::ray_counts::RayCounts;
use super::recorder::{Adding, Recorder};
use super::shadow_rays::ShadowRays;
use super::vertices::Vertices;
use crate::bvh::{Hit, Ray};
use crate::scene::{Lighting, RenderSettings};
use crate::trace::light_sampling::planes::{OWN, PlaneSet, Planes};
use crate::trace::light_sampling::visible_lights::VisibleLights;
use crate::trace::random::sampler::{SampleId, Sampler};
use crate::trace::{Camera, Cone, MaterialSet, World};
use glam::Vec3;

/// The arrays that a batch fills. Kept from batch to batch, so that nothing is allocated once they
/// have grown to their size. One per thread.
#[derive(Default)]
pub struct Workspace {
    camera_rays: CameraRays,
    /// Of this bounce, and of the next one.
    paths: Paths,
    next: Paths,
    /// Of the samples of the batch that comes, or was.
    pub known: Known,
    /// Of later bounces than the camera's.
    hits: Vec<Option<Hit>>,
    behind: Behind,
    visible_lights: VisibleLights,
    vertices: Vertices,
    shadow_rays: ShadowRays,
}

impl Workspace {
    /// The materials that paths have met since this was asked last. The values of samples depend on no other material, those
    /// apart that let light through.
    pub fn take_met(&mut self) -> MaterialSet {
        std::mem::take(&mut self.vertices.met)
    }
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

/// The same kept apart: `values` holds the samples' values in the first plane that is `wanted`, then those in the next, and
/// so on. Lights whose planes are not wanted are not asked. `None` where `stopped` said so, which is asked after every bounce
/// and every surface that paths go through, and now and then among many lights: the values mean nothing then.
///
/// # Panics
/// If there is not exactly one value for each sample and wanted plane.
#[expect(
    clippy::too_many_arguments,
    reason = "all that a sample depends on, and where it goes"
)]
pub fn radiance_in_planes(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    samples: &[SampleId],
    planes: &Planes,
    wanted: PlaneSet,
    values: &mut [Vec3],
    workspace: &mut Workspace,
    stopped: &dyn Fn() -> bool,
) -> Option<RayCounts> {
    let kept = (planes, wanted);
    evaluate(
        world,
        camera,
        settings,
        samples,
        kept,
        values,
        workspace,
        &mut (),
        stopped,
    )
}

/// The same, watched: what [`probe`](crate::trace::probe()) reads is what happened.
pub(in crate::trace) fn radiance_with<R: Recorder>(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    samples: &[SampleId],
    values: &mut [Vec3],
    workspace: &mut Workspace,
    recorder: &mut R,
) -> RayCounts {
    let kept = (&Planes::together(), PlaneSet::ALL);
    let never = &|| false;
    let counts = evaluate(
        world, camera, settings, samples, kept, values, workspace, recorder, never,
    );
    counts.unwrap_or_default()
}

#[expect(
    clippy::too_many_arguments,
    reason = "all that a sample depends on, and where it goes"
)]
fn evaluate<R: Recorder>(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    samples: &[SampleId],
    (planes, wanted): (&Planes, PlaneSet),
    values: &mut [Vec3],
    workspace: &mut Workspace,
    recorder: &mut R,
    stopped: &dyn Fn() -> bool,
) -> Option<RayCounts> {
    let expected = wanted.rows(planes.count()) * samples.len();
    assert_eq!(
        expected,
        values.len(),
        "one value for each sample and wanted plane"
    );
    values.fill(Vec3::ZERO);
    let Workspace {
        camera_rays,
        paths,
        next,
        known,
        hits,
        behind,
        visible_lights,
        vertices,
        shadow_rays,
    } = workspace;
    let cone = Cone::of_pixel(camera, settings.size);
    if next.rays.len() > paths.rays.len() {
        // Written over: to make them anew takes as long.
        std::mem::swap(paths, next);
    }
    let image_plane = camera.image_plane(settings.size);
    camera_rays.of(world, &image_plane, settings, samples, paths.of_camera());
    let (known_now, mut hits_now) = known.by_bounce(samples.len());
    let mut batch = Batch {
        world,
        settings,
        samples,
        pixels: camera_rays.asking().pixels(),
        planes,
        wanted,
        values,
        counts: RayCounts::default(),
        known: known_now,
        recorder,
        stopped,
        crossings: 0,
    };
    for ray in &paths.rays {
        batch.recorder.camera_ray(ray);
    }
    behind.begin();
    if batch.lights_are_visible() {
        visible_lights.of(&world.lights);
    }
    while !paths.rays.is_empty() {
        batch.find_hits(paths, hits_now, behind);
        next.clear();
        batch.find_vertices(paths, cone, hits_now, visible_lights, vertices);
        if settings.features.shading && !batch.add_direct_light(vertices, shadow_rays) {
            known.forget();
            return None;
        }
        batch.continue_paths(vertices, paths, next);
        std::mem::swap(paths, next);
        hits_now = &mut *hits;
        batch.known.next_bounce(paths);
        batch.recorder.next_bounce();
        if !paths.rays.is_empty() && stopped() {
            known.forget();
            return None;
        }
    }
    let (counts, found) = (batch.counts, batch.known.found());
    known.keep(found);
    Some(counts)
}

/// What the stages of a batch share.
pub(super) struct Batch<'a, R> {
    pub world: &'a World,
    pub settings: &'a RenderSettings,
    pub samples: &'a [SampleId],
    /// Of each sample what its pixel's random numbers come from.
    pub pixels: &'a [u32],
    pub planes: &'a Planes,
    pub wanted: PlaneSet,
    /// Plane by plane of those that are wanted, one for each sample.
    values: &'a mut [Vec3],
    pub counts: RayCounts,
    pub known: KnownNow<'a>,
    pub recorder: &'a mut R,
    pub stopped: &'a dyn Fn() -> bool,
    /// How many rays have gone straight on behind a hit.
    pub crossings: u32,
}

impl<R: Recorder> Batch<'_, R> {
    /// The random numbers of a sample of the batch, and its index in its pixel.
    pub(in crate::trace) fn sampler(&self, sample: u32) -> (Sampler, u64) {
        let RenderSettings {
            sequence, jitter, ..
        } = *self.settings;
        let pixel = self.pixels[sample as usize];
        let index = self.samples[sample as usize].index;
        (Sampler::of_pixel(pixel, sequence, jitter), index)
    }

    /// Turns every hit into a vertex, and adds what shines by itself: surfaces, visible lights and the background.
    fn find_vertices(
        &mut self,
        paths: &Paths,
        cone: Cone,
        hits: &[Option<Hit>],
        visible: &mut VisibleLights,
        vertices: &mut Vertices,
    ) {
        vertices.clear(cone);
        let lights_are_visible = self.lights_are_visible();
        if !lights_are_visible && paths.states.is_empty() {
            // Most rays of most pictures.
            for (i, (ray, hit)) in paths.rays.iter().zip(hits).enumerate() {
                let number = i as u32;
                if let Some(hit) = hit {
                    vertices.push_from_camera(number, *hit);
                } else if self.wants_own() {
                    let background = self.background(ray.direction, 0);
                    self.recorder.met_background(number, background);
                    self.add(number, OWN, Adding::Path(number), background);
                }
            }
        } else {
            self.sort_hits(paths, cone, hits, lights_are_visible, visible, vertices);
        }
        vertices.look_up(self.world, self.settings, &paths.rays);
        if R::LISTENS {
            for (i, number) in vertices.numbers.iter().enumerate() {
                let surface = vertices.surface(i);
                self.recorder
                    .met_surface(*number, &vertices.hits[i], &surface);
            }
        }
        let shines = self.world.needs.emission || !self.settings.features.shading;
        if shines && self.wants_own() {
            self.add_emission(vertices);
        }
    }

    /// Whether rays meet lights. Classic lights are nowhere to be seen, as in simple Phong ray tracers.
    fn lights_are_visible(&self) -> bool {
        self.world.needs.visible_lights && self.settings.lighting == Lighting::Physical
    }

    /// Whether what shines by itself is asked for. While a light is edited it is there already.
    fn wants_own(&self) -> bool {
        self.wanted.has(OWN)
    }

    /// Adds what paths meet that is no surface, and takes the hits of the others.
    fn sort_hits(
        &mut self,
        paths: &Paths,
        cone: Cone,
        hits: &[Option<Hit>],
        lights_are_visible: bool,
        visible: &mut VisibleLights,
        vertices: &mut Vertices,
    ) {
        for (i, (ray, hit)) in paths.rays.iter().zip(hits).enumerate() {
            let number = i as u32;
            let path = paths.get(i, cone);
            if lights_are_visible
                && let Some((i, t, light)) =
                    self.visible_light(&path, ray, hit.as_ref(), visible.near(ray))
            {
                let lights = &self.world.lights;
                self.recorder
                    .met_light(number, lights.parallelograms[i].id, t, light);
                let plane = self.planes.of_light(lights.first_parallelogram() + i);
                let value = path.throughput * light;
                self.add(path.sample, plane, Adding::Path(number), value);
                continue;
            }
            let Some(hit) = *hit else {
                if self.wants_own() {
                    let background = self.background(ray.direction, path.bounces);
                    self.recorder.met_background(number, background);
                    let value = path.throughput * background;
                    self.add(path.sample, OWN, Adding::Path(number), value);
                }
                continue;
            };
            vertices.push(number, path, hit);
        }
    }

    /// What surfaces send back by themselves: their emission, or kd where shading is off.
    fn add_emission(&mut self, vertices: &Vertices) {
        let shines = match (self.settings.features.shading, self.settings.lighting) {
            (false, _) => &vertices.diffuse,
            (true, Lighting::Physical) => &vertices.emission,
            (true, Lighting::Classic) => return,
        };
        for i in 0..vertices.len() {
            let path = vertices.path(i);
            let (opacity, radiance) = (vertices.opacity[i], shines.get(i));
            if opacity == 0.0 {
                continue;
            }
            let number = vertices.numbers[i];
            self.recorder.shines(number, opacity * radiance);
            let value = path.throughput * opacity * radiance;
            self.add(path.sample, OWN, Adding::Path(number), value);
        }
    }

    fn add(&mut self, sample: u32, plane: usize, by: Adding, value: Vec3) {
        if let Some(row) = self.wanted.row(plane) {
            self.add_to(row, sample, by, value);
        }
    }

    /// Adds to a plane that is wanted, this one of them.
    #[inline(always)]
    pub(super) fn add_to(&mut self, row: usize, sample: u32, by: Adding, value: Vec3) {
        self.values[row * self.samples.len() + sample as usize] += value;
        self.recorder.added(by, value);
    }

    /// What a ray carries that meets nothing, after so many mirror bounces.
    fn background(&self, direction: Vec3, bounces: u32) -> Vec3 {
        let environment = &self.world.environment;
        match environment.backdrop {
            Some(backdrop) if bounces == 0 => backdrop,
            _ if self.settings.features.environment => environment.radiance(direction),
            _ => environment.background,
        }
    }

    /// The nearest light that a path's ray meets before its hit, of those that are visible: its number among the
    /// parallelograms, where, and its radiance.
    fn visible_light(
        &self,
        path: &Path,
        ray: &Ray,
        hit: Option<&Hit>,
        visible: &[u32],
    ) -> Option<(usize, f32, Vec3)> {
        let behind = path.after.map_or(0.0, |hit| hit.t);
        let mut nearest = hit.map_or(f32::INFINITY, |hit| hit.t * LIGHT_BEFORE_SURFACE);
        let mut met = None;
        let lights = &self.world.lights;
        for i in visible.iter().map(|number| *number as usize) {
            let light = &lights.parallelograms[i];
            let origin = lights.in_rest_frame(light.id, ray.origin, ray.time);
            if let Some((t, radiance)) = light.meet(origin, ray.direction)
                && t > behind
                && t < nearest
            {
                nearest = t;
                met = Some((i, t, radiance));
            }
        }
        met
    }
}
