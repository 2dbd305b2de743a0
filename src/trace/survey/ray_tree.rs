//! What samples did, ray by ray: data that gizmos, the ray inspector and files read.

use crate::bvh::{Counters, Hit, Ray, TriangleId, Visitor};
use crate::scene::RenderSettings;
use crate::trace::World;
use crate::trace::light_sampling::lamp::LightKind;
use crate::trace::surfaces::transmittance::{crossings, through};
use glam::{UVec2, Vec3};
use serde::Serialize;

/// Every ray of some samples of one pixel, parents before their children.
///
/// # What the numbers mean
/// The radiance that comes back along a ray is what it met plus, over its children, `weight ×
/// radiance`: so `carried` of all children and the surface's own light make the parent's `radiance`,
/// and the camera ray's `radiance` is the sample's value but for rounding. `added` is what the ray
/// put into the sample's value by itself, multiplied by everything on its way to the camera; summed
/// in the order in which the tracer added it ([`Self::sums`]) it is the value bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RayTree {
    /// (0, 0) is the top left pixel.
    pub pixel: UVec2,
    /// Whether the camera has a lens.
    #[serde(skip)]
    pub has_lens: bool,
    /// The samples that were evaluated.
    pub samples: Vec<ProbedSample>,
    /// Samples of the pixel that were asked for and left out, because there would have been more
    /// rays than [`MOST_RAYS`](super::probe::MOST_RAYS).
    pub left_out: u64,
    /// Their rays: one sample's after the other's.
    pub rays: Vec<TracedRay>,
    /// Indices into `rays`, in the order in which they added something.
    pub order: Vec<u32>,
}

/// A sample, evaluated again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProbedSample {
    /// Counts the pixel's samples from 0.
    pub index: u64,
    /// What the film adds, linear RGB.
    pub value: Vec3,
}

/// One ray, where it ended, and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TracedRay {
    /// Index into [`RayTree::samples`].
    pub sample: u32,
    /// Index of the ray that met the surface where this one starts; `None` from the camera.
    pub parent: Option<u32>,
    /// What it is for.
    pub kind: RayKind,
    /// Surfaces between the camera and its start.
    pub depth: u32,
    /// The object whose surface it leaves, by its `SceneId`; `None` from the camera.
    pub from: Option<u64>,
    /// In world space. A straight continuation has its parent's.
    pub origin: Vec3,
    /// Of any length; `t` counts in it. That of a shadow ray reaches to its light.
    pub direction: Vec3,
    /// A straight continuation looks for what lies behind this `t`; 0 for the others.
    pub after: f32,
    /// Where it would have ended in any case; infinite for most.
    pub t_max: f32,
    /// When it is shot, in the shutter's [0, 1].
    pub time: f32,
    /// The triangle that it starts on; files name the object, [`Self::from`].
    #[serde(skip)]
    pub starts_on: TriangleId,
    /// Where it ended: at a surface, at a light, or at `t_max`.
    pub t: f32,
    /// What it ended at.
    pub end: RayEnd,
    /// The surface there. Of a shadow ray: the nearest that blocks it.
    pub hit: Option<RayHit>,
    /// The visible light that it ended at, by its `SceneId`.
    pub met_light: Option<u64>,
    /// The light point that it asks for.
    pub light: Option<LightSample>,
    /// What a shadow ray crossed on its way, nearest first.
    pub crossings: Vec<Crossing>,
    /// The part of the light that arrives; 1 for rays that are not for light.
    pub transmittance: Vec3,
    /// As many rays share what arrives at the surface where this one starts.
    pub count: u32,
    /// The probability with which the path went this way: 1, but for a choice between reflection
    /// and transmission, and for faint light where there is much of it: what was left out has that chance, too.
    pub chance: f32,
    /// What its radiance is multiplied by on its way into its parent's. For light: the part of the
    /// light's samples and of the surface's opacity alone; `light.reflected` has the rest.
    pub weight: Vec3,
    /// What comes back along it to its start, linear RGB.
    pub radiance: Vec3,
    /// Its part of its parent's `radiance`.
    pub carried: Vec3,
    /// What it added to the sample's value by itself.
    pub added: Vec3,
    /// What the walk that traces pictures costs for it alone, without packets.
    pub cost: RayCost,
}

