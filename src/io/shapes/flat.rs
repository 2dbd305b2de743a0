//! Shapes with flat sides.

use super::ShapeError;
use super::surface::{Surface, normal_of};
use bevy::math::{DVec2, DVec3};

/// Texture coordinates of a quadrilateral's corners: lower left, lower right, upper right, upper left.
const WHOLE_TEXTURE: [DVec2; 4] = [
    DVec2::new(0.0, 1.0),
    DVec2::new(1.0, 1.0),
    DVec2::new(1.0, 0.0),
    DVec2::new(0.0, 0.0),
];

pub(super) fn triangle(corners: [DVec3; 3]) -> Result<Surface, ShapeError> {
    if normal_of(corners) == DVec3::ZERO {
        return Err(ShapeError::NoArea { shape: "Triangle" });
    }
    let mut surface = Surface::default();
    let [left, right, _, _] = WHOLE_TEXTURE;
    surface.flat_triangle(corners, [left, right, DVec2::new(0.5, 0.0)]);
    Ok(surface)
}

pub(super) fn quad(corner: DVec3, edges: [DVec3; 2]) -> Result<Surface, ShapeError> {
    if edges[0].cross(edges[1]).normalize_or_zero() == DVec3::ZERO {
        return Err(ShapeError::NoArea { shape: "Quad" });
    }
    let mut surface = Surface::default();
    surface.flat_parallelogram(corner, edges);
    Ok(surface)
}

pub(super) fn ground(size: DVec2, tile: DVec2) -> Surface {
    let mut surface = Surface::default();
    let [a, b, c, d] = WHOLE_TEXTURE.map(|uv| {
        let place = (uv - 0.5) * size;
        surface.vertex(
            DVec3::new(place.x, 0.0, place.y),
            DVec3::Y,
            uv * size / tile,
        )
    });
    surface.triangle([a, b, c]);
    surface.triangle([a, c, d]);
    surface
}

/// Two triangles, each with its own normal: the four corners need not lie in one plane.
pub(super) fn quadrilateral(corners: [DVec3; 4]) -> Result<Surface, ShapeError> {
    let halves = [[0, 1, 2], [0, 2, 3]];
    let [first, second] = halves.map(|half| normal_of(half.map(|k| corners[k])));
    if first.dot(second) <= 0.0 {
        return Err(ShapeError::NotConvex {
            shape: "Quadrilateral",
        });
    }
    let mut surface = Surface::default();
    for half in halves {
        surface.flat_triangle(half.map(|k| corners[k]), half.map(|k| WHOLE_TEXTURE[k]));
    }
    Ok(surface)
}

pub(super) fn cuboid(size: DVec3) -> Surface {
    // Each side: where it faces, and which way its texture's right and top point.
    let sides = [
        (DVec3::X, DVec3::NEG_Z, DVec3::Y),
        (DVec3::NEG_X, DVec3::Z, DVec3::Y),
        (DVec3::Y, DVec3::X, DVec3::NEG_Z),
        (DVec3::NEG_Y, DVec3::X, DVec3::Z),
        (DVec3::Z, DVec3::X, DVec3::Y),
        (DVec3::NEG_Z, DVec3::NEG_X, DVec3::Y),
    ];
    let mut surface = Surface::default();
    for (normal, right, up) in sides {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| (normal + right * x + up * y) * 0.5 * size);
        let [a, b, c, d] =
            [0, 1, 2, 3].map(|k| surface.vertex(corners[k], normal, WHOLE_TEXTURE[k]));
        surface.triangle([a, b, c]);
        surface.triangle([a, c, d]);
    }
    surface
}

/// An upright block over a convex polygon in the plane y = 0.
pub(super) fn prism(base: &[DVec2], height: f64) -> Result<Surface, ShapeError> {
    let n = base.len();
    let not_convex = ShapeError::NotConvex { shape: "Prism" };
    let turn = |a: usize, b: usize, c: usize| (base[b] - base[a]).perp_dot(base[c] - base[a]);
    // Convex and wound once: every corner turns the same way, and so does every triangle of the fan.
    let corners = (0..n).map(|k| turn(k, (k + 1) % n, (k + 2) % n));
    let fan = (1..n - 1).map(|k| turn(0, k, k + 1));
    let turns: Vec<f64> = corners.chain(fan).collect();
    let leftwards = turns.iter().all(|&t| t > 0.0);
    if !leftwards && !turns.iter().all(|&t| t < 0.0) {
        return Err(not_convex);
    }
    // Seen from above, with x to the right, z points down: what turns left in (x, z) is clockwise.
    let ordered: Vec<DVec2> = if leftwards {
        base.iter().rev().copied().collect()
    } else {
        base.to_vec()
    };
    let (low, high) = (ordered.iter()).fold((ordered[0], ordered[0]), |(low, high), &p| {
        (low.min(p), high.max(p))
    });
    let up = DVec3::Y * height;
    let place = |k: usize| DVec3::new(ordered[k % n].x, 0.0, ordered[k % n].y);
    let mut surface = Surface::default();
    for k in 0..n {
        let (left, right) = (place(k), place(k + 1));
        let corners = [left, right, right + up, left + up];
        let normal = normal_of([left, right, right + up]);
        let [a, b, c, d] =
            [0, 1, 2, 3].map(|k| surface.vertex(corners[k], normal, WHOLE_TEXTURE[k]));
        surface.triangle([a, b, c]);
        surface.triangle([a, c, d]);
    }
    for (lift, normal) in [(up, DVec3::Y), (DVec3::ZERO, DVec3::NEG_Y)] {
        let first = surface.positions.len() as u32;
        for (k, &corner) in ordered.iter().enumerate() {
            let uv = (corner - low) / (high - low);
            let v = if normal.y > 0.0 { uv.y } else { 1.0 - uv.y };
            surface.vertex(place(k) + lift, normal, DVec2::new(uv.x, v));
        }
        for k in 1..n as u32 - 1 {
            let (a, b) = (first + k, first + k + 1);
            surface.triangle(if normal.y > 0.0 {
                [first, a, b]
            } else {
                [first, b, a]
            });
        }
    }
    Ok(surface)
}
