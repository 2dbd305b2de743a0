//! What hides lights from first and second hits, remembered from one evaluation of a sample to the next.
//!
//! While only materials are edited nothing is put in the way of a shadow ray, and most are the same again: the points of
//! lights hang on where a surface lies and faces, and of one with a highlight on how it reflects.

use super::vertices::Vertices;
use crate::scene::RenderSettings;
use crate::trace::{Lamp, World};
use bevy::platform::hash::FixedHasher;
use std::hash::BuildHasher;

/// Which points of lights something hides from a sample's first or second hit, as far as that was found out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visibility {
    /// What the points were chosen for.
    of: Chooser,
    /// A bit for each point: whether it was asked for, and whether something was in the way.
    asked: u64,
    hidden: u64,
}

/// What the choice of points for a vertex hangs on, as numbers that no other vertex of its sample is likely to have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Chooser {
    /// Where it lies, faces and how it was reached.
    place: u64,
    /// How it reflects, where points of lights with an extent hang on that; else 0.
    reflection: u64,
}

impl Visibility {
    /// Forgets points that were chosen for another vertex; of one that reflects otherwise than before it keeps those of
    /// lights that have one point, a bit for each in `single`. True where it forgot anything.
    pub(super) fn keep_of(&mut self, of: Chooser, single: u64) -> bool {
        let kept = if self.of == of {
            return false;
        } else if self.of.place == of.place {
            single
        } else {
            0
        };
        *self = Self {
            of,
            asked: self.asked & kept,
            hidden: self.hidden & kept,
        };
        true
    }

    /// Forgets these points, a bit for each.
    pub fn forget(&mut self, points: u64) {
        self.asked &= !points;
        self.hidden &= !points;
    }

    /// Whether something hides a point. `None` where that is not known.
    #[inline(always)]
    pub(super) fn is_hidden(&self, point: u32) -> Option<bool> {
        let has = |bits: u64| bits & bit(point) != 0;
        has(self.asked).then(|| has(self.hidden))
    }

    #[inline(always)]
    pub(super) fn remember(&mut self, point: u32, is_hidden: bool) {
        self.asked |= bit(point);
        if is_hidden {
            self.hidden |= bit(point);
        }
    }
}

/// A bit for a point of a light. None of those behind the first 64, which are not remembered.
#[inline(always)]
pub(in crate::trace) fn bit(point: u32) -> u64 {
    1_u64.checked_shl(point).unwrap_or(0)
}

/// Which points of lights lie elsewhere in another world with the same surroundings, a bit for each. `None` where points are
/// numbered otherwise there.
pub fn other_points(old: &World, new: &World, settings: &RenderSettings) -> Option<u64> {
    let named = |lamp: Lamp| (lamp.name(), lamp.samples(settings));
    let mut lamps = new.lamps(settings);
    let (mut first, mut others) = (0_u32, 0);
    for was in old.lamps(settings) {
        let is = lamps.next().filter(|is| named(*is) == named(was))?;
        let velocity = |world: &World| world.lights.velocity(was.id());
        let is_same = was.is_same(is) && velocity(old) == velocity(new);
        let end = first.saturating_add(is.samples(settings).unwrap_or(1));
        if !(is_same || matches!(is, Lamp::Dome(_))) {
            let points = first..end.min(u64::BITS);
            others |= points.fold(0, |all, point| all | bit(point));
        }
        first = end;
    }
    lamps.next().is_none().then_some(others)
}

impl Chooser {
    /// Of a vertex. The place of a first hit is not in it: no edit that leaves hits what they are moves it.
    pub fn of(vertices: &Vertices, i: usize) -> Self {
        let bits = |vector: glam::Vec3| vector.to_array().map(f32::to_bits);
        let normal = bits(vertices.normal.get(i));
        let reflection = if vertices.has_highlight(i) {
            let colors = [&vertices.diffuse, &vertices.specular].map(|color| bits(color.get(i)));
            FixedHasher.hash_one((colors, vertices.shininess[i].to_bits()))
        } else {
            0
        };
        let place = if vertices.are_from_camera() {
            FixedHasher.hash_one(normal)
        } else {
            let hit = &vertices.hits[i];
            let name = vertices.path(i).name;
            let place = bits(vertices.position.get(i));
            FixedHasher.hash_one((normal, place, hit.instance, hit.triangle, name))
        };
        Self { place, reflection }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_remembered_of_a_point_is_known_of_no_other_and_of_no_other_vertex() {
        let of = |place, reflection| Chooser { place, reflection };
        let mut visibility = Visibility::default();
        visibility.keep_of(of(7, 1), 0);
        let points = [0, 1, 62, 63, 64, 1000];
        for (i, point) in points.into_iter().enumerate() {
            assert_eq!(visibility.is_hidden(point), None);
            visibility.remember(point, i % 2 == 0);
        }
        let known = points.map(|point| visibility.is_hidden(point));
        let [yes, no] = [Some(true), Some(false)];
        assert_eq!(known, [yes, no, yes, no, None, None]);
        assert_eq!(visibility.is_hidden(2), None);
        visibility.keep_of(of(7, 1), 0);
        assert_eq!(visibility.is_hidden(62), yes);
        // It reflects otherwise: what hides a light without extent stays true.
        visibility.keep_of(of(7, 2), bit(0) | bit(1));
        let known = points.map(|point| visibility.is_hidden(point));
        assert_eq!(known, [yes, no, None, None, None, None]);
        visibility.forget(bit(0));
        let known = points.map(|point| visibility.is_hidden(point));
        assert_eq!(known, [None, no, None, None, None, None]);
        visibility.keep_of(of(8, 2), u64::MAX);
        assert!(
            points
                .iter()
                .all(|point| visibility.is_hidden(*point).is_none())
        );
    }
}
