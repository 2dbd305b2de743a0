use super::World;
use super::footprint::texture_footprint;
use crate::bvh::{Hit, Ray, SurfacePoint};
use crate::scene::{Lighting, RenderSettings, TextureFilter};
use glam::{Vec2, Vec3};

/// Below this cosine rounding may turn a normal to the wrong side of the ray: which one it came from is then asked of
/// where it started.
const GRAZING: f32 = 1e-4;

/// A place on a surface, with everything that shading reads.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Where it is, how far that may be off, and the triangle's own normal.
    pub point: SurfacePoint,
    /// Unit normal of the triangle, turned to the viewer.
    pub geometric_normal: Vec3,
    /// Unit normal for shading: Physical turns it to the viewer's side, Classic takes it as given.
    pub normal: Vec3,
    /// Unit vector towards where the ray came from.
    pub to_viewer: Vec3,
    /// kd, texture included.
    pub diffuse: Vec3,
    /// ks.
    pub specular: Vec3,
    /// km.
    pub mirror: Vec3,
    /// s ≥ 1.
    pub shininess: f32,
    /// d, opacity map included.
    pub opacity: f32,
    /// ke.
    pub emission: Vec3,
}

impl Surface {
    /// What `ray`, `width` metres wide at the hit, found at `hit`.
    pub fn at(world: &World, settings: &RenderSettings, ray: &Ray, width: f32, hit: &Hit) -> Self {
        let instance = &world.aggregate.instances()[hit.instance as usize];
        let object = &world.objects[hit.instance as usize];
        let material = &world.materials[object.material as usize];
        let point = instance.surface_point(hit, ray.time);
        let to_viewer = -ray.direction.normalize();

        let mut normal = point.normal;
        let mesh = &object.mesh;
        let corners = mesh.tree.triangles().indices()[hit.triangle as usize];
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        if settings.features.normal_interpolation && !mesh.normals.is_empty() {
            let smooth: Vec3 = (0..3)
                .map(|i| weights[i] * mesh.normals[corners[i] as usize])
                .sum();
            if let Some(smooth) = instance.to_world_normal(smooth).try_normalize() {
                normal = smooth;
            }
        }
        let cosine = point.normal.dot(to_viewer);
        let above = if cosine.abs() > GRAZING {
            cosine > 0.0
        } else {
            let above = instance.is_above(hit.triangle, ray.origin, ray.time);
            above.unwrap_or(cosine >= 0.0)
        };
        let geometric_normal = if above { point.normal } else { -point.normal };
        if settings.lighting == Lighting::Physical && normal.dot(geometric_normal) < 0.0 {
            normal = -normal;
        }

        let mut diffuse = material.diffuse;
        let mut opacity = material.opacity;
        if settings.features.textures
            && !mesh.uvs.is_empty()
            && (material.diffuse_map.is_some() || material.opacity_map.is_some())
        {
            let uv: Vec2 = (0..3)
                .map(|i| weights[i] * mesh.uvs[corners[i] as usize])
                .sum();
            let filter = settings.texture_filter;
            let footprint = if filter == TextureFilter::Mipmap {
                let [a, b, c] = mesh.tree.triangles().corners(hit.triangle);
                texture_footprint(
                    [b - a, c - a].map(|edge| instance.to_world_vector(edge)),
                    corners.map(|i| mesh.uvs[i as usize]),
                    width,
                    geometric_normal.dot(to_viewer),
                )
            } else {
                0.0
            };
            let raw = settings.lighting == Lighting::Classic;
            if let Some(map) = material.diffuse_map {
                let map = &world.textures[map as usize];
                diffuse = if material.opacity_map.is_some() {
                    map.sample_cut_out(uv, footprint, filter, raw)
                } else {
                    map.sample(uv, footprint, filter, raw)
                };
            }
            if let Some(map) = material.opacity_map {
                let map = world.textures[map as usize].opacity(uv, footprint, filter);
                // A picture of floats may leave the range, and light would be negative.
                opacity = (opacity * map).clamp(0.0, 1.0);
            }
        }
        if !settings.features.transparency {
            opacity = 1.0;
        }
        Self {
            point,
            geometric_normal,
            normal,
            to_viewer,
            diffuse,
            specular: material.specular,
            mirror: material.mirror,
            shininess: material.shininess,
            opacity,
            emission: material.emission,
        }
    }

    /// A matt grey surface at `position`, seen from its normal's side; exact. For the probe and for tests.
    pub fn flat(position: Vec3, normal: Vec3, to_viewer: Vec3) -> Self {
        Self {
            point: SurfacePoint {
                position,
                error: Vec3::ZERO,
                normal,
                near_edge: None,
            },
            geometric_normal: normal,
            normal,
            to_viewer,
            diffuse: Vec3::splat(0.8),
            specular: Vec3::ZERO,
            mirror: Vec3::ZERO,
            shininess: 1.0,
            opacity: 1.0,
            emission: Vec3::ZERO,
        }
    }

    /// The direction of a mirror's ray. Where a smooth normal would send it into the surface, it is
    /// that of the geometric normal.
    pub fn mirrored(&self) -> Vec3 {
        let direction = self.mirrored_about(self.normal);
        if direction.dot(self.geometric_normal) > 0.0 {
            direction
        } else {
            self.mirrored_geometric()
        }
    }

    /// The mirror direction about the geometric normal: it always leaves the surface.
    pub fn mirrored_geometric(&self) -> Vec3 {
        self.mirrored_about(self.geometric_normal)
    }

    fn mirrored_about(&self, n: Vec3) -> Vec3 {
        (2.0 * n.dot(self.to_viewer) * n - self.to_viewer).normalize()
    }
}
