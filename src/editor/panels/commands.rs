//! The commands that open, close and move panels and dialogs.

use super::dialogs::{Dialog, Dialogs, RenderForm};
use super::hierarchy::Hierarchy;
use super::palette::{OpenPalette, Palette};
use super::renaming::Renaming;
use super::state::OnlyPicture;
use super::{answer, first_steps};
use crate::editor::command::{Command, Over, State, commands, flip};
use crate::editor::edits::name_of;
use crate::editor::preferences::Preferences;
use crate::editor::selection::{Escaped, Selection};
use crate::inspect::Question;
use bevy::ecs::observer::On;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "file.scenes" "Built-in scenes…" [] "Opens one of the scenes that come with Glassbox"
            => |world| toggle(world, Dialog::Scenes); menu("File", 0),
        "file.render" "Render to file…" ["F12"] "Renders a picture to a file while you go on editing"
            => open_render; menu("File", 3),
        "file.preferences" "Preferences…" [] "Dark or light theme, and the size of text and panels"
            => |world| toggle(world, Dialog::Preferences); menu("File", 4),
        "edit.history" "History…" [] "All steps, to go back and forth between"
            => |world| toggle(world, Dialog::History); menu("Edit", 0),
        "edit.rename" "Rename" ["F2"] "Gives the selected entity another name, in the list"
            => rename; menu("Edit", 2); over(&[Over::Entity]); state(is_one_selected),
        "view.hierarchy" "Hierarchy" [] "Shows the list of entities on the left"
            => |world| flip(&mut world.resource_mut::<Preferences>().show_hierarchy); menu("View", 5); state(|world| State::switch(world.resource::<Preferences>().show_hierarchy)),
        "view.inspector" "Inspector" [] "Shows the properties on the right"
            => |world| flip(&mut world.resource_mut::<Preferences>().show_inspector); menu("View", 5); state(|world| State::switch(world.resource::<Preferences>().show_inspector)),
        "view.only-picture" "Only the picture" ["Ctrl+Space"] "Takes the panels away, so that the picture fills the window; again, or Escape, brings them back"
            => |world| flip(&mut world.resource_mut::<OnlyPicture>().0); menu("View", 5); over(&[Over::Nothing]),
        "why.black" "Why is this pixel black?" ["Shift+W"] "The next click in the view answers in a sentence what is in the way of the pixel's light"
            => |world| answer::ask(world, Question::Black); menu("View/Rays and trees", 1); button("questions", "Why black?"); over(&[Over::Pixel]),
        "why.noisy" "Why is this pixel noisy?" [] "The next click in the view answers in a sentence what the pixel's samples differ in"
            => |world| answer::ask(world, Question::Noisy); menu("View/Rays and trees", 1); over(&[Over::Pixel]),
        "why.color" "Why has this pixel this colour?" [] "The next click in the view answers in a sentence what the pixel's colour is mixed of"
            => |world| answer::ask(world, Question::Color); menu("View/Rays and trees", 1); over(&[Over::Pixel]),
        "help.keys" "Keys and mouse" ["F1", "?"] "Shows every key, and changes them"
            => |world| toggle(world, Dialog::Keys); menu("Help", 0),
        "help.palette" "Find a command…" ["Ctrl+P"] "Lists all commands, to be found by a few letters of their names"
            => |world| world.resource_mut::<OpenPalette>().0 = Some(Palette::default()); menu("Help", 0),
        "help.first-steps" "First steps" [] "Shows the card with three things to try"
            => first_steps::toggle; menu("Help", 0); state(first_steps::is_shown),
        "help.about" "About Glassbox" [] "Version, licences, and what it is made with"
            => |world| toggle(world, Dialog::About); menu("Help", 1),
    }
}

fn toggle(world: &mut World, dialog: Dialog) {
    let mut dialogs = world.resource_mut::<Dialogs>();
    let again = dialogs.open == Some(dialog);
    dialogs.open = (!again).then_some(dialog);
}

fn open_render(world: &mut World) {
    world.resource_mut::<RenderForm>().open();
    world.resource_mut::<Dialogs>().open = Some(Dialog::Render);
}

fn is_one_selected(world: &World) -> State {
    let one = world.resource::<Selection>().ids().len() == 1;
    State::when(one, "One entity has to be selected.")
}

fn rename(world: &mut World) {
    let Some(id) = world.resource::<Selection>().active() else {
        return;
    };
    // A name that is being typed is not lost by asking again.
    let before = world.resource_mut::<Hierarchy>().renaming.take();
    let text = match before {
        Some(before) if before.id == id => before.text,
        Some(before) => {
            before.give(world);
            name_of(world, id)
        }
        None => name_of(world, id),
    };
    world.resource_mut::<Preferences>().show_hierarchy = true;
    world.resource_mut::<OnlyPicture>().0 = false;
    let mut hierarchy = world.resource_mut::<Hierarchy>();
    hierarchy.filter = Default::default();
    hierarchy.list_keys.reveal = Some(id);
    hierarchy.renaming = Some(Renaming {
        id,
        text,
        focused: false,
    });
}

/// The panels come back.
pub(super) fn let_go(_: On<Escaped>, mut only: ResMut<OnlyPicture>) {
    only.0 = false;
}
