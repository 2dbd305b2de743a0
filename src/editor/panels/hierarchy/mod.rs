//! The list of entities. Only the rows that are seen are laid out, however many there are.
//!
//! | module | does |
//! |---|---|
//! | [`row`] | draws a row, and notes what is done to it |
//! | [`landing`] | dragging rows, and where they would land |
//! | [`keys`] | arrows, and letters that find names |

mod keys;
mod landing;
mod row;

use keys::ListKeys;

use super::kind_icons::{SIDE, draw_kind};
use super::outline::{Kind, Outline, Shown};
use super::outline_rows::{Filter, Folded, Row, Rows};
use super::renaming::{Renaming, settle_name};
use super::says::{Says, name_control};
use super::theme::accent;
use crate::editor::action::Action;
use crate::editor::command::Over;
use crate::editor::document::SceneOpened;
use crate::editor::edits::set_visible;
use crate::editor::history::History;
use crate::editor::pointer::RightClicked;
use crate::editor::selection::Selection;
use crate::scene::SceneId;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy::math::Vec2;
use bevy_egui::egui::{
    self, Rect, ScrollArea, Sense, Stroke, StrokeKind, TextEdit, Ui, pos2, vec2,
};
use landing::Dragged;
use std::ops::Range;

/// Points.
const ROW: f32 = 20.0;
const INDENT: f32 = 13.0;
const EYE: f32 = 20.0;

/// What the list remembers between two frames.
#[derive(Resource, Default)]
pub(super) struct Hierarchy {
    /// What is searched for.
    pub filter: Filter,
    pub list_keys: ListKeys,
    /// Entities whose descendants are not shown.
    pub folded: Folded,
    rows: Rows,
    /// Where a range of rows begins.
    pub anchor: Option<SceneId>,
    pub renaming: Option<Renaming>,
    /// How many rows were laid out in this frame.
    pub rows_drawn: usize,
}

/// Another scene was opened: the numbers of its entities are those of others.
pub(super) fn forget_scene(_: On<SceneOpened>, mut panel: ResMut<Hierarchy>) {
    panel.folded.clear();
    panel.anchor = None;
    panel.renaming = None;
}

/// What a person did to a row in this frame; rows by their places in [`Outline::items`].
enum Deed {
    Click(usize),
    /// A right click.
    Menu(usize),
    Fold(SceneId),
    FoldMaterials,
    Hide(usize),
    /// A name is to be typed.
    StartName(usize),
    Drop(Vec<SceneId>, Option<SceneId>),
    /// Objects get a material.
    Assign(Vec<SceneId>, SceneId),
    Nothing,
}

/// A name whose field has lost the keys is given, be its row scrolled away or the list hidden.
pub(super) fn settle(context: &egui::Context, world: &mut World, panel: &mut Hierarchy) {
    settle_name(context, world, &mut panel.renaming, row::name_field);
}

pub(super) fn hierarchy_ui(ui: &mut Ui, world: &mut World, panel: &mut Hierarchy) {
    filter_ui(ui, panel);
    ui.add_space(2.0);
    let outline = world.resource::<Outline>();
    let selection = world.resource::<Selection>();
    if let Some(at) = panel.list_keys.reveal.and_then(|id| outline.place(id)) {
        panel.folded.reveal(outline, at);
    }
    let rows = panel.rows.of(outline, &panel.folded, &panel.filter);
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
    let mut area = ScrollArea::vertical().auto_shrink([false, false]);
    if let Some(offset) = panel.list_keys.scroll_to(outline, &rows) {
        area = area.vertical_scroll_offset(offset);
    }
    let shown = area.show_rows(ui, ROW, rows.len(), |ui, range: Range<usize>| {
        drawn = range.len();
        let list = row::List {
            outline,
            selection,
            rows: &rows,
        };
        for index in range {
            list.row_ui(ui, index, panel, &mut deeds);
        }
        landing::scroll_while_dragging(ui);
    });
    panel.rows_drawn = drawn;
    panel.list_keys.seen = [shown.state.offset.y, shown.inner_rect.height()];
    // What is dropped below the last row belongs to nobody.
    let bottom = shown.inner_rect.min.y + rows.len() as f32 * ROW - shown.state.offset.y;
    let below = Rect::from_min_max(
        pos2(shown.inner_rect.min.x, bottom.max(shown.inner_rect.min.y)),
        shown.inner_rect.max,
    );
    if below.height() > 1.0 {
        let response = ui.interact(below, ui.id().with("below"), Sense::click());
        name_control(&response, "Below the list: a click selects nothing");
        if response.clicked() {
            deeds.push(Deed::Nothing);
        }
        if response.dnd_hover_payload::<Dragged>().is_some() {
            let stroke = Stroke::new(2.0, accent(ui));
            ui.painter().hline(below.x_range(), below.min.y, stroke);
        }
        if let Some(dragged) = response.dnd_release_payload::<Dragged>() {
            deeds.push(Deed::Drop(dragged.0.clone(), None));
        }
    }
    if panel.list_keys.focused {
        let stroke = Stroke::new(1.0, accent(ui));
        ui.painter()
            .rect_stroke(shown.inner_rect, 3.0, stroke, StrokeKind::Inside);
    }
    deeds.extend(landing::over_picture_ui(ui, world));
    // A click on another row ends a renaming: both count, the name first.
    settle(ui.ctx(), world, panel);
    for deed in deeds {
        perform(ui, world, panel, &rows, deed);
    }
    keys::keys_ui(ui, shown.inner_rect, world, panel, &rows);
}

