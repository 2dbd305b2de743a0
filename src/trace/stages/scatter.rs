//! How paths go on: mirrors, glossy reflections, transparency and translucency.

use super::paths::{Path, Paths};
use super::radiance::Batch;
use super::recorder::{Recorder, Way};
use super::vertices::Vertices;
use crate::bvh::{Hit, Ray};
use crate::trace::Surface;
use crate::trace::math::disc::offset_direction;
use crate::trace::random::sampler::{Purpose, mix};
use glam::Vec3;

/// A path that both reflects and transmits goes on as two while its largest throughput exceeds
/// this, then as one, chosen by chance: at 1/8 a stack of glass makes eight paths, not 2^depth.
const SPLIT_ABOVE: f32 = 0.125;

/// Of a path that has gone on as one, what carries less than this goes on by chance, and the more weighs what does: behind
/// ten thousand panes there is nothing to be seen, and finding it out should not take ten thousand rays, each to a light
/// behind as many.
pub(in crate::trace) const FAINT: f32 = 1.0 / 4096.0;

/// After this many scatterings in translucent surfaces a path ends: between fully transparent,
/// scattering walls it would go on for ever.
const MAX_SCATTERINGS: u32 = 256;

/// A vertex that paths leave, and the ray that met it.
struct Departure {
    /// Number of the path that met it.
    number: u32,
    path: Path,
    ray: Ray,
    hit: Hit,
    surface: Surface,
}

