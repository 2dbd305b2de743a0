//! Which line is under the pointer: a coarse test on the screen, made when the pointer, the lines or
//! the view moved, and not at all where nothing is drawn.

use super::draw::Drawings;
use crate::editor::pick;
use crate::editor::pointer::PointerUse;
use crate::editor::trees::pair::{Side, TreePair};
use crate::editor::viewport::Viewport;
use crate::inspect::{LineSet, Stands, System};
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::Local;
use bevy::ecs::world::World;
use bevy::math::{Mat4, Vec2, Vec3, Vec4};
use bevy::window::{PrimaryWindow, Window};

/// How near the pointer has to be, in logical pixels.
const REACH: f32 = 5.0;
/// Of lines that are as near but for this, in pixels, the one that is drawn later is meant: of a box
/// and one in it that share an edge, the inner one.
const ALIKE: f32 = 0.75;
/// Rays lie over boxes, and are the finer target.
const RAYS_BEFORE: f32 = 2.0;

/// What is under the pointer.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::editor) struct Hovered {
    /// What the line stands for, and whose it is.
    pub found: Option<(Stands, System)>,
    /// In which of two views: 0, or 1 for the right one.
    pub side: usize,
    /// Logical pixels of the window.
    pub at: Vec2,
}

/// What an answer depends on.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Asked {
    at: Vec2,
    versions: [u64; 2],
    clip_from_world: Mat4,
}

/// Looks again where the pointer, the lines or the view moved.
pub(super) fn find_hovered(world: &mut World, mut asked: Local<Option<Asked>>) {
    let mut windows = world.query_filtered::<&Window, With<PrimaryWindow>>();
    let at = windows.single(world).ok().and_then(Window::cursor_position);
    let of_pair = world.get_resource::<TreePair>();
    let versions = [
        world.resource::<Drawings>().version(),
        of_pair.map_or(0, |pair| pair.version),
    ];
    let is_free = matches!(world.resource::<PointerUse>(), PointerUse::Free);
    let over = world.resource::<Viewport>().hovered && is_free;
    let of_pair = of_pair.is_some_and(TreePair::draws);
    let at = at.filter(|_| over && (of_pair || !world.resource::<Drawings>().is_empty()));
    let Some(at) = at else {
        *asked = None;
        let mut hovered = world.resource_mut::<Hovered>();
        if hovered.found.is_some() {
            hovered.found = None;
        }
        return;
    };
    let Some((clip_from_world, _, _)) = screen(world) else {
        return;
    };
    let now = Asked {
        at,
        versions,
        clip_from_world,
    };
    if *asked == Some(now) {
        return;
    }
    *asked = Some(now);
    let offset = world.resource::<Viewport>().offset(at);
    let side = usize::from(offset != Vec2::ZERO);
    let found = line_at(world, at - offset, side);
    *world.resource_mut::<Hovered>() = Hovered { found, side, at };
}

/// From the world to the view's clip space, and the viewport's corner and size in logical pixels.
fn screen(world: &mut World) -> Option<(Mat4, Vec2, Vec2)> {
    let (camera, place) = pick::camera(world)?;
    let rect = camera.logical_viewport_rect()?;
    let clip_from_world = camera.clip_from_view() * place.to_matrix().inverse();
    Some((clip_from_world, rect.min, rect.size()))
}

/// The line at a place of the window that is in the first view, in logical pixels; of two views that on this side.
pub(in crate::editor) fn line_at(
    world: &mut World,
    at: Vec2,
    side: usize,
) -> Option<(Stands, System)> {
    let (clip_from_world, corner, size) = screen(world)?;
    let of_pair = world.get_resource::<TreePair>();
    let of_side = of_pair.and_then(|pair| pair.sides.get(side));
    let sets = world.get_resource::<Drawings>()?.sets();
    let sets = sets.chain(of_side.into_iter().flat_map(Side::sets));
    nearest(sets, &clip_from_world, size, at - corner)
}

/// The line that is nearest to a place of the viewport, in logical pixels from its top left.
fn nearest<'a>(
    sets: impl Iterator<Item = &'a LineSet>,
    clip_from_world: &Mat4,
    size: Vec2,
    at: Vec2,
) -> Option<(Stands, System)> {
    let eye = Eye::new(clip_from_world, size, at);
    let mut best: Option<(f32, Stands, System)> = None;
    for set in sets {
        let bonus = match set.system {
            System::Rays | System::Lobes => RAYS_BEFORE,
            _ => 0.0,
        };
        let mut offer = |distance: f32, stands: Stands| {
            let distance = distance - bonus;
            if best.is_none_or(|(least, ..)| distance < least + ALIKE) {
                let least = best.map_or(distance, |(least, ..)| least.min(distance));
                best = Some((least, stands, set.system));
            }
        };
        for segment in &set.segments {
            if let Some(distance) = eye.distance(segment.ends) {
                offer(distance, segment.stands);
            }
        }
        for dot in &set.points {
            if let Some(distance) = eye.distance([dot.at; 2]) {
                offer(distance, dot.stands);
            }
        }
    }
    best.map(|(_, stands, system)| (stands, system))
}

/// The pointer's own clip space: pixels from the pointer are `x / w` and `y / w`.
struct Eye {
    x: Vec4,
    y: Vec4,
    w: Vec4,
}

/// What is nearer to the eye's plane is cut off, in the clip space's `w`: metres for a perspective.
const NEAR: f32 = 1e-4;

impl Eye {
    fn new(clip_from_world: &Mat4, size: Vec2, at: Vec2) -> Self {
        let [x, y, w] = [0, 1, 3].map(|row| clip_from_world.row(row));
        let half = 0.5 * size;
        // From -1 … 1 to pixels, downwards, less the pointer's place.
        Self {
            x: half.x * x + (half.x - at.x) * w,
            y: -half.y * y + (half.y - at.y) * w,
            w,
        }
    }

