//! Everything that egui draws: menu and toolbar above, hierarchy left, inspector right, status
//! below, and the scene in the middle, which egui leaves free but for what lies over the picture.
//!
//! A panel is a function `xyz_ui(ui, world, …)` in a file of its own, with a resource for what it remembers. It reads the world,
//! works on copies, and writes back only what a person changed: a component that is only looked at
//! must not count as changed, or the traced picture would start over in every frame.
//!
//! | module | draws |
//! |---|---|
//! | [`layout`] | all of the panels, where they stand around the picture |
//! | [`menu_bar`], [`toolbar`] | what is above; made of the table of commands |
//! | [`hierarchy`] | the list of entities, from the [`outline`] |
//! | [`fields`], [`number_field`] | rows of properties, as the schema says |
//! | [`reflected`] | rows of what the schema does not know: parts of an app's own components |
//! | [`inspector`] | the tabs Object, Render, Debug and BVH |
//! | [`status`] | the line below |
//! | [`overlays`], [`notices`] | divider, legend, region, messages over the picture |
//! | [`compare`] | pictures that were kept, in place of the new one and beside it |
//! | [`line_legend`], [`pattern`] | what the tracer's lines mean, and where a pixel's samples lie |
//! | [`tree_pair`] | two views beside each other, with two builders' trees |
//! | [`rays`] | the ray inspector, below the picture or over it |
//! | [`answer`], [`first_steps`] | why a pixel is as it is; three things to try |
//! | [`mirror_picture`] | what the mirror sees that an answer is about |
//! | [`typed_drag`] | the number that is typed while a handle is dragged |
//! | [`told`], [`readout`] | what is under the pointer: a line of the gizmos, a pixel |
//! | [`context_menu`], [`palette`] | the table of commands: what fits a right click, and all of it |
//! | [`keyboard`] | nothing: tells egui of keys, each with its modifiers |
//! | [`screen_reader`] | nothing: tells the platform's screen readers what the others draw |
//! | [`mixer`] | what each light adds, and a mix of them, in a window over the picture |
//! | [`dialogs`] | what is in front of everything |

mod answer;
mod any_number;
mod asked;
mod asset_text;
mod bindings;
mod commands;
mod compare;
mod context_menu;
mod dialogs;
mod fields;
mod first_steps;
mod gesture;
mod hierarchy;
mod inspector;
mod keyboard;
mod kind_icons;
mod layout;
mod line_legend;
mod menu_bar;
mod mirror_picture;
mod mixer;
mod notices;
mod number_field;
mod number_text;
mod outline;
mod outline_rows;
mod overlays;
mod palette;
mod panel_focus;
mod pattern;
mod rays;
mod readout;
mod reflected;
mod renaming;
mod replaces;
mod save_form;
mod says;
mod screen_reader;
mod several;
mod state;
mod status;
mod temperature;
mod theme;
mod thumbnail;
mod told;
mod toolbar;
mod tree_pair;
mod turn;
mod typed_drag;

#[cfg(test)]
mod tests;

use super::command::AddCommands;
use super::embed::Editing;
use super::history::within;
use super::preferences::PreferencesPlugin;
use crate::sync::SyncSystems;
use bevy::app::{App, Last, Plugin, PostUpdate};
use bevy::asset::AssetEventSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::ecs::query::With;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::world::World;
use bevy::transform::TransformSystems;
use bevy_egui::{
    EguiContext, EguiPlugin, EguiPostUpdateSet, EguiPrimaryContextPass, PrimaryEguiContext,
};
use layout::{contained, contained_in_width, panels_ui};
use outline::{Outline, outline_scene};
use state::OnlyPicture;

/// Draws the panels.
pub(super) struct PanelsPlugin;

impl Plugin for PanelsPlugin {
    fn build(&self, app: &mut App) {
        // An app may have it for panels of its own.
        if !app.is_plugin_added::<EguiPlugin>() {
            app.add_plugins(EguiPlugin::default());
        }
        app.add_plugins((
            PreferencesPlugin,
            keyboard::KeyboardPlugin,
            screen_reader::ScreenReaderPlugin,
        ))
        .init_resource::<Outline>();
        add_panels(app);
        order_pass(app);
        app.add_systems(EguiPrimaryContextPass, (outline_scene, draw).chain());
    }
}

