//! Dragging rows. A row that is dropped onto another becomes its child, between two their sibling;
//! siblings stand by their numbers, so the line is drawn where it will stand and not where it is let
//! go.

use super::super::outline::{Kind, Outline};
use super::super::outline_rows::Row;
use super::super::theme::accent;
use super::row::List;
use super::{Deed, INDENT, ROW};
use crate::scene::SceneId;
use bevy::platform::collections::HashSet;
use bevy_egui::egui::{self, Rect, Response, Stroke, StrokeKind, Ui, pos2};

/// What is dragged onto another row.
pub(super) struct Dragged(pub Vec<SceneId>);

/// The part of a row's height at its upper and its lower edge where a drop is meant for between rows.
const EDGE: f32 = 0.25;
/// Points from the list's ends within which it scrolls while something is dragged, and by how much.
const NEAR: f32 = 24.0;
const SCROLL: f32 = 6.0;

/// Begins a drag of this row, and answers one that is over it.
pub(super) fn drag_ui(
    ui: &Ui,
    list: &List,
    index: usize,
    at: usize,
    body: Rect,
    response: &Response,
) -> Option<Deed> {
    let item = &list.outline.items[at];
    if response.drag_started() {
        let ids = match list.selection.contains(item.id) {
            true => list.selection.ids().to_vec(),
            false => vec![item.id],
        };
        response.dnd_set_drag_payload(Dragged(ids));
    }
    let pointer = ui.input(|input| input.pointer.interact_pos())?;
    let part = (pointer.y - body.min.y) / body.height();
    let target = match part {
        part if (EDGE..=1.0 - EDGE).contains(&part) => Some(at),
        _ => list.outline.parent(at),
    };
    let may = |dragged: &Dragged| may_land(list.outline, &dragged.0, target);
    if let Some(dragged) = response.dnd_hover_payload::<Dragged>()
        && may(&dragged)
    {
        let top = body.min.y - index as f32 * ROW;
        line_ui(ui, list, &dragged.0, target, top, body);
    }
    let dropped = response.dnd_release_payload::<Dragged>()?;
    let parent = target.map(|at| list.outline.items[at].id);
    may(&dropped).then(|| Deed::Drop(dropped.0.clone(), parent))
}

/// Those that a drop there would move: not what is there already, nor what comes along with what it is below.
fn moved(outline: &Outline, ids: &[SceneId], target: Option<usize>) -> Vec<SceneId> {
    let among: HashSet<usize> = ids.iter().filter_map(|&id| outline.place(id)).collect();
    let above = |at: usize| std::iter::successors(outline.parent(at), |&at| outline.parent(at));
    let moves = |id: &SceneId| {
        outline.place(*id).is_some_and(|at| {
            let comes_along = above(at).any(|above| among.contains(&above));
            outline.parent(at) != target && !comes_along
        })
    };
    ids.iter().copied().filter(moves).collect()
}

/// Not below itself or a material, which stands nowhere, and not where all of it is already.
fn may_land(outline: &Outline, ids: &[SceneId], target: Option<usize>) -> bool {
    if target.is_some_and(|at| outline.items[at].kind == Kind::Material) {
        return false;
    }
    let mut places = ids.iter().filter_map(|&id| outline.place(id));
    let below = |at: usize| target.is_some_and(|t| (at..outline.items[at].end).contains(&t));
    !places.any(below) && !moved(outline, ids, target).is_empty()
}

/// The row before which the first of those that move would stand, below that parent.
fn landing(outline: &Outline, rows: &[Row], ids: &[SceneId], target: Option<usize>) -> usize {
    let first = moved(outline, ids, target).into_iter().min();
    let first = first.unwrap_or_default();
    let (from, to, depth) = match target {
        Some(at) => (at + 1, outline.items[at].end, outline.items[at].depth + 1),
        None => (0, outline.items.len(), 0),
    };
    let later = (from..to).find(|&at| {
        let item = &outline.items[at];
        item.depth == depth && item.id > first
    });
    let place = later.unwrap_or(to);
    let shown = rows.iter().position(|row| match row {
        Row::Item(at) => *at >= place,
        Row::Materials(_) | Row::User { .. } => true,
    });
    shown.unwrap_or(rows.len())
}

