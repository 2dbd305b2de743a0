//! The palette: all commands, found by a few letters of their names.

use super::says::{name_control, note_hint};
use crate::editor::action::Action;
use crate::editor::command::{Command, CommandTable, State, shortcut};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy_egui::egui::text::{LayoutJob, TextWrapping};
use bevy_egui::egui::{
    self, Align2, Color32, FontId, Id, Key, Modal, Modifiers, Rect, ScrollArea, Sense, TextEdit,
    TextStyle, Ui, WidgetInfo, WidgetType, pos2, vec2,
};
use std::borrow::Cow;
use std::sync::Arc;

/// Points.
const WIDTH: f32 = 560.0;
const ROW: f32 = 22.0;
/// Rows that are seen at once.
const SEEN: f32 = 12.0;

/// The palette, where it is open.
#[derive(Resource, Default)]
pub(super) struct OpenPalette(pub Option<Palette>);

/// What is typed, and which of the rows found is chosen.
#[derive(Default)]
pub(super) struct Palette {
    text: String,
    chosen: usize,
}

pub(super) fn palette_ui(context: &egui::Context, world: &mut World, open: &mut OpenPalette) {
    let Some(palette) = &mut open.0 else {
        return;
    };
    let screen = context.content_rect();
    let top = vec2(0.0, 0.12 * screen.height());
    let area = Modal::default_area(Id::new("palette")).anchor(Align2::CENTER_TOP, top);
    let response = Modal::new(Id::new("palette"))
        .area(area)
        .show(context, |ui| {
            ui.set_width(WIDTH.min(screen.width() - 40.0));
            body_ui(ui, world, palette)
        });
    if let Some(id) = response.inner.clone() {
        world.write_message(Action::Run(id));
    }
    if response.inner.is_some() || response.should_close() {
        open.0 = None;
    }
}

/// The field and what is found; the id of what is to be run.
fn body_ui(ui: &mut Ui, world: &World, palette: &mut Palette) -> Option<Cow<'static, str>> {
    let (up, down, enter) = ui.input_mut(|input| {
        let mut pressed = |key| input.consume_key(Modifiers::NONE, key);
        (
            pressed(Key::ArrowUp),
            pressed(Key::ArrowDown),
            pressed(Key::Enter),
        )
    });
    let field = TextEdit::singleline(&mut palette.text)
        .hint_text("Find a command")
        .desired_width(f32::INFINITY);
    let field = ui.add(field);
    name_control(&field, "Finds a command by letters of its name");
    field.request_focus();
    if field.changed() {
        palette.chosen = 0;
    }
    let found = find(world, &palette.text);
    let last = found.len().saturating_sub(1);
    palette.chosen = match (up, down) {
        (true, false) => palette.chosen.checked_sub(1).unwrap_or(last),
        (false, true) if palette.chosen >= last => 0,
        (false, true) => palette.chosen + 1,
        _ => palette.chosen.min(last),
    };
    if found.is_empty() {
        ui.weak("No command is called that.");
    }
    let mut run = None;
    ui.spacing_mut().item_spacing.y = 0.0;
    ScrollArea::vertical()
        .max_height(SEEN * ROW)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            for (i, command) in found.iter().enumerate() {
                let state = command.state_in(world);
                let chosen = i == palette.chosen;
                let response = row_ui(ui, world, command, &state, chosen);
                if chosen && (up || down) {
                    response.scroll_to_me(None);
                }
                let wanted = response.clicked() || chosen && enter;
                if wanted && state.why_not.is_none() {
                    run = Some(command.id.clone());
                }
            }
        });
    run
}

