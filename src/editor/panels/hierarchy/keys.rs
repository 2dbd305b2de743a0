//! Keys of the list: arrows go through its rows and fold them; once they have, letters find names,
//! until Escape or a click elsewhere gives the letters back to the commands.

use super::super::outline::Outline;
use super::super::outline_rows::{Row, is_in_folder};
use super::super::says::note_hint;
use super::{Hierarchy, ROW, click};
use crate::editor::selection::Selection;
use crate::scene::SceneId;
use bevy::ecs::world::World;
use bevy_egui::egui::{Event, Key, Rect, Ui};

/// Seconds after which a letter begins another name.
const PAUSE: f64 = 1.0;

/// Whether the list has the letters, and what it has to show.
#[derive(Default)]
pub(in super::super) struct ListKeys {
    /// Arrows are the list's: it was clicked last, and not the view.
    active: bool,
    /// Letters are, too.
    pub focused: bool,
    typed: String,
    typed_at: f64,
    /// What has to come into sight.
    pub reveal: Option<SceneId>,
    /// How far it was scrolled in the last frame, and how high it was, in points.
    pub seen: [f32; 2],
}

impl ListKeys {
    /// The list is not to be seen: arrows and letters are those of others again.
    pub fn let_go(&mut self) {
        (self.active, self.focused) = (false, false);
    }

    /// How far to scroll, so that what has to come into sight does.
    pub fn scroll_to(&mut self, outline: &Outline, rows: &[Row]) -> Option<f32> {
        let place = outline.place(self.reveal.take()?)?;
        let row = rows.iter().position(|row| row.item() == Some(place))?;
        let (top, bottom) = (row as f32 * ROW, (row + 1) as f32 * ROW);
        let [from, height] = self.seen;
        if top < from {
            Some(top)
        } else if bottom > from + height {
            Some(bottom - height)
        } else {
            None
        }
    }
}

pub(super) fn keys_ui(ui: &Ui, list: Rect, world: &mut World, panel: &mut Hierarchy, rows: &[Row]) {
    let context = ui.ctx();
    let (pressed, place) = ui.input(|input| {
        let pointer = &input.pointer;
        (pointer.any_pressed(), pointer.interact_pos())
    });
    let keys = &mut panel.list_keys;
    if pressed {
        keys.active = place.is_some_and(|place| list.contains(place));
        keys.focused &= keys.active;
    }
    let modal = context.memory(|memory| memory.top_modal_layer().is_some());
    if modal || context.any_popup_open() || context.egui_wants_keyboard_input() {
        return;
    }
    let (events, time, shift) =
        ui.input(|input| (input.events.clone(), input.time, input.modifiers.shift));
    for event in events {
        match event {
            Event::Key {
                key: key @ (Key::ArrowUp | Key::ArrowDown | Key::ArrowLeft | Key::ArrowRight),
                pressed: true,
                modifiers,
                ..
            } if panel.list_keys.active && !modifiers.command && !modifiers.alt => {
                panel.list_keys.focused = true;
                arrow(world, panel, rows, key, shift);
            }
            Event::Key {
                key: Key::Escape,
                pressed: true,
                ..
            } => panel.list_keys.focused = false,
            Event::Text(text) if panel.list_keys.focused => {
                find_name(world, panel, rows, &text, time);
            }
            _ => {}
        }
    }
    if panel.list_keys.focused {
        let hint = "Arrows choose and fold, letters find a name; Escape gives letters back to the commands";
        note_hint(context, hint.into());
    }
}

/// The row of the active entity.
fn active_row(world: &World, rows: &[Row]) -> Option<usize> {
    let active = world.resource::<Selection>().active()?;
    let place = world.resource::<Outline>().place(active)?;
    rows.iter().position(|row| row.item() == Some(place))
}

fn arrow(world: &mut World, panel: &mut Hierarchy, rows: &[Row], key: Key, shift: bool) {
    let items = |row: &Row| row.item();
    let now = active_row(world, rows);
    let wanted = match (key, now) {
        (Key::ArrowUp, Some(now)) => rows[..now].iter().rev().find_map(items),
        (Key::ArrowDown, Some(now)) => rows[now + 1..].iter().find_map(items),
        (Key::ArrowUp | Key::ArrowDown, None) => rows.iter().find_map(items),
        (_, None) => None,
        (key, Some(now)) => {
            let Some(at) = rows[now].item() else {
                return;
            };
            let outline = world.resource::<Outline>();
            let item = &outline.items[at];
            let below = item.end > at + 1;
            let has_children = below || is_in_folder(item) && !outline.users(item).is_empty();
            let folded = panel.folded.contains(item);
            match key {
                Key::ArrowLeft if has_children && !folded => {
                    panel.folded.toggle(item.id);
                    None
                }
                Key::ArrowLeft => outline.parent(at),
                _ if folded && has_children => {
                    panel.folded.toggle(item.id);
                    None
                }
                _ => below.then_some(at + 1),
            }
        }
    };
    if let Some(at) = wanted {
        choose(world, panel, rows, at, shift);
    }
}

/// Selects the next row whose name begins with what was typed.
fn find_name(world: &mut World, panel: &mut Hierarchy, rows: &[Row], text: &str, time: f64) {
    let keys = &mut panel.list_keys;
    if time - keys.typed_at > PAUSE {
        keys.typed.clear();
    }
    keys.typed_at = time;
    keys.typed.push_str(&text.to_lowercase());
    let mut letters = keys.typed.chars();
    let first = letters.next();
    // The same letter again and again goes through all names with it.
    let again = letters.clone().count() > 0 && letters.all(|letter| Some(letter) == first);
    let wanted = match (again, first) {
        (true, Some(letter)) => letter.to_string(),
        _ => keys.typed.clone(),
    };
    let skip = usize::from(again || keys.typed.chars().count() == 1);
    let start = active_row(world, rows).map_or(0, |now| now + skip);
    let outline = world.resource::<Outline>();
    let found = (0..rows.len())
        .filter_map(|i| rows[(start + i) % rows.len()].item())
        .find(|&at| outline.items[at].lower_name.starts_with(&wanted));
    if let Some(at) = found {
        choose(world, panel, rows, at, false);
    }
}

fn choose(world: &mut World, panel: &mut Hierarchy, rows: &[Row], at: usize, shift: bool) {
    panel.list_keys.reveal = Some(world.resource::<Outline>().items[at].id);
    click(world, panel, rows, at, false, shift);
}
