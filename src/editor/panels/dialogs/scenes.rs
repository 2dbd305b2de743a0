//! The scenes that come with Glassbox, each with a picture that is rendered beside the editor.

use super::super::says::Says;
use super::Dialogs;
use crate::app::headless_app;
use crate::editor::action::Action;
use crate::film::{develop_rgba8, render};
use crate::io::builtin::SCENES;
use crate::io::{OpenOptions, SceneSource, open};
use crate::scene::{RenderSettings, Sampling};
use crate::sync::{Traced, TracedCameras};
use bevy::ecs::world::World;
use bevy::math::UVec2;
use bevy::platform::cell::SyncCell;
use bevy_egui::egui::{
    self, ColorImage, Sense, TextureHandle, TextureOptions, Ui, WidgetInfo, WidgetType, vec2,
};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

/// Pixels of a picture.
const SIZE: UVec2 = UVec2::new(192, 144);
/// Points that it takes on the screen.
const SHOWN: [f32; 2] = [144.0, 108.0];
const SAMPLES: u32 = 16;

/// The pictures of the built-in scenes, as they come in.
#[derive(Default)]
pub(in super::super) struct Gallery {
    coming: Option<SyncCell<Receiver<(usize, ColorImage)>>>,
    pictures: Vec<Option<TextureHandle>>,
}

impl Gallery {
    /// Begins to render where nothing was rendered yet, and takes what has come in.
    fn update(&mut self, context: &egui::Context) {
        if self.pictures.is_empty() {
            self.pictures = vec![None; SCENES.len()];
            let (sender, coming) = channel();
            let worker = thread::Builder::new().name("gallery".into());
            // Without a thread there are no pictures; the names are there.
            if worker.spawn(move || render_all(&sender)).is_ok() {
                self.coming = Some(SyncCell::new(coming));
            }
        }
        let Some(coming) = &mut self.coming else {
            return;
        };
        while let Ok((i, picture)) = coming.get().try_recv() {
            let name = format!("scene {}", SCENES[i].name);
            let texture = context.load_texture(name, picture, TextureOptions::LINEAR);
            self.pictures[i] = Some(texture);
        }
    }
}

/// All of them on one thread of their own: the tracer's threads belong to the view.
fn render_all(sender: &Sender<(usize, ColorImage)>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let Ok(pool) = pool else { return };
    for i in 0..SCENES.len() {
        let Some(picture) = pool.install(|| picture_of(i)) else {
            continue;
        };
        if sender.send((i, picture)).is_err() {
            return;
        }
    }
}

/// A small picture of a built-in scene, from its first camera.
fn picture_of(i: usize) -> Option<ColorImage> {
    let mut app = headless_app();
    let source = SceneSource::Builtin(&SCENES[i]);
    open(app.world_mut(), &source, OpenOptions::default()).ok()?;
    app.update();
    let world = app.world();
    let camera = world.resource::<TracedCameras>().0.first()?;
    let settings = RenderSettings {
        size: SIZE,
        spp: SAMPLES,
        jitter: 1,
        sampling: Sampling::default(),
        ..world.resource::<RenderSettings>().clone()
    };
    let traced = &world.resource::<Traced>().world;
    let rendered = render(traced, &camera.camera, &settings, &|_, _| {});
    let bytes = develop_rgba8(&rendered.picture, &settings.output);
    let size = [SIZE.x as usize, SIZE.y as usize];
    Some(ColorImage::from_rgba_unmultiplied(size, &bytes))
}

pub(super) fn scenes_ui(ui: &mut Ui, world: &mut World, dialogs: &mut Dialogs) {
    dialogs.gallery.update(ui.ctx());
    let pictures = dialogs.gallery.pictures.clone();
    ui.horizontal_wrapped(|ui| {
        for (scene, picture) in SCENES.iter().zip(pictures) {
            let size = vec2(SHOWN[0] + 8.0, SHOWN[1] + 26.0);
            let (rect, response) = ui.allocate_exact_size(size, Sense::click());
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, scene.name));
            let response = response.says(scene.sentence);
            let visuals = ui.style().interact(&response);
            let (fill, ink) = (visuals.weak_bg_fill, visuals.fg_stroke.color);
            ui.painter().rect_filled(rect, 4.0, fill);
            let place = egui::Rect::from_min_size(rect.min + vec2(4.0, 4.0), SHOWN.into());
            match &picture {
                Some(texture) => egui::Image::new(texture).paint_at(ui, place),
                None => {
                    let well = ui.visuals().extreme_bg_color;
                    ui.painter().rect_filled(place, 2.0, well);
                    let (at, font) = (place.center(), egui::TextStyle::Small.resolve(ui.style()));
                    let faint = ui.visuals().weak_text_color();
                    let painter = ui.painter();
                    painter.text(at, egui::Align2::CENTER_CENTER, "rendering…", font, faint);
                }
            }
            let font = egui::TextStyle::Small.resolve(ui.style());
            let at = egui::pos2(rect.center().x, rect.max.y - 11.0);
            let painter = ui.painter().with_clip_rect(rect);
            painter.text(at, egui::Align2::CENTER_CENTER, scene.name, font, ink);
            if response.clicked() {
                world.write_message(Action::Open(scene.name.into()));
                dialogs.open = None;
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_of_a_scene_shows_something() {
        let picture = picture_of(0).unwrap();
        assert_eq!(picture.size, [SIZE.x as usize, SIZE.y as usize]);
        let first = picture.pixels[0];
        assert!(picture.pixels.iter().any(|pixel| *pixel != first));
    }
}
