//! The list of rays: a heading that stays, and below it only the rows and columns that are seen.

use super::super::says::Says;
use super::super::theme::accent;
use crate::editor::inspection::Inspected;
use crate::editor::inspection::list::Row;
use crate::inspect::{COLUMNS, Column, Heading, Names, RaySettings};
use crate::trace::{RayEnd, RayTree, TracedRay, srgb};
use bevy_egui::egui::text::{LayoutJob, TextWrapping};
use bevy_egui::egui::{
    self, Align, Align2, Color32, FontFamily, FontId, Pos2, Rect, ScrollArea, Sense, Stroke, Ui,
    WidgetInfo, WidgetType, pos2, vec2,
};
use glam::Vec3;

/// Points.
const ROW: f32 = 18.0;
const HEADING: f32 = 19.0;
const INDENT: f32 = 12.0;
const FOLD: f32 = 14.0;
const SWATCH: f32 = 10.0;
const MARGIN: f32 = 5.0;

/// What is listed.
pub(super) struct Shown<'a> {
    pub rays: &'a RayTree,
    /// Which tree of rays it is.
    pub number: u64,
    pub names: &'a Names,
    pub kinds: &'a RaySettings,
    /// Stops, for the swatches.
    pub exposure: f32,
}

/// What a person did to a row.
enum Deed {
    Choose(u32),
    Fold(u32),
}

/// Draws the list; returns how many rows were laid out.
pub(super) fn table_ui(ui: &mut Ui, shown: &Shown, inspected: &mut Inspected) -> usize {
    if inspected.scrolls {
        unfold(shown.rays, inspected);
    }
    let area = ui.available_rect_before_wrap();
    let heading = Rect::from_min_size(area.min, vec2(area.width(), HEADING));
    ui.allocate_rect(heading, Sense::hover());
    ui.spacing_mut().item_spacing.y = 0.0;
    let Inspected {
        list, arrangement, ..
    } = &mut *inspected;
    let rows = list.rows(
        (shown.rays, shown.number),
        arrangement,
        shown.kinds,
        shown.names,
    );
    let count = rows.len();
    let width: f32 = COLUMNS.iter().map(|heading| heading.width).sum();
    let chosen = inspected.ray();
    let goal = inspected.scrolls.then(|| {
        let mut rows = inspected.list.known().iter();
        let row = rows.position(|row| Some(row.ray) == chosen);
        row.unwrap_or(usize::MAX)
    });
    inspected.scrolls = false;
    let rows = inspected.list.known();
    let mut drawn = 0;
    let mut deed = None;
    let scroll = ScrollArea::both()
        .id_salt("list of rays")
        .auto_shrink([false, false]);
    let out = scroll.show_viewport(ui, |ui, seen| {
        ui.set_width(width);
        // The bar below lies over what is there.
        ui.set_height(count as f32 * ROW + ui.spacing().scroll.bar_width);
        let corner = ui.max_rect().min;
        if let Some(goal) = goal.filter(|&goal| goal < count) {
            let top = corner + vec2(seen.min.x, goal as f32 * ROW);
            let rect = Rect::from_min_size(top, vec2(1.0, ROW));
            // At once: what was clicked in the view is looked for here.
            let at_once = egui::style::ScrollAnimation::none();
            ui.scroll_to_rect_animation(rect, Some(Align::Center), at_once);
        }
        let first = (seen.min.y / ROW).floor().max(0.0) as usize;
        let last = ((seen.max.y / ROW).ceil().max(0.0) as usize).min(count);
        for (at, row) in rows.iter().enumerate().take(last).skip(first) {
            drawn += 1;
            let top = corner + vec2(0.0, at as f32 * ROW);
            let rect = Rect::from_min_size(top, vec2(width.max(seen.max.x), ROW));
            let found = row_ui(ui, shown, row, rect, at, inspected);
            deed = found.or(deed.take());
        }
    });
    if count == 0 {
        let text = "No ray is of these kinds and contains the filter's text";
        let font = egui::TextStyle::Body.resolve(ui.style());
        let at = out.inner_rect.left_top() + vec2(MARGIN, MARGIN);
        let ink = ui.visuals().weak_text_color();
        ui.painter().text(at, Align2::LEFT_TOP, text, font, ink);
    }
    headings_ui(ui, heading, out.state.offset.x, inspected);
    match deed {
        Some(Deed::Choose(ray)) => {
            let again = inspected.ray() == Some(ray);
            inspected.choose_ray((!again).then_some(ray), false);
        }
        Some(Deed::Fold(ray)) => {
            let folded = &mut inspected.arrangement.folded;
            if !folded.remove(&ray) {
                folded.insert(ray);
            }
        }
        None => {}
    }
    drawn
}

