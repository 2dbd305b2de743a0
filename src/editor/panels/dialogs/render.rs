//! Rendering to a file: what, from where, how good; and how far it is.

use super::super::fields::{properties_ui, row};
use super::super::menu_bar::cameras;
use super::super::says::Says;
use super::super::status::error_text;
use super::Dialogs;
use super::question::whole_path_ui;
use crate::editor::render_job::{
    RenderFrom, RenderJob, RenderProgress, RenderRequest, start_render,
};
use crate::editor::texts::path_text;
use crate::editor::viewport::traced_render;
use crate::film::duration_text;
use crate::scene::{RenderSettings, SceneId};
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Color32, ComboBox, Label, ProgressBar, RichText, TextEdit, Ui};
use std::path::Path;

/// What is entered, kept while the dialog is closed.
pub(in super::super) struct RenderForm {
    file: String,
    /// From which camera; `None`: from where the view stands.
    from: Option<SceneId>,
    /// Size, samples and rules, from the scene's when the dialog is opened.
    settings: Option<RenderSettings>,
    refused: Option<String>,
}

impl Default for RenderForm {
    fn default() -> Self {
        Self {
            file: "picture.png".into(),
            from: None,
            settings: None,
            refused: None,
        }
    }
}

impl RenderForm {
    /// Takes the scene's settings over when it is opened.
    pub fn open(&mut self, settings: RenderSettings) {
        self.settings = Some(settings);
        self.refused = None;
    }

    /// What is entered, while the dialog is open.
    #[cfg(test)]
    pub fn settings(&self) -> Option<&RenderSettings> {
        self.settings.as_ref()
    }
}

pub(super) fn render_ui(ui: &mut Ui, world: &mut World, dialogs: &mut Dialogs) {
    let progress = world.resource::<RenderJob>().progress();
    if let Some(progress) = progress {
        progress_ui(ui, world, &progress);
        ui.weak(
            "You can close this and go on editing: the picture is that of the scene as it was.",
        );
        return;
    }
    let scene = world.resource::<RenderSettings>().clone();
    let form = &mut dialogs.render_form;
    let mut settings = form.settings.take().unwrap_or(scene);
    let says = "PNG and JPEG as on the screen; EXR and HDR keep the linear light";
    row(ui, "File", says, |ui| {
        let width = ui.available_width();
        ui.add(TextEdit::singleline(&mut form.file).desired_width(width))
            .says(says);
    });
    whole_path_ui(ui, Path::new(form.file.trim()));
    from_ui(ui, world, form);
    let paths = ["size", "spp", "sampling.error", "sampling.time"];
    properties_ui(ui, &mut settings, &paths);
    if let Some(refused) = &form.refused {
        let color: Color32 = ui.visuals().error_fg_color;
        ui.label(RichText::new(refused).color(color));
    }
    if let Some(done) = world.resource::<RenderJob>().done() {
        ui.add(Label::new(RichText::new(done).weak()).wrap());
    }
    ui.add_space(8.0);
    let says = "Begins; the editing goes on meanwhile";
    if ui.button("Render").says(says).clicked() {
        let camera = match form.from {
            Some(id) => Some(RenderFrom::Camera(id)),
            None => view_camera(world),
        };
        form.refused = match camera {
            None => Some("the view traces nothing; choose a camera, or the traced view".into()),
            Some(camera) => {
                let request = RenderRequest {
                    file: form.file.trim().into(),
                    camera,
                    settings: settings.clone(),
                };
                start_render(world, request)
                    .err()
                    .map(|why| why.to_string())
            }
        };
    }
    form.settings = Some(settings);
}

fn from_ui(ui: &mut Ui, world: &mut World, form: &mut RenderForm) {
    let cameras = cameras(world);
    let camera = |id: SceneId| cameras.iter().find(|(other, _)| *other == id);
    let name = match form.from {
        None => "The view",
        Some(id) => camera(id).map_or("a camera that is gone", |(_, name)| name),
    };
    let says = "From where: what the view shows, or one of the scene's cameras";
    row(ui, "From", says, |ui| {
        ComboBox::from_id_salt("from")
            .selected_text(name)
            .width(ui.available_width().max(80.0))
            .truncate()
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut form.from, None, "The view");
                for (id, name) in &cameras {
                    ui.selectable_value(&mut form.from, Some(*id), name);
                }
            })
            .response
            .says(says);
    });
}

/// The tracer's camera of the view.
fn view_camera(world: &World) -> Option<RenderFrom> {
    let (_, camera, _) = traced_render(world)?.subject()?;
    Some(RenderFrom::View(Box::new(camera.clone())))
}

/// A bar with what is known of the end, and a way to stop it.
fn progress_ui(ui: &mut Ui, world: &mut World, progress: &RenderProgress) {
    ui.label(path_text(&progress.file));
    let mut text = match (&progress.status, progress.writing) {
        (_, true) => "writing".to_owned(),
        (None, _) => "waiting for the trees".to_owned(),
        (Some(status), _) => format!("{:.0} samples", status.samples),
    };
    if let Some(status) = &progress.status {
        if let Some(error) = status.error() {
            text += &format!(", error {}", error_text(&error));
        }
        if let Some(left) = status.seconds_left.filter(|_| !progress.writing) {
            text += &format!(", {} left", duration_text(left));
        }
    }
    ui.add(ProgressBar::new(progress.fraction).text(text));
    let cancel = ui.add_enabled(!progress.writing, egui::Button::new("Cancel render"));
    if cancel.says("Stops it; nothing is written").clicked() {
        world.resource_mut::<RenderJob>().cancel();
    }
}