    /// Pixels from the pointer to a line; `None` where they are more than [`REACH`].
    #[inline]
    fn distance(&self, ends: [Vec3; 2]) -> Option<f32> {
        let project = |point: Vec3| {
            let point = point.extend(1.0);
            Vec3::new(self.x.dot(point), self.y.dot(point), self.w.dot(point))
        };
        let [mut a, mut b] = ends.map(project);
        // Both ends beyond the same side of the square around the pointer, or behind the eye: most
        // lines end here, without a division.
        let beyond = |a: f32, b: f32, wa: f32, wb: f32| {
            (a > REACH * wa && b > REACH * wb) || (a < -REACH * wa && b < -REACH * wb)
        };
        if (a.z <= NEAR && b.z <= NEAR) || (a.z > NEAR && b.z > NEAR) && beyond(a.x, b.x, a.z, b.z)
        {
            return None;
        }
        if a.z > NEAR && b.z > NEAR && beyond(a.y, b.y, a.z, b.z) {
            return None;
        }
        // Cut where it passes the eye's plane.
        if a.z <= NEAR {
            a = a + (b - a) * ((NEAR - a.z) / (b.z - a.z));
        } else if b.z <= NEAR {
            b = b + (a - b) * ((NEAR - b.z) / (a.z - b.z));
        }
        let (from, to) = (a.truncate() / a.z, b.truncate() / b.z);
        let along = to - from;
        let t = -from.dot(along) / along.length_squared().max(1e-12);
        let distance = (from + along * t.clamp(0.0, 1.0)).length();
        (distance <= REACH).then_some(distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::Segment;
    use bevy::color::LinearRgba;

    const SIZE: Vec2 = Vec2::new(200.0, 100.0);

    /// Looks along -Z from the origin, 90° upright: at z = -1 a pixel is 0.02 m.
    fn clip_from_world() -> Mat4 {
        Mat4::perspective_infinite_reverse_rh(std::f32::consts::FRAC_PI_2, 2.0, 0.1)
    }

    fn set(system: System, lines: &[([Vec3; 2], Stands)]) -> LineSet {
        let mut set = LineSet::new(system);
        set.segments = lines
            .iter()
            .map(|&(ends, stands)| Segment {
                ends,
                colors: [LinearRgba::WHITE; 2],
                stands,
            })
            .collect();
        set
    }

    fn find(sets: &[LineSet], at: [f32; 2]) -> Option<Stands> {
        let found = nearest(sets.iter(), &clip_from_world(), SIZE, at.into());
        found.map(|(stands, _)| stands)
    }

    fn node(node: u32) -> Stands {
        Stands::Node {
            instance: None,
            node,
        }
    }

    #[test]
    fn a_line_is_found_along_its_length_and_not_beyond_its_reach() {
        // From pixel (100, 50) to (150, 50), and upright at 150 up to the top.
        let lines = [
            (
                [Vec3::new(0.0, 0.0, -1.0), Vec3::new(1.0, 0.0, -1.0)],
                node(1),
            ),
            (
                [Vec3::new(1.0, 0.0, -1.0), Vec3::new(1.0, 1.0, -1.0)],
                node(2),
            ),
        ];
        let sets = [set(System::Boxes, &lines)];
        for (at, expected) in [
            ([120.0, 50.0], Some(node(1))),
            ([120.0, 54.5], Some(node(1))),
            ([120.0, 56.0], None),
            ([96.0, 50.0], Some(node(1))),
            ([94.0, 50.0], None),
            ([152.0, 20.0], Some(node(2))),
            ([160.0, 20.0], None),
        ] {
            assert_eq!(find(&sets, at), expected, "{at:?}");
        }
    }

    #[test]
    fn a_line_that_passes_the_eye_is_found_in_front_of_it_alone() {
        // Below the eye, from behind it to far ahead: on the screen from below up to the middle.
        let lines = [(
            [Vec3::new(0.0, -1.0, 5.0), Vec3::new(0.0, -1.0, -1e6)],
            node(1),
        )];
        let sets = [set(System::Boxes, &lines)];
        assert_eq!(find(&sets, [100.0, 51.0]), Some(node(1)));
        assert_eq!(find(&sets, [100.0, 99.0]), Some(node(1)));
        assert_eq!(find(&sets, [100.0, 30.0]), None);
        let behind = [(
            [Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.1, 0.0, 1.0)],
            node(1),
        )];
        assert_eq!(find(&[set(System::Boxes, &behind)], [100.0, 50.0]), None);
    }

    #[test]
    fn of_two_boxes_that_share_an_edge_the_inner_one_is_meant_and_rays_come_before_boxes() {
        let edge = |y: f32| [Vec3::new(-1.0, y, -1.0), Vec3::new(1.0, y, -1.0)];
        let boxes = set(System::Boxes, &[(edge(0.0), node(1)), (edge(0.0), node(2))]);
        assert_eq!(
            find(std::slice::from_ref(&boxes), [100.0, 50.0]),
            Some(node(2))
        );
        // A ray a pixel beside the boxes' edge.
        let rays = set(System::Rays, &[(edge(0.02), Stands::Ray(7))]);
        for sets in [[boxes.clone(), rays.clone()], [rays, boxes]] {
            assert_eq!(find(&sets, [100.0, 49.9]), Some(Stands::Ray(7)));
            assert_eq!(
                find(&sets, [100.0, 54.5]),
                Some(node(2)),
                "the boxes are nearer"
            );
        }
    }
}
