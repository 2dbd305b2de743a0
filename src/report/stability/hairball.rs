//! A million long thin triangles, against a plain tree in f64 that is itself checked by brute force.

use super::parallel::pieces;
use super::rays::teapot;
use super::{Effort, Outcome};
use crate::bvh::hard_cases::meshes::{alone, soup};
use crate::bvh::hard_cases::oracle::Tally;
use crate::bvh::hard_cases::random::Random;
use crate::bvh::hard_cases::sieve::{Columns, Sieve};
use crate::bvh::{Aggregate, BuildOptions, Hit, Ray};
use crate::report::table::digits;
use crate::report::timing::{median, seconds};
use glam::{DVec3, Vec3};
use std::hint::black_box;

/// Hairs: bent chains of thin triangles on a sphere of radius 1, each piece 1 : 500.
fn hairs(count: usize, random: &mut Random) -> Vec<[Vec3; 3]> {
    let pieces = 20;
    let mut triangles = Vec::with_capacity(count);
    while triangles.len() < count {
        let mut at = random.direction();
        let mut along = (at + 0.7 * random.cube()).normalize();
        for _ in 0..pieces {
            let next = at + along * 0.05;
            let width = along.cross(random.direction()) * 1e-4;
            triangles.push([at, next, at + width]);
            along = (along + 0.3 * random.cube()).normalize();
            at = next;
        }
    }
    triangles.truncate(count);
    triangles
}

/// The plainest tree there is: halves along the longest axis of the middles, boxes in f64.
struct Plain {
    boxes: Vec<[DVec3; 2]>,
    order: Vec<u32>,
}

/// Triangles of a leaf.
const LEAF: usize = 4;

impl Plain {
    fn build(triangles: &[[Vec3; 3]]) -> Self {
        let mut plain = Self {
            boxes: Vec::new(),
            order: (0..triangles.len() as u32).collect(),
        };
        plain
            .boxes
            .resize(2 * triangles.len().next_power_of_two(), [DVec3::ZERO; 2]);
        let mut order = std::mem::take(&mut plain.order);
        plain.split(1, &mut order, triangles);
        plain.order = order;
        plain
    }

    /// Node 1 is the root, 2n and 2n + 1 are the halves of n.
    fn split(&mut self, node: usize, order: &mut [u32], triangles: &[[Vec3; 3]]) {
        let corners = order
            .iter()
            .flat_map(|&i| triangles[i as usize])
            .map(|p| p.as_dvec3());
        let (min, max) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| {
            (min.min(p), max.max(p))
        });
        // Wider than whatever f32 may call a hit.
        let pad = DVec3::splat(1e-5 * (1.0 + min.abs().max(max.abs()).max_element()));
        self.boxes[node] = [min - pad, max + pad];
        if order.len() <= LEAF {
            return;
        }
        let size = max - min;
        let axis = (0..3)
            .max_by(|&a, &b| size[a].total_cmp(&size[b]))
            .unwrap_or(0);
        let middle = |i: u32| triangles[i as usize].iter().map(|p| p[axis]).sum::<f32>();
        let half = order.len() / 2;
        order.select_nth_unstable_by(half, |&a, &b| middle(a).total_cmp(&middle(b)));
        let (left, right) = order.split_at_mut(half);
        self.split(2 * node, left, triangles);
        self.split(2 * node + 1, right, triangles);
    }

    /// Every triangle in a leaf whose box the line of the ray meets, before what was found or where it lies: what begins
    /// behind that cannot be nearer, nor be missed in its place.
    fn near(&self, triangles: &[[Vec3; 3]], ray: &Ray, found: Option<Hit>, near: &mut Columns) {
        near.clear();
        let (origin, inverse) = (ray.origin.as_dvec3(), 1.0 / ray.direction.as_dvec3());
        let end = found.map_or(f64::INFINITY, |hit| f64::from(hit.t));
        let mut stack = vec![(1, 0, self.order.len())];
        while let Some((node, first, count)) = stack.pop() {
            let [min, max] = self.boxes[node];
            let (a, b) = ((min - origin) * inverse, (max - origin) * inverse);
            let (entry, exit) = (a.min(b).max_element(), a.max(b).min_element());
            if entry > exit || entry > end {
                continue;
            }
            if count <= LEAF {
                for &triangle in &self.order[first..first + count] {
                    near.push(triangle, triangles[triangle as usize]);
                }
                continue;
            }
            let half = count / 2;
            stack.push((2 * node, first, half));
            stack.push((2 * node + 1, first + half, count - half));
        }
    }
}

