//! What is written down while samples are evaluated: every ray of theirs.

use super::ray_tree::{Crossing, LightSample, RayEnd, RayHit, RayKind, RayTree, TracedRay};
use crate::bvh::{Counters, Hit, Ray};
use crate::scene::{Lighting, RenderSettings};
use crate::trace::stages::paths::Path;
use crate::trace::stages::recorder::{Adding, LitPoint, Recorder, Way};
use crate::trace::surfaces::shading::{cosines, reflected};
use crate::trace::surfaces::transmittance::crossings;
use crate::trace::{Surface, World};
use glam::Vec3;

/// What a recorder has written so far, and where the batch is.
pub(super) struct Recording<'a> {
    world: &'a World,
    settings: &'a RenderSettings,
    pub rays: Vec<TracedRay>,
    order: Vec<u32>,
    sample: u32,
    /// Rays of this bounce's paths, of the next one's, and of this bounce's points of lights.
    paths: Vec<u32>,
    next: Vec<u32>,
    points: Vec<u32>,
}

impl<'a> Recording<'a> {
    pub fn new(world: &'a World, settings: &'a RenderSettings) -> Self {
        Self {
            world,
            settings,
            rays: Vec::new(),
            order: Vec::new(),
            sample: 0,
            paths: Vec::new(),
            next: Vec::new(),
            points: Vec::new(),
        }
    }

    pub fn start_sample(&mut self, sample: u32) {
        self.sample = sample;
        self.paths.clear();
        self.next.clear();
        self.points.clear();
    }

    /// A ray that leaves the surface which the `parent` met, or the camera.
    fn push(&mut self, ray: &Ray, kind: RayKind, parent: Option<u32>) -> u32 {
        let before = parent.map(|parent| &self.rays[parent as usize]);
        let ray = TracedRay {
            sample: self.sample,
            parent,
            kind,
            depth: before.map_or(0, |before| before.depth + 1),
            from: before.and_then(|before| before.hit).map(|hit| hit.object),
            origin: ray.origin,
            direction: ray.direction,
            after: 0.0,
            t_max: ray.t_max,
            time: ray.time,
            starts_on: ray.starts_on,
            t: ray.t_max,
            end: RayEnd::Background,
            hit: None,
            met_light: None,
            light: None,
            crossings: Vec::new(),
            transmittance: Vec3::ONE,
            count: 1,
            chance: 1.0,
            weight: Vec3::ONE,
            radiance: Vec3::ZERO,
            carried: Vec3::ZERO,
            added: Vec3::ZERO,
            cost: Default::default(),
        };
        self.rays.push(ray);
        self.rays.len() as u32 - 1
    }

    /// The ray of a path of this bounce, or to a point of a light.
    fn number_of(&self, which: Adding) -> u32 {
        match which {
            Adding::Path(path) => self.paths[path as usize],
            Adding::Light(point) => self.points[point as usize],
        }
    }

    fn ray_of(&mut self, which: Adding) -> &mut TracedRay {
        let number = self.number_of(which);
        &mut self.rays[number as usize]
    }

    /// What is written down of a hit.
    fn hit(&self, hit: &Hit, surface: &Surface) -> RayHit {
        let object = &self.world.objects[hit.instance as usize];
        RayHit {
            object: object.id,
            instance: hit.instance,
            triangle: hit.triangle,
            t: hit.t,
            barycentric: [hit.u, hit.v],
            position: surface.point.position,
            geometric_normal: surface.geometric_normal,
            normal: surface.normal,
            to_viewer: surface.to_viewer,
            material: object.material,
            diffuse: surface.diffuse,
            specular: surface.specular,
            mirror: surface.mirror,
            shininess: surface.shininess,
            opacity: surface.opacity,
            emission: surface.emission,
        }
    }

    /// Adds up what comes back along each ray, and looks up what the tracer did not have to know.
    pub fn finish(mut self, mut tree: RayTree) -> RayTree {
        for i in (0..self.rays.len()).rev() {
            let ray = &mut self.rays[i];
            ray.carried = match &ray.light {
                Some(light) => ray.weight * light.reflected * ray.transmittance,
                None => ray.weight * ray.radiance,
            };
            let (parent, carried) = (ray.parent, ray.carried);
            if let Some(parent) = parent {
                self.rays[parent as usize].radiance += carried;
            }
        }
        tree.rays = std::mem::take(&mut self.rays);
        tree.order = std::mem::take(&mut self.order);
        for i in 0..tree.rays.len() {
            let mut cost = Counters::default();
            let found = tree.retrace(self.world, self.settings, i as u32, &mut cost);
            tree.rays[i].cost = cost.into();
            if tree.rays[i].asks_what_passes(self.world, self.settings) {
                let crossings = crossings(self.world, self.settings, &tree.rays[i].ray());
                let crossings = crossings.iter().map(|(hit, surface)| Crossing {
                    object: self.world.objects[hit.instance as usize].id,
                    triangle: hit.triangle,
                    t: hit.t,
                    diffuse: surface.diffuse,
                    opacity: surface.opacity,
                });
                tree.rays[i].crossings = crossings.collect();
            }
            if tree.rays[i].end == RayEnd::Blocked
                && let Some(hit) = found
            {
                let ray = tree.rays[i].ray();
                let surface = Surface::at(self.world, self.settings, &ray, 0.0, &hit);
                tree.rays[i].t = hit.t;
                tree.rays[i].hit = Some(self.hit(&hit, &surface));
            }
        }
        tree
    }
}

