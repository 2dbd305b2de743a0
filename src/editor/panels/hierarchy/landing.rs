//! Dragging rows. A row that is dropped onto another becomes its child, between two their sibling;
//! siblings stand by their numbers, so the line is drawn where it will stand and not where it is let
//! go. Objects that are dropped onto a shared material get it, and so do those that one is dropped onto, in the list or in
//! the picture.

use super::super::outline::{Kind, Outline};
use super::super::outline_rows::{Row, is_in_folder};
use super::super::says::note_hint;
use super::super::theme::accent;
use super::row::List;
use super::{Deed, INDENT, ROW};
use crate::editor::pick;
use crate::editor::viewport::Viewport;
use crate::scene::SceneId;
use bevy::ecs::world::World;
use bevy::math::Vec2;
use bevy::platform::collections::HashSet;
use bevy_egui::egui::{
    self, Area, CursorIcon, DragAndDrop, Frame, Id, Label, LayerId, Order, Rect, Response, Stroke,
    StrokeKind, Ui, pos2, vec2,
};

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
    let is_between = !(EDGE..=1.0 - EDGE).contains(&part);
    let dragged = response.dnd_hover_payload::<Dragged>();
    let dropped = response.dnd_release_payload::<Dragged>();
    let dragged = dropped.as_ref().or(dragged.as_ref())?;
    let landing = Landing::of(list.outline, &dragged.0, at, is_between);
    landing.show(ui, list, &dragged.0, body.min.y - index as f32 * ROW, body);
    dropped.and_then(|dragged| landing.deed(list.outline, &dragged.0))
}

/// What is dragged and let go over the row of an object below its material is given that material.
pub(super) fn drop_on_user_ui(
    ui: &Ui,
    list: &List,
    index: usize,
    material: usize,
    body: Rect,
    response: &Response,
) -> Option<Deed> {
    let dragged = response.dnd_hover_payload::<Dragged>();
    let dropped = response.dnd_release_payload::<Dragged>();
    let dragged = dropped.as_ref().or(dragged.as_ref())?;
    let landing = Landing::of(list.outline, &dragged.0, material, false);
    landing.show(ui, list, &dragged.0, body.min.y - index as f32 * ROW, body);
    dropped.and_then(|dragged| landing.deed(list.outline, &dragged.0))
}

/// A material that is dragged over the picture would be the object's there, and is once it is let go.
pub(super) fn over_picture_ui(ui: &Ui, world: &mut World) -> Option<Deed> {
    let context = ui.ctx();
    let dragged = DragAndDrop::payload::<Dragged>(context)?;
    let (pointer, released) = ui.input(|input| {
        let pointer = &input.pointer;
        (pointer.interact_pos(), pointer.any_released())
    });
    let pointer = pointer?;
    let at = Vec2::new(pointer.x, pointer.y) * context.zoom_factor();
    let viewport = world.resource::<Viewport>();
    let views = [Some(viewport.rect), viewport.twin];
    let is_over = views.iter().flatten().any(|view| view.contains(at));
    let is_covered = context
        .layer_id_at(pointer)
        .is_some_and(|layer| layer != LayerId::background());
    let in_view = at - viewport.offset(at);
    if !is_over || is_covered {
        return None;
    }
    let outline = world.resource::<Outline>();
    if !dragged.0.iter().all(|&id| is_material(outline, id)) {
        return None;
    }
    let ray = pick::ray(world, in_view)?;
    // Lights and cameras have no material: their symbols are passed over.
    let met = pick::seen(world, ray.origin, *ray.direction);
    let outline = world.resource::<Outline>();
    let landing = match met.and_then(|met| outline.place(met.id)) {
        Some(at) => Landing::of(outline, &dragged.0, at, false),
        None => Landing::Nowhere("Nothing is there"),
    };
    landing.say(context, outline, &dragged.0);
    released
        .then(|| landing.deed(outline, &dragged.0))
        .flatten()
}

fn is_material(outline: &Outline, id: SceneId) -> bool {
    let item = outline.find(id);
    item.is_some_and(|item| item.kind == Kind::Material)
}

