//! Normals at the vertices of meshes, and between them.

use super::color::{BETWEEN, VERTEX};
use super::count::counted;
use super::line_set::{LineSet, Stands, Thinned};
use super::{Subject, System};
use crate::trace::Cone;
use bevy::platform::collections::{HashMap, HashSet};
use glam::{IVec2, Vec3};

/// Levels between the vertices: each halves the edges.
const MOST_BETWEEN: u32 = 2;

/// A place on a surface with its normal.
struct Placed {
    at: Vec3,
    normal: Vec3,
    stands: Stands,
    ahead: f32,
    /// Which corner of its triangle it is; `None` between them.
    corner: Option<usize>,
}

/// Normals, as long as `length` pixels, and not denser than one in `spacing` pixels.
pub(super) fn normals(subject: &Subject) -> LineSet {
    let mut set = LineSet::of(System::Normals, subject.inspect);
    let settings = &subject.inspect.normals;
    let world = subject.world;
    let chosen = |id: u64| settings.object == 0 || settings.object == id;
    if !world.objects.iter().any(|object| chosen(object.id)) {
        set.notes.push(match settings.object {
            0 => "there is no object".into(),
            id => format!("object {id} is not in the scene"),
        });
        return set;
    }
    let n = 1 << settings.between.min(MOST_BETWEEN);
    let mut cells: HashMap<IVec2, Placed> = HashMap::default();
    // The bits of each place and its normal: triangles share them.
    let mut places: HashSet<[u32; 6]> = HashSet::default();
    let mut without: Vec<u64> = Vec::new();
    let spacing = settings.spacing.max(1.0);
    for (number, object) in (0..).zip(world.objects.iter()) {
        if !chosen(object.id) {
            continue;
        }
        if object.mesh.normals.is_empty() {
            without.push(object.id);
            continue;
        }
        let triangles = object.mesh.tree.triangles();
        let mut known = vec![false; object.mesh.normals.len()];
        for triangle in 0..triangles.len() as u32 {
            let corners = triangles.indices()[triangle as usize];
            for placed in on_triangle(subject, number, triangle, n) {
                if let Some(corner) = placed.corner {
                    let known = &mut known[corners[corner] as usize];
                    if std::mem::replace(known, true) {
                        continue;
                    }
                }
                let camera = subject.camera;
                let time = camera.optics.shutter[0];
                let Some((place, ahead)) = camera.project(placed.at, subject.settings.size, time)
                else {
                    continue;
                };
                let outside = place.cmplt(glam::Vec2::ZERO).any()
                    || place.cmpgt(subject.settings.size.as_vec2()).any();
                if outside {
                    continue;
                }
                let key = placed
                    .at
                    .to_array()
                    .into_iter()
                    .chain(placed.normal.to_array());
                let mut bits = [0; 6];
                for (bits, number) in bits.iter_mut().zip(key) {
                    // Zeros have two signs.
                    *bits = (number + 0.0).to_bits();
                }
                if !places.insert(bits) {
                    continue;
                }
                let placed = Placed { ahead, ..placed };
                let cell = (place / spacing).as_ivec2();
                let nearest = cells.entry(cell).or_insert(Placed {
                    ahead: f32::INFINITY,
                    ..placed
                });
                if placed.ahead < nearest.ahead {
                    *nearest = placed;
                }
            }
        }
    }
    set.notes.extend(without_text(&without));
    let mut kept: Vec<_> = cells.into_iter().collect();
    kept.sort_unstable_by_key(|(cell, _)| (cell.y, cell.x));
    kept.truncate(subject.inspect.max_lines as usize);
    let cone = Cone::of_pixel(subject.camera, subject.settings.size);
    for (_, placed) in &kept {
        let length = settings.length * cone.width_at(placed.ahead);
        let color = if placed.corner.is_none() {
            BETWEEN
        } else {
            VERTEX
        };
        let tip = placed.at + length * placed.normal;
        set.line([placed.at, tip], color, placed.stands);
    }
    if kept.len() < places.len() {
        set.thinned = Some(Thinned {
            what: "normals in the picture",
            drawn: kept.len(),
            of: places.len(),
            rule: "the nearest in each square of `spacing` pixels of the picture",
        });
    }
    set
}

/// What has nothing to draw: the first few, and how many there are.
fn without_text(objects: &[u64]) -> Option<String> {
    const SHOWN: usize = 8;
    if let [] | [_] = objects {
        let only = objects.first();
        return only.map(|id| format!("object {id} has no vertex normals"));
    }
    let shown = objects.iter().take(SHOWN).map(u64::to_string);
    let mut shown = shown.collect::<Vec<_>>().join(", ");
    if objects.len() > SHOWN {
        shown.push_str(&format!(" and {} more", objects.len() - SHOWN));
    }
    let all = counted(objects.len() as u64, "object");
    Some(format!("{all} have no vertex normals: {shown}"))
}

/// The interpolated normals at a triangle's places with barycentric weights i/n.
fn on_triangle(
    subject: &Subject,
    instance: u32,
    triangle: u32,
    n: u32,
) -> impl Iterator<Item = Placed> {
    let of = &subject.world.aggregate.instances()[instance as usize];
    let mesh = &subject.world.objects[instance as usize].mesh;
    let triangles = mesh.tree.triangles();
    let corners = triangles.corners(triangle);
    let normals = triangles.indices()[triangle as usize].map(|i| mesh.normals[i as usize]);
    (0..=n)
        .flat_map(move |u| (0..=n - u).map(move |v| [n - u - v, u, v]))
        .filter_map(move |weights| {
            let weighted = |values: [Vec3; 3]| -> Vec3 {
                (0..3)
                    .map(|i| values[i] * (weights[i] as f32 / n as f32))
                    .sum()
            };
            let normal = of.to_world_normal(weighted(normals)).try_normalize()?;
            Some(Placed {
                at: of.to_world_point(weighted(corners)),
                normal,
                stands: Stands::Triangle { instance, triangle },
                ahead: 0.0,
                corner: weights.iter().position(|weight| *weight == n),
            })
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_without_normals_are_one_note_however_many_there_are() {
        assert_eq!(without_text(&[]), None);
        let text = |count| {
            let objects: Vec<u64> = (1..=count).collect();
            without_text(&objects).unwrap()
        };
        assert_eq!(text(1), "object 1 has no vertex normals");
        assert_eq!(text(3), "3 objects have no vertex normals: 1, 2, 3");
        assert_eq!(
            text(10_000),
            "10000 objects have no vertex normals: 1, 2, 3, 4, 5, 6, 7, 8 and 9992 more"
        );
    }
}
