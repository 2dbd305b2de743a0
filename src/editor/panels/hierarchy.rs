//! The list of entities. Only the rows that are seen are laid out, however many there are.

use super::outline::{Item, Outline};
use super::says::Says;
use super::state::{Panels, Renaming};
use super::theme::accent;
use crate::editor::action::Action;
use crate::editor::history::History;
use crate::editor::selection::Selection;
use crate::scene::SceneId;
use bevy::camera::visibility::Visibility;
use bevy::ecs::world::World;
use bevy_egui::egui::{
    self, Align2, Color32, FontFamily, FontId, Rect, Response, ScrollArea, Sense, Stroke,
    StrokeKind, TextEdit, Ui, pos2, vec2,
};
use std::ops::Range;

/// Points.
const ROW: f32 = 20.0;
const INDENT: f32 = 13.0;
const EYE: f32 = 20.0;

/// What is dragged onto another row.
struct Dragged(Vec<SceneId>);

/// What a person did to a row in this frame.
enum Deed {
    Click(usize),
    Fold(SceneId),
    Hide(usize),
    Rename(usize),
    Drop(Vec<SceneId>, Option<SceneId>),
}

pub(super) fn hierarchy_ui(ui: &mut Ui, world: &mut World, panels: &mut Panels) {
    search_ui(ui, panels);
    ui.add_space(2.0);
    let outline = world.resource::<Outline>();
    let selection = world.resource::<Selection>();
    let rows = panels.rows.of(outline, &panels.folded, &panels.search);
    if rows.is_empty() {
        let text = match outline.items.is_empty() {
            true => "The scene is empty. The menu Add puts something into it.",
            false => "No entity is called that.",
        };
        ui.weak(text);
    }
    let mut deeds = Vec::new();
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut drawn = 0;
    let area = ScrollArea::vertical().auto_shrink([false, false]);
    let shown = area.show_rows(ui, ROW, rows.len(), |ui, range: Range<usize>| {
        drawn = range.len();
        for row in range {
            let item = &outline.items[rows[row]];
            row_ui(ui, item, rows[row], selection, panels, &mut deeds);
        }
    });
    panels.rows_drawn = drawn;
    // What is dropped below the last row belongs to nobody.
    let bottom = shown.inner_rect.min.y + rows.len() as f32 * ROW - shown.state.offset.y;
    let below = Rect::from_min_max(
        pos2(shown.inner_rect.min.x, bottom.max(shown.inner_rect.min.y)),
        shown.inner_rect.max,
    );
    if below.height() > 1.0 {
        let response = ui.interact(below, ui.id().with("below"), Sense::click());
        if response.clicked() {
            deeds.push(Deed::Drop(Vec::new(), None));
        }
        if let Some(dragged) = response.dnd_release_payload::<Dragged>() {
            deeds.push(Deed::Drop(dragged.0.clone(), None));
        }
    }
    // A click on another row ends a renaming: both count, the name first.
    deeds.sort_by_key(|deed| !matches!(deed, Deed::Rename(_)));
    for deed in deeds {
        perform(ui, world, panels, &rows, deed);
    }
}

fn search_ui(ui: &mut Ui, panels: &mut Panels) {
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    let right_to_left = egui::Layout::right_to_left(egui::Align::Center);
    ui.allocate_ui_with_layout(size, right_to_left, |ui| {
        let clear = ui.add_enabled(!panels.search.is_empty(), egui::Button::new("✖").small());
        if clear.says("Shows all entities again").clicked() {
            panels.search.clear();
        }
        let field = TextEdit::singleline(&mut panels.search)
            .hint_text("Search")
            .desired_width(f32::INFINITY);
        ui.add(field)
            .says("Shows only entities whose name or kind contains this");
    });
}

