//! Polygons with any number of corners become triangles: fans where that is right, ears elsewhere.
//!
//! An ear is a corner whose triangle holds no other corner; cutting it off leaves a smaller polygon (Meisters 1975,
//! "Polygons have ears"). Every triangle turns the same way as the polygon, and so their areas add up to its own.

use glam::{DVec2, DVec3, Vec3};

/// Comparisons that a file may ask for in all, a corner; polygons whose ears take longer to find become fans. Ordinary
/// ones with up to a thousand corners stay below.
const COMPARISONS_A_CORNER: u64 = 1000;
/// So many are free: a single large polygon is worth some milliseconds.
const FREE_COMPARISONS: u64 = 1 << 25;

/// How well the triangles fit the polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fit {
    /// They cover it.
    Exact,
    /// It has no area: all corners lie on a line.
    Flat,
    /// It crosses itself, so that what is inside is a matter of opinion.
    Crossed,
    /// It has so many corners that it was not looked into.
    TooLarge,
}

impl Fit {
    /// What there is to say of a polygon, and what became of it.
    pub fn note(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Exact => None,
            Self::Flat => Some(("a polygon without area", "its triangles have none")),
            Self::Crossed => Some(("a polygon that crosses itself", "its triangles may overlap")),
            Self::TooLarge => Some((
                "a polygon of very many corners",
                "what is concave is filled",
            )),
        }
    }
}

/// Makes triangles of polygons. Keeps its memory from one to the next, and count of its work.
#[derive(Default)]
pub(crate) struct Triangulator {
    points: Vec<DVec2>,
    previous: Vec<u32>,
    next: Vec<u32>,
    /// Corners that an ear may not hold: where the polygon turns inwards, or not at all.
    inward: Vec<u32>,
    is_inward: Vec<bool>,
    spent: u64,
    allowed: u64,
}

impl Triangulator {
    /// Appends the polygon's triangles, as indices of its corners: two fewer than it has, all facing the same way.
    pub fn triangulate(&mut self, polygon: &[Vec3], triangles: &mut Vec<[u32; 3]>) -> Fit {
        let count = polygon.len() as u32;
        if count < 3 {
            return Fit::Flat;
        }
        self.allowed += COMPARISONS_A_CORNER * u64::from(count);
        let fan = (2..count).map(|i| [0, i - 1, i]);
        if count == 3 {
            triangles.extend(fan);
            return Fit::Exact;
        }
        if !self.project(polygon) {
            triangles.extend(fan);
            // The two halves of a bow tie face opposite ways.
            return match is_a_line(polygon) {
                true => Fit::Flat,
                false => Fit::Crossed,
            };
        }
        if fan.clone().all(|[a, b, c]| self.turn(a, b, c) > 0.0) {
            triangles.extend(fan);
            return Fit::Exact;
        }
        self.link(count);
        self.clip(count, triangles)
    }

    /// Lays the polygon into a plane, counter-clockwise; false where it has no area.
    fn project(&mut self, polygon: &[Vec3]) -> bool {
        let origin = polygon[0].as_dvec3();
        let corner = |i: usize| polygon[i % polygon.len()].as_dvec3() - origin;
        // Newell's normal, twice the area long (Sutherland, Sproull, Schumacker 1974).
        let normal: DVec3 = (0..polygon.len())
            .map(|i| corner(i).cross(corner(i + 1)))
            .sum();
        let size = normal.abs();
        if !normal.is_finite() || size == DVec3::ZERO {
            return false;
        }
        let flat = |p: DVec3| match size {
            _ if size.z >= size.x && size.z >= size.y => (DVec2::new(p.x, p.y), normal.z),
            _ if size.y >= size.x => (DVec2::new(p.z, p.x), normal.y),
            _ => (DVec2::new(p.y, p.z), normal.x),
        };
        self.points.clear();
        self.points.extend((0..polygon.len()).map(|i| {
            let (point, side) = flat(corner(i));
            match side < 0.0 {
                true => DVec2::new(-point.x, point.y),
                false => point,
            }
        }));
        true
    }

    /// Twice the area of a triangle, positive where it turns counter-clockwise.
    fn turn(&self, a: u32, b: u32, c: u32) -> f64 {
        let [a, b, c] = [a, b, c].map(|i| self.points[i as usize]);
        (b - a).perp_dot(c - a)
    }

