//! Hits that are shaded: where they lie, which way they face and what they are made of; a stage over columns.
//!
//! Hits on one object that follow each other are looked up together, [`LANES`] at a time: what corners of triangles say is
//! gathered, and a loop without a branch does the rest. What that loop cannot say, for want of digits (slivers, hits beside an
//! edge, grazing rays), is looked up by itself, as [`Surface::at`] does: both take their formulas from the same places, so
//! their bits are the same.

use super::paths::Path;
use crate::bvh::{Hit, NearEdge, Placement, Ray, SurfacePoint};
use crate::instruction_sets::vectorized;
use crate::scene::{Lighting, RenderSettings};
use crate::trace::math::vectors::{Vectors, column_vector, set_column};
use crate::trace::surfaces::surface::{Facing, cut_opacity, smooth_normal};
use crate::trace::{Cone, MaterialSet, Surface, World};
use glam::Vec3;
use std::ops::Range;

/// Hits that are looked up together: what fills the widest vectors. Neighbours that hit the same object are often no more.
const LANES: usize = 16;

/// The hits of a bounce that are shaded, in columns of equal length: names as in [`Surface`].
#[derive(Default)]
pub(in crate::trace) struct Vertices {
    /// Of the path among those of the bounce.
    pub numbers: Vec<u32>,
    /// None where all rays left the camera: then [`Path::from_camera`] says what there is to know.
    paths: Vec<Path>,
    /// Of the camera's rays.
    cone: Cone,
    pub hits: Vec<Hit>,
    /// Of the ray.
    pub times: Vec<f32>,
    pub position: Vectors,
    /// Of the position.
    pub error: Vectors,
    /// The triangle's own.
    pub triangle_normal: Vectors,
    pub geometric_normal: Vectors,
    pub normal: Vectors,
    pub to_viewer: Vectors,
    /// Whether it is one for [`NearEdge`].
    pub is_near_edge: Vec<bool>,
    pub diffuse: Vectors,
    pub specular: Vectors,
    pub mirror: Vectors,
    pub emission: Vectors,
    pub shininess: Vec<f32>,
    pub opacity: Vec<f32>,
    /// What any of them was made of, since somebody took that.
    pub met: MaterialSet,
}

/// What is known of hits on one object before they are looked up.
struct Gathered<const N: usize> {
    /// Of the triangle, in the mesh.
    corners: [[[f32; N]; 3]; 3],
    /// What its narrowest wedge asks for.
    wedge: [f32; N],
    normals: [[[f32; N]; 3]; 3],
    uv: [[f32; N]; 2],
    /// Of the ray.
    direction: [[f32; N]; 3],
    time: [f32; N],
}

/// Where they lie and which way they face.
struct Found<const N: usize> {
    position: [[f32; N]; 3],
    error: [[f32; N]; 3],
    triangle_normal: [[f32; N]; 3],
    geometric_normal: [[f32; N]; 3],
    normal: [[f32; N]; 3],
    to_viewer: [[f32; N]; 3],
    /// Not zero where the normal is the opposite of the mesh's, and where the rest has to be asked elsewhere.
    is_turned: [u32; N],
    is_rare: [u32; N],
}

impl Vertices {
    /// None of rays of which those from the camera have this cone.
    pub fn clear(&mut self, cone: Cone) {
        self.numbers.clear();
        self.paths.clear();
        self.cone = cone;
        self.hits.clear();
    }

    pub fn push(&mut self, number: u32, path: Path, hit: Hit) {
        self.numbers.push(number);
        self.paths.push(path);
        self.hits.push(hit);
    }

    pub fn len(&self) -> usize {
        self.hits.len()
    }

    /// Whether a surface is more than matt.
    #[inline(always)]
    pub fn has_highlight(&self, i: usize) -> bool {
        self.specular.get(i) != Vec3::ZERO
    }

