//! What the trees of a world are like for one view: how large they are, and what rays look at of them.

use super::build_time;
use crate::bvh::Counters;
use crate::scene::RenderSettings;
use crate::trace::{Camera, FirstHit, RayTree, World, central_hits};
use bevy::platform::collections::HashSet;
use glam::UVec2;
use std::sync::Arc;
use std::time::Duration;

/// Pixels along each side of the grid whose rays are counted.
const GRID: u32 = 24;

/// All trees of a world together, a mesh that objects share counted once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeCounts {
    /// Nodes, leaves included.
    pub nodes: u64,
    /// Leaves.
    pub leaves: u64,
    /// From the root of the top tree to the deepest leaf.
    pub levels: u32,
    /// Of nodes and indices.
    pub bytes: u64,
    /// Wall clock.
    pub build_time: Duration,
    /// Expected cost of a random ray that hits the box of all: in the top tree, and in the tree of the mesh that has most
    /// triangles, where there is one.
    pub sah_costs: [Option<f64>; 2],
    /// What the rays through the middles of the view's pixels look at, the mean over a grid of them: boxes, nodes,
    /// triangles.
    pub per_camera_ray: [f64; 3],
    /// What all rays of the picked pixel look at.
    pub of_pixel: Option<Counters>,
}

impl TreeCounts {
    /// Counts what a camera sees, and what the rays of a pixel do there. Looks at every node.
    pub fn of(
        world: &World,
        camera: &Camera,
        settings: &RenderSettings,
        rays: Option<&RayTree>,
    ) -> Self {
        let aggregate = &world.aggregate;
        let top = aggregate.stats();
        let two = aggregate.options().levels == crate::bvh::Levels::Two;
        let mut counts = Self {
            nodes: top.nodes as u64,
            leaves: top.leaves as u64,
            bytes: top.bytes as u64,
            build_time: build_time(world),
            sah_costs: [Some(top.sah_cost), None],
            ..Self::default()
        };
        let (mut seen, mut deepest, mut most) = (HashSet::new(), 0, 0);
        let meshes = world.objects.iter().map(|object| &object.mesh.tree);
        for tree in meshes.filter(|tree| two && seen.insert(Arc::as_ptr(tree))) {
            let stats = tree.stats();
            counts.nodes += stats.nodes as u64;
            counts.leaves += stats.leaves as u64;
            counts.bytes += stats.bytes as u64;
            deepest = deepest.max(stats.levels);
            if tree.traced() > most {
                most = tree.traced();
                counts.sah_costs[1] = Some(stats.sah_cost);
            }
        }
        counts.levels = top.levels + deepest;
        let cell = |i: u32| UVec2::new(i % GRID, i / GRID);
        let pixels: Vec<UVec2> = (0..GRID * GRID)
            .map(|i| (2 * cell(i) + UVec2::ONE) * settings.size / (2 * GRID))
            .collect();
        let mut hits = vec![FirstHit::MISS; pixels.len()];
        central_hits(world, camera, settings, &pixels, &mut hits);
        let mean = |of: fn(&Counters) -> u64| {
            let sum: u64 = hits.iter().map(|hit| of(&hit.cost)).sum();
            sum as f64 / hits.len() as f64
        };
        counts.per_camera_ray = [
            mean(|cost| cost.boxes),
            mean(|cost| cost.nodes),
            mean(|cost| cost.triangles),
        ];
        counts.of_pixel = rays.map(|rays| {
            let mut cost = Counters::default();
            for index in 0..rays.rays.len() as u32 {
                rays.retrace(world, settings, index, &mut cost);
            }
            cost
        });
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::super::rebuilt;
    use super::*;
    use crate::app::headless_app;
    use crate::bvh::{BuildOptions, Builder};
    use crate::io::{OpenOptions, SceneSource, open};
    use crate::sync::{Traced, TracedCameras};
    use crate::trace::{Samples, probe};

    #[test]
    fn counts_are_those_of_the_rays_and_better_trees_have_fewer() {
        let mut app = headless_app();
        let source = SceneSource::named(std::path::Path::new("knot"));
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        app.update();
        let world = app.world().resource::<Traced>().world.clone();
        let camera = &app.world().resource::<TracedCameras>().0[0].camera;
        let settings = RenderSettings {
            size: UVec2::new(96, 96),
            ..app.world().resource::<RenderSettings>().clone()
        };
        let pixel = UVec2::new(48, 40);
        let rays = probe(&world, camera, &settings, pixel, &Samples::One(0)).unwrap();
        let counts = TreeCounts::of(&world, camera, &settings, Some(&rays));
        let told = rays
            .rays
            .iter()
            .fold(Counters::default(), |sum, ray| Counters {
                boxes: sum.boxes + ray.cost.boxes,
                nodes: sum.nodes + ray.cost.nodes,
                triangles: sum.triangles + ray.cost.triangles,
            });
        assert_eq!(counts.of_pixel, Some(told));
        let options = BuildOptions {
            builder: Builder::Median,
            ..*world.aggregate.options()
        };
        let median = TreeCounts::of(&rebuilt(&world, &options), camera, &settings, None);
        assert!(median.of_pixel.is_none() && median.nodes > 1000);
        assert!(median.sah_costs[1] > counts.sah_costs[1]);
        assert!(
            median.per_camera_ray[0] > counts.per_camera_ray[0],
            "{:?} against {:?}",
            median.per_camera_ray,
            counts.per_camera_ray
        );
    }
}
