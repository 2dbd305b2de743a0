//! Pictures that materials and the environment use: a thumbnail, the path, and what to choose from.

use super::super::fields::row;
use super::super::says::Says;
use super::super::state::Panels;
use crate::io::SceneFiles;
use crate::io::shapes::PICTURES;
use crate::scene::TextureSource;
use bevy::asset::{AssetId, Assets, Handle};
use bevy::color::ColorToPacked;
use bevy::ecs::world::World;
use bevy::image::Image;
use bevy::platform::cell::SyncCell;
use bevy::platform::collections::HashMap;
use bevy_egui::egui::{
    self, Color32, ColorImage, Sense, TextEdit, TextureHandle, TextureOptions, Ui, vec2,
};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

/// Pixels along a thumbnail's longer side.
const SIDE: u32 = 96;
/// Thumbnails that are kept: more than any panel shows at once.
const MOST: usize = 64;

/// What a field for a picture shows.
pub(super) struct Map<'a> {
    pub label: &'static str,
    pub says: &'static str,
    /// The picture as it was loaded.
    pub loaded: Option<&'a Handle<Image>>,
}

/// Small copies of pictures, made once each, and the file dialog that may be open.
#[derive(Default)]
pub(in super::super) struct Thumbnails {
    made: HashMap<AssetId<Image>, TextureHandle>,
    asking: Option<(egui::Id, SyncCell<Receiver<Option<PathBuf>>>)>,
    /// A path that is being typed, and in which field.
    typed: Option<(egui::Id, String)>,
}

/// The field; true where another picture was chosen.
pub(super) fn map_ui(
    ui: &mut Ui,
    world: &World,
    panels: &mut Panels,
    map: &Map,
    value: &mut Option<TextureSource>,
    mixed: bool,
) -> bool {
    let thumbnails = &mut panels.thumbnails;
    let id = ui.id().with(map.label);
    let mut chosen: Option<Option<String>> = None;
    if let Some(path) = thumbnails.answer(id) {
        chosen = Some(Some(world.resource::<SceneFiles>().folder.name_of(&path)));
    }
    row(ui, map.label, map.says, |ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(36.0, 36.0), Sense::hover());
        ui.painter()
            .rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
        if let Some(handle) = map.loaded
            && let Some(texture) = thumbnails.of(ui.ctx(), world, handle)
        {
            let size = texture.size_vec2();
            let size = size * (rect.width() / size.max_elem());
            let place = egui::Rect::from_center_size(rect.center(), size);
            egui::Image::new(&texture).paint_at(ui, place);
        }
        ui.vertical(|ui| {
            ui.horizontal(|ui| {
                ui.menu_button("Choose…", |ui| {
                    if ui.button("None").says("Without a picture").clicked() {
                        chosen = Some(None);
                        ui.close();
                    }
                    for name in PICTURES {
                        let says = "A picture that Glassbox makes itself";
                        if ui.button(name).says(says).clicked() {
                            chosen = Some(Some(name.to_owned()));
                            ui.close();
                        }
                    }
                    if ui.button("A file…").says("PNG, JPEG, HDR or EXR").clicked() {
                        thumbnails.ask(id);
                        ui.close();
                    }
                })
                .response
                .says(map.says);
            });
            let shown = match (mixed, &value) {
                (true, _) => "mixed".to_owned(),
                (false, Some(source)) => source.path.clone(),
                (false, None) => String::new(),
            };
            if let Some(path) = thumbnails.path_ui(ui, id, shown) {
                chosen = Some((!path.is_empty()).then_some(path));
            }
        });
    });
    let Some(chosen) = chosen else {
        return false;
    };
    let chosen = chosen.map(|path| TextureSource { path });
    let changed = mixed || *value != chosen;
    *value = chosen;
    changed
}

impl Thumbnails {
    /// The small copy of a picture; `None` while it is not loaded.
    fn of(
        &mut self,
        context: &egui::Context,
        world: &World,
        handle: &Handle<Image>,
    ) -> Option<TextureHandle> {
        if let Some(made) = self.made.get(&handle.id()) {
            return Some(made.clone());
        }
        let image = world.get_resource::<Assets<Image>>()?.get(handle)?;
        let small = smaller(image)?;
        if self.made.len() >= MOST {
            self.made.clear();
        }
        let name = format!("thumbnail {:?}", handle.id());
        let texture = context.load_texture(name, small, TextureOptions::LINEAR);
        self.made.insert(handle.id(), texture.clone());
        Some(texture)
    }

