use super::footprint::texture_footprint;
use crate::bvh::{Hit, Placement, Ray, SurfacePoint, TriangleId};
use crate::scene::{Alpha, Lighting, PhongMap, RenderSettings, TextureFilter};
use crate::trace::textures::normal_map;
use crate::trace::{Map, Material, Object, Reading, Texture, World};
use glam::{Vec2, Vec3, Vec4};

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
    /// kd, its map and the vertices' colours included.
    pub diffuse: Vec3,
    /// ks, its map included.
    pub specular: Vec3,
    /// km, its map included.
    pub mirror: Vec3,
    /// s ≥ 1.
    pub shininess: f32,
    /// d, its map, the vertices' alphas and the cutoff included.
    pub opacity: f32,
    /// ke, its map included, and where kd is black the vertices' colours.
    pub emission: Vec3,
}

/// Where on a triangle a hit reads its maps.
struct Textured {
    /// They leave the first corner, in world space.
    edges: [Vec3; 2],
    /// Of the corners.
    uvs: [Vec2; 3],
    /// Of the hit.
    uv: Vec2,
    /// Of the ray, in metres.
    width: f32,
    /// Whether the normal is the opposite of the mesh's.
    is_turned: bool,
    /// Of the mesh, in world space, around the normal as it is turned; `None` where the mesh has none.
    tangent: Option<Vec4>,
}

/// Where maps are read, and how.
struct Looked<'a> {
    world: &'a World,
    settings: &'a RenderSettings,
    uv: Vec2,
    /// As [`Texture::sample`](crate::trace::Texture::sample) has it.
    footprint: f32,
}

impl Looked<'_> {
    fn reading(&self, map: &Map) -> (&Texture, Reading) {
        let reading = Reading {
            filter: map.filter.with(self.settings.texture_filter),
            wrap: map.wrap,
        };
        (&self.world.textures[map.texture as usize], reading)
    }

    fn color(&self, map: &Map) -> Vec3 {
        let (texture, reading) = self.reading(map);
        let raw = self.settings.lighting == Lighting::Classic;
        if map.is_cut_out {
            texture.sample_cut_out(self.uv, self.footprint, reading, raw)
        } else {
            texture.sample(self.uv, self.footprint, reading, raw)
        }
    }

    fn opacity(&self, map: &Map) -> f32 {
        let (texture, reading) = self.reading(map);
        texture.opacity(self.uv, self.footprint, reading)
    }

    fn normal(&self, map: &Map) -> Vec3 {
        let (texture, reading) = self.reading(map);
        texture.sample(self.uv, self.footprint, reading, true)
    }
}

/// How much each corner counts at a hit.
#[inline(always)]
fn weights(hit: &Hit) -> [f32; 3] {
    [1.0 - hit.u - hit.v, hit.u, hit.v]
}

/// Between those of the corners.
fn place_in_maps(uvs: [Vec2; 3], hit: &Hit) -> Vec2 {
    let weights = weights(hit);
    (0..3).map(|i| weights[i] * uvs[i]).sum()
}

impl Object {
    /// The vertices' colour at a hit, and their alpha where they have one; `None` where they have no colours.
    fn vertex_color(&self, hit: &Hit) -> Option<(Vec3, Option<f32>)> {
        let mesh = &self.mesh;
        if mesh.colors.is_empty() {
            return None;
        }
        let corners = self.corners(hit);
        let weights = weights(hit);
        let [a, b, c] = corners.map(|corner| mesh.colors[corner as usize]);
        let color = weights[0] * a + weights[1] * b + weights[2] * c;
        let alpha = (!mesh.alphas.is_empty()).then(|| {
            let [a, b, c] = corners.map(|corner| mesh.alphas[corner as usize]);
            weights[0] * a + weights[1] * b + weights[2] * c
        });
        Some((color, alpha))
    }

    /// The vertices of the triangle of a hit on it.
    #[inline(always)]
    pub(in crate::trace) fn corners(&self, hit: &Hit) -> [u32; 3] {
        self.mesh.tree.triangles().indices()[hit.triangle as usize]
    }

    /// Of each vertex, where the mesh has them and they are to be seen.
    pub(in crate::trace) fn smooth_normals(&self, settings: &RenderSettings) -> Option<&[Vec3]> {
        let normals = &self.mesh.normals;
        (settings.features.normal_interpolation && !normals.is_empty()).then_some(normals)
    }

    /// Whether a hit's numbers may differ from those of the material, as [`Surface::vary`] has it.
    pub(in crate::trace) fn varies(&self, material: &Material, settings: &RenderSettings) -> bool {
        let has_maps = !material.maps.is_empty() && settings.features.textures;
        !self.mesh.colors.is_empty() || (has_maps && !self.mesh.uvs.is_empty())
    }
}

