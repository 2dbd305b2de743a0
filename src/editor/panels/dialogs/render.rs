//! Rendering to a file: what, from where, how good; and how far it is.

use super::super::fields::{properties_ui, row};
use super::super::menu_bar::cameras;
use super::super::replaces::Replaces;
use super::super::says::Says;
use super::super::status::error_text;
use super::question::whole_path_ui;
use crate::editor::document::SceneOpened;
use crate::editor::render_job::{
    RenderFrom, RenderJob, RenderProgress, RenderRequest, start_render,
};
use crate::editor::texts::{path_of, path_text};
use crate::editor::viewport::traced_render;
use crate::film::duration_text;
use crate::scene::{RenderSettings, SceneId};
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy::math::UVec2;
use bevy_egui::egui::{self, Color32, ComboBox, Key, Label, ProgressBar, RichText, TextEdit, Ui};

/// What of the settings is entered here. All others are the scene's as it is when the render begins.
const ENTERED: [&str; 4] = ["size", "spp", "sampling.error", "sampling.time"];

/// What is entered, kept while the dialog is closed.
#[derive(Resource)]
pub(in super::super) struct RenderForm {
    file: String,
    replaces: Replaces,
    /// From which camera; `None`: from where the view stands.
    from: Option<SceneId>,
    /// As the scene has it until the dialog was drawn.
    entered: Option<Entered>,
    refused: Option<String>,
}

/// The values of [`ENTERED`].
#[derive(Clone, Copy)]
struct Entered {
    size: UVec2,
    spp: u32,
    error: f32,
    time: f32,
}

impl Entered {
    fn of(settings: &RenderSettings) -> Self {
        Self {
            size: settings.size,
            spp: settings.spp,
            error: settings.sampling.error,
            time: settings.sampling.time,
        }
    }
}

impl Default for RenderForm {
    fn default() -> Self {
        Self {
            file: "picture.png".into(),
            replaces: Replaces::default(),
            from: None,
            entered: None,
            refused: None,
        }
    }
}

impl RenderForm {
    /// Begins with what the scene has, when the dialog is opened.
    pub fn open(&mut self) {
        self.entered = None;
        self.refused = None;
    }

    /// The scene's settings with what is entered.
    pub fn settings(&self, scene: &RenderSettings) -> RenderSettings {
        let mut settings = scene.clone();
        if let Some(entered) = self.entered {
            settings.size = entered.size;
            settings.spp = entered.spp;
            settings.sampling.error = entered.error;
            settings.sampling.time = entered.time;
        }
        settings
    }
}

/// Another scene was opened: its cameras and its settings are others.
pub(in super::super) fn forget_scene(_: On<SceneOpened>, mut form: ResMut<RenderForm>) {
    form.from = None;
    // A picture of the old one is replaced as any other file.
    form.replaces = Replaces::default();
    form.open();
}