/// Name, keys, and what it does or why it cannot be run.
fn row_ui(
    ui: &mut Ui,
    world: &World,
    command: &Command,
    state: &State,
    chosen: bool,
) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    response.widget_info(|| {
        WidgetInfo::selected(
            WidgetType::SelectableLabel,
            state.why_not.is_none(),
            chosen,
            command.title(state),
        )
    });
    let visuals = ui.visuals();
    let (fill, ink) = match (chosen, response.hovered()) {
        (true, _) => (visuals.selection.bg_fill, visuals.selection.stroke.color),
        (false, hovered) => (
            match hovered {
                true => visuals.widgets.noninteractive.bg_stroke.color,
                false => Color32::TRANSPARENT,
            },
            visuals.text_color(),
        ),
    };
    let ready = state.why_not.is_none();
    // Why it cannot be run is to be read too.
    let faint = match chosen {
        true => ink.gamma_multiply(0.7),
        false => visuals.weak_text_color(),
    };
    let ink = if ready { ink } else { ink.gamma_multiply(0.5) };
    let says = state.why_not.as_deref().unwrap_or(&command.help);
    if chosen || response.hovered() {
        note_hint(ui.ctx(), says.to_owned());
    }
    let painter = ui.painter();
    painter.rect_filled(rect, 3.0, fill);
    let font = TextStyle::Body.resolve(ui.style());
    let small = FontId::proportional(font.size - 2.0);
    let y = rect.center().y;
    let mut right = rect.max.x - 8.0;
    if let Some(keys) = shortcut(world, command) {
        let at = pos2(right, y);
        right = painter
            .text(at, Align2::RIGHT_CENTER, keys, small.clone(), ink)
            .min
            .x
            - 14.0;
    }
    let mark = if state.on == Some(true) { "✔ " } else { "" };
    let name = format!("{mark}{}", command.title(state));
    let line = |left: f32, text: String, font: FontId, ink: Color32| {
        let room = Rect::from_x_y_ranges(left..=right.max(left), rect.y_range());
        let mut line = LayoutJob::simple_singleline(text, font, ink);
        line.wrap = TextWrapping::truncate_at_width(room.width());
        let line = painter.layout_job(line);
        let at = Align2::LEFT_CENTER.anchor_size(pos2(left, y), line.size());
        // Where there is no room for more, an ellipsis says nothing.
        if line.size().x <= room.width() {
            painter.galley(at.min, line, ink);
        }
        at.max.x + 14.0
    };
    let left = line(rect.min.x + 8.0, name, font, ink);
    line(left, says.to_owned(), small, faint);
    response
}

/// How much less it is worth that a word stands in what is said of a command than in its name.
const SAID: i32 = 60;

/// The commands whose names have these letters in this order, or whose explanations have this word, the best first; all for
/// no letters.
fn find(world: &World, text: &str) -> Vec<Arc<Command>> {
    let rows = world.resource::<CommandTable>().rows();
    let scored = rows.iter().filter_map(|row| {
        // Who knows the id finds it by that too.
        let named = score(text, &row.name).or_else(|| Some(score(text, &row.id)? - 50));
        Some((named.max(score_said(text, &row.help))?, row))
    });
    let mut found: Vec<(i32, &Arc<Command>)> = scored.collect();
    found.sort_by_key(|(score, _)| -score);
    found.into_iter().map(|(_, row)| row.clone()).collect()
}

/// How well a name fits what was typed: letters at beginnings of words and letters in a row are
/// worth most, long gaps and long names little. `None` where a letter is missing.
pub(super) fn score(text: &str, name: &str) -> Option<i32> {
    let letters = |text: &str| -> Vec<char> { text.to_lowercase().chars().collect() };
    let (wanted, name) = (letters(text), letters(name));
    let wanted: Vec<char> = wanted.into_iter().filter(|c| !c.is_whitespace()).collect();
    let starts = |at: usize| at == 0 || !name[at - 1].is_alphanumeric();
    // For each letter the best score with it at each place of the name.
    let mut best: Vec<Option<i32>> = vec![None; name.len()];
    for (i, letter) in wanted.iter().enumerate() {
        let mut next = vec![None; name.len()];
        let mut before: Option<i32> = (i == 0).then_some(0);
        for at in 0..name.len() {
            let in_a_row = at.checked_sub(1).and_then(|at| best[at]).map(|s| s + 8);
            if name[at] == *letter {
                let from = in_a_row.max(before);
                next[at] = from.map(|score| score + if starts(at) { 10 } else { 1 });
            }
            before = before.max(best[at]);
        }
        best = next;
    }
    let found = match wanted.is_empty() {
        true => Some(0),
        false => best.into_iter().flatten().max(),
    };
    found.map(|score| score * 4 - name.len() as i32 * i32::from(!wanted.is_empty()))
}