fn row_ui(
    ui: &mut Ui,
    item: &Item,
    at: usize,
    selection: &Selection,
    panels: &mut Panels,
    deeds: &mut Vec<Deed>,
) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let id = ui.id().with(("row", item.id.0));
    let body = Rect::from_min_max(rect.min, pos2(rect.max.x - EYE, rect.max.y));
    let response = ui.interact(body, id, Sense::click_and_drag());
    let selected = selection.contains(item.id);
    let visuals = ui.visuals();
    let fill = match (selected, response.hovered()) {
        (true, _) => visuals.selection.bg_fill,
        (false, true) => visuals.widgets.noninteractive.bg_stroke.color,
        _ => Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(rect, 3.0, fill);
    let ink = match (item.unseen, selected) {
        (true, _) => visuals.weak_text_color().gamma_multiply(0.6),
        (false, true) => visuals.selection.stroke.color,
        _ => visuals.widgets.inactive.fg_stroke.color,
    };
    let mut x = rect.min.x + 2.0 + INDENT * item.depth as f32;
    if item.end > at + 1 {
        deeds.extend(fold_ui(ui, item, pos2(x, rect.center().y), panels));
    }
    x += INDENT;
    let glyphs = FontId::new(12.0, FontFamily::Monospace);
    let center = pos2(x + 8.0, rect.center().y);
    let icon_ink = if selected {
        ink
    } else {
        ink.gamma_multiply(0.8)
    };
    let painter = ui.painter();
    painter.text(
        center,
        Align2::CENTER_CENTER,
        item.kind.glyph(),
        glyphs.clone(),
        icon_ink,
    );
    let text_at = pos2(x + 20.0, rect.center().y);
    if let Some(renaming) = panels.renaming.as_mut().filter(|r| r.id == item.id) {
        let field = Rect::from_min_max(
            pos2(text_at.x - 3.0, rect.min.y),
            pos2(body.max.x, rect.max.y),
        );
        if rename_ui(ui, field, renaming) {
            deeds.push(Deed::Rename(at));
        }
    } else {
        let clip = Rect::from_min_max(pos2(x, rect.min.y), body.max).intersect(ui.clip_rect());
        let font = egui::TextStyle::Body.resolve(ui.style());
        ui.painter()
            .with_clip_rect(clip)
            .text(text_at, Align2::LEFT_CENTER, &item.name, font, ink);
    }
    deeds.extend(eye_ui(ui, item, at, rect, selected));
    if response.clicked() {
        deeds.push(Deed::Click(at));
    }
    if response.double_clicked() {
        panels.renaming = Some(Renaming {
            id: item.id,
            text: item.name.clone(),
            focused: false,
        });
    }
    deeds.extend(drag_ui(ui, item, body, &response, selection));
}

/// The triangle that folds; what was done with it.
fn fold_ui(ui: &Ui, item: &Item, left: egui::Pos2, panels: &Panels) -> Option<Deed> {
    let rect = Rect::from_center_size(left + vec2(5.0, 0.0), vec2(14.0, ROW));
    let response = ui.interact(rect, ui.id().with(("fold", item.id.0)), Sense::click());
    let folded = panels.folded.contains(item.id) && panels.search.trim().is_empty();
    let c = rect.center();
    let triangle = if folded {
        [vec2(-2.5, -4.0), vec2(3.0, 0.0), vec2(-2.5, 4.0)]
    } else {
        [vec2(-4.0, -2.5), vec2(4.0, -2.5), vec2(0.0, 3.0)]
    };
    let ink = ui.style().interact(&response).fg_stroke.color;
    let points = triangle.map(|offset| c + offset).to_vec();
    ui.painter()
        .add(egui::Shape::convex_polygon(points, ink, Stroke::NONE));
    response.clicked().then_some(Deed::Fold(item.id))
}

/// The eye that hides.
fn eye_ui(ui: &Ui, item: &Item, at: usize, row: Rect, selected: bool) -> Option<Deed> {
    let rect = Rect::from_min_max(pos2(row.max.x - EYE, row.min.y), row.max);
    let response = ui
        .interact(rect, ui.id().with(("eye", item.id.0)), Sense::click())
        .says("Hides or shows it and what is below it; what is hidden is not traced");
    let strength = match (item.hidden, response.hovered()) {
        (_, true) => 1.0,
        (true, _) => 0.2,
        (false, _) => 0.55,
    };
    let ink = if selected {
        ui.visuals().selection.stroke.color
    } else {
        ui.visuals().widgets.inactive.fg_stroke.color
    };
    ui.painter().text(
        rect.center(),
        Align2::CENTER_CENTER,
        "👁",
        FontId::new(12.0, FontFamily::Monospace),
        ink.gamma_multiply(strength),
    );
    if item.hidden {
        let [a, b] = [vec2(-5.0, 4.0), vec2(5.0, -4.0)].map(|offset| rect.center() + offset);
        ui.painter().line_segment([a, b], Stroke::new(1.2, ink));
    }
    response.clicked().then_some(Deed::Hide(at))
}