/// What letting go would do. Places are those in [`Outline::items`].
#[derive(Debug, PartialEq)]
enum Landing {
    /// What is dragged becomes a child of this, or of nothing.
    Below(Option<usize>),
    /// These objects get this material.
    Material {
        objects: Vec<SceneId>,
        material: usize,
    },
    /// Nothing, and why; without a word where that is to be seen.
    Nowhere(&'static str),
}

impl Landing {
    /// Over the row of what is at a place, or `is_between` it and the next one.
    fn of(outline: &Outline, ids: &[SceneId], at: usize, is_between: bool) -> Self {
        let item = &outline.items[at];
        let below = match is_between {
            true => outline.parent(at),
            false => Some(at),
        };
        let materials = ids.iter().filter(|&&id| is_material(outline, id)).count();
        let is_on_material = item.kind == Kind::Material && materials == 0;
        // In the folder there is nothing to stand between.
        if is_on_material && (!is_between || is_in_folder(item)) {
            let dragged = ids.iter().filter_map(|&id| outline.place(id));
            let objects = dragged.flat_map(|at| outline.objects_of(at));
            return Self::material(outline, objects, at);
        }
        let has_place = is_between && may_land(outline, ids, below);
        if materials > 0 && materials == ids.len() && !has_place {
            return match (ids, item.kind) {
                (_, Kind::Material) => Self::Nowhere(""),
                ([material], _) => match outline.place(*material) {
                    Some(place) => Self::material(outline, outline.objects_of(at), place),
                    None => Self::Nowhere(""),
                },
                _ => Self::Nowhere("An object has one material"),
            };
        }
        match may_land(outline, ids, below) {
            true => Self::Below(below),
            false => Self::Nowhere(""),
        }
    }

    fn material(
        outline: &Outline,
        objects: impl IntoIterator<Item = usize>,
        material: usize,
    ) -> Self {
        let entity = outline.items[material].entity;
        let mut objects = objects.into_iter().map(|at| &outline.items[at]).peekable();
        if objects.peek().is_none() {
            return Self::Nowhere("Only objects have a material");
        }
        let others = objects.filter(|item| item.material != Some(entity));
        let mut ids: Vec<SceneId> = others.map(|item| item.id).collect();
        // A group and what is in it may be dragged together.
        ids.sort_unstable();
        ids.dedup();
        match ids.is_empty() {
            true => Self::Nowhere("That is its material already"),
            false => Self::Material {
                objects: ids,
                material,
            },
        }
    }

    fn deed(self, outline: &Outline, ids: &[SceneId]) -> Option<Deed> {
        match self {
            Self::Below(parent) => {
                let parent = parent.map(|at| outline.items[at].id);
                Some(Deed::Drop(ids.to_vec(), parent))
            }
            Self::Material { objects, material } => {
                Some(Deed::Assign(objects, outline.items[material].id))
            }
            Self::Nowhere(_) => None,
        }
    }

    /// Marks it in the list, whose first row is at `top`.
    fn show(&self, ui: &Ui, list: &List, ids: &[SceneId], top: f32, body: Rect) {
        match self {
            Self::Below(target) => line_ui(ui, list, ids, *target, top, body),
            Self::Material { .. } => frame_ui(ui, body),
            Self::Nowhere(_) => {}
        }
        self.say(ui.ctx(), list.outline, ids);
    }

    /// Says beside the pointer what would become of a material, or why nothing would.
    fn say(&self, context: &egui::Context, outline: &Outline, ids: &[SceneId]) {
        let text = match self {
            Self::Below(_) => return,
            Self::Material { objects, material } => {
                let material = &outline.items[*material].name;
                match objects[..] {
                    [one] => {
                        let name = outline.find(one).map_or("", |item| &item.name);
                        format!("{name} gets {material}")
                    }
                    _ => format!("{} objects get {material}", objects.len()),
                }
            }
            Self::Nowhere(why) => {
                // It may be where it began.
                let is_itself = why.is_empty() && ids.len() == 1;
                if !is_itself {
                    context.set_cursor_icon(CursorIcon::NoDrop);
                }
                if why.is_empty() {
                    return;
                }
                (*why).to_owned()
            }
        };
        note_hint(context, text.clone());
        let Some(at) = context.pointer_latest_pos() else {
            return;
        };
        Area::new(Id::new("what a drop does"))
            .order(Order::Tooltip)
            .interactable(false)
            .fixed_pos(at + vec2(14.0, 14.0))
            .constrain_to(context.viewport_rect())
            .show(context, |ui| {
                Frame::popup(ui.style()).show(ui, |ui| ui.add(Label::new(text).extend()));
            });
    }
}

impl Outline {
    /// The objects that are meant where one is told what all of a thing looks like: itself, or those of a group.
    fn objects_of(&self, at: usize) -> impl Iterator<Item = usize> {
        let item = &self.items[at];
        let end = if item.kind == Kind::Group {
            item.end
        } else {
            at + 1
        };
        (at..end).filter(|&at| self.items[at].kind == Kind::Object)
    }
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
                frame_ui(ui, Rect::from_x_y_ranges(body.x_range(), y..=y + ROW));
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

/// Marks a row.
fn frame_ui(ui: &Ui, row: Rect) {
    let stroke = Stroke::new(1.0, accent(ui));
    ui.painter()
        .rect_stroke(row, 3.0, stroke, StrokeKind::Inside);
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
mod tests;
