//! Direct light: shadow rays to points of the lights, gathered for a whole batch, then traced.

use super::lights::{LightPoint, MIDDLE, sample_count};
use super::radiance::{Batch, Path, Shadow, Workspace};
use super::recorder::{LightKind, Recorder};
use super::sampler::Purpose;
use super::shading::reflected;
use super::{Lights, Surface};
use crate::bvh::{Aggregate, Hit, Ray};
use crate::scene::{Lighting, RenderSettings};
use glam::Vec3;

/// A shadow ray ends this much before its light, as a fraction of the distance: a light that lies
/// in a surface is not hidden by it. 64 units of rounding; t itself is good to a few.
const SHORT_OF_THE_LIGHT: f32 = 1.0 - 64.0 * f32::EPSILON;

impl<R: Recorder> Batch<'_, R> {
    /// Adds a shadow ray for every light point that can add something; `weight` is the path's
    /// throughput times the surface's opacity.
    pub(super) fn gather_direct_light(
        &mut self,
        path: &Path,
        surface: &Surface,
        weight: Vec3,
        workspace: &mut Workspace,
    ) {
        let world = self.world;
        let lights = &*world.lights;
        let lighting = self.settings.lighting;
        let weight = match lighting {
            Lighting::Physical => weight,
            Lighting::Classic => weight / lights.count().max(1) as f32,
        };
        if weight == Vec3::ZERO {
            return;
        }
        let seen_from = |id| lights.in_rest_frame(id, surface.point.position, path.time);
        for light in &lights.points {
            self.recorder.light(LightKind::Point, light.id);
            let point = light.point(seen_from(light.id), lighting);
            self.gather_point(path, surface, point, weight, workspace);
        }
        for light in &lights.directionals {
            self.recorder.light(LightKind::Directional, light.id);
            if light.disc.is_none() || !self.settings.features.soft_shadows {
                self.gather_point(path, surface, Some(light.middle()), weight, workspace);
                continue;
            }
            let count = (light.samples, light.solid_angle());
            self.gather_area(path, surface, light.id, count, weight, workspace, |u| {
                Some(light.point(u, lighting))
            });
        }
        for (i, light) in lights.segments.iter().enumerate() {
            self.recorder.light(LightKind::Segment, light.id);
            let size = (light.ends[1] - light.ends[0]).length();
            let count = (light.samples, size);
            let at = seen_from(light.id);
            let first = workspace.shadows.len();
            let frame = workspace.light_frames.segment(i);
            let point = |u: [f32; 2]| match &frame {
                Some(frame) => light.point_for(frame, surface, at, u[0]),
                None => light.point(at, u[0], lighting),
            };
            self.gather_area(path, surface, light.id, count, weight, workspace, point);
            if let Some(expected) = workspace.near_lights.segment(i, light, surface, at) {
                self.gather_near(path, count, weight * expected, first, workspace);
            }
        }
        for (i, light) in lights.parallelograms.iter().enumerate() {
            self.recorder.light(LightKind::Parallelogram, light.id);
            let count = (light.samples, light.area_normal().length());
            let at = seen_from(light.id);
            let first = workspace.shadows.len();
            let frame = workspace.light_frames.parallelogram(i);
            let point = |u| match &frame {
                Some(frame) => light.point_for(frame, surface, at, u),
                None => light.point(at, u, lighting),
            };
            self.gather_area(path, surface, light.id, count, weight, workspace, point);
            if let Some(expected) = workspace.near_lights.parallelogram(i, light, surface, at) {
                self.gather_near(path, count, weight * expected, first, workspace);
            }
        }
    }

    /// Several points of one light: `samples` of them at the first hit, stratified together over
    /// all samples of the pixel; one at later hits, and its middle where there are no soft shadows.
    #[expect(
        clippy::too_many_arguments,
        reason = "a light's numbers, a path's and the arrays"
    )]
    fn gather_area(
        &mut self,
        path: &Path,
        surface: &Surface,
        id: u64,
        (samples, size): (u32, f32),
        weight: Vec3,
        workspace: &mut Workspace,
        point: impl Fn([f32; 2]) -> Option<LightPoint>,
    ) {
        let features = &self.settings.features;
        if !features.soft_shadows {
            self.gather_point(path, surface, point(MIDDLE), weight, workspace);
            return;
        }
        let count = if path.first {
            sample_count(samples, size, features.scale_light_samples)
        } else {
            1
        };
        let (sampler, index) = self.sampler(path.sample);
        let weight = weight / count as f32;
        for i in 0..u64::from(count) {
            let index = index * u64::from(count) + i;
            let [u, v, ..] = sampler.block(index, Purpose::Light(id), path.name);
            let point = point([u, v]);
            if let Some(point) = &point {
                self.recorder.light_place(point, count);
            }
            self.gather_point(path, surface, point, weight, workspace);
        }
    }

    /// The light points whose shadow rays begin with the `first` are those of a lamp close by.
    fn gather_near(
        &self,
        path: &Path,
        (samples, size): (u32, f32),
        expected: Vec3,
        first: usize,
        workspace: &mut Workspace,
    ) {
        let features = &self.settings.features;
        if samples == 0 || !features.shadows {
            return;
        }
        let points = if path.first {
            sample_count(samples, size, features.scale_light_samples)
        } else {
            1
        };
        let shadows = first..workspace.shadows.len();
        (workspace.near_lights).found(path.sample, points, expected, shadows);
    }

    fn gather_point(
        &mut self,
        path: &Path,
        surface: &Surface,
        point: Option<LightPoint>,
        weight: Vec3,
        workspace: &mut Workspace,
    ) {
        let Some(point) = point else { return };
        let value = weight * reflected(surface, &point, self.settings.lighting);
        self.recorder.light_sample(surface, &point);
        if value == Vec3::ZERO {
            return;
        }
        if !self.settings.features.shadows {
            self.add(path.sample, value);
            return;
        }
        workspace.shadows.push(Shadow {
            sample: path.sample,
            value,
        });
        let ray = shadow_ray(&self.world.aggregate, surface, &point, path.time);
        self.recorder.shadow_ray(&ray);
        workspace.shadow_rays.push(ray);
    }

    /// Traces all shadow rays of the batch and adds what arrives.
    pub(super) fn add_arriving_light(&mut self, workspace: &mut Workspace) {
        self.counts.shadow += workspace.shadow_rays.len() as u64;
        if self.settings.features.transparency && self.world.needs.transparency {
            workspace.occluded.clear();
            for (shadow, ray) in workspace.shadows.iter().zip(&workspace.shadow_rays) {
                self.recorder.next_shadow();
                let transmittance = self.transmittance(ray);
                self.recorder.arrived(transmittance);
                let value = shadow.value * transmittance;
                workspace.occluded.push(value == Vec3::ZERO);
                self.add(shadow.sample, value);
            }
            workspace.compare_near_lights();
            return;
        }
        let aggregate = &self.world.aggregate;
        aggregate.occlusions(&workspace.shadow_rays, &mut workspace.occluded);
        for (shadow, occluded) in workspace.shadows.iter().zip(&workspace.occluded) {
            self.recorder.next_shadow();
            if !occluded {
                self.recorder.arrived(Vec3::ONE);
                self.add(shadow.sample, shadow.value);
            }
        }
        workspace.compare_near_lights();
    }

    /// What a shadow ray lets through: the product of `(1-d) · lerp(1, kd, d)` over its crossings.
    fn transmittance(&mut self, ray: &Ray) -> Vec3 {
        let mut transmittance = Vec3::ONE;
        let mut after: Option<Hit> = None;
        loop {
            let aggregate = &self.world.aggregate;
            let hit = match &after {
                None => aggregate.closest_hit(ray),
                Some(after) => aggregate.next_crossing(ray, after),
            };
            let Some(hit) = hit else { return transmittance };
            // The finest level: a shadow ray's own width is not known.
            let surface = Surface::at(self.world, self.settings, ray, 0.0, &hit);
            self.recorder.crossed(&hit, &surface);
            let d = surface.opacity;
            transmittance *= (1.0 - d) * Vec3::ONE.lerp(surface.diffuse, d);
            if transmittance == Vec3::ZERO {
                return Vec3::ZERO;
            }
            after = Some(hit);
        }
    }
}