impl<R: Recorder> Batch<'_, R> {
    /// Adds the paths that leave the vertices: what each reflects and what it lets through.
    pub(super) fn continue_paths(&mut self, vertices: &Vertices, paths: &Paths, next: &mut Paths) {
        if !vertices.may_go_on() {
            return;
        }
        for i in 0..vertices.len() {
            let path = vertices.path(i);
            let reflects = self.reflectance(vertices, i);
            let transmits = (path.throughput * (1.0 - vertices.opacity[i])).max_element();
            // Neither of most surfaces.
            if !(reflects > 0.0 || transmits > 0.0) {
                continue;
            }
            let vertex = Departure {
                number: vertices.numbers[i],
                path,
                ray: paths.rays[vertices.numbers[i] as usize],
                hit: vertices.hits[i],
                surface: vertices.surface(i),
            };
            self.depart(&vertex, reflects, transmits, next);
        }
    }

    /// The largest channel of what a path carries on from a mirror; 0 where none is looked into.
    fn reflectance(&self, vertices: &Vertices, i: usize) -> f32 {
        let path = vertices.path(i);
        let features = &self.settings.features;
        let mirrors =
            features.shading && features.mirrors && path.bounces < self.settings.max_depth;
        if !mirrors {
            return 0.0;
        }
        (path.throughput * vertices.opacity[i] * vertices.mirror.get(i)).max_element()
    }

    fn depart(&mut self, vertex: &Departure, reflects: f32, transmits: f32, next: &mut Paths) {
        let Departure { path, surface, .. } = vertex;
        if surface.opacity == 0.0 {
            self.pass(vertex, next);
            return;
        }
        let splits = path.throughput.max_element() > SPLIT_ABOVE;
        let is_faint = !splits && reflects.max(transmits) < FAINT;
        let does_both = reflects > 0.0 && transmits > 0.0;
        if splits || !(is_faint || does_both) {
            if reflects > 0.0 {
                self.reflect(vertex, 1.0, next);
            }
            self.transmit(vertex, 1.0, next);
            return;
        }
        let (sampler, index) = self.sampler(path.sample);
        let [which, whether, ..] = sampler.block(index, Purpose::Branch, path.name);
        let mut weight = 1.0;
        if is_faint {
            let chance = reflects.max(transmits) / FAINT;
            // A number tells no smaller chances.
            if chance < f32::EPSILON || whether >= chance {
                return;
            }
            weight = 1.0 / chance;
        }
        let share = reflects / (reflects + transmits);
        if which < share {
            self.reflect(vertex, weight / share, next);
        } else {
            self.transmit(vertex, weight / (1.0 - share), next);
        }
    }

    /// The same path goes on behind a surface that is not there: it is no first hit, scatters nothing and names no path,
    /// so that the picture is the one without it, bit for bit.
    fn pass(&mut self, vertex: &Departure, next: &mut Paths) {
        let path = Path {
            after: Some(vertex.hit),
            ..vertex.path
        };
        self.go_on(vertex, vertex.ray, path, Way::Straight, 1, 1.0, next);
        self.counts.transmission += 1;
    }

    fn reflect(&mut self, vertex: &Departure, weight: f32, next: &mut Paths) {
        let Departure {
            path, surface, hit, ..
        } = vertex;
        let throughput = path.throughput * surface.mirror * (surface.opacity * weight);
        let aggregate = &self.world.aggregate;
        let origin = aggregate.leave(&surface.point, surface.geometric_normal);
        let mirrored = surface.mirrored();
        let glossy = self.settings.features.glossy;
        let count = if glossy && path.first {
            self.settings.gloss_samples.clamp(1, 1000)
        } else {
            1
        };
        for i in 0..count {
            let direction = if glossy {
                let u = self.numbers(path, Purpose::Gloss, count, i);
                let radius = 1.0 / surface.shininess;
                offset_direction(mirrored, surface.geometric_normal, radius, u)
                    .unwrap_or_else(|| surface.mirrored_geometric())
            } else {
                mirrored
            };
            let spread = if glossy { 1.0 / surface.shininess } else { 0.0 };
            let path = Path {
                throughput: throughput / count as f32,
                cone: path.cone.reflected(hit.t, spread),
                name: child(path.name, 1, i),
                bounces: path.bounces + 1,
                first: false,
                after: None,
                crossing: 0,
                ..*path
            };
            let way = if glossy { Way::Gloss } else { Way::Mirror };
            let ray = spawned(origin, direction, vertex);
            self.go_on(vertex, ray, path, way, count, weight, next);
        }
        self.counts.mirror += u64::from(count);
    }

    /// Adds the path through the surface, if it lets anything through; `weight` corrects for chance.
    fn transmit(&mut self, vertex: &Departure, weight: f32, next: &mut Paths) {
        let Departure {
            path, surface, hit, ..
        } = vertex;
        let throughput = path.throughput * ((1.0 - surface.opacity) * weight);
        if throughput == Vec3::ZERO {
            return;
        }
        if !self.settings.features.translucency {
            // The same ray, from behind its hit: nothing is spawned, so no layer is met twice or
            // missed, however thin.
            let path = Path {
                throughput,
                name: child(path.name, 2, 0),
                first: false,
                after: Some(*hit),
                ..*path
            };
            self.go_on(vertex, vertex.ray, path, Way::Straight, 1, weight, next);
            self.counts.transmission += 1;
            return;
        }
        if path.scatterings >= MAX_SCATTERINGS {
            return;
        }
        let count = if path.first {
            self.settings.translucency_samples.clamp(1, 1000)
        } else {
            1
        };
        let straight = -surface.to_viewer;
        let far_side = -surface.geometric_normal;
        let origin = self.world.aggregate.leave(&surface.point, far_side);
        for i in 0..count {
            let u = self.numbers(path, Purpose::Translucency, count, i);
            let radius = 1.0 / surface.shininess;
            let direction = offset_direction(straight, far_side, radius, u).unwrap_or(straight);
            let path = Path {
                throughput: throughput / count as f32,
                cone: path.cone.reflected(hit.t, 1.0 / surface.shininess),
                name: child(path.name, 2, i),
                scatterings: path.scatterings + 1,
                first: false,
                after: None,
                crossing: 0,
                ..*path
            };
            let ray = spawned(origin, direction, vertex);
            self.go_on(vertex, ray, path, Way::Translucent, count, weight, next);
        }
        self.counts.transmission += u64::from(count);
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "where from, what, and how it is counted"
    )]
    fn go_on(
        &mut self,
        from: &Departure,
        ray: Ray,
        mut path: Path,
        way: Way,
        count: u32,
        weight: f32,
        next: &mut Paths,
    ) {
        if path.after.is_some() && path.crossing == 0 {
            self.crossings += 1;
            path.crossing = self.crossings;
        }
        (self.recorder).continued(from.number, &ray, &path, way, count, weight);
        next.push(ray, path);
    }

    /// Two numbers for ray `i` of `count` at this hit, stratified over all samples of the pixel.
    fn numbers(&self, path: &Path, purpose: Purpose, count: u32, i: u32) -> [f32; 2] {
        let (sampler, index) = self.sampler(path.sample);
        let index = index * u64::from(count) + u64::from(i);
        let [u, v, ..] = sampler.block(index, purpose, path.name);
        [u, v]
    }
}

/// A ray that starts at the surface that another met.
fn spawned(origin: Vec3, direction: Vec3, vertex: &Departure) -> Ray {
    Ray {
        origin,
        direction,
        t_max: f32::INFINITY,
        time: vertex.ray.time,
        starts_on: vertex.hit.id(),
    }
}

/// The name of a path's continuation: which way it went, and the how-many-eth of several.
fn child(name: u32, way: u32, i: u32) -> u32 {
    mix(name, way | i << 2)
}