/// A ray that was chosen elsewhere is not folded away.
fn unfold(rays: &RayTree, inspected: &mut Inspected) {
    let mut ray = inspected.ray();
    while let Some(now) = ray {
        ray = rays.rays.get(now as usize).and_then(|ray| ray.parent);
        if let Some(parent) = ray {
            inspected.arrangement.folded.remove(&parent);
        }
    }
}

fn headings_ui(ui: &Ui, area: Rect, scrolled: f32, inspected: &mut Inspected) {
    let painter = ui.painter().with_clip_rect(area.intersect(ui.clip_rect()));
    painter.rect_filled(area, 0.0, ui.visuals().faint_bg_color);
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    painter.hline(area.x_range(), area.max.y, line);
    let mut x = area.min.x - scrolled;
    for Heading {
        column,
        name,
        width,
        right,
        says,
    } in &COLUMNS
    {
        let cell = Rect::from_min_size(pos2(x, area.min.y), vec2(*width, area.height()));
        x += width;
        let seen = cell.intersect(area);
        if !seen.is_positive() {
            continue;
        }
        let sort = inspected.arrangement.sort;
        let says = format!("{says}. A click sorts by it: up, down, and as a tree again");
        let response = ui
            .interact(seen, ui.id().with(("heading", *name)), Sense::click())
            .says(&says);
        let arrow = match sort {
            Some((sorted, false)) if sorted == *column => " ⏶",
            Some((sorted, true)) if sorted == *column => " ⏷",
            _ => "",
        };
        let ink = match (arrow.is_empty(), response.hovered()) {
            (false, _) => accent(ui),
            (_, true) => ui.visuals().widgets.hovered.fg_stroke.color,
            _ => ui.visuals().widgets.noninteractive.fg_stroke.color,
        };
        let (at, align) = match right {
            true => (
                cell.right_center() - vec2(MARGIN, 0.0),
                Align2::RIGHT_CENTER,
            ),
            false => (cell.left_center() + vec2(MARGIN, 0.0), Align2::LEFT_CENTER),
        };
        let font = FontId::new(11.5, FontFamily::Proportional);
        let clip = painter.with_clip_rect(cell.intersect(painter.clip_rect()));
        clip.text(at, align, format!("{name}{arrow}"), font, ink);
        let edge = Stroke::new(1.0, line.color);
        painter.vline(cell.max.x, cell.y_range().shrink(3.0), edge);
        if response.clicked() {
            inspected.arrangement.click(*column);
        }
    }
}