    /// Everything that shading reads of one.
    #[inline(always)]
    pub fn surface(&self, i: usize) -> Surface {
        Surface {
            point: SurfacePoint {
                position: self.position.get(i),
                error: self.error.get(i),
                normal: self.triangle_normal.get(i),
                triangle: self.hits[i].id(),
                near_edge: self.is_near_edge[i].then(|| NearEdge {
                    hit: self.hits[i],
                    time: self.times[i],
                }),
            },
            geometric_normal: self.geometric_normal.get(i),
            normal: self.normal.get(i),
            to_viewer: self.to_viewer.get(i),
            diffuse: self.diffuse.get(i),
            specular: self.specular.get(i),
            mirror: self.mirror.get(i),
            shininess: self.shininess[i],
            opacity: self.opacity[i],
            emission: self.emission.get(i),
        }
    }

    fn set_surface(&mut self, i: usize, surface: &Surface) {
        self.position.set(i, surface.point.position);
        self.error.set(i, surface.point.error);
        self.triangle_normal.set(i, surface.point.normal);
        self.is_near_edge[i] = surface.point.near_edge.is_some();
        self.geometric_normal.set(i, surface.geometric_normal);
        self.normal.set(i, surface.normal);
        self.to_viewer.set(i, surface.to_viewer);
        self.diffuse.set(i, surface.diffuse);
        self.specular.set(i, surface.specular);
        self.mirror.set(i, surface.mirror);
        self.shininess[i] = surface.shininess;
        self.opacity[i] = surface.opacity;
        self.emission.set(i, surface.emission);
    }

    /// A hit of a ray from the camera: either all are pushed so, or none.
    #[inline(always)]
    pub fn push_from_camera(&mut self, number: u32, hit: Hit) {
        self.numbers.push(number);
        self.hits.push(hit);
    }

    /// The path that each hit ends.
    #[inline(always)]
    pub fn path(&self, i: usize) -> Path {
        if self.paths.is_empty() {
            Path::from_camera(self.numbers[i], self.cone)
        } else {
            self.paths[i]
        }
    }

    /// Whether all are hits of rays from the camera.
    pub fn are_from_camera(&self) -> bool {
        self.paths.is_empty()
    }

    /// Whether a path may go on behind some surface, or from it.
    pub fn may_go_on(&self) -> bool {
        let differs = |column: &[f32], from: f32| {
            (column.iter()).fold(false, |differs, value| differs | (*value != from))
        };
        differs(&self.opacity, 1.0)
            || self
                .mirror
                .columns()
                .iter()
                .any(|column| differs(column, 0.0))
    }

    /// Looks up everything about the hits that were pushed: `rays[number]` found each.
    pub fn look_up(&mut self, world: &World, settings: &RenderSettings, rays: &[Ray]) {
        let count = self.len();
        for column in [
            &mut self.position,
            &mut self.error,
            &mut self.triangle_normal,
            &mut self.geometric_normal,
            &mut self.normal,
            &mut self.to_viewer,
            &mut self.diffuse,
            &mut self.specular,
            &mut self.mirror,
            &mut self.emission,
        ] {
            column.resize(count);
        }
        self.shininess.resize(count, 0.0);
        self.opacity.resize(count, 0.0);
        self.is_near_edge.clear();
        self.is_near_edge.resize(count, false);
        self.times.clear();
        let times = self.numbers.iter().map(|&i| rays[i as usize].time);
        self.times.extend(times);
        let mut start = 0;
        while start < count {
            let instance = self.hits[start].instance;
            let others = self.hits[start..].iter();
            let run = others.take_while(|hit| hit.instance == instance).count();
            self.look_up_run(start..start + run, world, settings, rays);
            start += run;
        }
    }

