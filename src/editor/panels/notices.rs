//! Messages: beside the picture where a panel is, so that they hide nothing of it.

use super::says::Says;
use crate::editor::notice::{Notice, Notices};
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Align2, Id, Label, Rect, RichText, Ui, vec2};

/// How many messages are shown at most: more would hide the panel.
const MOST: usize = 4;
/// Points that a panel is wide at least where messages stand over it.
const LEAST_WIDTH: f32 = 100.0;
/// Lines of a message that are shown until all are asked for.
const FIRST_LINES: usize = 5;
/// Points that all lines of a message take at most; the rest is scrolled to.
const MOST_HEIGHT: f32 = 260.0;

/// Messages, the newest below; true where the pointer is over them.
pub(super) fn notices_ui(context: &egui::Context, free: Rect, world: &mut World) -> bool {
    // Only looked at while there are any: asking makes the resource count as changed.
    if world.resource::<Notices>().is_empty() {
        return false;
    }
    let mut notices = world.resource_mut::<Notices>();
    let all = notices.shown();
    if all.is_empty() {
        return false;
    }
    let room = room(context.viewport_rect(), free);
    let width = (room.width() - 40.0).clamp(LEAST_WIDTH, 460.0);
    let earlier = all.len().saturating_sub(MOST);
    let mut closed = None;
    let mut expanded = None;
    let area = egui::Area::new(Id::new("notices"))
        .pivot(Align2::RIGHT_BOTTOM)
        .fixed_pos(room.max - vec2(8.0, 8.0))
        .order(egui::Order::Foreground)
        .show(context, |ui| {
            ui.set_max_width(width);
            if earlier > 0 && earlier_ui(ui, earlier) {
                closed = Some(Closed::All);
            }
            for (i, notice) in all.iter().enumerate().skip(earlier) {
                match notice_ui(ui, notice, width) {
                    Some(Read::Closed) => closed = Some(Closed::One(i)),
                    Some(Read::More) => expanded = Some(i),
                    None => {}
                }
            }
        });
    match closed {
        Some(Closed::One(i)) => notices.close(i),
        Some(Closed::All) => notices.close_all(),
        None => {}
    }
    if let Some(i) = expanded {
        notices.show_all(i);
    }
    is_over(context, area.response.rect)
}

/// Where messages stand: over the panel on the left, whose lower part is free in most scenes, else over that on the right,
/// and over the picture where there is nothing else.
fn room(window: Rect, free: Rect) -> Rect {
    let left = window.with_max_x(free.min.x);
    let right = window.with_min_x(free.max.x);
    let beside = [left, right].map(|side| side.with_min_y(free.min.y).with_max_y(free.max.y));
    let wide = beside.into_iter().find(|side| side.width() >= LEAST_WIDTH);
    wide.unwrap_or(free)
}

/// What a person has read.
enum Closed {
    One(usize),
    All,
}

/// That there are more messages; true where all are to go.
fn earlier_ui(ui: &mut Ui, earlier: usize) -> bool {
    let frame = egui::Frame::popup(ui.style()).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.weak(format!("and {earlier} before these"));
            let close = ui.small_button("Close all");
            close.says("Closes all messages").clicked()
        })
        .inner
    });
    frame.inner
}

/// What a person wants of a message.
enum Read {
    Closed,
    /// The lines that are not shown.
    More,
}

/// One message.
fn notice_ui(ui: &mut Ui, notice: &Notice, width: f32) -> Option<Read> {
    let color = match notice.is_fault {
        true => ui.visuals().error_fg_color,
        false => ui.visuals().text_color(),
    };
    let frame = egui::Frame::popup(ui.style()).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            ui.set_width(width);
            let text = RichText::new(&notice.text).color(color);
            let room = ui.available_width() - 30.0;
            let wanted = ui
                .allocate_ui(vec2(room, 0.0), |ui| {
                    ui.set_width(room);
                    ui.vertical(|ui| {
                        ui.add(Label::new(text).wrap().selectable(true));
                        lines_ui(ui, notice)
                    })
                    .inner
                })
                .inner;
            let close = ui.small_button("✖");
            let close = close.says("Closes this message").clicked();
            close.then_some(Read::Closed).or(wanted)
        })
        .inner
    });
    frame.inner
}

/// What a message says one by one: the first few, and how many more there are.
fn lines_ui(ui: &mut Ui, notice: &Notice) -> Option<Read> {
    let line_ui = |ui: &mut Ui, line: &String| {
        ui.add(
            Label::new(RichText::new(line).small())
                .wrap()
                .selectable(true),
        );
    };
    if notice.shows_all {
        egui::ScrollArea::vertical()
            .max_height(MOST_HEIGHT)
            .show(ui, |ui| {
                notice.lines.iter().for_each(|line| line_ui(ui, line))
            });
        return None;
    }
    let first = notice.lines.iter().take(FIRST_LINES);
    first.for_each(|line| line_ui(ui, line));
    let more = notice.lines.len().saturating_sub(FIRST_LINES);
    if more == 0 {
        return None;
    }
    ui.horizontal(|ui| {
        ui.weak(format!("and {more} more"));
        let all = ui.small_button("Show all");
        let clicked = all
            .says("Shows all that there is to say about this file")
            .clicked();
        clicked.then_some(Read::More)
    })
    .inner
}

/// Whether the pointer is there.
pub(super) fn is_over(context: &egui::Context, rect: Rect) -> bool {
    let pointer = context.pointer_latest_pos();
    pointer.is_some_and(|at| rect.contains(at))
}