    fn link(&mut self, count: u32) {
        self.previous.clear();
        self.previous.push(count - 1);
        self.previous.extend(0..count - 1);
        self.next.clear();
        self.next.extend(1..count);
        self.next.push(0);
        self.inward.clear();
        self.is_inward.clear();
        for corner in 0..count {
            let is_inward = self.turn_at(corner) <= 0.0;
            self.is_inward.push(is_inward);
            if is_inward {
                self.inward.push(corner);
            }
        }
    }

    fn around(&self, corner: u32) -> [u32; 3] {
        let at = corner as usize;
        [self.previous[at], corner, self.next[at]]
    }

    fn turn_at(&self, corner: u32) -> f64 {
        let [a, b, c] = self.around(corner);
        self.turn(a, b, c)
    }

    /// Cuts ear after ear off.
    fn clip(&mut self, count: u32, triangles: &mut Vec<[u32; 3]>) -> Fit {
        let (mut left, mut at, mut refused) = (count, 0, 0);
        let mut patience = Patience::Ears;
        let mut fit = Fit::Exact;
        while left > 3 {
            self.spent += 1;
            if self.spent > self.allowed + FREE_COMPARISONS {
                return self.fan(at, left, triangles);
            }
            let turn = self.turn_at(at);
            let take = match patience {
                Patience::Ears => turn > 0.0 && self.is_ear(at),
                Patience::Lines => turn == 0.0,
                Patience::Corners => turn > 0.0,
                Patience::Any => true,
            };
            if !take {
                at = self.next[at as usize];
                refused += 1;
                if refused > left {
                    refused = 0;
                    patience = patience.less();
                }
                continue;
            }
            if matches!(patience, Patience::Corners | Patience::Any) {
                fit = Fit::Crossed;
            }
            triangles.push(self.around(at));
            at = self.cut(at);
            left -= 1;
            refused = 0;
            patience = Patience::Ears;
        }
        if self.turn_at(at) < 0.0 {
            fit = Fit::Crossed;
        }
        triangles.push(self.around(at));
        fit
    }

    /// Takes a corner out; returns where to go on. From the one after the next, so that the triangles are no fan of
    /// slivers around one corner.
    fn cut(&mut self, corner: u32) -> u32 {
        let [before, _, after] = self.around(corner);
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        // What is gone has no next that leads back to it; `is_ear` passes over it.
        self.is_inward[corner as usize] = false;
        for side in [before, after] {
            let is_inward = self.turn_at(side) <= 0.0;
            let was = std::mem::replace(&mut self.is_inward[side as usize], is_inward);
            if is_inward && !was {
                self.inward.push(side);
            }
        }
        let is_inward = &self.is_inward;
        if self.inward.len() > 8 && self.spent.is_multiple_of(64) {
            self.inward.retain(|&corner| is_inward[corner as usize]);
        }
        self.next[after as usize]
    }

    /// Whether no other corner lies in the triangle of this one, or on its edge.
    fn is_ear(&mut self, corner: u32) -> bool {
        let around = self.around(corner);
        let [a, b, c] = around.map(|i| self.points[i as usize]);
        self.spent += self.inward.len() as u64;
        !self.inward.iter().any(|&other| {
            if !self.is_inward[other as usize] || around.contains(&other) {
                return false;
            }
            let p = self.points[other as usize];
            // A polygon with a hole comes back to the same place over the seam between the two.
            if p == a || p == b || p == c {
                return false;
            }
            (b - a).perp_dot(p - a) >= 0.0
                && (c - b).perp_dot(p - b) >= 0.0
                && (a - c).perp_dot(p - c) >= 0.0
        })
    }

    fn fan(&self, first: u32, left: u32, triangles: &mut Vec<[u32; 3]>) -> Fit {
        let mut at = self.next[first as usize];
        for _ in 2..left {
            let then = self.next[at as usize];
            triangles.push([first, at, then]);
            at = then;
        }
        Fit::TooLarge
    }
}

/// Whether all corners lie on one line.
fn is_a_line(polygon: &[Vec3]) -> bool {
    let from_first = |&corner: &Vec3| (corner - polygon[0]).as_dvec3();
    let sides = polygon.iter().map(from_first);
    let longest = sides
        .clone()
        .max_by(|a, b| a.length().total_cmp(&b.length()));
    let longest = longest.unwrap_or_default();
    sides
        .into_iter()
        .all(|side| side.cross(longest) == DVec3::ZERO)
}

/// What counts as an ear. Less is asked for where a round has found none.
#[derive(Clone, Copy)]
enum Patience {
    Ears,
    Lines,
    Corners,
    Any,
}

