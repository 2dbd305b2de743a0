//! What both oracles ask of every triangle, asked of many at once: whether it is surely missed. That is nearly always the
//! answer; what is left is looked at one by one. No tree: every triangle is asked, and the sums are those of
//! [`ExactRay::cross`](super::oracle::ExactRay::cross) and of [`SingleTriangle`](super::single::SingleTriangle), in the same
//! order, so that it is the same answer to the last bit.

use std::ops::Range;

use glam::Vec3;

use super::super::kernel::triangle::Shear;
use crate::bvh::{Aggregate, Triangles};
use crate::instruction_sets::vectorized;

/// The traced triangles of a mesh, a column for each coordinate of each corner.
#[derive(Default)]
pub(crate) struct Columns {
    /// Their numbers in the mesh.
    numbers: Vec<u32>,
    /// By axis, then by corner.
    corners: [[Vec<f32>; 3]; 3],
}

/// Triangles that are asked at once: their columns stay in the first-level cache.
const TOGETHER: usize = 512;

/// A ray of f64 that looks along an axis, sheared into it.
#[derive(Clone, Copy)]
pub(crate) struct Sheared {
    /// Which axes are x, y and z.
    pub axes: [usize; 3],
    /// The origin along them.
    pub from: [f64; 3],
    pub slope: [f64; 2],
    /// The direction along z, without its sign.
    pub along: f64,
    pub origin_error: f64,
    pub direction_error: f64,
}

impl Columns {
    /// All of a mesh.
    fn of(triangles: &Triangles) -> Self {
        let mut columns = Self::default();
        let traced = (0..triangles.len() as u32).filter(|&i| triangles.is_traced(i));
        traced.for_each(|i| columns.push(i, triangles.corners(i)));
        columns
    }

    pub fn clear(&mut self) {
        self.numbers.clear();
        self.corners.iter_mut().flatten().for_each(Vec::clear);
    }

    pub fn push(&mut self, number: u32, corners: [Vec3; 3]) {
        self.numbers.push(number);
        for (axis, columns) in self.corners.iter_mut().enumerate() {
            for (column, corner) in columns.iter_mut().zip(corners) {
                column.push(corner[axis]);
            }
        }
    }

    /// Some of them.
    fn some(&self, axes: [usize; 3], range: Range<usize>) -> [[&[f32]; 3]; 3] {
        axes.map(|axis| [0, 1, 2].map(|corner| &self.corners[axis][corner][range.clone()]))
    }

    /// Adds those to `left` that f64 does not call missed.
    pub fn exact(&self, ray: &Sheared, left: &mut Vec<u32>) {
        self.sort_out(left, |range, misses| {
            exact_misses(self.some(ray.axes, range), ray, misses);
        });
    }

    /// Adds those to `left` that our triangle test does not call missed by their edges.
    fn rounded(&self, shear: &Shear, left: &mut Vec<u32>) {
        self.sort_out(left, |range, misses| {
            let corners = self.some(shear.axes.map(|axis| axis as usize), range);
            rounded_misses(corners, shear.from, shear.slope, misses);
        });
    }

    fn sort_out(&self, left: &mut Vec<u32>, ask: impl Fn(Range<usize>, &mut [bool])) {
        let mut misses = [false; TOGETHER];
        for first in (0..self.numbers.len()).step_by(TOGETHER) {
            let range = first..(first + TOGETHER).min(self.numbers.len());
            let misses = &mut misses[..range.len()];
            ask(range.clone(), misses);
            let numbers = &self.numbers[range];
            for (misses, numbers) in misses.chunks(16).zip(numbers.chunks(16)) {
                if misses.iter().fold(true, |all, misses| all & misses) {
                    continue;
                }
                let rest = numbers.iter().zip(misses).filter(|(_, misses)| !**misses);
                left.extend(rest.map(|(number, _)| number));
            }
        }
    }
}

/// The meshes of all instances.
pub(crate) struct Sieve(Vec<Columns>);

impl Sieve {
    pub fn of(aggregate: &Aggregate) -> Self {
        let meshes = aggregate.instances().iter();
        Self(meshes.map(|i| Columns::of(i.mesh.triangles())).collect())
    }

    /// [`Columns::exact`] of an instance.
    pub fn exact(&self, instance: usize, ray: &Sheared, left: &mut Vec<u32>) {
        self.0[instance].exact(ray, left);
    }