/// Which way a surface faces.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct Facing {
    /// As [`Surface`] has them.
    pub geometric_normal: Vec3,
    pub normal: Vec3,
    /// Whether the normal is the opposite of the mesh's.
    pub is_turned: bool,
    /// Whether the ray is too grazing to tell: where it started has to be asked.
    pub is_grazing: bool,
}

impl Facing {
    /// Of a triangle with that normal, shaded by the other one; unit vectors. Without a branch.
    #[inline(always)]
    pub fn of(triangle: Vec3, shading: Vec3, to_viewer: Vec3, is_physical: bool) -> Self {
        let cosine = triangle.dot(to_viewer);
        let is_clear = cosine.abs() > GRAZING;
        Self {
            is_grazing: !is_clear,
            ..Self::from_side(triangle, shading, cosine >= 0.0, is_physical)
        }
    }

    #[inline(always)]
    fn from_side(triangle: Vec3, shading: Vec3, is_above: bool, is_physical: bool) -> Self {
        let side = if is_above { 1.0 } else { -1.0 };
        let geometric_normal = side * triangle;
        let is_turned = is_physical & (shading.dot(geometric_normal) < 0.0);
        let side = if is_turned { -1.0 } else { 1.0 };
        Self {
            geometric_normal,
            normal: side * shading,
            is_turned,
            is_grazing: false,
        }
    }
}

/// A smooth normal in the world, of those at the corners in the mesh; the triangle's where it has no direction.
#[inline(always)]
pub(in crate::trace) fn smooth_normal(
    placement: &Placement,
    [a, b, c]: [Vec3; 3],
    [u, v]: [f32; 2],
    triangle: Vec3,
) -> Vec3 {
    let smooth = Vec3::ZERO + (1.0 - u - v) * a + u * b + v * c;
    let smooth = placement.world_normal(smooth);
    let scale = 1.0 / smooth.length();
    let has_direction = scale > 0.0 && scale < f32::INFINITY;
    if has_direction {
        smooth * scale
    } else {
        triangle
    }
}

