//! Two views of the scene beside each other: over each which builder's trees it shows, and below it what there is to
//! count of them.

use super::overlays::label_within;
use super::status::memory_text;
use crate::editor::texts::counted;
use crate::editor::trees::pair::{Side, SideState, TreePair};
use crate::inspect::{InspectSettings, TreeCounts};
use crate::scene::Builder;
use crate::scene::schema::choice_name;
use bevy::ecs::world::World;
use bevy_egui::egui::{Align2, Pos2, Rect, Stroke, Ui, pos2, vec2};

/// Between a view's side and what is written over it, and between two texts, in points.
const MARGIN: f32 = 8.0;
/// Where there is less room for it, nothing is written.
const LEAST_WIDTH: f32 = 80.0;
/// Lines are no longer: they would cover the picture.
const MOST_WIDTH: f32 = 360.0;
/// Points between the views.
const GAP: f32 = 2.0;

/// The left one's place and the right one's, which is as large; `None` where one tree or none is shown.
pub(super) fn views(free: Rect, world: &World) -> Option<[Rect; 2]> {
    let inspect = world.get_resource::<InspectSettings>()?;
    let width = 0.5 * (free.width() - GAP);
    let is_shown = inspect.on && inspect.pair.on && width > 0.0;
    is_shown.then(|| {
        let size = vec2(width, free.height());
        let right = pos2(free.max.x - width, free.min.y);
        [free.min, right].map(|corner| Rect::from_min_size(corner, size))
    })
}

/// What a side is, in a few words.
fn heading(builder: Builder, side: &Side) -> String {
    let name = choice_name(&builder);
    match side.state() {
        SideState::Traced => format!("{name}: these trees are traced"),
        SideState::Built => format!("{name}: to look at, not traced"),
        SideState::Building => format!("{name}: being built…"),
        SideState::Failed(why) => format!("{name}: {why}"),
    }
}

/// What there is to count, line by line.
fn lines(counts: &TreeCounts) -> Vec<String> {
    let TreeCounts {
        nodes,
        leaves,
        levels,
        bytes,
        build_time,
        sah_costs,
        per_camera_ray,
        of_pixel,
    } = counts;
    let mut lines = vec![format!(
        "{}, {}, {}, {}, built in {:.1} ms",
        counted(*nodes, "node"),
        counted(*leaves, "leaf"),
        counted((*levels).into(), "level"),
        memory_text(*bytes),
        build_time.as_secs_f64() * 1e3
    )];
    match sah_costs {
        [Some(top), Some(mesh)] => lines.push(format!(
            "SAH cost {top:.2} over the objects, {mesh:.2} in the largest mesh"
        )),
        [Some(top), None] => lines.push(format!("SAH cost {top:.2}")),
        _ => {}
    }
    let [boxes, entered, triangles] = per_camera_ray;
    lines.push(format!(
        "a camera ray: {boxes:.1} boxes, {entered:.1} nodes, {triangles:.1} triangles"
    ));
    if let Some(cost) = of_pixel {
        lines.push(format!(
            "the pixel's rays: {}, {}, {}",
            counted(cost.boxes, "box"),
            counted(cost.nodes, "node"),
            counted(cost.triangles, "triangle")
        ));
    }
    lines
}

/// The line between the views; over each its heading and what was left out, below it its counts. With the split view the
/// headings stand below its own. Returns how much of the left view's height that takes above and below.
pub(super) fn pair_ui(ui: &Ui, views: [Rect; 2], world: &World, split: bool) -> [f32; 2] {
    let [left, right] = views;
    let line = Stroke::new(GAP, ui.visuals().panel_fill);
    let middle = 0.5 * (left.max.x + right.min.x);
    ui.painter().vline(middle, left.y_range(), line);
    let wanted = &world.resource::<InspectSettings>().pair;
    let pair = world.resource::<TreePair>();
    let width = (left.width() - 2.0 * MARGIN).min(MOST_WIDTH);
    if width < LEAST_WIDTH {
        return [0.0; 2];
    }
    let top = left.min.y + if split { 34.0 } else { MARGIN };
    let mut taken = [0.0_f32; 2];
    let mut said = Vec::new();
    for ((view, side), builder) in
        (views.into_iter().zip(&pair.sides)).zip([wanted.left, wanted.right])
    {
        let mut texts = vec![heading(builder, side)];
        for text in side.says() {
            // What both say is said once.
            if !said.contains(&text) {
                said.push(text.clone());
                texts.push(text);
            }
        }
        let mut at = pos2(view.center().x, top);
        for text in texts {
            let rect = label_within(ui, at, Align2::CENTER_TOP, &text, width);
            at.y = rect.max.y + MARGIN - 1.0;
        }
        taken[0] = taken[0].max(at.y - view.min.y);
        if let Some(counts) = side.counts() {
            let at: Pos2 = view.left_bottom() + vec2(MARGIN + 3.0, -MARGIN);
            let text = lines(counts).join("\n");
            let rect = label_within(ui, at, Align2::LEFT_BOTTOM, &text, width);
            taken[1] = taken[1].max(view.max.y - rect.min.y + MARGIN);
        }
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Counters;
    use std::time::Duration;

    #[test]
    fn counts_are_said_with_as_many_digits_as_mean_something() {
        let counts = TreeCounts {
            nodes: 1,
            leaves: 1,
            levels: 0,
            bytes: 900,
            build_time: Duration::from_micros(1250),
            sah_costs: [Some(3.456), None],
            per_camera_ray: [12.04, 3.0, 1.96],
            of_pixel: None,
        };
        assert_eq!(
            lines(&counts),
            [
                "1 node, 1 leaf, 0 levels, 0.9 kB, built in 1.2 ms",
                "SAH cost 3.46",
                "a camera ray: 12.0 boxes, 3.0 nodes, 2.0 triangles"
            ]
        );
        let counts = TreeCounts {
            sah_costs: [Some(3.456), Some(40.0)],
            of_pixel: Some(Counters {
                boxes: 12_345,
                nodes: 7,
                triangles: 3,
            }),
            ..counts
        };
        assert_eq!(
            lines(&counts)[1..],
            [
                "SAH cost 3.46 over the objects, 40.00 in the largest mesh",
                "a camera ray: 12.0 boxes, 3.0 nodes, 2.0 triangles",
                "the pixel's rays: 12\u{2009}345 boxes, 7 nodes, 3 triangles"
            ]
        );
    }
}