    /// What is left of an instance of those that our triangle test calls missed.
    pub fn rounded(&self, instance: usize, shear: &Shear, left: &mut Vec<u32>) {
        self.0[instance].rounded(shear, left);
    }
}

/// 2⁻²⁴.
const U: f64 = f32::EPSILON as f64 / 2.0;

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Of an edge function, whether its sign is beyond doubt: whether it is surely more than 0, and surely less.
#[inline(always)]
fn sides(p: [f64; 2], q: [f64; 2], delta: f64) -> [bool; 2] {
    let value = p[0] * q[1] - p[1] * q[0];
    let error = delta * (p[0].abs() + p[1].abs() + q[0].abs() + q[1].abs())
        + 2.0 * delta * delta
        + 2.0 * U * ((p[0] * q[1]).abs() + (p[1] * q[0]).abs());
    [value > error, -value > error]
}

vectorized! {
    fn exact_misses(corners: [[&[f32]; 3]; 3], ray: &Sheared, misses: &mut [bool]) {
        let count = misses.len();
        let [[ax, bx, cx], [ay, by, cy], [az, bz, cz]] = corners;
        let [ax, bx, cx] = [&ax[..count], &bx[..count], &cx[..count]];
        let [ay, by, cy] = [&ay[..count], &by[..count], &cy[..count]];
        let [az, bz, cz] = [&az[..count], &bz[..count], &cz[..count]];
        let Sheared { from, slope, along, origin_error, direction_error, .. } = *ray;
        for i in 0..count {
            let x = [f64::from(ax[i]) - from[0], f64::from(bx[i]) - from[0], f64::from(cx[i]) - from[0]];
            let y = [f64::from(ay[i]) - from[1], f64::from(by[i]) - from[1], f64::from(cy[i]) - from[1]];
            let z = [f64::from(az[i]) - from[2], f64::from(bz[i]) - from[2], f64::from(cz[i]) - from[2]];
            let deepest = larger(larger(z[0].abs(), z[1].abs()), z[2].abs());
            let widest = larger(larger(x[0].abs(), x[1].abs()), x[2].abs());
            let highest = larger(larger(y[0].abs(), y[1].abs()), y[2].abs());
            let largest = larger(larger(widest, highest), deepest);
            let delta = 6.001 * U * largest
                + 2.0 * origin_error
                + 2.0 * deepest * direction_error / along;
            let a = [x[0] - slope[0] * z[0], y[0] - slope[1] * z[0]];
            let b = [x[1] - slope[0] * z[1], y[1] - slope[1] * z[1]];
            let c = [x[2] - slope[0] * z[2], y[2] - slope[1] * z[2]];
            let [plus_a, minus_a] = sides(c, b, delta);
            let [plus_b, minus_b] = sides(a, c, delta);
            let [plus_c, minus_c] = sides(b, a, delta);
            misses[i] = (plus_a | plus_b | plus_c) & (minus_a | minus_b | minus_c);
        }
    }

    fn rounded_misses(
        corners: [[&[f32]; 3]; 3],
        from: [f32; 3],
        slope: [f32; 2],
        misses: &mut [bool],
    ) {
        let count = misses.len();
        let [[ax, bx, cx], [ay, by, cy], [az, bz, cz]] = corners;
        let [ax, bx, cx] = [&ax[..count], &bx[..count], &cx[..count]];
        let [ay, by, cy] = [&ay[..count], &by[..count], &cy[..count]];
        let [az, bz, cz] = [&az[..count], &bz[..count], &cz[..count]];
        for i in 0..count {
            let z = [az[i] - from[2], bz[i] - from[2], cz[i] - from[2]];
            let x = [
                ax[i] - from[0] - z[0] * slope[0],
                bx[i] - from[0] - z[1] * slope[0],
                cx[i] - from[0] - z[2] * slope[0],
            ];
            let y = [
                ay[i] - from[1] - z[0] * slope[1],
                by[i] - from[1] - z[1] * slope[1],
                cy[i] - from[1] - z[2] * slope[1],
            ];
            let edges = [
                x[2] * y[1] - y[2] * x[1],
                x[0] * y[2] - y[0] * x[2],
                x[1] * y[0] - y[1] * x[0],
            ];
            misses[i] = ((edges[0] < 0.0) | (edges[1] < 0.0) | (edges[2] < 0.0))
                & ((edges[0] > 0.0) | (edges[1] > 0.0) | (edges[2] > 0.0));
        }
    }
}
