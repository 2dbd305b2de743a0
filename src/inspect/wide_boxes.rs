//! Boxes of the wide form of the trees, through which pictures are traced.

use super::Subject;
use super::color::of_scale;
use super::line_set::{LineSet, Stands, Thinned, box_corners};
use super::trees::TreeView;
use crate::bvh::WideBox;

/// Boxes of the wide form: a range of its levels, coloured by level.
pub(super) fn wide_boxes(set: &mut LineSet, subject: &Subject, views: &[TreeView]) {
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
    let deepest = boxes.iter().map(|(_, b)| b.depth).max().unwrap_or(0);
    let most = subject.inspect.max_lines as usize / 12;
    let of = boxes.len();
    boxes.sort_by_key(|(_, b)| b.depth);
    boxes.truncate(most);
    for (view, WideBox { depth, bounds, .. }) in &boxes {
        let [min, max] = *bounds;
        // A wide box has no node of its own in the binary form: it stands for its tree.
        let stands = Stands::Node {
            instance: view.instance().map(|(instance, _)| instance),
            node: 0,
        };
        let color = of_scale(*depth as f32 / deepest.max(1) as f32);
        set.edges(&view.place(box_corners(min, max)), color, stands);
    }
    set.notes
        .push("the wide form of the trees, through which pictures are traced".into());
    if of > boxes.len() {
        set.thinned = Some(Thinned {
            what: "boxes",
            drawn: boxes.len(),
            of,
            rule: "the levels nearest to the root",
        });
    }
}