    /// Of hits on one object.
    fn look_up_run(
        &mut self,
        run: Range<usize>,
        world: &World,
        settings: &RenderSettings,
        rays: &[Ray],
    ) {
        let number = self.hits[run.start].instance as usize;
        let instance = &world.aggregate.instances()[number];
        let object = &world.objects[number];
        let material = &world.materials[object.material as usize];
        self.met = self.met.with(object.material);
        let placement = instance.placement();
        let is_physical = settings.lighting == Lighting::Physical;
        let normals = object.smooth_normals(settings);
        let varies = object.varies(material, settings);

        self.diffuse.fill(run.clone(), material.diffuse);
        self.specular.fill(run.clone(), material.specular);
        self.mirror.fill(run.clone(), material.mirror);
        self.emission.fill(run.clone(), material.emission);
        self.shininess[run.clone()].fill(material.shininess);
        let opacity = cut_opacity(material.opacity, material.alpha, settings);
        self.opacity[run.clone()].fill(if varies { material.opacity } else { opacity });

        let triangles = instance.mesh.triangles();
        let mut gathered = Gathered::<LANES>::nothing();
        for start in run.clone().step_by(LANES) {
            let count = LANES.min(run.end - start);
            for lane in 0..count {
                let hit = &self.hits[start + lane];
                let corners = object.corners(hit);
                for (k, corner) in triangles.corners(hit.triangle).into_iter().enumerate() {
                    set_column(&mut gathered.corners[k], lane, corner);
                }
                if let Some(normals) = normals {
                    for (k, corner) in corners.into_iter().enumerate() {
                        set_column(&mut gathered.normals[k], lane, normals[corner as usize]);
                    }
                }
                gathered.wedge[lane] = instance.mesh.wedge_of(hit.triangle);
                gathered.uv[0][lane] = hit.u;
                gathered.uv[1][lane] = hit.v;
                let ray = &rays[self.numbers[start + lane] as usize];
                set_column(&mut gathered.direction, lane, ray.direction);
                gathered.time[lane] = ray.time;
            }
            let found = match (placement.is_identity(), normals.is_some()) {
                (true, false) => still_and_flat(&placement, is_physical, &gathered),
                (true, true) => still_and_smooth(&placement, is_physical, &gathered),
                (false, false) => placed_and_flat(&placement, is_physical, &gathered),
                (false, true) => placed_and_smooth(&placement, is_physical, &gathered),
            };
            let range = start..start + count;
            self.position.copy_from(range.clone(), &found.position);
            self.error.copy_from(range.clone(), &found.error);
            (self.triangle_normal).copy_from(range.clone(), &found.triangle_normal);
            (self.geometric_normal).copy_from(range.clone(), &found.geometric_normal);
            self.normal.copy_from(range.clone(), &found.normal);
            self.to_viewer.copy_from(range.clone(), &found.to_viewer);
            for (lane, i) in range.enumerate() {
                if found.is_rare[lane] == 0 && !varies {
                    continue;
                }
                let ray = &rays[self.numbers[i] as usize];
                let width = self.path(i).cone.width_at(self.hits[i].t);
                let surface = if found.is_rare[lane] == 0 {
                    let mut surface = self.surface(i);
                    let is_turned = found.is_turned[lane] != 0;
                    surface.vary(world, settings, &self.hits[i], is_turned, width);
                    surface.opacity = cut_opacity(surface.opacity, material.alpha, settings);
                    surface
                } else {
                    Surface::at(world, settings, ray, width, &self.hits[i])
                };
                self.set_surface(i, &surface);
            }
        }
    }
}

impl<const N: usize> Gathered<N> {
    fn nothing() -> Self {
        Self {
            corners: [[[0.0; N]; 3]; 3],
            wedge: [0.0; N],
            normals: [[[0.0; N]; 3]; 3],
            uv: [[0.0; N]; 2],
            direction: [[0.0; N]; 3],
            time: [0.0; N],
        }
    }
}

