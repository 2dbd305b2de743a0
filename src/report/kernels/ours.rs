//! Glassbox' own traversals, through the calls that the tracer uses.

use super::{Found, Kernel};
use crate::bvh::{Aggregate, BuildOptions, Hit, Instance, MeshTree, Order, Ray, Triangles};
use glam::{Affine3A, Vec3};
use std::cell::RefCell;
use std::sync::Arc;

/// One mesh where it is. Triangles keep their numbers.
pub(super) fn aggregate(triangles: &[[Vec3; 3]], options: &BuildOptions) -> Aggregate {
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let triangles = Triangles::new(triangles.as_flattened().to_vec(), indices.collect());
    let triangles = triangles.expect("every index has its position");
    let mesh = Arc::new(MeshTree::build(triangles, options));
    let instance = Instance::new(mesh, &Affine3A::IDENTITY).expect("the identity has an inverse");
    Aggregate::build(vec![instance], options)
}

fn found(hit: Option<Hit>) -> Option<Found> {
    hit.map(
        |Hit {
             t, triangle, u, v, ..
         }| Found { t, triangle, u, v },
    )
}

/// What pictures are traced with.
pub(super) struct OursWide {
    aggregate: Arc<Aggregate>,
    /// Of the rays whose nearest hit is asked for, and of the others.
    orders: [Order; 2],
    hits: RefCell<Vec<Option<Hit>>>,
}

impl OursWide {
    pub fn build(triangles: &[[Vec3; 3]]) -> Self {
        Self::with(aggregate(triangles, &BuildOptions::default()))
    }

    pub fn with(aggregate: Aggregate) -> Self {
        Self::in_order(Arc::new(aggregate), [Order::None; 2])
    }

    /// Rays whose nearest hit is asked for come in the first order, the others in the second.
    pub fn in_order(aggregate: Arc<Aggregate>, orders: [Order; 2]) -> Self {
        Self {
            aggregate,
            orders,
            hits: RefCell::default(),
        }
    }
}

impl Kernel for OursWide {
    fn closest(&self, rays: &[Ray], all: &mut Vec<Option<Found>>) {
        let mut hits = self.hits.borrow_mut();
        self.aggregate
            .closest_hits_in(self.orders[0], rays, &mut hits);
        all.clear();
        all.extend(hits.iter().copied().map(found));
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        self.aggregate.occlusions_in(self.orders[1], rays, occluded);
    }
}
