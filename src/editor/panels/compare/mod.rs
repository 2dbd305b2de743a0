//! Pictures of the traced view that are kept: one is shown in place of the view while a key is held, so that whether an edit
//! changed anything is seen at once, and a window compares any two by numbers.
//!
//! | module | has |
//! |---|---|
//! | [`difference`] | two pictures as one, and in figures |
//! | [`histogram`] | how often each brightness is there |
//! | [`zoom`] | a picture to look into, down to the numbers of a pixel |
//! | [`computed`] | what is computed of two pictures, beside the window |
//! | [`window`] | all of them together |

mod computed;
mod difference;
mod histogram;
mod window;
mod zoom;

use super::status::count;
use crate::editor::command::{Command, State, commands};
use crate::editor::document::SceneOpened;
use crate::editor::history::History;
use crate::editor::notice::Notices;
use crate::editor::viewport::{Viewport, traced_render, traced_view};
use crate::view::{TracedPicture, TracedRender};
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy_egui::egui::text::{LayoutJob, TextWrapping};
use bevy_egui::egui::{
    self, Color32, ColorImage, FontId, Rect, TextureHandle, TextureOptions, Ui, pos2, vec2,
};
use std::sync::Arc;
use window::Comparison;

pub(super) use window::window_ui;

/// How many are kept; the oldest goes then. One of two megapixels takes 32 MB.
const MOST: usize = 8;
/// Points of the ground to the left and to the right of a name.
const BESIDE_NAME: f32 = 6.0;
/// Letters of a step that are a part of a picture's name.
const LONGEST_STEP: usize = 32;

/// The pictures that were kept, the oldest first.
#[derive(Resource, Default)]
pub(super) struct KeptPictures {
    all: Vec<Kept>,
    /// How many were kept so far.
    count: u32,
    comparison: Option<Comparison>,
}

/// A picture of one moment.
struct Kept {
    /// The first one that was kept has 1.
    number: u32,
    name: String,
    picture: Arc<TracedPicture>,
    /// As egui knows it, once it was shown.
    texture: Option<TextureHandle>,
}

impl Kept {
    fn texture(&mut self, context: &egui::Context) -> TextureHandle {
        let picture = &self.picture;
        let texture = self.texture.get_or_insert_with(|| {
            let image = color_image(picture);
            context.load_texture(&self.name, image, PIXELS)
        });
        texture.clone()
    }
}

/// Smooth where it is small, and pixels where it is large.
const PIXELS: TextureOptions = TextureOptions {
    magnification: egui::TextureFilter::Nearest,
    minification: egui::TextureFilter::Linear,
    wrap_mode: egui::TextureWrapMode::ClampToEdge,
    mipmap_mode: None,
};

fn color_image(picture: &TracedPicture) -> ColorImage {
    let size = picture.size();
    ColorImage::from_rgba_unmultiplied([size.x as usize, size.y as usize], &picture.shown)
}

impl KeptPictures {
    /// `after` is the step that the scene was edited with last.
    fn add(&mut self, picture: TracedPicture, samples: f64, after: Option<&str>) {
        self.count += 1;
        if self.all.len() == MOST {
            self.all.remove(0);
        }
        self.all.push(Kept {
            number: self.count,
            name: match after {
                Some(step) => format!(
                    "{}: {} spp, {}",
                    self.count,
                    count(samples),
                    shortened(step)
                ),
                None => format!("{}: {} spp", self.count, count(samples)),
            },
            picture: Arc::new(picture),
            texture: None,
        });
    }

    fn find(&self, number: u32) -> Option<&Kept> {
        self.all.iter().find(|kept| kept.number == number)
    }
}

/// A step may be called after things with long names.
fn shortened(step: &str) -> String {
    let mut letters = step.chars();
    let text: String = letters.by_ref().take(LONGEST_STEP).collect();
    match letters.next() {
        Some(_) => text + "…",
        None => text,
    }
}

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "compare.keep" "Keep this picture" [] "Keeps the traced picture as it is now: hold C to see it in place of the new one, or compare the two"
            => keep; menu("View", 4); button("kept", "Keep"); state(has_a_picture),
        "compare.open" "Compare pictures" ["Shift+C"] "Shows two pictures and where they differ: by how much, in which pixels, in which brightness"
            => flip_window; menu("View", 4); button("kept", "Compare"); state(is_comparing),
        "compare.forget" "Forget the kept pictures" [] "Takes all pictures away that were kept"
            => |world| *world.resource_mut::<KeptPictures>() = KeptPictures::default(); menu("View", 4); state(has_kept),
    }
}

