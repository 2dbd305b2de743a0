//! Cases of rays and triangles alone.

use super::parallel::{count, pieces, tally};
use super::{Effort, Outcome};
use crate::bvh::hard_cases::broken::{
    degenerate as points_and_lines, not_finite as odd, with_extra,
};
use crate::bvh::hard_cases::leaks::{AIMS, Aim, FAR, away, closed, leaks};
use crate::bvh::hard_cases::meshes::{
    alone, cube, joined, mesh, moved, placed, scatter, soup, sphere,
};
use crate::bvh::hard_cases::oracle::{Tally, same};
use crate::bvh::hard_cases::random::Random;
use crate::bvh::hard_cases::rays as shoot;
use crate::bvh::hard_cases::spawned::{self_hits, triangles_of_all_sizes};
use crate::bvh::hard_cases::transforms::any_transform;
use crate::bvh::{
    Aggregate, BuildOptions, Builder, Counters, Instance, Levels, MeshTree, Ray, Triangles,
};
use crate::io::shapes;
use crate::report::table::digits;
use crate::scene::Shape;
use bevy::mesh::{Mesh, VertexAttributeValues};
use glam::{Affine3A, Vec3};
use std::sync::Arc;

fn usual() -> BuildOptions {
    BuildOptions::default()
}

fn leaking(effort: &Effort, offset: Vec3, aims: &[Aim]) -> Outcome {
    // Rounding to coordinates of 1/64 takes points that are near walls to the other side.
    let meshes: Vec<_> = (closed().into_iter())
        .filter(|(name, ..)| offset == Vec3::ZERO || !name.contains("near"))
        .collect();
    let rays = effort.rays / (meshes.len() * aims.len());
    let mut figures = Vec::new();
    let (mut all, mut first) = (0, None);
    for (name, mesh, inside) in &meshes {
        let scene = away(mesh, offset);
        let mut lost = 0;
        for &aim in aims {
            let found = pieces(rays, effort.seed + aim as u64, |random, count| {
                leaks(&scene, *inside, offset, aim, count, random)
            });
            lost += found.iter().map(|(lost, _)| lost).sum::<usize>();
            first = first.or(found.into_iter().find_map(|(_, first)| first));
        }
        figures.push(format!("{name} {lost}"));
        all += lost;
    }
    Outcome::new(
        rays * meshes.len() * aims.len(),
        format!("leaks: {}", figures.join(", ")),
    )
    .require(all == 0, format!("{all} leaks, first {first:?}"))
}

pub(super) fn leaks_anywhere(effort: &Effort) -> Outcome {
    leaking(effort, Vec3::ZERO, &[Aim::Anywhere])
}

pub(super) fn leaks_at_edges(effort: &Effort) -> Outcome {
    leaking(effort, Vec3::ZERO, &[Aim::Edge])
}

pub(super) fn leaks_at_vertices(effort: &Effort) -> Outcome {
    leaking(effort, Vec3::ZERO, &[Aim::Vertex])
}

pub(super) fn leaks_far_away(effort: &Effort) -> Outcome {
    leaking(effort, FAR, &AIMS)
}

/// What both oracles say, in words.
fn judged(tally: &Tally) -> Outcome {
    let figures = format!(
        "{} hits, {} wrong against f32, {} against f64, {} in the band",
        tally.hits, tally.unlike_brute_force, tally.wrong, tally.in_band
    );
    Outcome::new(tally.rays, figures)
        .require(
            tally.is_right(),
            tally.first_wrong.clone().unwrap_or_default(),
        )
        .require(tally.hits * 100 > tally.rays, "hardly a ray hits anything")
}

pub(super) fn signed_zeros(effort: &Effort) -> Outcome {
    let scene = alone(shoot::boxed(), &usual());
    judged(&tally(
        &scene,
        effort.rays,
        effort.seed,
        shoot::signed_zeros,
    ))
}

pub(super) fn thin_targets(effort: &Effort) -> Outcome {
    let scene = alone(shoot::thin_targets(), &usual());
    let misses = count(effort.rays, effort.seed, |random| {
        scene.closest_hit(&shoot::at_thin_target(random)).is_none()
    });
    Outcome::new(effort.rays, format!("{misses} misses"))
        .require(misses == 0, format!("{misses} misses"))
}