/// The search, and which kinds are shown.
fn filter_ui(ui: &mut Ui, panel: &mut Hierarchy) {
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    let right_to_left = egui::Layout::right_to_left(egui::Align::Center);
    ui.allocate_ui_with_layout(size, right_to_left, |ui| {
        let clear = !panel.filter.is_off();
        let clear = ui.add_enabled(clear, egui::Button::new("✖").small());
        if clear.says("Shows all entities again").clicked() {
            panel.filter = Default::default();
        }
        let field = TextEdit::singleline(&mut panel.filter.text)
            .hint_text("Search")
            .desired_width(f32::INFINITY);
        ui.add(field)
            .says("Shows only entities whose name or kind contains this");
    });
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for (shown, kind, says) in [
            (Shown::Objects, Kind::Object, "Shows objects alone"),
            (Shown::Lights, Kind::PointLamp, "Shows lights alone"),
            (Shown::Cameras, Kind::Camera, "Shows cameras alone"),
            (
                Shown::Materials,
                Kind::Material,
                "Shows shared materials alone",
            ),
            (Shown::Groups, Kind::Group, "Shows groups alone"),
        ] {
            let on = panel.filter.shown == shown;
            let response = ui.add(egui::Button::selectable(on, "").min_size(vec2(26.0, 20.0)));
            let ink = ui
                .style()
                .interact_selectable(&response, on)
                .fg_stroke
                .color;
            debug_assert!(response.rect.width() >= SIDE);
            draw_kind(ui.painter(), response.rect.center(), kind, ink);
            if response.says(&format!("{says}; again: all")).clicked() {
                panel.filter.shown = if on { Shown::All } else { shown };
            }
        }
    });
}

fn perform(ui: &Ui, world: &mut World, panel: &mut Hierarchy, rows: &[Row], deed: Deed) {
    match deed {
        Deed::Click(at) => {
            let modifiers = ui.input(|input| input.modifiers);
            click(world, panel, rows, at, modifiers.command, modifiers.shift);
        }
        Deed::Menu(at) => {
            let id = world.resource::<Outline>().items[at].id;
            if !world.resource::<Selection>().contains(id) {
                click(world, panel, rows, at, false, false);
            }
            let pointer = ui.input(|input| input.pointer.interact_pos());
            let at = pointer.unwrap_or_default() * ui.ctx().zoom_factor();
            world.trigger(RightClicked {
                at: Vec2::new(at.x, at.y),
                over: Over::Entity,
            });
        }
        Deed::Fold(id) => panel.folded.toggle(id),
        Deed::FoldMaterials => panel.folded.toggle_folder(),
        Deed::Hide(at) => {
            let item = &world.resource::<Outline>().items[at];
            let (id, hidden) = (item.id, item.hidden);
            let verb = if hidden { "Show" } else { "Hide" };
            let name = format!("{verb} {}", item.name);
            world.resource_mut::<History>().name_next(name);
            set_visible(world, &[id], hidden);
        }
        Deed::StartName(at) => {
            let item = &world.resource::<Outline>().items[at];
            panel.renaming = Some(Renaming {
                id: item.id,
                text: item.name.clone(),
                focused: false,
            });
        }
        Deed::Nothing => world.resource_mut::<Selection>().set([]),
        Deed::Drop(ids, parent) => {
            world.write_message(Action::Reparent(ids, parent));
        }
        Deed::Assign(objects, material) => {
            world.write_message(Action::AssignMaterial(objects, material));
        }
    }
}

/// Selects a row; with Ctrl as well, with Shift everything from the last one clicked to it.
fn click(
    world: &mut World,
    panel: &mut Hierarchy,
    rows: &[Row],
    at: usize,
    ctrl: bool,
    shift: bool,
) {
    let outline = world.resource::<Outline>();
    let id = outline.items[at].id;
    let row_of = |wanted: SceneId| {
        let place = outline.place(wanted)?;
        rows.iter().position(|row| row.item() == Some(place))
    };
    let range = panel
        .anchor
        .filter(|_| shift)
        .and_then(|anchor| Some((row_of(anchor)?, row_of(id)?)));
    let mut places: Vec<usize> = match range {
        Some((from, to)) => rows[from.min(to)..=from.max(to)]
            .iter()
            .filter_map(|row| row.item())
            .collect(),
        None => vec![at],
    };
    if range.is_some_and(|(from, to)| from > to) {
        places.reverse();
    }
    let ids: Vec<SceneId> = places.iter().map(|&at| outline.items[at].id).collect();
    let mut selection = world.resource_mut::<Selection>();
    match (shift, ctrl) {
        (true, true) => selection.add(ids),
        (true, false) => selection.set(ids),
        (false, true) => selection.toggle(id),
        (false, false) => selection.set([id]),
    }
    if !shift {
        panel.anchor = Some(id);
    }
}
