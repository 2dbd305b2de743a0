//! The triangles that a scene shows, in the world's space.

use super::super::model::MeshParts;
use super::super::place::world_from;
use bevy::asset::Assets;
use bevy::math::{Affine3A, Vec3};
use bevy::mesh::{Mesh, Mesh3d};
use bevy::prelude::{Entity, World};

/// So many triangles tell where much is to be seen; of more, every so many are looked at.
const ENOUGH: usize = 200_000;
/// A triangle of more than this share of the largest square around everything is always looked at.
const LARGE: f32 = 1e-3;
/// So many places are kept to see whether all of them are in a picture; of more, the corners of a box around each
/// object.
const MOST_POINTS: usize = 1 << 22;

/// What there is to see, and where.
#[derive(Default)]
pub(super) struct Surface {
    /// Counter-clockwise seen from the front. Not all, where there are very many.
    pub triangles: Vec<[Vec3; 3]>,
    /// Everything lies between them.
    pub points: Vec<Vec3>,
}

impl Surface {
    pub fn of(world: &mut World) -> Self {
        let mut query = world.query::<(Entity, &Mesh3d)>();
        let objects: Vec<_> = query.iter(world).map(|(e, m)| (e, m.0.id())).collect();
        let mut surface = Self::default();
        let Some(meshes) = world.get_resource::<Assets<Mesh>>() else {
            return surface;
        };
        let parts: Vec<(Affine3A, MeshParts)> = objects
            .into_iter()
            .filter_map(|(entity, mesh)| {
                let parts = MeshParts::of(meshes.get(mesh)?)?;
                Some((world_from(world, entity), parts))
            })
            .collect();
        let count: usize = parts.iter().map(|(_, parts)| parts.positions.len()).sum();
        for (place, parts) in &parts {
            let points = parts.positions.iter().copied().map(Vec3::from);
            match count > MOST_POINTS {
                true => surface.add(place, box_around(points)),
                false => surface.add(place, points),
            }
        }
        let Some([least, most]) = surface.bounds() else {
            return Self::default();
        };
        let large = LARGE * (most - least).length_squared();
        let count: usize = parts.iter().map(|(_, parts)| parts.indices.len() / 3).sum();
        let every = count.div_ceil(ENOUGH).max(1);
        let (mut index, mut larger) = (0, 0);
        for (place, parts) in &parts {
            let is_mirrored = place.matrix3.determinant() < 0.0;
            for corners in parts.triangles() {
                let corner = |i: usize| place.transform_point3(parts.positions[i].into());
                let [a, mut b, mut c] = corners.map(corner);
                if is_mirrored {
                    (b, c) = (c, b);
                }
                index += 1;
                let is_large = 0.5 * (b - a).cross(c - a).length() > large && larger < ENOUGH;
                larger += usize::from(is_large);
                if is_large || index % every == 0 {
                    surface.triangles.push([a, b, c]);
                }
            }
        }
        surface
    }

    /// Whether there are triangles, and all of them are lines or points.
    pub fn is_without_area(&self) -> bool {
        let area = |&[a, b, c]: &[Vec3; 3]| (b - a).cross(c - a).length_squared();
        !self.triangles.is_empty() && self.triangles.iter().all(|t| area(t) == 0.0)
    }

    fn add(&mut self, place: &Affine3A, points: impl IntoIterator<Item = Vec3>) {
        let points = points
            .into_iter()
            .map(|point| place.transform_point3(point));
        self.points.extend(points.filter(|point| point.is_finite()));
    }

    /// The corners of the box around everything; `None` where there is nothing.
    fn bounds(&self) -> Option<[Vec3; 2]> {
        let points = || self.points.iter().copied();
        Some([points().reduce(Vec3::min)?, points().reduce(Vec3::max)?])
    }

    /// The middle of everything, and how far from there nothing is any more.
    pub fn sphere(&self) -> (Vec3, f32) {
        let Some([least, most]) = self.bounds() else {
            return (Vec3::ZERO, 1.0);
        };
        let radius = 0.5 * (most - least).length();
        let is_usable = radius > 0.0 && radius.is_finite();
        let middle = 0.5 * least + 0.5 * most;
        (middle, if is_usable { radius } else { 1.0 })
    }

    /// How far a camera has to be from a point to have everything in a square picture, of which `tangent` is that of
    /// half the angle of view. `towards` is from there to the camera, of length 1.
    pub fn distance(&self, centre: Vec3, towards: Vec3, tangent: f32) -> f32 {
        let up = Vec3::Y.reject_from_normalized(towards);
        let up = up.try_normalize().unwrap_or(-Vec3::Z);
        let right = up.cross(towards);
        let needed = |&point: &Vec3| {
            let from = point - centre;
            let across = from.dot(right).abs().max(from.dot(up).abs());
            from.dot(towards) + across / tangent
        };
        match self.points.is_empty() {
            true => 1.0 + 1.0 / tangent,
            false => self.points.iter().map(needed).fold(0.0, f32::max),
        }
    }
}

/// The corners of the box around points; none where there are none.
fn box_around(points: impl Iterator<Item = Vec3> + Clone) -> Vec<Vec3> {
    let least = points.clone().reduce(Vec3::min);
    let Some((least, most)) = least.zip(points.reduce(Vec3::max)) else {
        return Vec::new();
    };
    let corner = |i: usize| {
        let [x, y, z] = [0, 1, 2].map(|axis| [least, most][i >> axis & 1][axis]);
        Vec3::new(x, y, z)
    };
    (0..8).map(corner).collect()
}