pub(super) fn in_planes(effort: &Effort) -> Outcome {
    let heights = [0.0, 0.3, -1e5];
    let rays = effort.rays / 4;
    let mut hits = 0;
    for height in heights {
        let scene = alone(shoot::flat_square(height), &usual());
        hits += count(rays, effort.seed, |random| {
            scene
                .closest_hit(&shoot::in_plane(height, random))
                .is_some()
        });
    }
    let boxed = alone(cube(), &usual());
    let in_faces = tally(&boxed, rays, effort.seed, shoot::in_faces);
    let nan = count(rays, effort.seed, |random| {
        let hit = boxed.closest_hit(&shoot::in_faces(random));
        hit.is_some_and(|hit| !(hit.t + hit.u + hit.v).is_finite())
    });
    let figures = format!(
        "{hits} hits in a triangle's own plane, {nan} NaN; in a box's faces {} hits, {} wrong",
        in_faces.hits,
        in_faces.wrong + in_faces.unlike_brute_force
    );
    Outcome::new(4 * rays, figures)
        .require(hits == 0, format!("{hits} rays in a plane hit"))
        .require(nan == 0, format!("{nan} hits are not numbers"))
        .require(
            in_faces.is_right(),
            in_faces.first_wrong.unwrap_or_default(),
        )
}

pub(super) fn scales(effort: &Effort) -> Outcome {
    let exponents = [-20, -17, -10, -1, 1, 7, 13, 20];
    let others = [1e-6, 1e-3, 0.1, 3.0, 1e3, 1e6];
    let rays = effort.rays / (exponents.len() + others.len());
    let unscaled = alone(shoot::mixed(), &usual());
    let mut differ = 0;
    for exponent in exponents {
        let scale = (exponent as f32).exp2();
        let scene = alone(moved(&shoot::mixed(), |p| p * scale), &usual());
        differ += count(rays, effort.seed, |random| {
            let ray = shoot::into_unit(random);
            let scaled = Ray::new(ray.origin * scale, ray.direction);
            let mut hit = scene.closest_hit(&scaled);
            if let Some(hit) = &mut hit {
                hit.t /= scale;
            }
            !same(hit, unscaled.closest_hit(&ray))
        });
    }
    let mut sum = Tally::default();
    for scale in others {
        let scene = alone(moved(&shoot::mixed(), |p| p * scale), &usual());
        sum.add(tally(&scene, rays, effort.seed, |random| {
            let ray = shoot::into_unit(random);
            Ray::new(ray.origin * scale, ray.direction * scale)
        }));
    }
    let oracles = judged(&sum);
    let mut outcome = Outcome::new(
        rays * (exponents.len() + others.len()),
        format!(
            "powers of two: {differ} hits differ; others: {}",
            oracles.figures
        ),
    )
    .require(
        differ == 0,
        format!("{differ} hits differ at powers of two"),
    );
    outcome.faults.extend(oracles.faults);
    outcome
}

/// Figures of t besides those of the oracles.
fn with_t(tally: &Tally) -> Outcome {
    let mut outcome = judged(tally);
    outcome.figures += &format!(
        "; t off by at most {} relative, {} of its bound",
        digits(tally.worst_t, 2),
        digits(tally.worst_of_bound, 2)
    );
    outcome
}

pub(super) fn offsets(effort: &Effort) -> Outcome {
    let distances = [1e2, 1e3, 1e4, 1e5, 1e6];
    let mut sum = Tally::default();
    for distance in distances {
        let offset = Vec3::new(1.0, -0.7, 0.4) * distance;
        let scene = away(&shoot::mixed(), offset);
        sum.add(tally(
            &scene,
            effort.rays / distances.len(),
            effort.seed,
            |random| {
                let ray = shoot::into_unit(random);
                Ray::new(ray.origin + offset, ray.direction)
            },
        ));
    }
    with_t(&sum)
}

/// A shape's triangles.
pub(super) fn triangles(shape: &Shape) -> Triangles {
    let made = shapes::mesh(shape).expect("the report's own shapes have sane numbers");
    let Some(VertexAttributeValues::Float32x3(positions)) =
        made.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        return Triangles::default();
    };
    let positions = positions.iter().copied().map(Vec3::from).collect();
    let indices: Vec<u32> = made
        .indices()
        .into_iter()
        .flat_map(|indices| indices.iter())
        .map(|i| i as u32)
        .collect();
    let (corners, _) = indices.as_chunks::<3>();
    mesh(positions, corners.to_vec())
}

/// Newell's.
pub(super) fn teapot() -> Triangles {
    triangles(&Shape::Teapot { divisions: 16 })
}

