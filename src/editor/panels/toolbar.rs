//! Below the menu: handles, what the view shows, and how the traced picture is developed.

use super::fields::number_row;
use super::menu_bar::menu_ui;
use super::number_field::NumberField;
use super::says::Says;
use crate::editor::action::Action;
use crate::editor::command::{CommandTable, tooltip};
use crate::editor::handles::{SnapTo, Tools};
use crate::editor::pointer::{self, Armed};
use crate::editor::preferences::Preferences;
use crate::editor::viewport::{RegionDrag, traced_view, traced_view_mut};
use crate::film::views::View;
use crate::scene::schema::quantity_of;
use crate::scene::{Quantity, RenderSettings};
use bevy::ecs::world::World;
use bevy_egui::egui::{Button, ComboBox, Popup, PopupCloseBehavior, Ui};

pub(super) fn toolbar_ui(ui: &mut Ui, world: &mut World) {
    ui.horizontal(|ui| {
        group_ui(ui, world, "tools");
        ui.separator();
        group_ui(ui, world, "show");
        ui.separator();
        traced_ui(ui, world);
        ui.menu_button("Rays and trees", |ui| {
            menu_ui(ui, world, "View/Rays and trees");
        })
        .response
        .says("What is drawn of the tracer's rays and trees, and questions about them and about pixels");
        group_ui(ui, world, "questions");
        ui.separator();
        exposure_ui(ui, world);
    });
}

/// The buttons of the commands that belong to a group of the toolbar, pressed in where they are on.
fn group_ui(ui: &mut Ui, world: &mut World, group: &str) {
    let rows = world.resource::<CommandTable>().rows().to_vec();
    for row in rows {
        let Some((_, text)) = row.button.filter(|(of, _)| *of == group) else {
            continue;
        };
        let state = row.state_in(world);
        let button = Button::selectable(state.on == Some(true), text);
        let response = ui.add_enabled(state.why_not.is_none(), button);
        let response = match &state.why_not {
            Some(why) => response.says(why),
            None => response.says(&tooltip(world, &row.id)),
        };
        if response.clicked() {
            world.write_message(Action::Run(row.id.clone()));
        }
        if row.id == "tool.snap" {
            Popup::context_menu(&response)
                .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
                .show(|ui| steps_ui(ui, world));
        }
    }
}

/// How large the steps of snapping are.
fn steps_ui(ui: &mut Ui, world: &mut World) {
    let Some(mut tools) = world.get_resource::<Tools>().cloned() else {
        return;
    };
    let before = tools.clone();
    // Those of a menu have no frames: nobody would see that these are fields.
    ui.reset_style();
    ui.set_width(250.0);
    ui.horizontal(|ui| {
        ui.label("Move to");
        for (choice, name, says) in [
            (SnapTo::Steps, "steps", "Moves are multiples of the step below"),
            (SnapTo::Faces, "faces", "What is moved touches the face of another object that is under the pointer"),
            (SnapTo::Vertices, "vertices", "The middle of what is moved goes to the nearest corner of the triangle under the pointer"),
        ] {
            ui.selectable_value(&mut tools.snap_to, choice, name)
                .says(says);
        }
    });
    ui.label("Steps of snapping");
    let says = "How far one step moves";
    let steps = Quantity::within(1e-4, 1e4, "m");
    number_row(ui, "Move", says, &mut tools.move_step, steps);
    let says = "How far one step turns";
    let steps = Quantity::degrees(1.0, 90.0);
    number_row(ui, "Turn", says, &mut tools.turn_step, steps);
    let says = "By how much of its size one step scales";
    let steps = Quantity::slider(0.01, 1.0, "×");
    number_row(ui, "Scale", says, &mut tools.scale_step, steps);
    if tools != before {
        *world.resource_mut::<Tools>() = tools;
    }
}

