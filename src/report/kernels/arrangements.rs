//! A large mesh, instances, and rays in packets, against the same in Embree.

use super::Kernel;
use super::against::sentence;
use super::embree;
use super::embree_eights::{InEights, instances};
use super::ours::OursWide;
use super::speed::{BATCH, rounds};
use crate::bvh::hard_cases::meshes::{moved, sphere};
use crate::bvh::hard_cases::random::Random;
use crate::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Order, Ray, Triangles};
use crate::report::timing::take_turns;
use crate::report::{Cell, Options, Section, Table, Watch};
use glam::{Affine3A, EulerRot, Quat, Vec3};
use std::hint::black_box;
use std::rc::Rc;
use std::sync::Arc;

/// One mesh in many places.
struct Arrangement {
    name: String,
    mesh: Triangles,
    places: Vec<Affine3A>,
}

fn arrangements(options: &Options) -> Vec<Arrangement> {
    let mut random = Random::new(u64::from(options.seed) + 3);
    let counts: &[usize] = if options.quick {
        &[1, 1_000]
    } else {
        &[1, 1_000, 100_000]
    };
    let bumpy = |levels| {
        let bump = |p: Vec3| {
            p * (1.0 + 0.05 * (13.0 * p.x).sin() * (11.0 * p.y).sin() * (9.0 * p.z).cos())
        };
        moved(&sphere(levels), bump)
    };
    // 2 million triangles.
    let large = bumpy(if options.quick { 6 } else { 9 });
    let large = Arrangement {
        name: format!("{} triangles", large.len()),
        mesh: large,
        places: vec![Affine3A::IDENTITY],
    };
    let scattered = counts.iter().map(|&count| {
        let side = (count as f32).cbrt();
        let place = || {
            let [x, y, z] = [0; 3].map(|_| random.between(0.0, std::f32::consts::TAU));
            let turn = Quat::from_euler(EulerRot::XYZ, x, y, z);
            let scale = Vec3::splat(random.between(0.3, 0.6));
            Affine3A::from_scale_rotation_translation(scale, turn, random.cube() * 0.5 * side)
        };
        Arrangement {
            name: format!("8192 triangles, instances: {count}"),
            mesh: bumpy(5),
            places: std::iter::repeat_with(place).take(count).collect(),
        }
    });
    std::iter::once(large).chain(scattered).collect()
}

/// Rays of three kinds: from a camera, tile by tile; diffuse ones from their hits; and from those to one light.
fn rays(scene: &Aggregate, options: &Options) -> [Vec<Ray>; 3] {
    let bounds = scene.instances().iter().filter_map(|i| i.world_bounds());
    let bounds = bounds.reduce(|a, b| a.union(&b)).unwrap_or_default();
    let (middle, size) = (Vec3::from(bounds.center()), bounds.diagonal().length());
    let eye = middle + Vec3::new(0.3, 0.4, 0.8).normalize() * size;
    let right = Vec3::Y.cross(eye - middle).normalize() * 0.5 * size;
    let up = (eye - middle).cross(right).normalize() * 0.5 * size;
    let side = if options.quick { 128 } else { 512 };
    let tiles = (0..side / 4).flat_map(|y| (0..side / 4).map(move |x| (4 * x, 4 * y)));
    let pixels = tiles.flat_map(|(x, y)| (0..16).map(move |i| (x + i % 4, y + i / 4)));
    let primary: Vec<Ray> = pixels
        .map(|(x, y)| {
            let [x, y] = [x, y].map(|i| 2.0 * (i as f32 + 0.5) / side as f32 - 1.0);
            Ray::new(eye, middle + x * right + y * up - eye)
        })
        .collect();
    let light = middle + Vec3::Y * size;
    let mut random = Random::new(u64::from(options.seed) + 4);
    let (mut diffuse, mut shadow) = (Vec::new(), Vec::new());
    for ray in &primary {
        let Some(hit) = scene.closest_hit(ray) else {
            continue;
        };
        let point = scene.instances()[hit.instance as usize].surface_point(&hit, 0.0);
        let outwards = -point.normal * ray.direction.dot(point.normal).signum();
        let scattered = outwards + 0.999 * random.direction();
        diffuse.push(scene.leaving(&point, scattered));
        let to_light = light - point.position;
        shadow.push(Ray {
            t_max: 0.9999,
            ..scene.leaving(&point, to_light)
        });
    }
    [primary, diffuse, shadow]
}

const KINDS: [&str; 3] = ["primary", "diffuse", "shadow"];