impl Recorder for Recording<'_> {
    fn camera_ray(&mut self, ray: &Ray) {
        let ray = self.push(ray, RayKind::Camera, None);
        self.paths.push(ray);
    }

    fn next_bounce(&mut self) {
        std::mem::swap(&mut self.paths, &mut self.next);
        self.next.clear();
        self.points.clear();
    }

    fn met_background(&mut self, path: u32, radiance: Vec3) {
        self.ray_of(Adding::Path(path)).radiance = radiance;
    }

    fn met_light(&mut self, path: u32, id: u64, t: f32, radiance: Vec3) {
        let ray = self.ray_of(Adding::Path(path));
        ray.end = RayEnd::Light;
        ray.t = t;
        ray.radiance = radiance;
        ray.met_light = Some(id);
    }

    fn met_surface(&mut self, path: u32, hit: &Hit, surface: &Surface) {
        let hit = self.hit(hit, surface);
        let ray = self.ray_of(Adding::Path(path));
        ray.end = RayEnd::Surface;
        ray.t = hit.t;
        ray.hit = Some(hit);
    }

    fn shines(&mut self, path: u32, radiance: Vec3) {
        self.ray_of(Adding::Path(path)).radiance = radiance;
    }

    fn light_sample(&mut self, point: u32, lit: &LitPoint) {
        let LitPoint {
            surface,
            point: of_light,
            ..
        } = *lit;
        let kind = match lit.count {
            None => RayKind::Shadow,
            Some(_) => RayKind::LightSample,
        };
        let parent = self.paths[lit.path as usize];
        let ray = Ray {
            origin: surface.point.position,
            direction: of_light.direction,
            t_max: of_light.distance,
            time: self.rays[parent as usize].time,
            starts_on: surface.point.triangle,
        };
        let index = self.push(&ray, kind, Some(parent));
        let lighting = self.settings.lighting;
        let lights = match lighting {
            Lighting::Physical => 1,
            Lighting::Classic => self.world.lights.count().max(1),
        };
        let count = lit.count.unwrap_or(1);
        let [n_dot_l, r_dot_v] = cosines(surface, of_light.direction);
        let light = LightSample {
            kind: lit.kind,
            id: lit.id,
            place: of_light.place,
            density: of_light.density,
            direction: of_light.direction,
            distance: of_light.distance,
            arriving: of_light.arriving,
            n_dot_l,
            r_dot_v,
            reflected: reflected(surface, &of_light, lighting),
        };
        let ray = &mut self.rays[index as usize];
        ray.light = Some(light);
        ray.end = RayEnd::Unlit;
        ray.count = count;
        ray.weight = Vec3::splat(surface.opacity / lights as f32 / count as f32);
        ray.transmittance = Vec3::ZERO;
        // Those of which nothing comes have a number, too.
        self.points.resize(point as usize, u32::MAX);
        self.points.push(index);
    }

    fn left_to_chance(&mut self, point: u32, chance: f32, is_asked: bool) {
        let ray = self.ray_of(Adding::Light(point));
        ray.chance = chance;
        if is_asked {
            ray.weight /= chance;
        } else {
            ray.end = RayEnd::LeftOut;
        }
    }

    fn shadow_ray(&mut self, point: u32, shadow: &Ray) {
        let ray = self.ray_of(Adding::Light(point));
        ray.origin = shadow.origin;
        ray.direction = shadow.direction;
        ray.t_max = shadow.t_max;
        ray.t = shadow.t_max;
        ray.end = RayEnd::Blocked;
    }

    fn continued(&mut self, path: u32, ray: &Ray, next: &Path, way: Way, count: u32, weight: f32) {
        let kind = match way {
            Way::Mirror => RayKind::Mirror,
            Way::Gloss => RayKind::Gloss,
            Way::Straight => RayKind::Transmission,
            Way::Translucent => RayKind::Translucency,
        };
        let parent = self.paths[path as usize];
        let index = self.push(ray, kind, Some(parent));
        let share = weight / count as f32;
        let surface = self.rays[parent as usize].hit;
        let ray = &mut self.rays[index as usize];
        ray.count = count;
        ray.chance = 1.0 / weight;
        if let Some(surface) = surface {
            ray.weight = match way {
                Way::Mirror | Way::Gloss => surface.mirror * (surface.opacity * share),
                Way::Straight | Way::Translucent => Vec3::splat((1.0 - surface.opacity) * share),
            };
        }
        ray.after = next.after.map_or(0.0, |hit| hit.t);
        self.next.push(index);
    }

    fn arrived(&mut self, point: u32, transmittance: Vec3) {
        let ray = self.ray_of(Adding::Light(point));
        ray.transmittance = transmittance;
        if transmittance != Vec3::ZERO {
            ray.end = RayEnd::Arrived;
        }
        ray.radiance = ray
            .light
            .map_or(Vec3::ZERO, |light| light.arriving * transmittance);
    }

    fn added(&mut self, by: Adding, value: Vec3) {
        let number = self.number_of(by);
        let ray = &mut self.rays[number as usize];
        if ray.end == RayEnd::Unlit {
            // Only what is not shadowed adds something without having been traced.
            ray.end = RayEnd::Unshadowed;
            ray.transmittance = Vec3::ONE;
            ray.radiance = ray.light.map_or(Vec3::ZERO, |light| light.arriving);
        }
        ray.added += value;
        self.order.push(number);
    }
}
