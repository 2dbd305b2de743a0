//! What hides lights from first and second hits, remembered from one evaluation of a sample to the next.
//!
//! While only materials are edited nothing is put in the way of a shadow ray, and most are the same again: the points of
//! lights hang on where a surface lies and faces, and of one with a highlight on how it reflects.

use super::vertices::Vertices;
use bevy::platform::hash::FixedHasher;
use std::hash::BuildHasher;

/// Points of lights of which it is remembered: the first ones.
const POINTS: u32 = u64::BITS;

/// Which points of lights something hides from a sample's first or second hit, as far as that was found out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visibility {
    /// What the points were chosen for.
    surface: u64,
    /// A bit for each point: whether it was asked for, and whether something was in the way.
    asked: u64,
    hidden: u64,
}

impl Visibility {
    /// Forgets points that were chosen for another surface: as [`surface`] names them.
    pub(super) fn keep_of(&mut self, surface: u64) {
        if self.surface != surface {
            *self = Self {
                surface,
                ..Self::default()
            };
        }
    }

    /// Whether something hides a point. `None` where that is not known.
    #[inline(always)]
    pub(super) fn is_hidden(&self, point: u32) -> Option<bool> {
        let has = |bits: u64| point < POINTS && bits >> point & 1 != 0;
        has(self.asked).then(|| has(self.hidden))
    }

    #[inline(always)]
    pub(super) fn remember(&mut self, point: u32, is_hidden: bool) {
        if point < POINTS {
            self.asked |= 1 << point;
            self.hidden |= u64::from(is_hidden) << point;
        }
    }
}

/// What the choice of points for a vertex hangs on, as a number that no other vertex of its sample is likely to have. The place
/// of a first hit is not in it: no edit that leaves hits what they are moves it.
pub(super) fn surface(vertices: &Vertices, i: usize) -> u64 {
    let bits = |vector: glam::Vec3| vector.to_array().map(f32::to_bits);
    let normal = bits(vertices.normal.get(i));
    if !vertices.are_from_camera() {
        return of_later(vertices, i, normal);
    }
    if !vertices.has_highlight(i) {
        return FixedHasher.hash_one(normal);
    }
    let diffuse = bits(vertices.diffuse.get(i));
    let specular = bits(vertices.specular.get(i));
    let shininess = vertices.shininess[i].to_bits();
    FixedHasher.hash_one((normal, diffuse, specular, shininess))
}

/// The same of a later hit, with its place and its path.
fn of_later(vertices: &Vertices, i: usize, normal: [u32; 3]) -> u64 {
    let bits = |vector: glam::Vec3| vector.to_array().map(f32::to_bits);
    let hit = &vertices.hits[i];
    let place = (bits(vertices.position.get(i)), hit.instance, hit.triangle);
    let name = vertices.path(i).name;
    let reflects = vertices.has_highlight(i).then(|| {
        let [diffuse, specular] = [&vertices.diffuse, &vertices.specular].map(|v| bits(v.get(i)));
        (diffuse, specular, vertices.shininess[i].to_bits())
    });
    FixedHasher.hash_one((name, place, normal, reflects))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_remembered_of_a_point_is_known_of_no_other_and_of_no_other_surface() {
        let mut visibility = Visibility::default();
        visibility.keep_of(7);
        let points = [0, 1, 62, 63, 64, 1000];
        for (i, point) in points.into_iter().enumerate() {
            assert_eq!(visibility.is_hidden(point), None);
            visibility.remember(point, i % 2 == 0);
        }
        let known = points.map(|point| visibility.is_hidden(point));
        let [yes, no] = [Some(true), Some(false)];
        assert_eq!(known, [yes, no, yes, no, None, None]);
        assert_eq!(visibility.is_hidden(2), None);
        visibility.keep_of(7);
        assert_eq!(visibility.is_hidden(62), yes);
        visibility.keep_of(8);
        assert!(
            points
                .iter()
                .all(|point| visibility.is_hidden(*point).is_none())
        );
    }
}
