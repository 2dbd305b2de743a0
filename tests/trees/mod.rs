//! Are the trees good: by their cost, and by what rays meet in them.

use crate::analytic::Numbers;
use bevy::mesh::{Mesh, VertexAttributeValues};
use glam::{Affine3A, Vec3};
use glassbox::bvh::{
    Aggregate, BuildOptions, Builder, Counters, Instance, MeshTree, Ray, Triangles,
};
use glassbox::io::shapes;
use glassbox::scene::Shape;
use std::sync::Arc;

fn triangles(shape: &Shape) -> Triangles {
    let mesh = shapes::mesh(shape).unwrap();
    let Some(VertexAttributeValues::Float32x3(positions)) =
        mesh.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        panic!("a shape without positions");
    };
    let positions = positions.iter().map(|p| Vec3::from(*p)).collect();
    let indices: Vec<u32> = mesh.indices().unwrap().iter().map(|i| i as u32).collect();
    let indices = indices
        .chunks_exact(3)
        .map(|c| [c[0], c[1], c[2]])
        .collect();
    Triangles::new(positions, indices).unwrap()
}

fn knot(segments: u32, sides: u32) -> Shape {
    Shape::Knot {
        p: 2,
        q: 3,
        tube_radius: 0.3,
        displacement: 0.2,
        segments,
        sides,
    }
}

struct Measured {
    sah: f64,
    /// Nodes entered and triangles tested, by a ray from outside towards a point of the box.
    visits: f64,
}

fn measure(triangles: Triangles, builder: Builder) -> Measured {
    let options = BuildOptions {
        builder,
        ..BuildOptions::default()
    };
    let mesh = Arc::new(MeshTree::build(triangles, &options));
    let sah = mesh.stats().sah_cost;
    let bounds = mesh.bounds().unwrap();
    let (min, max) = (Vec3::from(bounds.min), Vec3::from(bounds.max));
    let instance = Instance::new(mesh, &Affine3A::IDENTITY).unwrap();
    let aggregate = Aggregate::build(vec![instance], &options);
    let mut numbers = Numbers(31);
    let mut counters = Counters::default();
    let rays = 4000;
    for _ in 0..rays {
        let target = min + (max - min) * numbers.point(0.0, 1.0);
        let origin = 0.5 * (min + max) + numbers.direction() * (max - min).length();
        aggregate.closest_hit_with(&Ray::new(origin, target - origin), &mut counters);
    }
    Measured {
        sah,
        visits: (counters.nodes + counters.triangles) as f64 / f64::from(rays),
    }
}

#[test]
fn binned_sah_beats_median_and_clustering_is_no_worse_than_sah_on_every_mesh() {
    let teapot = Shape::Teapot { divisions: 16 };
    let head = Shape::Head {
        segments: 24,
        rings: 22,
    };
    for (name, shape) in [
        ("teapot", teapot),
        ("head", head),
        ("87k", knot(1088, 40)),
        ("2M", knot(5000, 200)),
    ] {
        let triangles = triangles(&shape);
        let [median, sah, ploc] = [Builder::Median, Builder::Sah, Builder::Ploc]
            .map(|builder| measure(triangles.clone(), builder));
        println!(
            "{name}: SAH cost {:.2} / {:.2} / {:.2}, visits a ray {:.1} / {:.1} / {:.1} (median / SAH / PLOC)",
            median.sah, sah.sah, ploc.sah, median.visits, sah.visits, ploc.visits
        );
        assert!(
            sah.sah < median.sah,
            "{name}: SAH {} against median {}",
            sah.sah,
            median.sah
        );
        assert!(
            sah.visits < median.visits,
            "{name}: {} visits with SAH, {} with median",
            sah.visits,
            median.visits
        );
        assert!(
            ploc.sah <= 1.05 * sah.sah,
            "{name}: PLOC {} against SAH {}",
            ploc.sah,
            sah.sah
        );
    }
}

#[test]
fn visits_of_a_ray_grow_like_the_logarithm_of_the_triangles() {
    // Eight times the triangles, a level of wide nodes more: a few visits more each time, by how full the blocks are.
    let visits: Vec<f64> = [(272, 10), (768, 28), (2176, 80), (6144, 226)]
        .map(|(segments, sides)| measure(triangles(&knot(segments, sides)), Builder::Ploc).visits)
        .into();
    let steps: Vec<f64> = visits.windows(2).map(|w| w[1] - w[0]).collect();
    println!("visits {visits:.1?}, steps {steps:.1?}");
    for step in &steps {
        assert!(
            step.abs() < 0.6 * visits[0],
            "visits {visits:.1?} do not grow by steps alike: {steps:.1?}"
        );
    }
    assert!(
        visits[3] < 3.0 * visits[0],
        "512 times the triangles cost {:.1} times the visits",
        visits[3] / visits[0]
    );
}