/// Adds a table, and a sentence on it.
pub(super) fn measure(options: &Options, watch: Watch, section: &mut Section) {
    let library = embree::find().ok().flatten().map(Rc::new);
    let mut table = Table::new(
        "arrangements",
        "A large mesh, instances and packets: million rays a second",
        &[
            "scene",
            "rays",
            "Glassbox, single",
            "Glassbox, packets",
            "Embree default, single",
            "Embree robust, single",
            "Embree default, eights",
            "Embree robust, eights",
        ],
    );
    let mut against = [("single rays", Vec::new()), ("packets", Vec::new())];
    for arrangement in arrangements(options) {
        watch(&arrangement.name, 0, 1);
        let Arrangement { name, mesh, places } = arrangement;
        let scene = shared(mesh.clone(), &places);
        let rays = rays(&scene, options);
        let scene = Arc::new(scene);
        let mut kernels: Vec<Box<dyn Kernel>> = vec![
            Box::new(OursWide::in_order(scene.clone(), [Order::None; 2])),
            Box::new(OursWide::in_order(scene, [Order::Tile, Order::Light])),
        ];
        if let Some(library) = &library {
            let triangles: Vec<[Vec3; 3]> =
                (0..mesh.len() as u32).map(|i| mesh.corners(i)).collect();
            let both = [false, true].map(|robust| {
                let of = library.clone();
                Rc::new(if places == [Affine3A::IDENTITY] {
                    embree::Embree::build(of, &triangles, robust)
                } else {
                    instances(of, &triangles, &places, robust)
                })
            });
            let single = both
                .iter()
                .map(|of| Box::new(of.clone()) as Box<dyn Kernel>);
            let eights = both
                .iter()
                .map(|of| Box::new(InEights(of.clone())) as Box<dyn Kernel>);
            kernels.extend(single.chain(eights));
        }
        for (kind, rays) in KINDS.iter().zip(&rays) {
            let (mut found, mut occluded) = (Vec::new(), Vec::new());
            let seconds = take_turns(kernels.len(), rounds(options), |kernel| {
                for rays in rays.chunks(BATCH) {
                    if *kind == "shadow" {
                        kernels[kernel].occluded(rays, &mut occluded);
                    } else {
                        kernels[kernel].closest(rays, &mut found);
                    }
                    black_box((&found, &occluded));
                }
            });
            let speed = |kernel: usize| -> Option<f64> {
                // Diffuse rays go apart: nobody traces them in packets.
                let is_packet = [1, 4, 5].contains(&kernel);
                let seconds = seconds
                    .get(kernel)
                    .filter(|_| !(is_packet && *kind == "diffuse"))?;
                Some(rays.len() as f64 / seconds / 1e6)
            };
            let [
                ours,
                packets,
                default,
                robust,
                default_eights,
                robust_eights,
            ] = std::array::from_fn(|kernel| Cell::from(speed(kernel)));
            table.push([
                name.as_str().into(),
                (*kind).into(),
                ours,
                packets,
                default,
                robust,
                default_eights,
                robust_eights,
            ]);
            for ((_, ratios), (ours, theirs)) in against.iter_mut().zip([(0, 3), (1, 5)]) {
                let ratio = speed(ours)
                    .zip(speed(theirs))
                    .map(|(ours, theirs)| ours / theirs);
                ratios.extend(ratio.map(|ratio| (ratio, format!("{kind} rays, {name}"))));
            }
        }
    }
    for (what, ratios) in &against {
        section
            .findings
            .extend(sentence(what, "Embree robust", ratios));
    }
    section.tables.push(table);
}

/// One tree for all places.
fn shared(mesh: Triangles, places: &[Affine3A]) -> Aggregate {
    let options = BuildOptions::default();
    let mesh = Arc::new(MeshTree::build(mesh, &options));
    let instances = places
        .iter()
        .filter_map(|place| Instance::new(mesh.clone(), place).ok());
    Aggregate::build(instances.collect(), &options)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::kernels::Found;

    #[test]
    fn instances_and_eights_of_embree_find_what_ours_find() {
        let Ok(Some(library)) = embree::find() else {
            println!("NOT TESTED, since this machine has no Embree");
            return;
        };
        let mesh = sphere(3);
        let places = [Vec3::ZERO, Vec3::X * 2.5].map(|at| {
            Affine3A::from_scale_rotation_translation(
                Vec3::splat(0.9),
                Quat::from_rotation_y(1.0),
                at,
            )
        });
        let ours = OursWide::with(shared(mesh.clone(), &places));
        let triangles: Vec<[Vec3; 3]> = (0..mesh.len() as u32).map(|i| mesh.corners(i)).collect();
        let theirs = Rc::new(instances(Rc::new(library), &triangles, &places, true));
        let mut random = Random::new(8);
        let rays: Vec<Ray> = (0..1_003)
            .map(|_| {
                let origin = random.cube() * 4.0;
                Ray::new(origin, random.cube() * 2.0 + Vec3::X - origin)
            })
            .collect();
        let kernels: [Box<dyn Kernel>; 3] = [
            Box::new(ours),
            Box::new(theirs.clone()),
            Box::new(InEights(theirs)),
        ];
        let answers = kernels.map(|kernel| {
            let (mut found, mut occluded) = (Vec::new(), Vec::new());
            kernel.closest(&rays, &mut found);
            kernel.occluded(&rays, &mut occluded);
            (found, occluded)
        });
        let (expected, seen) = &answers[0];
        assert!(expected.iter().flatten().count() > 300, "too few hits");
        for (name, (found, occluded)) in ["single", "eights"].iter().zip(&answers[1..]) {
            let near = |a: &Option<Found>, b: &Option<Found>| match (a, b) {
                (Some(a), Some(b)) => (a.t / b.t - 1.0).abs() < 1e-4,
                (a, b) => a.is_none() && b.is_none(),
            };
            let apart = expected
                .iter()
                .zip(found)
                .filter(|(a, b)| !near(a, b))
                .count();
            let unseen = seen.iter().zip(occluded).filter(|(a, b)| a != b).count();
            // On a silhouette rounding decides.
            assert!(
                apart + unseen <= 4,
                "{name}: {apart} hits and {unseen} occlusions differ"
            );
        }
    }
}