vectorized! {
    fn still_and_flat(
        placement: &Placement,
        is_physical: bool,
        gathered: &Gathered<LANES>,
    ) -> Found<LANES> {
        find::<true, false, LANES>(placement, is_physical, gathered)
    }

    fn still_and_smooth(
        placement: &Placement,
        is_physical: bool,
        gathered: &Gathered<LANES>,
    ) -> Found<LANES> {
        find::<true, true, LANES>(placement, is_physical, gathered)
    }

    fn placed_and_flat(
        placement: &Placement,
        is_physical: bool,
        gathered: &Gathered<LANES>,
    ) -> Found<LANES> {
        find::<false, false, LANES>(placement, is_physical, gathered)
    }

    fn placed_and_smooth(
        placement: &Placement,
        is_physical: bool,
        gathered: &Gathered<LANES>,
    ) -> Found<LANES> {
        find::<false, true, LANES>(placement, is_physical, gathered)
    }
}

#[inline(always)]
fn find<const IDENTITY: bool, const SMOOTH: bool, const N: usize>(
    placement: &Placement,
    is_physical: bool,
    gathered: &Gathered<N>,
) -> Found<N> {
    let placement = placement.as_identity(IDENTITY);
    let mut found = Found {
        position: [[0.0; N]; 3],
        error: [[0.0; N]; 3],
        triangle_normal: [[0.0; N]; 3],
        geometric_normal: [[0.0; N]; 3],
        normal: [[0.0; N]; 3],
        to_viewer: [[0.0; N]; 3],
        is_turned: [0; N],
        is_rare: [0; N],
    };
    for i in 0..N {
        let [a, b, c] = &gathered.corners;
        let corners = [
            column_vector(a, i),
            column_vector(b, i),
            column_vector(c, i),
        ];
        let uv = [gathered.uv[0][i], gathered.uv[1][i]];
        let placed = placement.of_hit(corners, gathered.wedge[i], uv, gathered.time[i]);
        let direction = column_vector(&gathered.direction, i);
        let to_viewer = -(direction * (1.0 / direction.length()));
        let mut normal = placed.normal;
        if SMOOTH {
            let [a, b, c] = &gathered.normals;
            let normals = [
                column_vector(a, i),
                column_vector(b, i),
                column_vector(c, i),
            ];
            normal = smooth_normal(&placement, normals, uv, normal);
        }
        let facing = Facing::of(placed.normal, normal, to_viewer, is_physical);
        set_column(&mut found.position, i, placed.position);
        set_column(&mut found.error, i, placed.error);
        set_column(&mut found.triangle_normal, i, placed.normal);
        set_column(&mut found.geometric_normal, i, facing.geometric_normal);
        set_column(&mut found.normal, i, facing.normal);
        set_column(&mut found.to_viewer, i, to_viewer);
        found.is_turned[i] = facing.is_turned as u32;
        found.is_rare[i] = (facing.is_grazing | !placed.is_ordinary) as u32;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::test_scene;

    #[test]
    fn what_columns_say_of_a_hit_is_what_is_said_of_it_alone_to_the_bit() {
        let world = test_scene::world();
        let (rays, hits) = test_scene::rays(&world);
        let cone = Cone::default();
        let mut rare = 0;
        for lighting in [Lighting::Physical, Lighting::Classic] {
            for normal_interpolation in [true, false] {
                let mut settings = RenderSettings {
                    lighting,
                    ..RenderSettings::default()
                };
                settings.features.normal_interpolation = normal_interpolation;
                let vertices = test_scene::vertices(&world, &settings, (&rays, &hits), cone);
                for (i, (ray, hit)) in rays.iter().zip(&hits).enumerate() {
                    let alone = Surface::at(&world, &settings, ray, 0.0, hit);
                    rare += u32::from(alone.point.near_edge.is_some());
                    assert_eq!(
                        format!("{:?}", vertices.surface(i)),
                        format!("{alone:?}"),
                        "{lighting:?}: {ray:?}, {hit:?}"
                    );
                }
            }
        }
        assert!(rare > 100, "only {rare} hits beside edges");
    }
}
