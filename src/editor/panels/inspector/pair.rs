//! Two builders' trees over the same view.

use super::super::fields::{properties_ui, row};
use super::super::says::Says;
use crate::editor::trees::pair::{Side, SideState, TreePair};
use crate::inspect::InspectSettings;
use crate::scene::Builder;
use crate::scene::schema::{about_choice, choice_name};
use bevy::ecs::world::World;
use bevy_egui::egui::{ComboBox, Label, RichText, Ui};

const BUILDERS: [Builder; 4] = [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc];

pub(super) fn pair_ui(ui: &mut Ui, world: &mut World) {
    let Some(before) = world.get_resource::<InspectSettings>().cloned() else {
        return;
    };
    let mut settings = before.clone();
    properties_ui(ui, &mut settings, &["pair.on"]);
    let pair = &mut settings.pair;
    let states = world.get_resource::<TreePair>().map(|pair| {
        let state = |side: &Side| side.state();
        [state(&pair.sides[0]), state(&pair.sides[1])]
    });
    let says = "Whose trees; built in the background where they are not those that are traced";
    for (i, label, builder) in [(0, "Left", &mut pair.left), (1, "Right", &mut pair.right)] {
        row(ui, label, says, |ui| {
            ComboBox::from_id_salt(label)
                .selected_text(choice_name(builder))
                .width(84.0)
                .show_ui(ui, |ui| {
                    for choice in BUILDERS {
                        ui.selectable_value(builder, choice, choice_name(&choice))
                            .says(&about_choice(&choice));
                    }
                })
                .response
                .says(says);
            let state = states.as_ref().filter(|_| before.on && before.pair.on);
            ui.weak(match state.map(|states| &states[i]) {
                None => "",
                Some(SideState::Traced) => "traced",
                Some(SideState::Built) => "to look at",
                Some(SideState::Building) => "being built…",
                Some(SideState::Failed(_)) => "failed",
            });
        });
    }
    let on = pair.on;
    if on != before.pair.on
        && let Some(mut pair) = world.get_resource_mut::<TreePair>()
    {
        pair.switch(&mut settings, on);
    }
    if settings.pair.on {
        let note = "Which boxes, and in which colours: Debug, Trees. Visits are those of the debug ray (R).";
        ui.add(Label::new(RichText::new(note).weak()).wrap());
    }
    if settings != before {
        *world.resource_mut::<InspectSettings>() = settings;
    }
}