pub(super) fn stadium(effort: &Effort) -> Outcome {
    let stadium = moved(&cube(), |p| p * 1e6);
    let without = alone(teapot(), &usual());
    let as_one = alone(joined(&[teapot(), stadium.clone()]), &usual());
    let apart = placed(
        &[
            (teapot(), Affine3A::IDENTITY),
            (stadium, Affine3A::IDENTITY),
        ],
        &usual(),
    );
    // Inside the pot's body, farther from its wall than a ray from the stands is rounded.
    let inside = |random: &mut Random| Vec3::new(0.0, 0.9, 0.0) + random.cube() * 0.3;
    // Rounded as they are from afar, those rays ask two thousand boxes each: a tenth of them takes as long as the others.
    let (near, far) = (effort.rays * 4 / 17, effort.rays / 34);
    let mut counted = 0;
    let (mut differ, mut cliffs, mut figures) = (0, 0, Vec::new());
    for (what, scene) in [("one mesh", &as_one), ("two meshes", &apart)] {
        for (from, rays) in [(4.0, near), (1e3, near), (9e5, far)] {
            counted += rays;
            let found = pieces(rays, effort.seed, |random, count| {
                let (mut differ, mut with, mut alone) =
                    (0, Counters::default(), Counters::default());
                for _ in 0..count {
                    let origin = random.direction() * from;
                    let ray = Ray::new(origin, inside(random) - origin);
                    let hit = scene.closest_hit_with(&ray, &mut with);
                    // What is seen of the teapot is seen in the stadium too, bit for bit.
                    let expected = without.closest_hit_with(&ray, &mut alone);
                    differ += usize::from(expected.is_some() && !same(hit, expected));
                }
                let work = |c: Counters| c.boxes + c.triangles;
                (differ, work(with), work(alone))
            });
            differ += found.iter().map(|f| f.0).sum::<usize>();
            let work = |f: fn(&(usize, u64, u64)) -> u64| {
                found.iter().map(f).sum::<u64>() as f64 / rays as f64
            };
            let (with, alone) = (work(|f| f.1), work(|f| f.2));
            cliffs += usize::from(with > 2.0 * alone + 40.0);
            figures.push(format!("{what} from {from:e}: {with:.0} for {alone:.0}"));
        }
    }
    let figures = format!(
        "{differ} hits differ from the teapot's alone; boxes and triangles a ray, {}",
        figures.join(", ")
    );
    Outcome::new(counted, figures)
        .require(
            differ == 0,
            format!("{differ} rays miss what they hit without the stadium"),
        )
        .require(cliffs == 0, "the stadium makes rays dear")
}

pub(super) fn slivers(effort: &Effort) -> Outcome {
    let slivers = shoot::slivers(300, &mut Random::new(effort.seed + 14));
    let scene = alone(soup(slivers.iter().copied()), &usual());
    // Three hundred triangles a ray: a tenth of the rays takes as long as other cases.
    with_t(&tally(&scene, effort.rays / 10, effort.seed, |random| {
        shoot::at_one_of(&slivers, random)
    }))
}

pub(super) fn degenerate(effort: &Effort) -> Outcome {
    let extra = points_and_lines(&mut Random::new(3));
    let (broken, number) = with_extra(&extra);
    let counted = broken.degenerate() as usize;
    let scene = alone(broken, &usual());
    let hit = count(effort.rays, effort.seed, |random| {
        let [a, b, _] = random.of(&extra);
        let to = if random.unit() < 0.5 {
            (a + b) * 0.5
        } else {
            random.cube()
        };
        let origin = random.cube() * 3.0;
        let hit = scene.closest_hit(&Ray::new(origin, to - origin));
        hit.is_some_and(|hit| (hit.triangle as usize) < number)
    });
    Outcome::new(
        effort.rays,
        format!("{counted} of {number} counted, hit {hit} times"),
    )
    .require(counted == number, format!("{counted} of {number} counted"))
    .require(hit == 0, format!("hit {hit} times"))
}

