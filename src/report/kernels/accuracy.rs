//! How wrong a kernel's t and barycentrics are, against f64 on the triangle that it found.

use super::rays::RaySets;
use super::{Found, Kernel, exact};
use crate::bvh::Ray;
use glam::Vec3;

/// Errors over primary and diffuse rays.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Errors {
    /// Relative.
    pub t_mean: f64,
    pub t_max: f64,
    /// 99th percentile, in units in the last place of t.
    pub t_ulps_99: f64,
    /// Absolute, the larger one of u and v.
    pub uv_mean: f64,
    pub uv_max: f64,
    /// Of a million rays: another kernel found something nearer, and f64 says that it is there.
    pub missed: f64,
}

/// Nearer than this fraction counts as something else that was hit.
const NEARER: f64 = 1e-3;
/// f64's weights this far inside a triangle are inside whatever f32 says.
const INSIDE: f64 = 1e-3;

/// Of each kernel.
pub(super) fn errors(
    kernels: &[Box<dyn Kernel>],
    triangles: &[[Vec3; 3]],
    rays: &RaySets,
) -> Vec<Errors> {
    let rays: Vec<Ray> = [&rays.closest[0], &rays.closest[2]]
        .into_iter()
        .flatten()
        .copied()
        .collect();
    let found: Vec<Vec<Option<Found>>> = kernels
        .iter()
        .map(|kernel| {
            let mut found = Vec::new();
            kernel.closest(&rays, &mut found);
            found
        })
        .collect();
    let truth = |ray: &Ray, found: &Found| {
        let corners = &triangles[found.triangle as usize];
        exact::crossing(corners, ray.origin.as_dvec3(), ray.direction.as_dvec3())
    };
    // The nearest of what any kernel found and f64 confirms.
    let nearest: Vec<f64> = (0..rays.len())
        .map(|i| {
            let all = found.iter().filter_map(|found| found[i]);
            all.map(|found| truth(&rays[i], &found))
                .filter(|[t, u, v]| *t > 0.0 && u.min(*v).min(1.0 - u - v) > INSIDE)
                .map(|[t, ..]| t)
                .fold(f64::INFINITY, f64::min)
        })
        .collect();
    found
        .iter()
        .map(|found| {
            let mut errors = Errors::default();
            let (mut ulps, mut missed) = (Vec::new(), 0usize);
            for ((ray, found), &nearest) in rays.iter().zip(found).zip(&nearest) {
                let distance = found.map_or(f64::INFINITY, |found| f64::from(found.t));
                missed += usize::from(nearest < distance * (1.0 - NEARER));
                let Some(found) = found else { continue };
                let [t, u, v] = truth(ray, found);
                if !(t.is_finite() && u.is_finite() && v.is_finite()) {
                    continue;
                }
                let off = (f64::from(found.t) - t).abs();
                let relative = off / t.abs();
                errors.t_mean += relative;
                errors.t_max = errors.t_max.max(relative);
                ulps.push(off / f64::from(found.t.next_up() - found.t));
                let uv = (f64::from(found.u) - u)
                    .abs()
                    .max((f64::from(found.v) - v).abs());
                errors.uv_mean += uv;
                errors.uv_max = errors.uv_max.max(uv);
            }
            let hits = ulps.len().max(1) as f64;
            errors.t_mean /= hits;
            errors.uv_mean /= hits;
            errors.missed = 1e6 * missed as f64 / rays.len().max(1) as f64;
            ulps.sort_by(f64::total_cmp);
            let at = (ulps.len() as f64 * 0.99) as usize;
            errors.t_ulps_99 = ulps.get(at).copied().unwrap_or(0.0);
            errors
        })
        .collect()
}
