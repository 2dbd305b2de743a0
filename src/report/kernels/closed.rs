//! Leaks: closed meshes seen from inside, rays aimed at edges and vertices.

use super::candidates::Candidate;
use super::{Found, Leaks};
use crate::bvh::Ray;
use crate::bvh::hard_cases::leaks::{Aim, closed, target};
use crate::bvh::hard_cases::random::Random;
use crate::report::{Options, Watch};
use glam::Vec3;

/// Of each kernel.
pub(super) fn leaks(candidates: &[Candidate], options: &Options, watch: Watch) -> Vec<Leaks> {
    let rays_each = if options.quick { 25_000 } else { 250_000 };
    let mut all = vec![Leaks::default(); candidates.len()];
    let meshes = closed();
    let steps = (meshes.len() * candidates.len()) as u64;
    let mut step = 0;
    for (_, mesh, inside) in &meshes {
        let triangles: Vec<[Vec3; 3]> = (0..mesh.len() as u32).map(|i| mesh.corners(i)).collect();
        let mut random = Random::new(u64::from(options.seed) + 2);
        let mut aimed = |aim| -> Vec<Ray> {
            let rays = std::iter::repeat_with(|| {
                let origin = inside(&mut random);
                Ray::new(origin, target(aim, mesh, origin, &mut random) - origin)
            });
            rays.filter(|ray| ray.direction != Vec3::ZERO)
                .take(rays_each)
                .collect()
        };
        let (edges, vertices) = (aimed(Aim::Edge), aimed(Aim::Vertex));
        for (candidate, leaks) in candidates.iter().zip(&mut all) {
            let kernel = candidate.build(&triangles);
            let mut found: Vec<Option<Found>> = Vec::new();
            let mut lost = |rays: &[Ray]| {
                kernel.closest(rays, &mut found);
                found.iter().filter(|found| found.is_none()).count() as f64
            };
            let of_a_million = 1e6 / (meshes.len() * rays_each) as f64;
            leaks.edges += lost(&edges) * of_a_million;
            leaks.vertices += lost(&vertices) * of_a_million;
            step += 1;
            watch("leaks", step, steps);
        }
    }
    all
}
