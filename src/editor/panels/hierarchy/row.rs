//! One row: fold, icon, name, eye.

use super::super::kind_icons::{draw_eye, draw_fold, draw_kind};
use super::super::number_field::select_letters;
use super::super::outline::{Item, Kind, Outline};
use super::super::outline_rows::{Row, is_in_folder};
use super::super::renaming::Renaming;
use super::super::says::Says;
use super::{Deed, EYE, Hierarchy, INDENT, ROW, landing};
use crate::editor::selection::Selection;
use crate::scene::SceneId;
use bevy_egui::egui::{
    self, Color32, Id, Pos2, Rect, Response, Sense, TextEdit, TextStyle, TextWrapMode, Ui,
    WidgetInfo, WidgetText, WidgetType, pos2, vec2,
};

/// What the rows are drawn of.
pub(super) struct List<'a> {
    pub outline: &'a Outline,
    pub selection: &'a Selection,
    pub rows: &'a [Row],
}

impl List<'_> {
    pub fn row_ui(&self, ui: &mut Ui, index: usize, panel: &mut Hierarchy, deeds: &mut Vec<Deed>) {
        match self.rows[index] {
            Row::Item(at) => self.item_ui(ui, index, at, panel, deeds),
            Row::Materials(count) => folder_ui(ui, count, panel, deeds),
            Row::User { object, material } => self.user_ui(ui, index, [object, material], deeds),
        }
    }

    /// An object below the material that it has: to be seen and chosen.
    fn user_ui(
        &self,
        ui: &mut Ui,
        index: usize,
        [object, material]: [usize; 2],
        deeds: &mut Vec<Deed>,
    ) {
        let item = &self.outline.items[object];
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
        let of = self.outline.items[material].id.0;
        let response = ui.interact(rect, ui.id().with(("user", item.id.0, of)), Sense::click());
        let selected = self.selection.contains(item.id);
        name_row(&response, item, selected);
        let (ink, icon_ink) = inks(ui, rect, &response, selected, item.unseen);
        let x = rect.min.x + 2.0 + 3.0 * INDENT;
        let y = rect.center().y;
        draw_kind(ui.painter(), pos2(x + 8.0, y), item.kind, icon_ink);
        let field = Rect::from_min_max(pos2(x + 19.0, rect.min.y), rect.max);
        name_ui(ui, field, &item.name, ink);
        if response.clicked() {
            deeds.push(Deed::Click(object));
        }
        if response.secondary_clicked() {
            deeds.push(Deed::Menu(object));
        }
        let dropped = landing::drop_on_user_ui(ui, self, index, material, rect, &response);
        deeds.extend(dropped);
    }

    fn item_ui(
        &self,
        ui: &mut Ui,
        index: usize,
        at: usize,
        panel: &mut Hierarchy,
        deeds: &mut Vec<Deed>,
    ) {
        let item = &self.outline.items[at];
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
        let eye = if item.can_hide { EYE } else { 0.0 };
        let body = Rect::from_min_max(rect.min, pos2(rect.max.x - eye, rect.max.y));
        let id = ui.id().with(("row", item.id.0));
        let response = ui.interact(body, id, Sense::click_and_drag());
        let selected = self.selection.contains(item.id);
        name_row(&response, item, selected);
        let (ink, icon_ink) = inks(ui, rect, &response, selected, item.unseen);
        let depth = item.depth + u32::from(is_in_folder(item));
        let x = rect.min.x + 2.0 + INDENT * depth as f32;
        let y = rect.center().y;
        let is_shared = is_in_folder(item) && !self.outline.users(item).is_empty();
        if item.end > at + 1 || is_shared && panel.filter.is_off() {
            let folded = panel.folded.contains(item) && panel.filter.is_off();
            if fold_ui(ui, pos2(x, y), item, folded) {
                deeds.push(Deed::Fold(item.id));
            }
        }
        draw_kind(ui.painter(), pos2(x + INDENT + 8.0, y), item.kind, icon_ink);
        let field = Rect::from_min_max(pos2(x + INDENT + 19.0, rect.min.y), body.max);
        if let Some(renaming) = panel.renaming.as_mut().filter(|r| r.id == item.id) {
            rename_ui(ui, field, renaming);
        } else {
            name_ui(ui, field, &item.name, ink);
        }
        if item.can_hide && eye_ui(ui, item, rect, selected) {
            deeds.push(Deed::Hide(at));
        }
        if response.clicked() {
            deeds.push(Deed::Click(at));
        }
        if response.secondary_clicked() {
            deeds.push(Deed::Menu(at));
        }
        if response.double_clicked() {
            deeds.push(Deed::StartName(at));
        }
        deeds.extend(landing::drag_ui(ui, self, index, at, body, &response));
    }
}

fn name_row(response: &Response, item: &Item, selected: bool) {
    response.widget_info(|| {
        let what = format!("{}, {}", item.name, item.kind.name());
        WidgetInfo::selected(WidgetType::SelectableLabel, true, selected, what)
    });
}