/// What becomes of a material's opacity.
pub(in crate::trace) fn cut_opacity(opacity: f32, alpha: Alpha, settings: &RenderSettings) -> f32 {
    if !settings.features.transparency {
        return 1.0;
    }
    match alpha {
        Alpha::Blend => opacity,
        Alpha::Mask { cutoff } => f32::from(opacity >= cutoff),
        Alpha::Opaque => 1.0,
    }
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
        if let Some(normals) = object.smooth_normals(settings) {
            let corners = object.corners(hit).map(|corner| normals[corner as usize]);
            normal = smooth_normal(&instance.placement(), corners, [hit.u, hit.v], normal);
        }
        let is_physical = settings.lighting == Lighting::Physical;
        let mut facing = Facing::of(point.normal, normal, to_viewer, is_physical);
        if facing.is_grazing
            && let Some(is_above) = instance.is_above(hit.triangle, ray.origin, ray.time)
        {
            facing = Facing::from_side(point.normal, normal, is_above, is_physical);
        }
        let mut surface = Self {
            point,
            geometric_normal: facing.geometric_normal,
            normal: facing.normal,
            to_viewer,
            diffuse: material.diffuse,
            specular: material.specular,
            mirror: material.mirror,
            shininess: material.shininess,
            opacity: material.opacity,
            emission: material.emission,
        };
        surface.vary(world, settings, hit, facing.is_turned, width);
        surface.opacity = cut_opacity(surface.opacity, material.alpha, settings);
        surface
    }

    /// kd and d of a hit alone, as [`Self::at`] has them by the finest texels: what a shadow ray asks of what it crosses.
    pub(in crate::trace) fn diffuse_and_opacity(
        world: &World,
        settings: &RenderSettings,
        hit: &Hit,
    ) -> (Vec3, f32) {
        let object = &world.objects[hit.instance as usize];
        let material = &world.materials[object.material as usize];
        let (mut diffuse, mut opacity) = (material.diffuse, material.opacity);
        let mesh = &object.mesh;
        if let Some((color, alpha)) = object.vertex_color(hit) {
            diffuse *= color;
            if let Some(alpha) = alpha {
                opacity = (opacity * alpha).clamp(0.0, 1.0);
            }
        }
        if !material.maps.is_empty() && settings.features.textures && !mesh.uvs.is_empty() {
            let uvs = object.corners(hit).map(|corner| mesh.uvs[corner as usize]);
            let looked = Looked {
                world,
                uv: place_in_maps(uvs, hit),
                footprint: 0.0,
                settings,
            };
            for map in &material.maps {
                match map.of {
                    PhongMap::Diffuse => diffuse *= looked.color(map),
                    PhongMap::Opacity => {
                        opacity = (opacity * looked.opacity(map)).clamp(0.0, 1.0);
                    }
                    _ => {}
                }
            }
        }
        (diffuse, cut_opacity(opacity, material.alpha, settings))
    }

    /// Multiplies what differs over the object: the vertices' colours and the material's maps.
    pub(in crate::trace) fn vary(
        &mut self,
        world: &World,
        settings: &RenderSettings,
        hit: &Hit,
        is_turned: bool,
        width: f32,
    ) {
        let instance = &world.aggregate.instances()[hit.instance as usize];
        let object = &world.objects[hit.instance as usize];
        let material = &world.materials[object.material as usize];
        let mesh = &object.mesh;
        let corners = object.corners(hit);
        let weights = weights(hit);
        if let Some((color, alpha)) = object.vertex_color(hit) {
            self.diffuse *= color;
            // What has no body shows its colours by itself, as unlit models do.
            if material.diffuse == Vec3::ZERO {
                self.emission *= color;
            }
            if let Some(alpha) = alpha {
                self.opacity = (self.opacity * alpha).clamp(0.0, 1.0);
            }
        }
        if !material.maps.is_empty() && settings.features.textures && !mesh.uvs.is_empty() {
            let uvs = corners.map(|corner| mesh.uvs[corner as usize]);
            let [a, b, c] = mesh.tree.triangles().corners(hit.triangle);
            let tangent = (!mesh.tangents.is_empty()).then(|| {
                let [a, b, c] = corners.map(|corner| mesh.tangents[corner as usize]);
                let tangent = weights[0] * a + weights[1] * b + weights[2] * c;
                let opposite = instance.mirrored() != is_turned;
                let side = if opposite { -tangent.w } else { tangent.w };
                (instance.to_world_vector(tangent.truncate())).extend(side)
            });
            let triangle = Textured {
                edges: [b - a, c - a].map(|edge| instance.to_world_vector(edge)),
                uvs,
                uv: place_in_maps(uvs, hit),
                width,
                is_turned,
                tangent,
            };
            self.multiply_maps(world, settings, material, &triangle);
        }
    }

    /// Every number times its map.
    fn multiply_maps(
        &mut self,
        world: &World,
        settings: &RenderSettings,
        material: &Material,
        triangle: &Textured,
    ) {
        let setting = settings.texture_filter;
        let uv = triangle.uv;
        let footprint = if setting == TextureFilter::Mipmap {
            let cosine = self.geometric_normal.dot(self.to_viewer);
            texture_footprint(triangle.edges, triangle.uvs, triangle.width, cosine)
        } else {
            0.0
        };
        let looked = Looked {
            world,
            uv,
            footprint,
            settings,
        };
        for map in &material.maps {
            match map.of {
                PhongMap::Diffuse => self.diffuse *= looked.color(map),
                PhongMap::Specular => self.specular *= looked.color(map),
                PhongMap::Mirror => self.mirror *= looked.color(map),
                PhongMap::Emission => self.emission *= looked.color(map),
                PhongMap::Opacity => {
                    // A picture of floats may leave the range, and light would be negative.
                    self.opacity = (self.opacity * looked.opacity(map)).clamp(0.0, 1.0);
                }
                PhongMap::Normal => {
                    let texel = looked.normal(map);
                    self.bend_normal(texel, material.normal_scale, triangle);
                }
            }
        }
    }

    /// Takes the normal of a map's texel, as far as mirror directions stay above the surface.
    fn bend_normal(&mut self, texel: Vec3, scale: f32, triangle: &Textured) {
        let given = triangle.tangent;
        let given = given.and_then(|tangent| normal_map::tangents_given(tangent, self.normal));
        let tangents = given.or_else(|| {
            let [a, b, c] = triangle.uvs;
            normal_map::tangents_of_triangle(triangle.edges, [b - a, c - a], self.normal)
        });
        let bent = normal_map::bent(self.normal, triangle.is_turned, texel, scale, tangents);
        // Classic leaves normals on the side where the mesh has them.
        let faces_viewer = self.normal.dot(self.geometric_normal) >= 0.0;
        let above = |n| normal_map::above_surface(n, self.geometric_normal, self.to_viewer);
        self.normal = if faces_viewer {
            above(bent)
        } else {
            -above(-bent)
        };
    }

    /// A matt grey surface at `position`, seen from its normal's side; exact. For the probe and for tests.
    pub fn flat(position: Vec3, normal: Vec3, to_viewer: Vec3) -> Self {
        Self {
            point: SurfacePoint {
                position,
                error: Vec3::ZERO,
                normal,
                triangle: TriangleId::NONE,
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