    /// A path as it is typed; `Some` when it is finished and another.
    fn path_ui(&mut self, ui: &mut Ui, id: egui::Id, shown: String) -> Option<String> {
        let is_typed = self.typed.as_ref().is_some_and(|(of, _)| *of == id);
        let mut text = match &self.typed {
            Some((_, text)) if is_typed => text.clone(),
            _ => shown.clone(),
        };
        let field = TextEdit::singleline(&mut text)
            .id(id.with("path"))
            .hint_text("path")
            .desired_width((ui.available_width() - 10.0).max(40.0));
        let response = ui
            .add(field)
            .says("Relative to the scene file's folder, with / between its parts");
        if response.changed() {
            self.typed = Some((id, text));
        }
        if response.lost_focus()
            && let Some((_, text)) = self.typed.take_if(|(of, _)| *of == id)
        {
            let text = text.trim().to_owned();
            return (text != shown).then_some(text);
        }
        None
    }

    /// Opens the system's file dialog beside the editor, which goes on.
    fn ask(&mut self, id: egui::Id) {
        let (sender, answer) = channel();
        let dialog = thread::Builder::new().name("file dialog".into());
        let spawned = dialog.spawn(move || {
            let file = rfd::FileDialog::new()
                .add_filter("Pictures", &["png", "jpg", "jpeg", "hdr", "exr"])
                .pick_file();
            // The editor may have been closed meanwhile.
            let _ = sender.send(file);
        });
        if spawned.is_ok() {
            self.asking = Some((id, SyncCell::new(answer)));
        }
    }

    /// The file that was chosen for this field.
    fn answer(&mut self, id: egui::Id) -> Option<PathBuf> {
        let (of, answer) = self.asking.as_mut()?;
        if *of != id {
            return None;
        }
        match answer.get().try_recv() {
            Ok(file) => {
                self.asking = None;
                file
            }
            Err(TryRecvError::Disconnected) => {
                self.asking = None;
                None
            }
            Err(TryRecvError::Empty) => None,
        }
    }
}

/// Every n-th pixel of a picture, for a screen.
fn smaller(image: &Image) -> Option<ColorImage> {
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        return None;
    }
    let longer = width.max(height);
    let part = |side: u32| {
        ((u64::from(side) * u64::from(SIDE.min(longer))) / u64::from(longer)).max(1) as u32
    };
    let (columns, rows) = (part(width), part(height));
    let mut pixels = Vec::with_capacity((columns * rows) as usize);
    for y in 0..rows {
        for x in 0..columns {
            let at = |i: u32, of: u32, side: u32| {
                ((2 * u64::from(i) + 1) * u64::from(side) / (2 * u64::from(of))) as u32
            };
            let color = image.get_color_at(at(x, columns, width), at(y, rows, height));
            let [r, g, b, _] = color.ok()?.to_srgba().to_u8_array();
            pixels.push(Color32::from_rgb(r, g, b));
        }
    }
    Some(ColorImage::new([columns as usize, rows as usize], pixels))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::shapes::texture;

    #[test]
    fn a_thumbnail_keeps_the_picture_s_shape_and_colours() {
        for name in PICTURES {
            let image = texture(name).unwrap();
            let small = smaller(&image).unwrap();
            let [columns, rows] = small.size;
            assert_eq!(columns.max(rows), SIDE as usize, "{name}");
            let shape = image.width() as f32 / image.height() as f32;
            let small_shape = columns as f32 / rows as f32;
            assert!((small_shape / shape - 1.0).abs() < 0.05, "{name}");
        }
        // 8 × 8 squares: the middles of two neighbours differ, of two apart by two do not.
        let checker = smaller(&texture("builtin:checker").unwrap()).unwrap();
        let at = |x: usize| checker.pixels[6 * checker.size[0] + x];
        assert_ne!(at(6), at(18));
        assert_eq!(at(6), at(30));
    }
}