/// What is edited in the panels' pass is traced in the same frame: the pass comes before all that is derived from the
/// scene.
fn order_pass(app: &mut App) {
    app.configure_sets(
        PostUpdate,
        EguiPostUpdateSet::EndPass
            .before(AssetEventSystems)
            .before(TransformSystems::Propagate)
            .before(VisibilitySystems::VisibilityPropagate)
            .before(SyncSystems),
    );
}

/// What panels remember, their commands, and what they hear of.
fn add_panels(app: &mut App) {
    app.init_resource::<OnlyPicture>()
        .init_resource::<answer::Answer>()
        .init_resource::<compare::KeptPictures>()
        .init_resource::<context_menu::ContextMenu>()
        .init_resource::<dialogs::Dialogs>()
        .init_resource::<dialogs::RenderForm>()
        .init_resource::<first_steps::FirstSteps>()
        .init_resource::<gesture::OwnGesture>()
        .init_resource::<hierarchy::Hierarchy>()
        .init_resource::<inspector::Builders>()
        .init_resource::<inspector::ErrorCurve>()
        .init_resource::<inspector::Inspector>()
        .init_resource::<inspector::PerformanceForm>()
        .init_resource::<inspector::Trees>()
        .init_resource::<line_legend::LineLegend>()
        .init_resource::<mixer::Mixer>()
        .init_resource::<overlays::UnderPointer>()
        .init_resource::<palette::OpenPalette>()
        .init_resource::<panel_focus::PanelStep>()
        .init_resource::<pattern::ShownPattern>()
        .init_resource::<rays::RaysPanel>()
        .init_resource::<status::StatusBar>()
        .init_resource::<told::Tales>()
        .add_observer(answer::forget_scene)
        .add_observer(compare::forget_scene)
        .add_observer(dialogs::forget_scene)
        .add_observer(hierarchy::forget_scene)
        .add_observer(inspector::forget_scene)
        .add_observer(overlays::forget_scene)
        .add_observer(mixer::forget_scene)
        .add_commands(commands::commands())
        .add_commands(panel_focus::commands())
        .add_commands(mixer::commands())
        .add_commands(compare::commands())
        .add_observer(commands::let_go)
        .add_observer(answer::note_question)
        .add_observer(answer::forget_question)
        .add_observer(context_menu::note_right_click)
        .add_observer(outline::note_gone)
        .add_systems(Last, inspector::forget_thumbnails);
}

fn draw(world: &mut World) {
    if world.get_resource::<Editing>().is_some_and(|on| !on.0) {
        return;
    }
    let mut contexts = world.query_filtered::<&mut EguiContext, With<PrimaryEguiContext>>();
    let Ok(mut context) = contexts.single_mut(world) else {
        return;
    };
    let context = context.get_mut().clone();
    within(world, |world| panels_ui(&context, world));
}

#[cfg(test)]
mod pass_tests {
    use super::*;
    use crate::editor::headless_editor;
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use crate::scene::PointLamp;
    use crate::sync::Traced;
    use bevy::ecs::system::{Local, Query};
    use bevy::transform::components::Transform;

    #[test]
    fn what_is_edited_in_the_panels_pass_is_traced_in_that_frame() {
        let mut app = headless_editor();
        order_pass(&mut app);
        let edit = |mut lamps: Query<&mut Transform, With<PointLamp>>, mut frame: Local<f32>| {
            *frame += 1.0;
            for mut place in &mut lamps {
                place.translation.y = *frame;
            }
        };
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        app.add_systems(PostUpdate, edit.in_set(EguiPostUpdateSet::EndPass));
        for frame in 1..=5 {
            app.update();
            let traced = &app.world().resource::<Traced>().world;
            let height = traced.lights.points[0].position.y;
            assert_eq!(height, frame as f32, "in frame {frame}");
        }
    }
}