/// From outside at a place on a random hair: rays that are aimed at nothing hardly ever meet one of so thin ones.
fn at_hair(triangles: &[[Vec3; 3]], random: &mut Random) -> Ray {
    let [a, b, c] = random.of(triangles);
    let (u, v) = (random.unit(), random.unit());
    let origin = random.direction() * 3.0;
    Ray::new(origin, a + (b - a) * (u * (1.0 - v)) + (c - a) * v - origin)
}

/// Nanoseconds a ray, on one thread.
fn time(scene: &Aggregate, rays: &[Ray]) -> f64 {
    let mut hits = Vec::new();
    let times = (0..5).map(|_| {
        seconds(|| {
            scene.closest_hits(rays, &mut hits);
            black_box(&hits);
        })
    });
    1e9 * median(times.collect()) / rays.len() as f64
}

pub(super) fn hairball(effort: &Effort) -> Outcome {
    let triangles = hairs(effort.hairball, &mut Random::new(effort.seed + 35));
    let scene = alone(soup(triangles.iter().copied()), &BuildOptions::default());
    let plain = Plain::build(&triangles);
    // Every candidate costs as much as a ray elsewhere does in all.
    let rays = (effort.rays / 10).min(1_000_000);
    let tallies = pieces(rays, effort.seed, |random, count| {
        let (mut tally, mut near) = (Tally::default(), Columns::default());
        for _ in 0..count {
            let ray = at_hair(&triangles, random);
            let found = scene.closest_hit(&ray);
            plain.near(&triangles, &ray, found, &mut near);
            tally.judge_among(&scene, &ray, found, |_, ray, some| near.exact(ray, some));
        }
        tally
    });
    let mut sum = Tally::default();
    tallies.into_iter().for_each(|tally| sum.add(tally));
    // The plain tree itself: it keeps what brute force finds, so that both judge alike the answer that was found, and the
    // answer that there is nothing. (The band may differ: a triangle seen along its length is in it from afar.)
    let sieve = Sieve::of(&scene);
    let checked = (effort.rays / 10_000).clamp(10, 1_000);
    let differ: usize = pieces(checked, effort.seed + 1, |random, count| {
        let mut near = Columns::default();
        (0..count)
            .filter(|_| {
                let ray = at_hair(&triangles, random);
                [scene.closest_hit(&ray), None].into_iter().any(|found| {
                    let (mut all, mut some) = (Tally::default(), Tally::default());
                    plain.near(&triangles, &ray, found, &mut near);
                    all.judge(&scene, &sieve, &ray, found);
                    some.judge_among(&scene, &ray, found, |_, ray, some| near.exact(ray, some));
                    all.wrong != some.wrong
                })
            })
            .count()
    })
    .into_iter()
    .sum();
    let mut random = Random::new(effort.seed + 2);
    let timed: Vec<Ray> = (0..20_000)
        .map(|_| at_hair(&triangles, &mut random))
        .collect();
    let pot = alone(teapot(), &BuildOptions::default());
    let at_pot: Vec<Ray> = (0..20_000)
        .map(|_| {
            let origin = Vec3::new(0.0, 0.9, 0.0) + random.direction() * 6.0;
            Ray::new(origin, Vec3::new(0.0, 0.9, 0.0) + random.cube() - origin)
        })
        .collect();
    let (hair, pot) = (time(&scene, &timed), time(&pot, &at_pot));
    let figures = format!(
        "{} triangles: {} hits, {} wrong, {} in the band; plain tree against brute force on {checked} rays: {differ} differ; \
         {} ns a ray, {} times a teapot's",
        triangles.len(),
        sum.hits,
        sum.wrong,
        sum.in_band,
        digits(hair, 3),
        digits(hair / pot, 3)
    );
    Outcome::new(rays + checked, figures)
        .require(sum.wrong == 0, sum.first_wrong.unwrap_or_default())
        .require(
            differ == 0,
            format!("the plain tree loses {differ} of {checked}"),
        )
        .require(sum.hits * 2 > rays, "hardly a ray hits a hair")
}