/// Fills the row; the colours of text and icon.
fn inks(
    ui: &Ui,
    rect: Rect,
    response: &Response,
    selected: bool,
    unseen: bool,
) -> (Color32, Color32) {
    let visuals = ui.visuals();
    let fill = match (selected, response.hovered()) {
        (true, _) => visuals.selection.bg_fill,
        (false, true) => visuals.widgets.noninteractive.bg_stroke.color,
        _ => Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(rect, 3.0, fill);
    // The name of what is hidden is fainter, and read all the same; its icon and its eye say the rest.
    let ink = match (unseen, selected) {
        (_, true) => visuals.selection.stroke.color,
        (true, false) => visuals.weak_text_color(),
        (false, false) => visuals.widgets.inactive.fg_stroke.color,
    };
    let icon = match (unseen, selected) {
        (true, _) => 0.5,
        (false, true) => 1.0,
        (false, false) => 0.8,
    };
    (ink, ink.gamma_multiply(icon))
}

/// The name, ending in an ellipsis where there is no more room.
fn name_ui(ui: &Ui, rect: Rect, name: &str, ink: Color32) {
    let wrap = Some(TextWrapMode::Truncate);
    let room = (rect.width() - 4.0).max(8.0);
    let galley = WidgetText::from(name).into_galley(ui, wrap, room, TextStyle::Body);
    let at = pos2(rect.min.x + 1.0, rect.center().y - 0.5 * galley.size().y);
    ui.painter()
        .galley_with_override_text_color(at, galley, ink);
}

/// The folder of shared materials: no entity, so that it can only be folded.
fn folder_ui(ui: &mut Ui, count: usize, panel: &Hierarchy, deeds: &mut Vec<Deed>) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let response = response.says("Materials that several objects can use; a click folds them away");
    let name = format!("Materials ({count})");
    let folded = panel.folded.folder() && panel.filter.is_off();
    response
        .widget_info(|| WidgetInfo::selected(WidgetType::CollapsingHeader, true, !folded, &name));
    let (ink, icon_ink) = inks(ui, rect, &response, false, false);
    let (x, y) = (rect.min.x + 2.0, rect.center().y);
    draw_fold(ui.painter(), pos2(x + 5.0, y), folded, icon_ink);
    draw_kind(
        ui.painter(),
        pos2(x + INDENT + 8.0, y),
        Kind::Group,
        icon_ink,
    );
    let field = Rect::from_min_max(pos2(x + INDENT + 19.0, rect.min.y), rect.max);
    name_ui(ui, field, &name, ink);
    if response.clicked() {
        deeds.push(Deed::FoldMaterials);
    }
}

/// The triangle that folds; true where it was clicked.
fn fold_ui(ui: &Ui, left: Pos2, item: &Item, folded: bool) -> bool {
    let rect = Rect::from_center_size(left + vec2(5.0, 0.0), vec2(14.0, ROW));
    let response = ui.interact(rect, ui.id().with(("fold", item.id.0)), Sense::click());
    response.widget_info(|| {
        let what = format!("What is below {}", item.name);
        WidgetInfo::selected(WidgetType::CollapsingHeader, true, !folded, what)
    });
    let ink = ui.style().interact(&response).fg_stroke.color;
    draw_fold(ui.painter(), rect.center(), folded, ink);
    response.clicked()
}

/// The eye that hides; true where it was clicked.
fn eye_ui(ui: &Ui, item: &Item, row: Rect, selected: bool) -> bool {
    let rect = Rect::from_min_max(pos2(row.max.x - EYE, row.min.y), row.max);
    let response = ui.interact(rect, ui.id().with(("eye", item.id.0)), Sense::click());
    response.widget_info(|| {
        let what = format!("{} is shown", item.name);
        WidgetInfo::selected(WidgetType::Checkbox, true, !item.hidden, what)
    });
    let response =
        response.says("Hides or shows it and what is below it; what is hidden is not traced");
    let strength = match (item.hidden, response.hovered()) {
        (_, true) => 1.0,
        (true, _) => 0.6,
        (false, _) => 0.55,
    };
    let ink = if selected {
        ui.visuals().selection.stroke.color
    } else {
        ui.visuals().widgets.inactive.fg_stroke.color
    };
    let ink = ink.gamma_multiply(strength);
    draw_eye(ui.painter(), rect.center(), item.hidden, ink);
    response.clicked()
}

/// Where the name of an entity is typed.
pub(super) fn name_field(id: SceneId) -> Id {
    Id::new(("name in the list", id.0))
}

/// The field for a name.
fn rename_ui(ui: &mut Ui, rect: Rect, renaming: &mut Renaming) {
    let id = name_field(renaming.id);
    let field = TextEdit::singleline(&mut renaming.text)
        .id(id)
        .margin(egui::Margin::symmetric(3, 1))
        .char_limit(200);
    let response = ui
        .scope_builder(egui::UiBuilder::new().max_rect(rect), |ui| {
            ui.add(field.desired_width(rect.width() - 8.0))
        })
        .inner;
    if !renaming.focused {
        response.request_focus();
        renaming.focused = true;
        // What is typed replaces the name.
        select_letters(ui, id, 0..renaming.text.chars().count());
    }
}
