//! Where the panels stand around the picture, and what is left for it.

use super::state::{OnlyPicture, with};
use super::{
    compare, context_menu, dialogs, gesture, hierarchy, inspector, menu_bar, mixer, overlays,
    palette, panel_focus, rays, readout, status, theme, told, toolbar, tree_pair, typed_drag,
};
use crate::editor::dispatch::dispatch;
use crate::editor::preferences::Preferences;
use crate::editor::viewport::Viewport;
use bevy::ecs::world::World;
use bevy::math::{Rect, Vec2};
use bevy_egui::egui;

/// What is left for the picture at least, in egui's points.
const LEAST_PICTURE: f32 = 240.0;

/// All of it, within a pass of egui.
pub(super) fn panels_ui(context: &egui::Context, world: &mut World) {
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
pub(super) fn contained(ui: &mut egui::Ui, body: impl FnOnce(&mut egui::Ui)) {
    let room = ui.available_rect_before_wrap();
    within_room(ui, room, body);
    ui.advance_cursor_after_rect(room);
}

/// The same of the width alone: a window is as high as what is in it.
pub(super) fn contained_in_width(ui: &mut egui::Ui, body: impl FnOnce(&mut egui::Ui)) {
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
