//! What is in front of everything else, and takes keys and clicks until it is answered.

mod about;
mod folder;
mod history;
mod keys;
mod path;
mod preferences;
mod question;
mod render;
mod scenes;

use super::bindings::note_recording;
use super::says::Says;
use super::state::with;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Event, Id, Modal, RichText, ScrollArea, Ui};

use path::PathForm;
pub(super) use render::{RenderForm, forget_scene};
use scenes::Gallery;

/// What is in front of everything else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialog {
    Keys,
    About,
    Preferences,
    Scenes,
    History,
    Render,
}

/// What dialogs remember between two frames.
#[derive(Resource, Default)]
pub(super) struct Dialogs {
    /// The one that is open.
    pub open: Option<Dialog>,
    /// The one that was open in the frame before.
    before: Option<Dialog>,
    /// A path that is being typed for the document.
    typed_path: Option<PathForm>,
    gallery: Gallery,
    /// What is searched for among the keys.
    pub bindings_search: String,
    /// A command waited for keys when the frame before was drawn.
    records: bool,
}

/// A dialog's title, and its width in points.
pub(super) fn frame_of(dialog: Dialog) -> (&'static str, f32) {
    match dialog {
        Dialog::Keys => ("Keys and mouse", 760.0),
        Dialog::About => ("About Glassbox", 440.0),
        Dialog::Preferences => ("Preferences", 380.0),
        Dialog::Scenes => ("Built-in scenes", 790.0),
        Dialog::History => ("History", 420.0),
        Dialog::Render => ("Render to file", 460.0),
    }
}

pub(super) fn dialogs_ui(context: &egui::Context, world: &mut World, dialogs: &mut Dialogs) {
    if dialogs.records {
        // The command that waited for keys has had them: Escape and F1 close nothing.
        context.input_mut(|input| input.events.retain(|event| !is_of_keys(event)));
    }
    // What the document asks comes first: something waits for it.
    let asks = question::question_ui(context, world, dialogs);
    if !asks {
        open_ui(context, world, dialogs);
    }
    let lists_keys = !asks && dialogs.open == Some(Dialog::Keys);
    dialogs.records = note_recording(world, lists_keys);
}

fn is_of_keys(event: &Event) -> bool {
    use Event::{Copy, Cut, Key, Paste, Text};
    matches!(event, Key { .. } | Text(_) | Copy | Cut | Paste(_))
}

/// The dialog that is open, if one is.
fn open_ui(context: &egui::Context, world: &mut World, dialogs: &mut Dialogs) {
    let Some(dialog) = dialogs.open else {
        dialogs.before = None;
        return;
    };
    let (title, width) = frame_of(dialog);
    let stays = modal_ui(context, title, width, |ui| match dialog {
        Dialog::Keys => keys::keys_ui(ui, world, dialogs),
        Dialog::About => about::about_ui(ui),
        Dialog::Preferences => preferences::preferences_ui(ui, world),
        Dialog::Scenes => scenes::scenes_ui(ui, world, dialogs),
        Dialog::History => history::history_ui(ui, world),
        Dialog::Render => with(world, |world, form| render::render_ui(ui, world, form)),
    });
    // The press that opened it does not close it again.
    let f1 = context.input(|input| input.key_pressed(egui::Key::F1));
    let again = f1 && dialogs.before == Some(dialog);
    if (!stays || again) && dialogs.open == Some(dialog) {
        dialogs.open = None;
    }
    dialogs.before = dialogs.open;
}

/// How high what is in a dialog may be; more is scrolled. Points.
fn most_height(context: &egui::Context) -> f32 {
    (context.content_rect().height() - 140.0).max(120.0)
}

/// A dialog with a title and a way out; false where it was closed: by its button, by Escape, or by a
/// click beside it.
fn modal_ui(context: &egui::Context, title: &str, width: f32, body: impl FnOnce(&mut Ui)) -> bool {
    let screen = context.content_rect().size();
    let mut stays = true;
    // As high as what is in it asks for, and the screen allows.
    let area = Modal::default_area(Id::new(title)).default_size(screen);
    let response = Modal::new(Id::new(title)).area(area).show(context, |ui| {
        ui.set_width(width.min(screen.x - 40.0));
        // An area remembers how high it was, and what is in it may have grown since.
        ui.set_max_height(screen.y);
        ui.horizontal(|ui| {
            ui.label(RichText::new(title).heading());
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("✖").says("Closes this (Esc)").clicked() {
                    stays = false;
                }
            });
        });
        ui.separator();
        ScrollArea::vertical()
            .max_height(most_height(ui.ctx()))
            .auto_shrink([false, true])
            .show(ui, body);
    });
    stays && !response.should_close()
}