impl Patience {
    fn less(self) -> Self {
        match self {
            Self::Ears => Self::Lines,
            Self::Lines => Self::Corners,
            Self::Corners | Self::Any => Self::Any,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[[f32; 2]]) -> Vec<Vec3> {
        points.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect()
    }

    /// The triangles, how well they fit, and the sum of their areas.
    fn triangles(polygon: &[Vec3]) -> (Vec<[u32; 3]>, Fit, f32) {
        let mut triangles = Vec::new();
        let fit = Triangulator::default().triangulate(polygon, &mut triangles);
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| polygon[i as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        let sum = triangles.iter().map(area).sum();
        (triangles, fit, sum)
    }

    #[test]
    fn a_convex_polygon_becomes_a_fan_around_its_first_corner() {
        let square = polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(triangles(&square).0, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn the_triangles_of_a_concave_polygon_have_its_area_whichever_corner_is_first_and_way_it_faces()
    {
        let arrow = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]];
        let comb = [
            [0.0, 0.0],
            [5.0, 0.0],
            [5.0, 3.0],
            [4.0, 3.0],
            [4.0, 1.0],
            [3.0, 1.0],
            [3.0, 3.0],
            [2.0, 3.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ];
        for (points, area) in [(&arrow[..], 10.0), (&comb[..], 11.0)] {
            for first in 0..points.len() {
                let mut turned = points.to_vec();
                turned.rotate_left(first);
                let flat = polygon(&turned);
                let mirrored: Vec<Vec3> = flat.iter().rev().copied().collect();
                let tilted = flat.iter().map(|p| Vec3::new(p.x, -0.6 * p.y, 0.8 * p.y));
                for polygon in [flat.clone(), mirrored, tilted.collect()] {
                    let (triangles, fit, sum) = triangles(&polygon);
                    assert_eq!(triangles.len(), points.len() - 2);
                    assert_eq!(fit, Fit::Exact);
                    assert!((sum - area).abs() < 1e-5, "from {first}: {sum}, not {area}");
                }
            }
        }
    }

    #[test]
    fn a_ring_cut_open_by_a_seam_keeps_its_hole() {
        // An outer square, the seam to the inner one, that the other way around, and the seam back.
        let ring = polygon(&[
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ]);
        for first in 0..ring.len() {
            let mut turned = ring.clone();
            turned.rotate_left(first);
            let (_, fit, sum) = triangles(&turned);
            assert_eq!((fit, sum), (Fit::Exact, 12.0), "from corner {first}");
        }
    }

    #[test]
    fn a_corner_on_an_edge_is_joined_to_what_lies_opposite() {
        let square = polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        let (triangles, fit, sum) = triangles(&square);
        assert_eq!((fit, sum), (Fit::Exact, 4.0));
        for t in &triangles {
            assert!(*t != [0, 1, 2], "a triangle without area: {triangles:?}");
        }
    }

    #[test]
    fn what_crosses_itself_or_has_no_area_ends_and_says_so() {
        let bow_tie = polygon(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]]);
        let (some, fit, _) = triangles(&bow_tie);
        assert_eq!((some.len(), fit), (2, Fit::Crossed));
        let even = polygon(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]);
        assert_eq!(triangles(&even).1, Fit::Crossed, "halves of the same size");
        let line = polygon(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]);
        assert_eq!(triangles(&line).1, Fit::Flat);
        let point = [Vec3::ONE; 5];
        assert_eq!(triangles(&point).1, Fit::Flat);
    }

    #[test]
    fn polygons_of_many_corners_end_after_work_that_grows_with_their_number() {
        // Spikes of a saw: as many corners turn inwards as outwards.
        let count = 200_000;
        let saw = (0..count).map(|i| [i as f32, if i % 2 == 0 { 1.0 } else { 0.1 }]);
        let mut points: Vec<[f32; 2]> = saw.collect();
        points.push([count as f32, -1.0]);
        points.push([-1.0, -1.0]);
        let mut worker = Triangulator::default();
        let mut triangles = Vec::new();
        worker.triangulate(&polygon(&points), &mut triangles);
        assert_eq!(triangles.len(), points.len() - 2);
        let most = COMPARISONS_A_CORNER * points.len() as u64 + FREE_COMPARISONS;
        let spent = worker.spent;
        assert!(spent <= most + points.len() as u64, "{spent} comparisons");
    }
}