pub(super) fn not_finite(effort: &Effort) -> Outcome {
    let extra = odd(&mut Random::new(4));
    let (broken, number) = with_extra(&extra);
    let left_out = broken.left_out() as usize;
    let (broken, intact) = (alone(broken, &usual()), alone(with_extra(&[]).0, &usual()));
    let differ = count(effort.rays, effort.seed, |random| {
        let ray = shoot::into_unit(random);
        let mut hit = broken.closest_hit(&ray);
        if let Some(hit) = &mut hit {
            hit.triangle = hit.triangle.wrapping_sub(number as u32);
        }
        !same(hit, intact.closest_hit(&ray))
    });
    let error = Triangles::new(vec![Vec3::ZERO; 3], vec![[0, 1, 2], [0, 1, 3]]).err();
    let error = error.map_or_else(String::new, |error| error.to_string());
    Outcome::new(
        effort.rays,
        format!("{left_out} of {number} left out, {differ} hits of the rest differ; index out of range: “{error}”"),
    )
    .require(left_out == number, format!("{left_out} of {number} left out"))
    .require(differ == 0, format!("{differ} hits differ"))
    .require(error.contains("triangle 1"), "an index out of range is no error")
}

pub(super) fn not_numbers(effort: &Effort) -> Outcome {
    let scene = alone(cube(), &usual());
    let hit = count(effort.rays, effort.seed, |random| {
        let ray = shoot::not_numbers(random);
        let hit = scene.closest_hit(&ray);
        hit.is_some() != scene.occluded(&ray) || hit.is_some() && !shoot::is_ray(&ray)
    });
    Outcome::new(effort.rays, format!("{hit} hits"))
        .require(hit == 0, format!("{hit} rays that are none hit"))
}

pub(super) fn nothing(effort: &Effort) -> Outcome {
    let empty = || mesh(Vec::new(), Vec::new());
    let only_points = || mesh(vec![Vec3::ONE; 2], vec![[0, 1, 0]; 4]);
    let (mut scenes, mut wrong) = (0, 0);
    let rays = effort.rays / 100;
    for builder in [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc] {
        for levels in [Levels::One, Levels::Two] {
            let options = BuildOptions {
                builder,
                levels,
                ..usual()
            };
            let all = [
                Aggregate::default(),
                Aggregate::build(Vec::new(), &options),
                alone(empty(), &options),
                alone(only_points(), &options),
            ];
            for scene in &all {
                scenes += 1;
                wrong += count(rays, effort.seed, |random| {
                    let ray = shoot::into_unit(random);
                    scene.closest_hit(&ray).is_some() || scene.occluded(&ray)
                });
            }
            let one = alone(
                mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]),
                &options,
            );
            let judged = tally(&one, rays, effort.seed, shoot::into_unit);
            wrong += judged.wrong + judged.unlike_brute_force;
            scenes += 1;
        }
    }
    let clean = super::environment::empty_world_is_clean();
    Outcome::new(
        scenes * rays,
        format!("{scenes} scenes, {wrong} wrong answers; the picture is the background: {clean}"),
    )
    .require(wrong == 0, format!("{wrong} wrong answers"))
    .require(clean, "the picture of nothing is not the background")
}

pub(super) fn spawned(effort: &Effort) -> Outcome {
    let (scene, targets) = triangles_of_all_sizes(&mut Random::new(effort.seed + 17));
    // Each ray that hits spawns two.
    let found = pieces(effort.rays / 2, effort.seed, |random, count| {
        self_hits(&scene, &targets, count, random)
    });
    let (rays, same) = found
        .into_iter()
        .fold((0, 0), |sum, f| (sum.0 + f.0, sum.1 + f.1));
    Outcome::new(rays, format!("{same} self-hits")).require(same == 0, format!("{same} self-hits"))
}

pub(super) fn instances(effort: &Effort) -> Outcome {
    let rounds = 50;
    let shape = joined(&[sphere(1), scatter(40, 0.7, 5)]);
    let mut random = Random::new(effort.seed + 41);
    let mut sum = Tally::default();
    for _ in 0..rounds {
        let transform = any_transform(&mut random);
        let scene = placed(&[(shape.clone(), transform)], &usual());
        sum.add(tally(&scene, effort.rays / rounds, effort.seed, |random| {
            let (from, to) = (random.cube() * 3.0, random.cube());
            let from = transform.transform_point3(from);
            Ray::new(from, transform.transform_point3(to) - from)
        }));
    }
    let mesh = Arc::new(MeshTree::build(cube(), &usual()));
    let flat = Instance::new(mesh, &Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0))).err();
    let flat = flat.map_or_else(String::new, |error| error.to_string());
    let mut outcome = judged(&sum);
    outcome.figures += &format!("; singular: “{flat}”");
    outcome.require(
        flat.contains("singular"),
        "a singular transform is no error",
    )
}