fn row_ui(
    ui: &Ui,
    shown: &Shown,
    row: &Row,
    rect: Rect,
    at: usize,
    inspected: &Inspected,
) -> Option<Deed> {
    let ray = shown.rays.rays.get(row.ray as usize)?;
    let clip = ui.clip_rect();
    let seen = rect.intersect(clip);
    if !seen.is_positive() {
        return None;
    }
    let response = ui.interact(seen, ui.id().with(("ray", at)), Sense::click());
    let visuals = ui.visuals();
    let is_chosen = inspected.ray() == Some(row.ray);
    response.widget_info(|| {
        let name = format!("{} ray {}", ray.kind.name(), row.ray);
        WidgetInfo::selected(WidgetType::SelectableLabel, true, is_chosen, name)
    });
    let fill = match (is_chosen, response.hovered(), at % 2) {
        (true, ..) => visuals.selection.bg_fill,
        (_, true, _) => visuals.widgets.noninteractive.bg_stroke.color,
        (_, _, 1) => visuals.faint_bg_color,
        _ => Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(seen, 0.0, fill);
    let ink = match (is_chosen, ray.end) {
        (true, _) => visuals.selection.stroke.color,
        // What was never traced is there, and pale.
        (_, RayEnd::Unlit | RayEnd::LeftOut) => visuals.weak_text_color(),
        _ => visuals.widgets.inactive.fg_stroke.color,
    };
    let mut deed = None;
    let mut x = rect.min.x;
    for Heading {
        column,
        width,
        right,
        ..
    } in &COLUMNS
    {
        let cell = Rect::from_min_size(pos2(x, rect.min.y), vec2(*width, ROW));
        x += width;
        if !cell.intersects(clip) {
            continue;
        }
        let mut left = cell.min.x + MARGIN;
        if *column == Column::Ray {
            left += INDENT * row.indent as f32;
            if row.folds && fold_ui(ui, row.ray, pos2(left, cell.center().y), inspected, ink) {
                deed = Some(Deed::Fold(row.ray));
            }
            left += FOLD;
        }
        let painter = ui.painter().with_clip_rect(cell.intersect(clip));
        if let Some(color) = column.swatch(ray) {
            let size = vec2(SWATCH, SWATCH);
            let center = pos2(left + 0.5 * SWATCH, cell.center().y);
            let swatch = Rect::from_center_size(center, size);
            painter.rect(
                swatch,
                2.0,
                screen_color(color, shown.exposure),
                Stroke::new(1.0, visuals.widgets.noninteractive.bg_stroke.color),
                egui::StrokeKind::Inside,
            );
            left += SWATCH + 4.0;
        }
        cell_text(
            &painter,
            (cell, left),
            *right,
            column,
            row.ray,
            ray,
            shown.names,
            ink,
        );
    }
    if response.clicked() {
        deed = deed.or(Some(Deed::Choose(row.ray)));
    }
    deed
}

#[expect(clippy::too_many_arguments, reason = "a cell is where, how and what")]
fn cell_text(
    painter: &egui::Painter,
    (cell, left): (Rect, f32),
    right: bool,
    column: &Column,
    index: u32,
    ray: &TracedRay,
    names: &Names,
    ink: Color32,
) {
    let text = column.text(index, ray, names);
    let y = cell.center().y;
    if right {
        let font = FontId::new(11.0, FontFamily::Monospace);
        let at = pos2(cell.max.x - MARGIN, y);
        painter.text(at, Align2::RIGHT_CENTER, text, font, ink);
    } else {
        let font = FontId::new(12.0, FontFamily::Proportional);
        let mut line = LayoutJob::simple_singleline(text, font, ink);
        line.wrap = TextWrapping::truncate_at_width((cell.max.x - MARGIN - left).max(0.0));
        let line = painter.layout_job(line);
        let at = Align2::LEFT_CENTER.anchor_size(pos2(left, y), line.size());
        painter.galley(at.min, line, ink);
    }
}

/// The triangle that folds; true where it was clicked.
fn fold_ui(ui: &Ui, ray: u32, left: Pos2, inspected: &Inspected, ink: Color32) -> bool {
    let rect = Rect::from_center_size(left + vec2(4.0, 0.0), vec2(FOLD, ROW));
    let seen = rect.intersect(ui.clip_rect());
    if !seen.is_positive() {
        return false;
    }
    let response = ui.interact(seen, ui.id().with(("fold ray", ray)), Sense::click());
    let folded = inspected.arrangement.folded.contains(&ray);
    response.widget_info(|| {
        let name = format!("What ray {ray} leads to");
        WidgetInfo::selected(WidgetType::CollapsingHeader, true, !folded, name)
    });
    let c = rect.center();
    let triangle = if folded {
        [vec2(-2.0, -3.5), vec2(3.0, 0.0), vec2(-2.0, 3.5)]
    } else {
        [vec2(-3.5, -2.0), vec2(3.5, -2.0), vec2(0.0, 3.0)]
    };
    let points = triangle.map(|offset| c + offset).to_vec();
    let shape = egui::Shape::convex_polygon(points, ink, Stroke::NONE);
    ui.painter().with_clip_rect(ui.clip_rect()).add(shape);
    response.clicked()
}

/// Linear light as a screen shows it; what is brighter than a screen keeps its hue.
pub(super) fn screen_color(color: Vec3, exposure: f32) -> Color32 {
    let exposed = (color * exposure.exp2()).max(Vec3::ZERO);
    let largest = exposed.max_element();
    if !largest.is_finite() {
        return Color32::from_rgb(255, 0, 255);
    }
    let shown = exposed / largest.max(1.0);
    let [r, g, b] = shown
        .to_array()
        .map(|channel| (srgb::encode(channel) * 255.0 + 0.5) as u8);
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swatch_has_the_colour_that_a_screen_shows() {
        assert_eq!(screen_color(Vec3::ZERO, 0.0), Color32::BLACK);
        assert_eq!(screen_color(Vec3::ONE, 0.0), Color32::WHITE);
        assert_eq!(
            screen_color(Vec3::new(8.0, 0.0, 0.0), 0.0),
            Color32::from_rgb(255, 0, 0)
        );
        assert_eq!(screen_color(Vec3::splat(0.25), 2.0), Color32::WHITE);
    }
}
