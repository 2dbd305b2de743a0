//! Scenes and rays that divide by zero, are very thin, or are no rays at all.

use glam::Vec3;

use super::{
    meshes::{cube, joined, scatter, soup, sphere},
    random::Random,
};
use crate::bvh::{Ray, TriangleId, Triangles};

/// Triangles of all kinds in a cube of side 2.
pub(crate) fn mixed() -> Triangles {
    joined(&[scatter(90, 0.5, 21), sphere(1), cube()])
}

/// From around a mesh of size 1 to somewhere in it.
pub(crate) fn into_unit(random: &mut Random) -> Ray {
    let origin = random.cube() * 2.0;
    Ray::new(origin, random.cube() - origin)
}

/// What [`signed_zeros`] are shot at.
pub(crate) fn boxed() -> Triangles {
    joined(&[scatter(120, 0.6, 3), cube()])
}

/// Directions with components that are signed zeros or tiny, from on faces, edges and corners of a cube too.
pub(crate) fn signed_zeros(random: &mut Random) -> Ray {
    const PARTS: [f32; 10] = [-0.0, 0.0, 1e-9, -1e-9, 1e-38, -1e-38, 1e-45, 1.0, -1.0, 0.3];
    const PLACES: [f32; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];
    loop {
        let three = |choices: &[f32], random: &mut Random| {
            Vec3::new(random.of(choices), random.of(choices), random.of(choices))
        };
        let origin = if random.unit() < 0.5 {
            three(&PLACES, random)
        } else {
            random.cube()
        };
        let direction = three(&PARTS, random);
        if direction != Vec3::ZERO {
            return Ray::new(origin, direction);
        }
    }
}

/// Half of the side of [`thin_targets`], and how far away they are.
const HALF: f32 = 0.5e-5;
const AWAY: f32 = 1e4;

/// Along the axes, and against them.
fn axes() -> [Vec3; 6] {
    [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z]
}

/// Six squares 1e-5 wide, 1e4 away along each axis.
pub(crate) fn thin_targets() -> Triangles {
    let positive = [Vec3::X, Vec3::Y, Vec3::Z];
    soup(axes().into_iter().flat_map(|ahead| {
        let across = (0..3).find(|&i| ahead[i] == 0.0).unwrap_or(0);
        let right = positive[across];
        let up = right.cross(ahead);
        let corner = |x: f32, y: f32| (right * x + up * y) * HALF + ahead * AWAY;
        let [a, b, c, d] =
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| corner(x, y));
        [[a, b, c], [a, c, d]]
    }))
}

/// Along an axis, at one of the [`thin_targets`].
pub(crate) fn at_thin_target(random: &mut Random) -> Ray {
    let direction = random.of(&axes());
    Ray::new(
        random.cube() * HALF * (Vec3::ONE - direction.abs()),
        direction,
    )
}

/// A square in the plane z = height.
pub(crate) fn flat_square(height: f32) -> Triangles {
    let [a, b, c, d] =
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, height));
    soup([[a, b, c], [a, c, d]])
}

/// In the plane z = height.
pub(crate) fn in_plane(height: f32, random: &mut Random) -> Ray {
    let mut flat = |scale: f32| {
        let v = random.cube() * scale;
        Vec3::new(
            random.of(&[v.x, 0.0, 1.0, -1.0]),
            random.of(&[v.y, 0.0, 1.0, -1.0]),
            0.0,
        )
    };
    Ray::new(flat(2.0) + Vec3::Z * height, flat(1.0))
}

/// In the planes of a cube's faces, as often as not.
pub(crate) fn in_faces(random: &mut Random) -> Ray {
    const TOWARDS: [Vec3; 5] = [
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(0.0, 1.0, -1.0),
    ];
    let place = |random: &mut Random| random.of(&[-2.0, -1.0, 1.0, 0.5]);
    let origin = Vec3::new(place(random), place(random), place(random));
    Ray::new(origin, random.of(&TOWARDS) * random.of(&[1.0, -1.0]))
}

/// With a NaN or an infinity somewhere, as a rule.
pub(crate) fn not_numbers(random: &mut Random) -> Ray {
    const ODD: [f32; 6] = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        0.0,
        1.0,
    ];
    let mut three = || Vec3::new(random.of(&ODD), random.of(&ODD), random.of(&ODD));
    Ray {
        origin: three(),
        direction: three(),
        t_max: random.of(&ODD),
        time: random.of(&ODD),
        starts_on: TriangleId::NONE,
    }
}

/// Whether [`not_numbers`] gave a ray that may hit something.
pub(crate) fn is_ray(ray: &Ray) -> bool {
    ray.origin.is_finite()
        && ray.direction.is_finite()
        && ray.direction != Vec3::ZERO
        && ray.t_max > 0.0
        && (0.0..=1.0).contains(&ray.time)
}

/// Triangles a million times longer than wide.
pub(crate) fn slivers(count: usize, random: &mut Random) -> Vec<[Vec3; 3]> {
    (0..count)
        .map(|_| {
            let (start, along) = (random.cube(), random.direction());
            let across = along.cross(random.direction()) * 1e-6;
            [start, start + along, start + along * random.unit() + across]
        })
        .collect()
}

/// At a place on one of these triangles.
pub(crate) fn at_one_of(triangles: &[[Vec3; 3]], random: &mut Random) -> Ray {
    let [a, b, c] = random.of(triangles);
    let (u, v) = (random.unit(), random.unit());
    let origin = random.cube() * 2.0;
    Ray::new(origin, a + (b - a) * (u * (1.0 - v)) + (c - a) * v - origin)
}
