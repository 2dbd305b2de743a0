//! What tests ask of a surface.

use super::surface::Surface;
use bevy::math::{DVec3, Vec3};
use std::collections::HashMap;

/// How triangles meet at edges, vertices at the same place counted as one.
#[derive(Debug, PartialEq)]
pub(super) struct Edges {
    /// Edges with one triangle.
    pub open: usize,
    /// Edges that two triangles run along in the same direction, or that have more than two.
    pub crowded: usize,
}

pub(super) fn edges(surface: &Surface) -> Edges {
    let place = |i: u32| surface.positions[i as usize].map(f32::to_bits);
    let mut directed = HashMap::new();
    for corners in surface.indices.chunks_exact(3) {
        for k in 0..3 {
            let edge = (place(corners[k]), place(corners[(k + 1) % 3]));
            *directed.entry(edge).or_insert(0) += 1;
        }
    }
    let open = directed
        .keys()
        .filter(|(a, b)| !directed.contains_key(&(*b, *a)));
    Edges {
        open: open.count(),
        crowded: directed.values().filter(|&&count| count > 1).count(),
    }
}

/// Lowest and highest coordinates.
pub(super) fn bounds(surface: &Surface) -> (DVec3, DVec3) {
    let places = surface.positions.iter().map(|&p| Vec3::from(p).as_dvec3());
    places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    })
}

/// Corners of every triangle.
pub(super) fn triangles(surface: &Surface) -> impl Iterator<Item = [DVec3; 3]> {
    surface.indices.chunks_exact(3).map(|corners| {
        [0, 1, 2].map(|k| Vec3::from(surface.positions[corners[k] as usize]).as_dvec3())
    })
}

/// The enclosed volume, positive when triangles are counter-clockwise seen from outside.
pub(super) fn volume(surface: &Surface) -> f64 {
    triangles(surface)
        .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
        .sum()
}
