//! A picture of the traced view that is kept, and shown in its place while a key is held: whether an
//! edit changed anything is seen at once.

use super::says::Says;
use crate::editor::document::SceneOpened;
use crate::editor::viewport::{EditorCamera, Viewport};
use crate::view::{TracedRender, TracedView};
use bevy::asset::Handle;
use bevy::ecs::observer::On;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy::image::Image;
use bevy_egui::egui::{self, Align2, Button, Color32, FontId, Rect, TextureId, Ui, pos2, vec2};
use bevy_egui::{EguiTextureHandle, EguiUserTextures};

/// A picture that was kept to compare with.
#[derive(Resource, Default)]
pub(super) struct KeptPicture(Option<Kept>);

/// As egui knows it.
struct Kept {
    handle: Handle<Image>,
    texture: TextureId,
}

/// The button that keeps what stands on the screen, or forgets it.
pub(super) fn keep_ui(ui: &mut Ui, world: &mut World) {
    let on = world.resource::<KeptPicture>().0.is_some();
    let button = ui.add(Button::selectable(on, "Keep")).says(
        "Keeps the traced picture: hold C to see it in place of the new one; press again to forget it",
    );
    if !button.clicked() {
        return;
    }
    if on {
        world.run_system_cached(forget).ok();
        return;
    }
    let mut query = world.query_filtered::<&TracedRender, With<EditorCamera>>();
    let shown = query.single(world).ok().and_then(TracedRender::shown);
    let Some(handle) = shown.map(|shown| shown.picture.clone()) else {
        return;
    };
    if let Some(mut textures) = world.get_resource_mut::<EguiUserTextures>() {
        let texture = textures.add_image(EguiTextureHandle::Strong(handle.clone()));
        world.resource_mut::<KeptPicture>().0 = Some(Kept { handle, texture });
    }
}

/// Lets go of the kept picture.
fn forget(mut kept: ResMut<KeptPicture>, textures: Option<ResMut<EguiUserTextures>>) {
    if let (Some(kept), Some(mut textures)) = (kept.0.take(), textures) {
        textures.remove_image(&kept.handle);
    }
}

/// It shows another scene.
pub(super) fn forget_scene(
    _: On<SceneOpened>,
    kept: ResMut<KeptPicture>,
    textures: Option<ResMut<EguiUserTextures>>,
) {
    forget(kept, textures);
}

/// Shows the kept picture while C is held.
pub(super) fn compare_ui(ui: &mut Ui, free: Rect, world: &mut World) {
    let Some(texture) = world
        .resource::<KeptPicture>()
        .0
        .as_ref()
        .map(|kept| kept.texture)
    else {
        return;
    };
    let held = ui.input(|input| input.key_down(egui::Key::C) && input.modifiers.is_none());
    if !held || !world.resource::<Viewport>().takes_keys {
        return;
    }
    let mut query = world.query_filtered::<&TracedView, With<EditorCamera>>();
    let divider = query.single(world).map_or(0.0, |view| view.divider);
    if divider >= 1.0 {
        return;
    }
    // Its own part of the picture, where the view is split.
    let part = Rect::from_min_max(pos2(divider, 0.0), pos2(1.0, 1.0));
    let place = Rect::from_min_max(
        pos2(free.min.x + divider * free.width(), free.min.y),
        free.max,
    );
    let painter = ui.painter();
    painter.image(texture, place, part, Color32::WHITE);
    let at = pos2(place.center().x, place.max.y - 14.0);
    let back = Rect::from_center_size(at, vec2(90.0, 20.0));
    painter.rect_filled(back, 4.0, Color32::from_black_alpha(170));
    let font = FontId::proportional(13.0);
    painter.text(
        at,
        Align2::CENTER_CENTER,
        "kept picture",
        font,
        Color32::WHITE,
    );
}