/// From a surface to a light point, ending just before it.
fn shadow_ray(aggregate: &Aggregate, surface: &Surface, point: &LightPoint, time: f32) -> Ray {
    let origin = aggregate.leave(&surface.point, point.direction);
    if point.distance == f32::INFINITY {
        return Ray {
            origin,
            direction: point.direction,
            t_max: f32::INFINITY,
            time,
        };
    }
    // From the moved origin to the light itself, so that the ray still ends there.
    let to_light = point.distance * point.direction - (origin - surface.point.position);
    Ray {
        origin,
        direction: to_light,
        t_max: SHORT_OF_THE_LIGHT,
        time,
    }
}

impl Lights {
    /// How many shadow rays the area light with this `SceneId` gets at a first hit; `None` where there
    /// is no such light.
    pub fn samples_of(&self, id: u64, settings: &RenderSettings) -> Option<u32> {
        let directional =
            (self.directionals.iter()).map(|light| (light.id, light.samples, light.solid_angle()));
        let segments = self.segments.iter().map(|light| {
            let length = (light.ends[1] - light.ends[0]).length();
            (light.id, light.samples, length)
        });
        let parallelograms = self.parallelograms.iter().map(|light| {
            let area = light.area_normal().length();
            (light.id, light.samples, area)
        });
        let mut all = directional.chain(segments).chain(parallelograms);
        let (_, samples, size) = all.find(|(of, ..)| *of == id)?;
        Some(sample_count(
            samples,
            size,
            settings.features.scale_light_samples,
        ))
    }

    /// How many there are of all kinds.
    pub fn count(&self) -> usize {
        self.points.len()
            + self.directionals.len()
            + self.segments.len()
            + self.parallelograms.len()
    }
}
