//! Everything that egui draws: menu and toolbar above, hierarchy left, inspector right, status
//! below, and the scene in the middle, which egui leaves free but for what lies over the picture.
//!
//! A panel is a function `xyz_ui(ui, world, …)` in a file of its own, with a resource for what it remembers. It reads the world,
//! works on copies, and writes back only what a person changed: a component that is only looked at
//! must not count as changed, or the traced picture would start over in every frame.
//!
//! | module | draws |
//! |---|---|
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
mod told;
mod toolbar;
mod tree_pair;
mod turn;
mod typed_drag;

#[cfg(test)]
mod tests;

use super::command::AddCommands;
use super::dispatch::dispatch;
use super::embed::Editing;
use super::history::within;
use super::preferences::{Preferences, PreferencesPlugin};
use super::viewport::Viewport;
use crate::sync::SyncSystems;
use bevy::app::{App, Last, Plugin, PostUpdate};
use bevy::asset::AssetEventSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::ecs::query::With;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::world::World;
use bevy::math::{Rect, Vec2};
use bevy::transform::TransformSystems;
use bevy_egui::{
    EguiContext, EguiPlugin, EguiPostUpdateSet, EguiPrimaryContextPass, PrimaryEguiContext, egui,
};
use outline::{Outline, outline_scene};
use state::{OnlyPicture, with};

/// What is left for the picture at least, in egui's points.
const LEAST_PICTURE: f32 = 240.0;

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

/// All of it, within a pass of egui.
fn panels_ui(context: &egui::Context, world: &mut World) {
    let preferences = world.resource::<Preferences>().clone();
    theme::apply(context, &preferences);
    if context.zoom_factor() != preferences.zoom {
        context.set_zoom_factor(preferences.zoom);
    }
    let window = egui::UiBuilder::new()
        .layer_id(egui::LayerId::background())
        .max_rect(context.viewport_rect());
    let mut ui = egui::Ui::new(context.clone(), "window".into(), window);
    let only_picture = world.resource::<OnlyPicture>().0;
    with(world, |world, panel| {
        inspector::settle(context, world, panel)
    });
    with(world, |world, panel| {
        hierarchy::settle(context, world, panel)
    });
    let free = match only_picture {
        true => ui.available_rect_before_wrap(),
        false => around_ui(&mut ui, world, &preferences),
    };
    let views = tree_pair::views(free, world);
    let picture = views.map_or(free, |[left, _]| left);
    compare::compare_ui(&mut ui, picture, world);
    let over_overlay = overlays::overlays_ui(&mut ui, free, views, world, only_picture);
    typed_drag::typed_drag_ui(&ui, picture, world);
    with(world, |world, under| {
        readout::readout_ui(&ui, picture, world, under)
    });
    with(world, |world, tales| {
        told::told_ui(context, free, world, tales)
    });
    with(world, |world, panel| {
        rays::window_ui(context, free, world, panel)
    });
    mixer::mixer_ui(context, free, world);
    compare::window_ui(context, free, world);
    with(world, |world, menu| {
        context_menu::context_menu_ui(context, world, menu)
    });
    with(world, |world, dialogs| {
        dialogs::dialogs_ui(context, world, dialogs)
    });
    with(world, |world, palette| {
        palette::palette_ui(context, world, palette)
    });
    panel_focus::step(context, world);
    theme::ring_ui(context);
    gesture::note_gesture(context, world);
    let mut list = world.resource_mut::<hierarchy::Hierarchy>();
    if only_picture || !preferences.show_hierarchy {
        list.list_keys.let_go();
    }
    let letters_taken = list.list_keys.focused;
    let twin = views.map(|[_, right]| right);
    note_viewport(
        context,
        (picture, twin),
        [over_overlay, letters_taken],
        world,
    );
    dispatch(world);
    mixer::apply(world);
}