pub(super) fn render_ui(ui: &mut Ui, world: &mut World, form: &mut RenderForm) {
    let progress = world.resource::<RenderJob>().progress();
    if let Some(progress) = progress {
        progress_ui(ui, world, &progress);
        ui.weak(
            "You can close this and go on editing: the picture is that of the scene as it was.",
        );
        return;
    }
    let mut settings = form.settings(world.resource::<RenderSettings>());
    let says = "PNG and JPEG as on the screen; EXR and HDR keep the linear light. Relative paths begin in the working folder, ~ is home";
    let field = row(ui, "File", says, |ui| {
        let width = ui.available_width();
        let field = ui.add(TextEdit::singleline(&mut form.file).desired_width(width));
        field.says(says)
    });
    let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    let file = path_of(&form.file);
    whole_path_ui(ui, &file);
    from_ui(ui, world, form);
    properties_ui(ui, &mut settings, &ENTERED);
    form.entered = Some(Entered::of(&settings));
    if let Some(refused) = &form.refused {
        let color: Color32 = ui.visuals().error_fg_color;
        ui.label(RichText::new(refused).color(color));
    }
    if let Some(done) = world.resource::<RenderJob>().done() {
        ui.add(Label::new(RichText::new(done).weak()).wrap());
    }
    ui.add_space(8.0);
    let replaces = form.replaces.look(ui.ctx(), &file);
    let (name, says) = match replaces {
        true => (
            "Replace",
            "The file is there already: it is replaced when the picture is done",
        ),
        false => ("Render", "Begins; the editing goes on meanwhile"),
    };
    let clicked = ui.button(name).says(says).clicked();
    // A file that is there is replaced by its button alone.
    if (clicked || entered && !replaces) && form.replaces.allows(replaces) {
        let camera = match form.from {
            Some(id) => Some(RenderFrom::Camera(id)),
            None => view_camera(world),
        };
        form.refused = match camera {
            None => Some("the view traces nothing; choose a camera, or the traced view".into()),
            Some(camera) => {
                let request = RenderRequest {
                    file,
                    camera,
                    settings,
                };
                start_render(world, request)
                    .err()
                    .map(|why| why.to_string())
            }
        };
        if form.refused.is_none() {
            form.replaces.note_written();
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::action::Action;
    use crate::editor::document::adopt;
    use crate::editor::panels::dialogs::{Dialog, Dialogs};
    use crate::editor::panels::tests::Desk;
    use crate::sync::TracedCameras;
    use std::path::Path;
    use std::time::Instant;

    fn open(desk: &mut Desk) {
        desk.world().write_message(Action::run("file.render"));
        desk.settle();
    }

    /// The dialog's own button: a tab of the inspector is called like it.
    fn press(desk: &mut Desk, name: &str) {
        let at = desk.places(name).last().unwrap();
        desk.click(at);
    }

    #[test]
    fn the_dialog_shows_and_renders_the_scene_as_it_is_however_it_was_opened() {
        let mut desk = Desk::open("triangle");
        open(&mut desk);
        desk.key(Key::Escape);
        desk.settle();
        let mut scene = desk.world().resource_mut::<RenderSettings>();
        (scene.spp, scene.sampling.time, scene.max_depth) = (77, 2.5, 3);
        let folder = tempfile::tempdir().unwrap();
        desk.begin_endless_render(folder.path().join("a.png"));
        desk.settle();
        desk.click_on("rendering 0 %");
        desk.world().resource_mut::<RenderJob>().cancel();
        desk.settle();
        let open = desk.world().resource::<Dialogs>().open;
        assert_eq!(open, Some(Dialog::Render));
        // What the dialog does not show may be another meanwhile, as by an app of its own.
        let mut scene = desk.world().resource_mut::<RenderSettings>();
        scene.max_depth = 5;
        let scene = scene.clone();
        assert_eq!(
            desk.world().resource::<RenderForm>().settings(&scene),
            scene
        );
    }

    /// The dialog, about to render one sample of a small picture to a file.
    fn small_to(file: &Path) -> Desk {
        let mut desk = Desk::open("triangle");
        open(&mut desk);
        let camera = desk.world().resource::<TracedCameras>().0[0].id;
        let mut form = desk.world().resource_mut::<RenderForm>();
        form.file = file.display().to_string();
        form.from = Some(camera);
        let entered = form.entered.as_mut().unwrap();
        (entered.size, entered.spp) = (UVec2::splat(8), 1);
        desk.settle();
        desk
    }

    #[test]
    fn a_picture_that_is_there_is_replaced_only_by_who_was_told_so() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.png");
        std::fs::write(&file, "old").unwrap();
        let mut desk = small_to(&file);
        let start = Instant::now();
        while desk.find("Replace").is_none() {
            assert!(start.elapsed().as_secs() < 60, "it is not told");
            desk.settle();
        }
        // The tab of the inspector alone is called so.
        assert_eq!(desk.places("Render").count(), 1);
        press(&mut desk, "Replace");
        while desk.world().resource::<RenderJob>().done().is_none() {
            assert!(start.elapsed().as_secs() < 60, "it is not rendered");
            desk.settle();
        }
        assert_ne!(std::fs::read(&file).unwrap(), b"old");
        // Its own picture is rendered again without a question, that of another scene is not.
        desk.settle();
        assert_eq!(desk.places("Render").count(), 2);
        adopt(desk.world(), "another", None);
        while desk.find("Replace").is_none() {
            assert!(start.elapsed().as_secs() < 60, "it is not told");
            desk.settle();
        }
    }

    #[test]
    fn a_path_from_home_is_one() {
        let mut desk = Desk::open("triangle");
        open(&mut desk);
        let text = "~/no/such/folder/of/glassbox/a.png";
        let camera = desk.world().resource::<TracedCameras>().0[0].id;
        let mut form = desk.world().resource_mut::<RenderForm>();
        text.clone_into(&mut form.file);
        form.from = Some(camera);
        desk.settle();
        press(&mut desk, "Render");
        let refused = desk.world().resource::<RenderForm>().refused.clone();
        let there = path_of(text).display().to_string();
        assert!(
            refused.as_ref().is_some_and(|why| why.contains(&there)),
            "{refused:?}"
        );
    }

    #[test]
    fn enter_behind_a_files_name_begins_the_render_and_replaces_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.png");
        let mut desk = small_to(&file);
        let enter = |desk: &mut Desk| {
            let at = desk.place_of(&file.display().to_string());
            desk.click(at);
            desk.key(Key::Enter);
            desk.settle();
        };
        enter(&mut desk);
        let start = Instant::now();
        while desk.world().resource::<RenderJob>().done().is_none() {
            assert!(start.elapsed().as_secs() < 60, "it is not rendered");
            desk.settle();
        }
        // Another picture's file is asked about.
        std::fs::write(&file, "old").unwrap();
        adopt(desk.world(), "another", None);
        desk.settle();
        desk.world().resource_mut::<RenderForm>().file = file.display().to_string();
        while desk.find("Replace").is_none() {
            assert!(start.elapsed().as_secs() < 60, "it is not told");
            desk.settle();
        }
        enter(&mut desk);
        assert!(desk.world().resource::<RenderJob>().progress().is_none());
        assert_eq!(std::fs::read(&file).unwrap(), b"old");
    }

    #[test]
    fn another_scene_is_rendered_with_its_own_settings_and_from_none_of_the_old_cameras() {
        let mut desk = Desk::open("triangle");
        open(&mut desk);
        let mut form = desk.world().resource_mut::<RenderForm>();
        form.from = Some(SceneId(1));
        form.entered.as_mut().unwrap().spp = 12_345;
        adopt(desk.world(), "another", None);
        desk.settle();
        let scene = desk.world().resource::<RenderSettings>().clone();
        let form = desk.world().resource::<RenderForm>();
        assert_eq!((form.from, form.settings(&scene)), (None, scene));
    }
}
