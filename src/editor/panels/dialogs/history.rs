//! Every step, the newest below; a click goes to the scene as it was after it. Only those that are seen are laid out.

use super::super::says::Says;
use super::most_height;
use crate::editor::history::{History, go_to};
use bevy::ecs::world::World;
use bevy_egui::egui::{Button, RichText, ScrollArea, TextStyle, Ui};

pub(super) fn history_ui(ui: &mut Ui, world: &mut World) {
    let history = world.resource::<History>();
    let position = history.position();
    let count = history.steps().len();
    if count == 0 {
        ui.weak("Nothing was changed yet.");
        return;
    }
    let mut wanted = None;
    let spacing = ui.spacing();
    let (padding, least) = (spacing.button_padding.y, spacing.interact_size.y);
    let row = (ui.text_style_height(&TextStyle::Button) + 2.0 * padding).max(least);
    // The first row is the scene as it was opened.
    ScrollArea::vertical()
        .id_salt("steps")
        .max_height(most_height(ui.ctx()))
        .auto_shrink([false, true])
        .show_rows(ui, row, count + 1, |ui, rows| {
            let mut steps = history.steps().skip(rows.start.saturating_sub(1));
            for done in rows {
                let (text, says) = match done {
                    0 => ("The scene as it was opened", "Takes all steps back"),
                    _ => (
                        steps.next().unwrap_or_default(),
                        "Goes to the scene as it was after this step; those below are kept",
                    ),
                };
                let text = match done <= position {
                    true => RichText::new(text),
                    false => RichText::new(text).weak().italics(),
                };
                let button = Button::selectable(position == done, text).truncate();
                if ui.add(button).says(says).clicked() {
                    wanted = Some(done);
                }
            }
        });
    if let Some(wanted) = wanted.filter(|&wanted| wanted != position) {
        go_to(world, wanted);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Dialog, Dialogs};
    use crate::editor::history::{History, commit};
    use crate::editor::panels::tests::Desk;
    use bevy::ecs::name::Name;

    #[test]
    fn of_thousands_of_steps_those_that_are_seen_are_laid_out_and_a_click_on_one_goes_there() {
        let mut desk = Desk::open("triangle");
        desk.context.enable_accesskit();
        let (entity, _) = desk.named("Triangle");
        for i in 1..=1500 {
            let name = Name::new(format!("Thing {i}"));
            let world = desk.world();
            world
                .resource_mut::<History>()
                .name_next(format!("Step {i}"));
            world.entity_mut(entity).insert(name);
            assert!(commit(world));
        }
        desk.world().resource_mut::<Dialogs>().open = Some(Dialog::History);
        desk.settle();
        let update = desk.output.platform_output.accesskit_update.as_ref();
        let laid_out = update.map_or(0, |update| update.nodes.len());
        assert!((10..400).contains(&laid_out), "{laid_out} controls");
        desk.click_on("Step 3");
        desk.settle();
        assert_eq!(desk.world().resource::<History>().position(), 3);
        desk.click_on("The scene as it was opened");
        desk.settle();
        assert_eq!(desk.world().resource::<History>().position(), 0);
        let name = desk.world().get::<Name>(entity).unwrap();
        assert_eq!(name.as_str(), "Triangle");
    }
}