/// What of the film is shown, and whether it goes on.
fn traced_ui(ui: &mut Ui, world: &mut World) {
    let Some(before) = traced_view(world).cloned() else {
        return;
    };
    let mut view = before.clone();
    view.pixel_size = world.resource::<Preferences>().pixel_size;
    ComboBox::from_id_salt("view of the film")
        .selected_text(view_name(view.view))
        .width(104.0)
        .height(400.0)
        .show_ui(ui, |ui| {
            for (choice, says) in VIEWS {
                ui.selectable_value(&mut view.view, choice, view_name(choice))
                    .says(says);
            }
        })
        .response
        .says("What of the traced picture is shown: the picture, or how it came about");
    if view.view != before.view {
        view.range = None;
    }
    group_ui(ui, world, "traced");
    let on = world.resource::<RegionDrag>().is_armed || view.region.is_some();
    let region = ui.add(Button::selectable(on, "Region")).says(
        "Only a part of the view is traced: press, then drag a frame over the picture; press again for all",
    );
    if region.clicked() {
        pointer::arm(world, Armed::No);
        *world.resource_mut::<RegionDrag>() = RegionDrag {
            is_armed: !on,
            start: None,
        };
        view.region = None;
    }
    group_ui(ui, world, "kept");
    if view != before
        && let Some(mut traced) = traced_view_mut(world)
    {
        *traced = view;
    }
}

/// Points of its field: enough for a number with its unit, which says what it is.
const EXPOSURE: f32 = 52.0;

/// Of the picture on the screen and in files alike; no ray is traced for it.
fn exposure_ui(ui: &mut Ui, world: &mut World) {
    let exposure = world.resource::<RenderSettings>().output.exposure;
    let field = NumberField {
        quantity: quantity_of::<RenderSettings>("output.exposure"),
        is_whole: false,
        is_mixed: false,
        says: "Exposure in stops: +1 doubles the picture's brightness; nothing is traced again",
    };
    let mut number = f64::from(exposure);
    ui.spacing_mut().interact_size.x = EXPOSURE;
    let (response, is_changed) = field.number_ui(ui, &mut number);
    let mut entered = is_changed.then_some(number as f32);
    response.context_menu(|ui| {
        if ui.button("Reset to 0").clicked() {
            entered = Some(0.0);
            ui.close();
        }
    });
    if let Some(exposure) = entered.filter(|exposure| !exposure.is_nan())
        && world.resource::<RenderSettings>().output.exposure != exposure
    {
        world.resource_mut::<RenderSettings>().output.exposure = exposure;
    }
}

/// The views with what they show.
const VIEWS: [(View, &str); 11] = [
    (View::Shaded, "The picture"),
    (
        View::Albedo,
        "The diffuse colour that the camera meets first",
    ),
    (View::Normal, "The normal that shading uses, as a colour"),
    (View::Depth, "Metres to the first surface"),
    (View::Object, "A colour for each object"),
    (
        View::Nodes,
        "Nodes of the trees that the pixel's ray entered",
    ),
    (
        View::Triangles,
        "Triangles that the pixel's ray was tested against",
    ),
    (View::Samples, "Samples that each pixel has so far"),
    (
        View::Error,
        "The estimated error of each pixel: where the noise is",
    ),
    (View::BloomThreshold, "What is bright enough for bloom"),
    (View::BloomLayer, "The light that bloom adds"),
];

fn view_name(view: View) -> &'static str {
    match view {
        View::Shaded => "Picture",
        View::Albedo => "Albedo",
        View::Normal => "Normals",
        View::Depth => "Depth",
        View::Object => "Objects",
        View::Nodes => "Nodes visited",
        View::Triangles => "Triangles tested",
        View::Samples => "Samples",
        View::Error => "Error",
        View::BloomThreshold => "Bloom: bright",
        View::BloomLayer => "Bloom: added",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::panels::tests::type_nonsense;
    use std::f32::consts::FRAC_PI_2;

    #[test]
    fn nothing_that_is_typed_makes_a_step_of_snapping_that_is_none() {
        let mut world = World::new();
        world.init_resource::<Tools>();
        let before = world.resource::<Tools>().clone();
        let fields = type_nonsense(&mut world, steps_ui, |world, text| {
            let tools = world.resource::<Tools>();
            for (step, range) in [
                (tools.move_step, 1e-4..=1e4),
                (tools.turn_step, 0.01..=FRAC_PI_2 + 1e-6),
                (tools.scale_step, 0.01..=1.0),
            ] {
                assert!(range.contains(&step), "`{text}` gives {step}");
            }
        });
        assert_eq!(fields, 3);
        assert_ne!(*world.resource::<Tools>(), before, "some of it is a number");
    }
}
