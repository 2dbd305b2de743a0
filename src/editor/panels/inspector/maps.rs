//! Pictures that materials and the environment use: a thumbnail, the path, and what to choose from.

use super::super::fields::row;
use super::super::number_field::MIXED;
use super::super::says::Says;
use super::super::thumbnail::thumbnail_ui;
use super::Inspector;
use crate::editor::document::{Document, ask_for_picture, picture_at, typed_picture};
use crate::editor::edits::scene_entity;
use crate::io::PICTURE_EXTENSIONS;
use crate::io::shapes::PICTURES;
use crate::scene::{Environment, Phong, PhongMap, SceneId, TextureSource};
use bevy::asset::{AssetEvent, AssetId, Assets, Handle};
use bevy::color::ColorToPacked;
use bevy::ecs::message::MessageReader;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy::image::Image;
use bevy::platform::collections::HashMap;
use bevy_egui::egui::{
    self, Color32, ColorImage, Key, Sense, TextEdit, TextureHandle, TextureOptions, Ui, vec2,
};
use std::sync::Arc;

/// Pixels along a thumbnail's longer side.
const SIDE: u32 = 96;
/// Thumbnails that are kept: more than any panel shows at once.
const MOST: usize = 64;

/// What a field for a picture shows.
pub(super) struct Map<'a> {
    pub label: &'a str,
    pub says: &'a str,
    /// The picture as it was loaded.
    pub loaded: Option<&'a Handle<Image>>,
    /// Whose picture it is.
    pub owner: Owner,
}

/// Whose picture a field is. What is chosen for it may come when something else is selected.
#[derive(Clone)]
pub(super) enum Owner {
    Environment,
    /// The materials of these numbers, which outlive undo.
    Materials(Arc<[SceneId]>, PhongMap),
}

impl Owner {
    /// Where a path for it is typed.
    fn field(&self, label: &str) -> egui::Id {
        let first = match self {
            Self::Environment => None,
            Self::Materials(ids, _) => ids.first().map(|id| id.0),
        };
        egui::Id::new(("path of a picture", label, first))
    }

    /// Gives it a picture, or none. What has it already is not touched.
    fn give(&self, world: &mut World, picture: Option<&TextureSource>) {
        match self {
            Self::Environment => {
                let mut environment = world.resource_mut::<Environment>();
                if environment.map.as_ref() != picture {
                    environment.map = picture.cloned();
                }
            }
            Self::Materials(ids, map) => {
                for &id in ids.iter() {
                    let Some(entity) = scene_entity(world, id) else {
                        continue;
                    };
                    let Some(before) = world.get::<Phong>(entity) else {
                        continue;
                    };
                    let mut after = before.clone();
                    let source = map.source_mut(&mut after);
                    *source = picture.map(|picture| in_place_of(source.as_ref(), &picture.path));
                    if after != *before
                        && let Some(mut phong) = world.get_mut::<Phong>(entity)
                    {
                        *phong = after;
                    }
                }
            }
        }
    }
}

/// Small copies of pictures, made once each, and what is being typed or chosen.
#[derive(Default)]
pub(in super::super) struct Thumbnails {
    made: HashMap<AssetId<Image>, TextureHandle>,
    asking: Option<Asking>,
    typed: Option<Typed>,
}

/// A file that somebody wants to choose.
struct Asking {
    owner: Owner,
    /// The question is open, or was.
    is_asked: bool,
}

/// A path that is being typed.
struct Typed {
    field: egui::Id,
    owner: Owner,
    text: String,
    /// What the field showed before.
    shown: String,
}

/// What was typed and what was chosen in a file dialog becomes the picture of those whose field it
/// was.
pub(super) fn settle_pictures(
    context: &egui::Context,
    world: &mut World,
    thumbnails: &mut Thumbnails,
) {
    if let Some(asking) = thumbnails.asking.as_mut().filter(|asking| !asking.is_asked) {
        asking.is_asked = true;
        ask_for_picture(world);
    }
    if thumbnails.asking.is_some()
        && let Some(file) = world.resource_mut::<Document>().take_picture()
        && let Some(Asking { owner, .. }) = thumbnails.asking.take()
    {
        let picture = picture_at(world, &file);
        owner.give(world, picture.as_ref());
    }
    if let Some((owner, path)) = thumbnails.left_field(context) {
        let picture = (!path.is_empty()).then(|| typed_picture(world, path));
        owner.give(world, picture.as_ref());
    }
}