/// How well an explanation fits what was typed: a person who asks for a spot is shown the light that becomes one.
fn score_said(text: &str, says: &str) -> Option<i32> {
    let wanted = text.trim().to_lowercase();
    let mut words = says.split(|c: char| !c.is_alphanumeric());
    let has = !wanted.is_empty() && words.any(|word| word.to_lowercase() == wanted);
    match has {
        true => Some(score(&wanted, &wanted)? - SAID),
        false => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_of_an_explanation_finds_what_it_explains_before_letters_here_and_there() {
        let mut world = World::new();
        let row = |id: &'static str, name: &'static str, says: &'static str| {
            Command::new(id, name, says, |_| {})
        };
        let mut table = CommandTable::default();
        for row in [
            row(
                "a",
                "Perspective or orthographic",
                "Far things keep their size",
            ),
            row("b", "Point light", "With a cone it is a spot"),
            row("c", "Spotless", "Shows spots"),
        ] {
            table.add(row);
        }
        world.insert_resource(table);
        let names = |text: &str| -> Vec<String> {
            let found = find(&world, text).into_iter();
            found.map(|row| row.name.to_string()).collect()
        };
        assert_eq!(
            names("Spot "),
            ["Spotless", "Point light", "Perspective or orthographic"]
        );
        assert_eq!(names("cone"), ["Point light"]);
        assert!(names("con").iter().all(|name| name != "Point light"));
        assert_eq!(names("").len(), 3);
    }

    #[test]
    fn what_can_be_added_is_found_by_what_else_it_is_called() {
        let mut app = crate::editor::headless_editor();
        let world = app.world_mut();
        for (text, wanted) in [
            ("cube", "Cuboid"),
            ("box", "Cuboid"),
            ("ball", "Sphere"),
            ("floor", "Ground"),
            ("plane", "Ground"),
            ("ring", "Torus"),
            ("lamp", "Point light"),
            ("sun", "Directional light"),
            ("tube", "Segment light"),
        ] {
            let found: Vec<_> = find(world, text)
                .into_iter()
                .map(|row| row.name.to_string())
                .collect();
            let at = found.iter().position(|name| name == wanted);
            assert!(at.is_some_and(|at| at < 4), "{text}: {found:?}");
        }
    }

    fn best<'a>(text: &str, names: &[&'a str]) -> &'a str {
        let scored = names
            .iter()
            .filter_map(|name| Some((score(text, name)?, *name)));
        scored
            .max_by_key(|(score, _)| *score)
            .map_or("", |(_, name)| name)
    }

    #[test]
    fn a_few_letters_find_the_name_that_they_begin_words_of() {
        let names = [
            "Frame selected",
            "Frame all",
            "Front view",
            "Find a command…",
            "Duplicate",
            "Select all",
        ];
        for (text, wanted) in [
            ("fs", "Frame selected"),
            ("fra", "Frame all"),
            ("front", "Front view"),
            ("DUP", "Duplicate"),
            ("sel all", "Select all"),
            ("fc", "Find a command…"),
        ] {
            assert_eq!(best(text, &names), wanted, "{text}");
        }
        assert_eq!(score("xyz", "Frame all"), None);
        assert_eq!(score("llaf", "Frame all"), None);
    }
}