/// The field for a name; true when it is finished.
fn rename_ui(ui: &mut Ui, rect: Rect, renaming: &mut Renaming) -> bool {
    let field = TextEdit::singleline(&mut renaming.text)
        .margin(egui::Margin::symmetric(3, 1))
        .char_limit(200);
    let response = ui.put(rect, field);
    if !renaming.focused {
        response.request_focus();
        renaming.focused = true;
        return false;
    }
    response.lost_focus()
}

/// Rows are dragged onto others, which become their parents.
fn drag_ui(
    ui: &Ui,
    item: &Item,
    body: Rect,
    response: &Response,
    selection: &Selection,
) -> Option<Deed> {
    if response.drag_started() {
        let ids = match selection.contains(item.id) {
            true => selection.ids().to_vec(),
            false => vec![item.id],
        };
        response.dnd_set_drag_payload(Dragged(ids));
    }
    let may = |dragged: &Dragged| !dragged.0.contains(&item.id);
    if let Some(dragged) = response.dnd_hover_payload::<Dragged>()
        && may(&dragged)
    {
        let stroke = Stroke::new(1.5, accent(ui));
        ui.painter()
            .rect_stroke(body, 3.0, stroke, StrokeKind::Inside);
    }
    let dropped = response.dnd_release_payload::<Dragged>()?;
    may(&dropped).then(|| Deed::Drop(dropped.0.clone(), Some(item.id)))
}

fn perform(ui: &Ui, world: &mut World, panels: &mut Panels, rows: &[usize], deed: Deed) {
    match deed {
        Deed::Click(at) => {
            let modifiers = ui.input(|input| input.modifiers);
            click(world, panels, rows, at, modifiers.command, modifiers.shift);
        }
        Deed::Fold(id) => panels.folded.toggle(id),
        Deed::Hide(at) => {
            let item = &world.resource::<Outline>().items[at];
            let (entity, hidden) = (item.entity, item.hidden);
            let verb = if hidden { "Show" } else { "Hide" };
            let name = format!("{verb} {}", item.name);
            world.resource_mut::<History>().name_next(name);
            let visibility = match hidden {
                true => Visibility::Inherited,
                false => Visibility::Hidden,
            };
            if let Ok(mut entity) = world.get_entity_mut(entity) {
                entity.insert(visibility);
            }
        }
        Deed::Rename(at) => {
            let item = &world.resource::<Outline>().items[at];
            let (id, old) = (item.id, item.name.clone());
            let cancelled = ui.input(|input| input.key_pressed(egui::Key::Escape));
            if let Some(renaming) = panels.renaming.take() {
                let name = renaming.text.trim();
                if !cancelled && !name.is_empty() && name != old {
                    world.write_message(Action::Rename(id, name.to_owned()));
                }
            }
        }
        Deed::Drop(ids, _) if ids.is_empty() => {
            world.resource_mut::<Selection>().set([]);
        }
        Deed::Drop(ids, parent) => {
            world.write_message(Action::Reparent(ids, parent));
        }
    }
}

/// Selects a row; with Ctrl as well, with Shift everything from the last one clicked to it.
fn click(
    world: &mut World,
    panels: &mut Panels,
    rows: &[usize],
    at: usize,
    ctrl: bool,
    shift: bool,
) {
    let outline = world.resource::<Outline>();
    let id = outline.items[at].id;
    let row_of = |wanted: SceneId| rows.iter().position(|&row| outline.items[row].id == wanted);
    let range = panels
        .anchor
        .filter(|_| shift)
        .and_then(|anchor| Some((row_of(anchor)?, row_of(id)?)));
    let ids: Vec<SceneId> = match range {
        Some((from, to)) if from <= to => rows[from..=to].to_vec(),
        Some((from, to)) => rows[to..=from].iter().rev().copied().collect(),
        None => vec![at],
    }
    .into_iter()
    .map(|row| outline.items[row].id)
    .collect();
    let mut selection = world.resource_mut::<Selection>();
    match (shift, ctrl) {
        (true, true) => ids.into_iter().for_each(|id| selection.add(id)),
        (true, false) => selection.set(ids),
        (false, true) => selection.toggle(id),
        (false, false) => selection.set([id]),
    }
    if !shift {
        panels.anchor = Some(id);
    }
}