/// The panels around the picture; returns what they leave free.
fn around_ui(ui: &mut egui::Ui, world: &mut World, preferences: &Preferences) -> egui::Rect {
    let fill = ui.visuals().panel_fill;
    let bar = |margin| egui::Frame::new().fill(fill).inner_margin(margin);
    egui::Panel::top("menu")
        .frame(bar(egui::Margin::symmetric(6, 2)))
        .show_inside(ui, |ui| menu_bar::menu_bar_ui(ui, world));
    egui::Panel::top("toolbar")
        .frame(bar(egui::Margin::symmetric(6, 4)))
        .show_inside(ui, |ui| toolbar::toolbar_ui(ui, world));
    egui::Panel::bottom("status")
        .frame(bar(egui::Margin::symmetric(8, 3)))
        .show_inside(ui, |ui| {
            with(world, |world, bar| status::status_ui(ui, world, bar));
        });

    with(world, |world, panel| rays::panel_ui(ui, world, panel));

    // Narrow windows: the panels give way before the picture does.
    let for_panels = (ui.available_width() - LEAST_PICTURE).max(0.0);
    let mut widths = [preferences.hierarchy_width, preferences.inspector_width];
    let dragged = ui.ctx().egui_is_using_pointer();
    let context = ui.ctx().clone();
    let side = |id: &'static str, width: f32, left: bool| {
        let range = egui::Rangef::new(120.0, (0.5 * for_panels).max(120.0));
        if !dragged {
            come_back(&context, id, range.clamp(width));
        }
        let panel = if left {
            egui::Panel::left(id)
        } else {
            egui::Panel::right(id)
        };
        panel
            .resizable(true)
            .default_size(width)
            .size_range(range)
            .frame(bar(egui::Margin::symmetric(6, 4)))
    };
    if preferences.show_hierarchy {
        widths[0] = side("hierarchy", widths[0], true)
            .show_inside(ui, |ui| {
                contained(ui, |ui| {
                    with(world, |world, panel| {
                        hierarchy::hierarchy_ui(ui, world, panel)
                    })
                })
            })
            .response
            .rect
            .width();
    }
    if preferences.show_inspector {
        widths[1] = side("inspector", widths[1], false)
            .show_inside(ui, |ui| {
                contained(ui, |ui| {
                    with(world, |world, panel| {
                        inspector::inspector_ui(ui, world, panel)
                    })
                })
            })
            .response
            .rect
            .width();
    }
    let known = [preferences.hierarchy_width, preferences.inspector_width];
    // A width that a narrow window forces is not one that a person chose.
    if dragged && widths != known {
        let mut preferences = world.resource_mut::<Preferences>();
        [preferences.hierarchy_width, preferences.inspector_width] = widths;
    }
    ui.available_rect_before_wrap()
}

/// Egui remembers how wide a panel was last, also where a narrow window forced that: it is as wide as it shall be again
/// once there is room.
fn come_back(context: &egui::Context, panel: &'static str, width: f32) {
    let id = egui::Id::new(panel);
    let now = egui::PanelState::load(context, id).map(|state| state.size().x);
    if now.is_some_and(|now| (now - width).abs() > 1.0) {
        context.data_mut(|data| data.remove::<egui::PanelState>(id));
    }
}

/// Keeps what is drawn within the room that there is: a panel would grow with what sticks out of it,
/// frame by frame, and the picture would start over with each.
fn contained(ui: &mut egui::Ui, body: impl FnOnce(&mut egui::Ui)) {
    let room = ui.available_rect_before_wrap();
    within_room(ui, room, body);
    ui.advance_cursor_after_rect(room);
}

/// The same of the width alone: a window is as high as what is in it.
fn contained_in_width(ui: &mut egui::Ui, body: impl FnOnce(&mut egui::Ui)) {
    let mut room = ui.available_rect_before_wrap();
    room.max.y = f32::INFINITY;
    let bottom = within_room(ui, room, body).bottom();
    ui.advance_cursor_after_rect(room.with_max_y(bottom));
}

/// Draws in a part of it, and returns what was drawn in.
fn within_room(
    ui: &mut egui::Ui,
    room: egui::Rect,
    body: impl FnOnce(&mut egui::Ui),
) -> egui::Rect {
    let mut inner = ui.new_child(egui::UiBuilder::new().max_rect(room));
    inner.shrink_clip_rect(room);
    body(&mut inner);
    inner.min_rect()
}

/// Tells the rest of the editor where the picture is, and whether pointer and keys are meant for it.
fn note_viewport(
    context: &egui::Context,
    (picture, twin): (egui::Rect, Option<egui::Rect>),
    [over_overlay, letters_taken]: [bool; 2],
    world: &mut World,
) {
    let zoom = context.zoom_factor();
    let in_window = |rect: egui::Rect| Rect {
        min: Vec2::new(rect.min.x, rect.min.y) * zoom,
        max: Vec2::new(rect.max.x, rect.max.y) * zoom,
    };
    let places = (in_window(picture), twin.map(in_window));
    let pointer = context.pointer_latest_pos();
    let in_front = |at| {
        context
            .layer_id_at(at)
            .is_some_and(|layer| layer.order != egui::Order::Background)
    };
    let is_over = |at| picture.contains(at) || twin.is_some_and(|twin| twin.contains(at));
    let hovered = !over_overlay
        && pointer.is_some_and(|at| is_over(at) && !in_front(at))
        && !context.egui_is_using_pointer();
    let modal = context.memory(|memory| memory.top_modal_layer().is_some());
    let takes_function_keys = !modal && !context.any_popup_open();
    let takes_keys = takes_function_keys && !context.egui_wants_keyboard_input();
    let takes_letters = takes_keys && !letters_taken;
    let viewport = world.resource::<Viewport>();
    let keys = [takes_function_keys, takes_keys, takes_letters];
    let known = [
        viewport.takes_function_keys,
        viewport.takes_keys,
        viewport.takes_letters,
    ];
    if (viewport.rect, viewport.twin) != places || viewport.hovered != hovered || known != keys {
        let mut viewport = world.resource_mut::<Viewport>();
        (viewport.rect, viewport.twin) = places;
        viewport.hovered = hovered;
        [
            viewport.takes_function_keys,
            viewport.takes_keys,
            viewport.takes_letters,
        ] = keys;
    }
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
