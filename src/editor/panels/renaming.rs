//! A name that is being typed, in the list or in the inspector.

use super::outline::Outline;
use crate::editor::action::Action;
use crate::scene::SceneId;
use bevy::ecs::world::World;
use bevy_egui::egui::{Context, Id, Key};

/// A name that is being typed.
#[derive(Clone, Debug)]
pub(super) struct Renaming {
    pub id: SceneId,
    pub text: String,
    /// The field has the keys; until then it asks for them.
    pub focused: bool,
}

impl Renaming {
    /// Whose name it is gets it, unless it is none.
    pub fn give(self, world: &mut World) {
        let name = self.text.trim();
        let item = world.resource::<Outline>().find(self.id);
        let is_other = item.is_some_and(|item| item.name != name);
        if is_other && !name.is_empty() {
            world.write_message(Action::Rename(self.id, name.to_owned()));
        }
    }
}

/// Gives the name that was typed once its field has lost the keys, be it because that is drawn no more. Escape leaves the
/// old one. `field` tells an entity's field.
pub(super) fn settle_name(
    context: &Context,
    world: &mut World,
    typed: &mut Option<Renaming>,
    field: fn(SceneId) -> Id,
) {
    let has_keys = |id| context.memory(|memory| memory.has_focus(field(id)));
    let is_left = |naming: &mut Renaming| naming.focused && !has_keys(naming.id);
    let Some(naming) = typed.take_if(is_left) else {
        return;
    };
    if !context.input(|input| input.key_pressed(Key::Escape)) {
        naming.give(world);
    }
}