/// What a ray is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RayKind {
    /// From the camera.
    Camera,
    /// A sharp reflection.
    Mirror,
    /// One of a blurred reflection's.
    Gloss,
    /// Straight on through a transparent surface.
    Transmission,
    /// One of those through a translucent surface.
    Translucency,
    /// To a light without extent, or to the middle of one that is taken for a point.
    Shadow,
    /// To a point of a light that has an extent.
    LightSample,
}

impl RayKind {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Camera,
        Self::Mirror,
        Self::Gloss,
        Self::Transmission,
        Self::Translucency,
        Self::Shadow,
        Self::LightSample,
    ];

    /// As tables and files call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Mirror => "mirror",
            Self::Gloss => "gloss",
            Self::Transmission => "transmission",
            Self::Translucency => "translucency",
            Self::Shadow => "shadow",
            Self::LightSample => "light-sample",
        }
    }

    /// Whether it asks for a light.
    pub fn is_for_light(self) -> bool {
        matches!(self, Self::Shadow | Self::LightSample)
    }
}

/// Where a ray ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RayEnd {
    /// At a surface.
    Surface,
    /// At a light that is to be seen.
    Light,
    /// Nowhere: it carries the background.
    Background,
    /// At its light, in full or in part.
    Arrived,
    /// At a surface before its light.
    Blocked,
    /// Not traced, because shadows are off: its light arrives.
    Unshadowed,
    /// Not traced, because the surface reflects nothing of that light: it stands behind the surface,
    /// or is black, or the surface is.
    Unlit,
    /// Not traced, because there are many lights and this one adds so little: chance asks for it now and then.
    LeftOut,
}

impl RayEnd {
    /// As tables and files call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surface => "surface",
            Self::Light => "light",
            Self::Background => "background",
            Self::Arrived => "arrived",
            Self::Blocked => "blocked",
            Self::Unshadowed => "unshadowed",
            Self::Unlit => "unlit",
            Self::LeftOut => "left-out",
        }
    }

    /// Whether there is a ray at all.
    pub fn is_traced(self) -> bool {
        !matches!(self, Self::Unshadowed | Self::Unlit | Self::LeftOut)
    }
}

/// A surface that a ray met, with all that shading read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RayHit {
    /// The object's `SceneId`.
    pub object: u64,
    /// Index into the aggregate's instances.
    pub instance: u32,
    /// Index into the mesh's triangles.
    pub triangle: u32,
    /// Distance in lengths of the ray's direction.
    pub t: f32,
    /// Barycentric weights of the corners 1 and 2.
    pub barycentric: [f32; 2],
    /// World space.
    pub position: Vec3,
    /// Unit normal of the triangle, turned to the viewer.
    pub geometric_normal: Vec3,
    /// Unit normal for shading.
    pub normal: Vec3,
    /// Unit vector to where the ray came from.
    pub to_viewer: Vec3,
    /// Index into the world's materials.
    pub material: u32,
    /// kd, texture included.
    pub diffuse: Vec3,
    /// ks.
    pub specular: Vec3,
    /// km.
    pub mirror: Vec3,
    /// s.
    pub shininess: f32,
    /// d, opacity map included; 1 where transparency is off.
    pub opacity: f32,
    /// ke.
    pub emission: Vec3,
}

/// A point of a light, as a surface saw it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LightSample {
    /// Which array the light is in.
    pub kind: LightKind,
    /// The light's `SceneId`; 0 of the dome.
    pub id: u64,
    /// Where on the light, in [0, 1]²; a segment uses the first number, of a dome it is the place in its map.
    pub place: [f32; 2],
    /// How likely that place is, as a multiple of what it is where points are chosen evenly over the light.
    pub density: f32,
    /// Unit vector from the surface.
    pub direction: Vec3,
    /// In metres; infinite for a directional light and the dome.
    pub distance: f32,
    /// What arrives if nothing is in the way, before the surface's cosine.
    pub arriving: Vec3,
    /// Between the shading normal and the direction.
    pub n_dot_l: f32,
    /// Between the light's mirror direction and the viewer.
    pub r_dot_v: f32,
    /// What leaves towards the viewer if nothing is in the way, before opacity.
    pub reflected: Vec3,
}

/// A surface on a shadow ray's way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Crossing {
    /// The object's `SceneId`.
    pub object: u64,
    /// Index into the mesh's triangles.
    pub triangle: u32,
    /// Distance in lengths of the ray's direction.
    pub t: f32,
    /// kd, texture included.
    pub diffuse: Vec3,
    /// d.
    pub opacity: f32,
}