/// Marks the parent to be, and the place among its children.
fn line_ui(ui: &Ui, list: &List, ids: &[SceneId], target: Option<usize>, top: f32, body: Rect) {
    let color = accent(ui);
    let painter = ui.painter();
    let depth = match target {
        Some(at) => {
            let row = list.rows.iter().position(|row| *row == Row::Item(at));
            if let Some(row) = row {
                let y = top + row as f32 * ROW;
                let rect = Rect::from_x_y_ranges(body.x_range(), y..=y + ROW);
                let stroke = Stroke::new(1.0, color);
                painter.rect_stroke(rect, 3.0, stroke, StrokeKind::Inside);
            }
            list.outline.items[at].depth + 1
        }
        None => 0,
    };
    let y = top + landing(list.outline, list.rows, ids, target) as f32 * ROW;
    let x = body.min.x + 2.0 + INDENT * (depth + 1) as f32;
    painter.hline(x..=body.max.x, y, Stroke::new(2.0, color));
    painter.circle_filled(pos2(x, y), 3.0, color);
}

/// Near the list's ends it scrolls on.
pub(super) fn scroll_while_dragging(ui: &Ui) {
    if !egui::DragAndDrop::has_payload_of_type::<Dragged>(ui.ctx()) {
        return;
    }
    let Some(pointer) = ui.input(|input| input.pointer.interact_pos()) else {
        return;
    };
    let seen = ui.clip_rect();
    if pointer.y < seen.min.y + NEAR {
        ui.scroll_with_delta(egui::vec2(0.0, SCROLL));
    } else if pointer.y > seen.max.y - NEAR {
        ui.scroll_with_delta(egui::vec2(0.0, -SCROLL));
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::outline::tests::village;
    use super::*;
    use crate::scene::Phong;
    use bevy::ecs::hierarchy::ChildOf;

    #[test]
    fn rows_land_among_their_siblings_to_be_and_never_below_themselves() {
        let app = village();
        // House 10 { Roof 11 { Tile 12 }, Door 13 }, Garden 20 { Tree 21 }.
        let outline = app.world().resource::<Outline>();
        let rows: Vec<Row> = (0..outline.items.len()).map(Row::Item).collect();
        let place = |id| outline.place(SceneId(id));
        let lands = |id, target| landing(outline, &rows, &[SceneId(id)], target);
        assert_eq!(lands(12, place(10)), 3, "after the roof, before the door");
        assert_eq!(lands(21, place(10)), 4, "after the door");
        assert_eq!(lands(12, None), 4, "between house and garden");
        assert_eq!(lands(21, None), 6, "at the end");
        let may = |id, target| may_land(outline, &[SceneId(id)], target);
        assert!(may(12, place(10)) && may(13, None));
        assert!(!may(10, place(12)) && !may(10, place(10)));
        assert!(!may(13, place(10)), "it is there already");
        // Of several those count that move.
        let all = |ids: &[u64]| ids.iter().map(|&id| SceneId(id)).collect::<Vec<_>>();
        let (some, target) = (all(&[11, 21]), place(10));
        assert_eq!(landing(outline, &rows, &some, target), 4, "after the door");
        let along = all(&[10, 13]);
        assert!(!may_land(outline, &along, None), "the door comes along");
    }

    #[test]
    fn nothing_lands_below_a_material() {
        let mut app = village();
        app.world_mut().spawn((SceneId(30), Phong::default()));
        app.update();
        let outline = app.world().resource::<Outline>();
        let place = |id| outline.place(SceneId(id));
        assert!(place(30).is_some() && may_land(outline, &[SceneId(12)], place(20)));
        assert!(!may_land(outline, &[SceneId(12)], place(30)));
    }

    #[test]
    fn many_rows_of_one_parent_are_dragged_at_once() {
        let mut app = village();
        let world = app.world_mut();
        let garden = world.resource::<Outline>().find(SceneId(20)).unwrap();
        let garden = garden.entity;
        let ids: Vec<SceneId> = (100..20_100).map(SceneId).collect();
        world.spawn_batch(ids.clone().into_iter().map(move |id| (id, ChildOf(garden))));
        app.update();
        let outline = app.world().resource::<Outline>();
        assert_eq!(moved(outline, &ids, outline.place(SceneId(10))), ids);
    }
}
