//! Boxes of the wide form of the trees, through which rays are traced.

use super::Subject;
use super::color::of_scale;
use super::line_set::{LineSet, Stands, Thinned, box_corners};
use super::trees::TreeView;
use super::visits::Visits;
use crate::bvh::WideBox;

/// Boxes of the wide form: a range of its levels, coloured by level, or by visits.
pub(super) fn wide_boxes(
    set: &mut LineSet,
    subject: &Subject,
    views: &[TreeView],
    visits: Option<&Visits>,
) {
    let settings = &subject.inspect.boxes;
    let levels = settings.from_level..=settings.to_level;
    let mut boxes: Vec<(&TreeView, WideBox)> = Vec::new();
    for view in views {
        let of = match view.instance() {
            None => subject.world.aggregate.wide_boxes(),
            Some((_, instance)) => instance.mesh.wide_boxes(),
        };
        let in_range = of.into_iter().filter(|b| levels.contains(&b.depth));
        boxes.extend(in_range.map(|b| (view, b)));
    }
    if boxes.is_empty() {
        let (from, to) = (settings.from_level, settings.to_level);
        set.notes
            .push(format!("the wide form has no box at levels {from} to {to}"));
        return;
    }
    let value = |view: &TreeView, b: &WideBox| match visits {
        Some(visits) => visits.entered(view.name, b.node),
        None => b.depth,
    };
    let highest = boxes.iter().map(|(view, b)| value(view, b)).max();
    let highest = highest.unwrap_or(0).max(1) as f32;
    let most = subject.inspect.max_lines as usize / 12;
    let of = boxes.len();
    boxes.sort_by_key(|(_, b)| b.depth);
    boxes.truncate(most);
    for (view, b) in &boxes {
        let [min, max] = b.bounds;
        let stands = Stands::Node {
            instance: view.instance().map(|(instance, _)| instance),
            node: b.node,
        };
        let color = of_scale(value(view, b) as f32 / highest);
        set.edges(&view.place(box_corners(min, max)), color, stands);
    }
    set.notes
        .push("the wide form of the trees, through which rays are traced".into());
    if of > boxes.len() {
        set.thinned = Some(Thinned {
            what: "boxes",
            drawn: boxes.len(),
            of,
            rule: "the levels nearest to the root",
        });
    }
}