/// What walking the trees costs for a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RayCost {
    /// Nodes entered.
    pub nodes: u64,
    /// Boxes tested, and roots entered.
    pub boxes: u64,
    /// Triangles tested.
    pub triangles: u64,
}

impl From<Counters> for RayCost {
    fn from(counters: Counters) -> Self {
        Self {
            nodes: counters.nodes,
            boxes: counters.boxes,
            triangles: counters.triangles,
        }
    }
}

impl RayTree {
    /// What the rays of each sample added, in the order in which they added it: the sample's value, bit for bit. In the order
    /// of [`Self::samples`].
    pub fn sums(&self) -> Vec<Vec3> {
        let mut sums = vec![Vec3::ZERO; self.samples.len()];
        for ray in self.order.iter().map(|&ray| &self.rays[ray as usize]) {
            sums[ray.sample as usize] += ray.added;
        }
        sums
    }

    /// The mean of the samples' values.
    pub fn mean(&self) -> Vec3 {
        let sum: glam::DVec3 = self.samples.iter().map(|s| s.value.as_dvec3()).sum();
        (sum / self.samples.len().max(1) as f64).as_vec3()
    }

    /// Traces a ray once more, by itself, watched: the queries that the
    /// tracer made of them. Of a blocked shadow ray the nearest blocker is found, which the tracer does
    /// not look for; that part is not watched. A ray that was not traced is none now.
    ///
    /// # Panics
    /// If there is no ray of that index.
    pub fn retrace<V: Visitor>(
        &self,
        world: &World,
        settings: &RenderSettings,
        index: u32,
        visitor: &mut V,
    ) -> Option<Hit> {
        let traced = &self.rays[index as usize];
        if !traced.end.is_traced() {
            return None;
        }
        let (aggregate, ray) = (&world.aggregate, traced.ray());
        if !traced.kind.is_for_light() {
            // The world may be another than the rays were traced in.
            let behind = self.behind(traced).filter(|hit| {
                let instance = aggregate.instances().get(hit.instance as usize);
                instance.is_some_and(|i| (hit.triangle as usize) < i.mesh.triangles().len())
            });
            return match behind {
                Some(behind) => aggregate.next_crossing_with(&ray, &behind, visitor),
                None => aggregate.closest_hit_with(&ray, visitor),
            };
        }
        if !traced.asks_what_passes(world, settings) {
            let occluded = aggregate.occluded_with(&ray, visitor);
            return aggregate.closest_hit(&ray).filter(|_| occluded);
        }
        let through = |hit: &Hit| through(world, settings, hit);
        if aggregate.transmittance_with(&ray, through, visitor) != Vec3::ZERO {
            return None;
        }
        let last = crossings(world, settings, &ray).pop();
        last.map(|(hit, _)| hit)
    }

    /// The hit behind which a straight continuation goes on: its parent's.
    fn behind(&self, ray: &TracedRay) -> Option<Hit> {
        if ray.kind != RayKind::Transmission {
            return None;
        }
        let hit = self.rays[ray.parent? as usize].hit?;
        let [u, v] = hit.barycentric;
        Some(Hit {
            t: hit.t,
            instance: hit.instance,
            triangle: hit.triangle,
            u,
            v,
        })
    }

    /// Whether a ray of it leaves the first surface.
    pub fn leaves_first(&self, ray: &TracedRay) -> bool {
        (ray.parent).is_some_and(|parent| self.rays[parent as usize].parent.is_none())
    }

    /// The children of a ray.
    pub fn children(&self, ray: u32) -> impl Iterator<Item = (u32, &TracedRay)> {
        let behind = (ray as usize + 1).min(self.rays.len());
        (ray + 1..)
            .zip(&self.rays[behind..])
            .filter(move |(_, child)| child.parent == Some(ray))
    }
}

impl TracedRay {
    /// As the trees take it.
    pub fn ray(&self) -> Ray {
        Ray {
            origin: self.origin,
            direction: self.direction,
            t_max: self.t_max,
            time: self.time,
            starts_on: self.starts_on,
        }
    }

    /// Whether it asks how much of a light passes, and not just whether anything is in the way.
    pub(super) fn asks_what_passes(&self, world: &World, settings: &RenderSettings) -> bool {
        self.kind.is_for_light()
            && self.end.is_traced()
            && settings.features.transparency
            && world.needs.transparency
    }

    /// The point at `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}
