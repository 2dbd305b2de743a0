//! Rays of a batch, read into lanes.

use super::ray::{Ray, TriangleId};
use super::safe_ray::ORDINARY;
use super::wide::{Lanes, PacketRays, by_axis, largest_size};
use crate::bvh::triangles::REACH;

/// Rays, a lane each.
pub(in crate::bvh) struct Columns<L> {
    pub(in crate::bvh) world: PacketRays<L>,
    pub(in crate::bvh) end: L,
    pub(in crate::bvh) time: L,
    /// Which of them [`SafeRay::new`](super::safe_ray::SafeRay::new) would take as they are, without a scale.
    pub(in crate::bvh) safe: u32,
    /// Whether any of them starts on a triangle.
    pub(in crate::bvh) is_spawned: bool,
}

impl<L: Lanes> Columns<L> {
    /// At most as many rays as there are lanes; what [`SafeRay::new`](super::safe_ray::SafeRay::new) does with one.
    #[inline(always)]
    pub(in crate::bvh) fn of(rays: &[Ray]) -> Self {
        let zero = L::splat(0.0);
        let mut rows = [[0.0; 8]; 16];
        let mut starts = TriangleId::NONE.triangle;
        for (row, ray) in rows.iter_mut().zip(rays) {
            let numbers: &[f32; 10] = bytemuck::cast_ref(ray);
            row.copy_from_slice(&numbers[..8]);
            starts &= ray.starts_on.triangle;
        }
        let columns = L::columns(&rows);
        let [.., end, time] = columns;
        // -0.0 becomes +0.0, so that both mean the same.
        let origin = by_axis!(|i| columns[i].add(zero));
        let direction = by_axis!(|i| columns[3 + i].add(zero));
        let longest = largest_size(&direction);
        let ordinary = L::splat(1.0 / ORDINARY);
        let reach = L::splat(REACH);
        let in_time = L::and(zero.le(time), time.le(L::splat(1.0)));
        let ahead = L::and(L::splat(ORDINARY).le(longest), zero.lt(end));
        let mut safe = L::and(in_time, ahead);
        for axis in 0..3 {
            let here = origin[axis].abs().le(reach);
            safe = L::and(safe, L::and(direction[axis].abs().le(ordinary), here));
        }
        Self {
            world: PacketRays::new(origin, direction, longest),
            end,
            time,
            safe: L::bits(safe) & ((1 << rays.len()) - 1),
            is_spawned: starts != TriangleId::NONE.triangle,
        }
    }
}