/// Another picture, read as the one before it.
fn in_place_of(before: Option<&TextureSource>, path: &str) -> TextureSource {
    TextureSource {
        path: path.to_owned(),
        ..before.cloned().unwrap_or_default()
    }
}

/// The field; true where another picture was chosen from its menu.
pub(super) fn map_ui(
    ui: &mut Ui,
    world: &World,
    thumbnails: &mut Thumbnails,
    map: &Map,
    value: &mut Option<TextureSource>,
    mixed: bool,
) -> bool {
    let mut chosen: Option<Option<String>> = None;
    row(ui, map.label, map.says, |ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(36.0, 36.0), Sense::hover());
        let picture = map.loaded;
        let picture = picture.and_then(|handle| thumbnails.of(ui.ctx(), world, handle));
        thumbnail_ui(ui, rect, picture.as_ref(), egui::Color32::WHITE);
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
                    let says = format!("A picture: .{}", PICTURE_EXTENSIONS.join(", ."));
                    if ui.button("A file…").says(&says).clicked() {
                        thumbnails.asking = Some(Asking {
                            owner: map.owner.clone(),
                            is_asked: false,
                        });
                        ui.close();
                    }
                })
                .response
                .says(map.says);
            });
            let shown = match (mixed, &value) {
                (false, Some(source)) => source.path.clone(),
                _ => String::new(),
            };
            thumbnails.path_ui(ui, map, shown, if mixed { MIXED } else { "path" });
        });
    });
    let Some(chosen) = chosen else {
        return false;
    };
    let chosen = chosen.map(|path| in_place_of(value.as_ref(), &path));
    let changed = mixed || *value != chosen;
    *value = chosen;
    changed
}