fn has_a_picture(world: &World) -> State {
    let status = traced_render(world).and_then(TracedRender::status);
    State::when(status.is_some(), "The view shows no traced picture.")
}

fn has_kept(world: &World) -> State {
    let any = !world.resource::<KeptPictures>().all.is_empty();
    State::when(any, "No picture was kept.")
}

fn is_comparing(world: &World) -> State {
    let kept = world.resource::<KeptPictures>();
    let ready = !kept.all.is_empty() || kept.comparison.is_some();
    State {
        on: Some(kept.comparison.is_some()),
        ..State::when(ready, "No picture was kept: Keep does.")
    }
}

fn keep(world: &mut World) {
    let Some(render) = traced_render(world) else {
        return;
    };
    let (Some(picture), Some(status)) = (render.picture(), render.status()) else {
        return;
    };
    let samples = status.samples;
    // Which of two is meant is told best by what was done between them.
    let step = world.get_resource::<History>().and_then(History::undo_text);
    let step = step.map(str::to_owned);
    let mut kept = world.resource_mut::<KeptPictures>();
    kept.add(picture, samples, step.as_deref());
    let text = format!("Kept picture {}: hold C to see it.", kept.count);
    world.resource_mut::<Notices>().tell(text);
}

fn flip_window(world: &mut World) {
    let mut kept = world.resource_mut::<KeptPictures>();
    kept.comparison = match kept.comparison {
        Some(_) => None,
        None => kept.all.last().map(|last| Comparison::new(last.number)),
    };
}

/// They show another scene.
pub(super) fn forget_scene(_: On<SceneOpened>, mut kept: ResMut<KeptPictures>) {
    if kept.count > 0 {
        *kept = KeptPictures::default();
    }
}

/// Shows the picture that was kept last while C is held.
pub(super) fn compare_ui(ui: &mut Ui, free: Rect, world: &mut World) {
    if world.resource::<KeptPictures>().all.is_empty() {
        return;
    }
    let held = ui.input(|input| input.key_down(egui::Key::C) && input.modifiers.is_none());
    if !held || !world.resource::<Viewport>().takes_keys {
        return;
    }
    let divider = traced_view(world).map_or(0.0, |view| view.divider);
    if divider >= 1.0 {
        return;
    }
    let mut kept = world.resource_mut::<KeptPictures>();
    let Some(last) = kept.all.last_mut() else {
        return;
    };
    let texture = last.texture(ui.ctx()).id();
    let name = format!("kept picture {}", last.name);
    let size = last.picture.size().as_vec2();
    // Its own part of the picture, where the view is split.
    let place = free.with_min_x(free.min.x + divider * free.width());
    let whole = fitted(free, size.x / size.y);
    let painter = ui.painter().with_clip_rect(place);
    if whole != free {
        painter.rect_filled(place, 0.0, Color32::BLACK);
    }
    let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    painter.image(texture, whole, all, Color32::WHITE);
    let mut name = LayoutJob::simple_singleline(name, FontId::proportional(13.0), Color32::WHITE);
    name.wrap = TextWrapping::truncate_at_width((place.width() - 2.0 * BESIDE_NAME).max(0.0));
    let name = painter.layout_job(name);
    let at = pos2(place.center().x, place.max.y - 14.0);
    let text = Rect::from_center_size(at, name.size());
    let back = text.expand2(vec2(BESIDE_NAME, 2.0));
    painter.rect_filled(back, 4.0, Color32::from_black_alpha(170));
    painter.galley(text.min, name, Color32::WHITE);
}

/// The largest rectangle of this shape (width by height) in the middle of another one: all of that where a rounded pixel
/// makes the difference.
fn fitted(free: Rect, shape: f32) -> Rect {
    let wanted = vec2(
        free.width().min(free.height() * shape),
        free.height().min(free.width() / shape),
    );
    let missing = free.size() - wanted;
    match missing.max_elem() > 1.5 {
        true => Rect::from_center_size(free.center(), wanted),
        false => free,
    }
}

/// A small picture of one brightness.
#[cfg(test)]
fn even_picture(level: f32) -> TracedPicture {
    let mut linear = crate::film::Picture::black(bevy::math::UVec2::new(8, 4));
    linear.pixels.fill(bevy::math::Vec3::splat(level));
    let shown = vec![128; 4 * linear.pixels.len()];
    TracedPicture { linear, shown }
}