/// A picture that was loaded again has another thumbnail, and one that is gone has none.
pub(in super::super) fn forget_thumbnails(
    mut changes: MessageReader<AssetEvent<Image>>,
    mut panel: ResMut<Inspector>,
) {
    for change in changes.read() {
        if let AssetEvent::Modified { id } | AssetEvent::Removed { id } = change {
            panel.thumbnails.made.remove(id);
        }
    }
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

    /// A path as it is typed. It counts when the field has lost the keys.
    fn path_ui(&mut self, ui: &mut Ui, map: &Map, shown: String, hint: &str) {
        let field = map.owner.field(map.label);
        let typed = self.typed.as_ref().filter(|typed| typed.field == field);
        let mut text = typed.map_or_else(|| shown.clone(), |typed| typed.text.clone());
        let edit = TextEdit::singleline(&mut text)
            .id(field)
            .hint_text(hint)
            .desired_width(ui.available_width().max(40.0));
        let response = ui
            .add(edit)
            .says("Relative to the scene file's folder, with / between its parts; ~ is home");
        if response.changed() {
            self.typed = Some(Typed {
                field,
                owner: map.owner.clone(),
                text,
                shown,
            });
        }
    }

    /// The path that was typed into a field that has lost the keys, where it is another than before.
    /// Escape leaves the old one.
    fn left_field(&mut self, context: &egui::Context) -> Option<(Owner, String)> {
        let has_keys = |field| context.memory(|memory| memory.has_focus(field));
        let typed = self.typed.take_if(|typed| !has_keys(typed.field))?;
        let cancelled = context.input(|input| input.key_pressed(Key::Escape));
        let path = typed.text.trim();
        (!cancelled && path != typed.shown).then(|| (typed.owner, path.to_owned()))
    }

    /// Another scene is open: what is still typed or chosen belongs to nobody.
    pub fn forget_fields(&mut self) {
        self.asking = None;
        self.typed = None;
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
    use crate::editor::document::{Answer, Purpose, Question, answer};
    use crate::editor::headless_editor;
    use crate::editor::panels::state::with;
    use crate::editor::panels::tests::{Desk, USUAL};
    use crate::io::shapes::texture;
    use bevy::app::{App, Last};
    use std::fs;

    #[test]
    fn a_path_that_was_typed_reaches_those_for_whom_it_was_typed_whatever_is_selected_now() {
        let mut app = headless_editor();
        let world = app.world_mut();
        let ids = [1, 2, 3].map(SceneId);
        let materials = ids.map(|id| world.spawn((id, Phong::default())).id());
        let owner = Owner::Materials(Arc::from(&ids[..2]), PhongMap::Opacity);
        let mut thumbnails = Thumbnails::default();
        let typed = |text: &str| Typed {
            field: owner.field("Opacity map"),
            owner: owner.clone(),
            text: text.into(),
            shown: String::new(),
        };
        // Its field has no keys, in an egui that never drew it.
        let context = egui::Context::default();
        thumbnails.typed = Some(typed(" a.png "));
        settle_pictures(&context, world, &mut thumbnails);
        let paths = materials.map(|material| {
            let map = world.get::<Phong>(material).unwrap().opacity_map.clone();
            map.map(|source| source.path)
        });
        let path = Some("a.png".to_owned());
        assert_eq!(paths, [path.clone(), path, None]);
        assert!(thumbnails.typed.is_none());
    }

    #[test]
    fn what_is_typed_for_several_is_all_of_the_path_that_they_get() {
        let mut desk = Desk::empty(USUAL);
        for (id, path) in [(1, "a.png"), (2, "b.png")] {
            let phong = Phong {
                diffuse_map: Some(TextureSource::new(path)),
                ..Phong::default()
            };
            desk.world().spawn((SceneId(id), phong));
        }
        desk.settle();
        desk.select([SceneId(1), SceneId(2)]);
        let at = desk.place_of(MIXED);
        desk.click(at);
        desk.frame(vec![egui::Event::Text("wood.png".into())]);
        desk.key(Key::Enter);
        desk.settle();
        let mut all = desk.world().query::<&Phong>();
        let paths: Vec<_> = (all.iter(desk.app.world()))
            .map(|phong| phong.diffuse_map.clone().map(|source| source.path))
            .collect();
        let path = Some("wood.png".to_owned());
        assert_eq!(paths, [path.clone(), path]);
    }

    #[test]
    fn a_file_that_was_chosen_reaches_the_environment_and_nothing_of_another_scene() {
        let mut app = headless_editor();
        let world = app.world_mut();
        let mut thumbnails = Thumbnails::default();
        let context = egui::Context::default();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("sky.exr");
        let path = || Answer::Path(file.clone());
        for is_forgotten in [true, false] {
            thumbnails.asking = Some(Asking {
                owner: Owner::Environment,
                is_asked: false,
            });
            settle_pictures(&context, world, &mut thumbnails);
            let asked = world.resource::<Document>().question.clone();
            if matches!(asked, Some(Question::Waiting { .. })) {
                // Where the desktop has a dialog: the path is typed all the same.
                answer(world, Answer::No);
            }
            answer(world, path());
            let asked = world.resource::<Document>().question.clone();
            let again = matches!(
                &asked,
                Some(Question::Path {
                    purpose: Purpose::Picture,
                    refused: Some(_),
                    ..
                })
            );
            assert!(again, "there is no such file: {asked:?}");
            settle_pictures(&context, world, &mut thumbnails);
            assert!(thumbnails.asking.is_some(), "it waits");
            fs::write(&file, "").unwrap();
            if is_forgotten {
                thumbnails.forget_fields();
            }
            answer(world, path());
            assert_eq!(world.resource::<Document>().question, None);
            settle_pictures(&context, world, &mut thumbnails);
            let map = world.resource::<Environment>().map.clone();
            assert_eq!(map.is_some(), !is_forgotten);
            fs::remove_file(&file).unwrap();
        }
    }

    #[test]
    fn a_picture_that_was_loaded_again_has_another_thumbnail() {
        let mut app = headless_editor();
        app.init_resource::<Inspector>()
            .add_systems(Last, forget_thumbnails);
        let context = egui::Context::default();
        let mut pictures = app.world_mut().resource_mut::<Assets<Image>>();
        let handle = pictures.add(texture("builtin:checker").unwrap());
        let shown = |app: &mut App| {
            with(app.world_mut(), |world, panel: &mut Inspector| {
                let thumbnail = panel.thumbnails.of(&context, world, &handle);
                thumbnail.unwrap().id()
            })
        };
        let first = shown(&mut app);
        app.update();
        assert_eq!(shown(&mut app), first);
        let mut pictures = app.world_mut().resource_mut::<Assets<Image>>();
        let another = texture("builtin:uv").unwrap();
        pictures.insert(handle.id(), another).unwrap();
        app.update();
        assert_ne!(shown(&mut app), first);
    }

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
