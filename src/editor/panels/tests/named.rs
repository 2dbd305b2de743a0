//! What can be clicked has a name, so that it can be told aloud.

use super::super::commands::commands;
use super::super::dialogs::{Dialog, Dialogs};
use super::super::hierarchy::Hierarchy;
use super::super::inspector::{Inspector, Tab};
use super::super::outline_rows::Filter;
use super::super::palette::{OpenPalette, Palette};
use super::super::says::can_be_told;
use super::desk::{self, Desk, LARGE};
use crate::editor::action::Action;
use crate::editor::inspection::{DebugRay, debug_ray::Shot};
use crate::editor::notice::Notices;
use crate::editor::preferences::Preferences;
use crate::editor::viewport::Viewport;
use crate::io::builtin::SCENES;
use crate::sync::TracedCameras;
use bevy::math::UVec2;
use bevy_egui::egui::accesskit::{Action as Request, Role, TreeUpdate};
use bevy_egui::egui::{self, Key};
use std::collections::BTreeSet;

/// What a screen reader is told.
fn listed(desk: &Desk) -> &TreeUpdate {
    let update = desk.output.platform_output.accesskit_update.as_ref();
    update.expect("all controls are listed")
}

/// What can be clicked and has no name, with where it was seen.
fn note_unnamed(desk: &mut Desk, place: &str, unnamed: &mut BTreeSet<String>) -> usize {
    desk.settle();
    let update = listed(desk);
    let mut count = 0;
    for (_, node) in &update.nodes {
        // What is read, and can be marked for copying, is its own name.
        let is_control = !matches!(node.role(), Role::Label | Role::ScrollBar);
        if !is_control || !node.supports_action(Request::Click) {
            continue;
        }
        count += 1;
        let named = node.label().is_some_and(can_be_told);
        if !named && node.labelled_by().is_empty() {
            unnamed.insert(format!(
                "{place}: {:?} {:?} of value {:?} at {:?}",
                node.role(),
                node.label(),
                node.value(),
                node.bounds()
            ));
        }
    }
    count
}

#[test]
fn whatever_can_be_clicked_in_any_panel_has_a_name() {
    let (mut unnamed, mut count) = (BTreeSet::new(), 0);
    for scene in SCENES {
        let mut desk = Desk::open(scene.name);
        desk.size = LARGE;
        desk.context.enable_accesskit();
        let ids = desk.ids();
        for tab in [Tab::Object, Tab::Render, Tab::Debug, Tab::Bvh] {
            desk.world().resource_mut::<Inspector>().tab = tab;
            let choices = ids
                .iter()
                .map(|&id| vec![id])
                .chain([ids.clone(), Vec::new()]);
            for selected in choices.take(if tab == Tab::Object { 60 } else { 1 }) {
                desk.select(selected);
                count += note_unnamed(&mut desk, &format!("{} {tab:?}", scene.name), &mut unnamed);
            }
        }
    }
    let mut desk = Desk::with_trees("cornell-box");
    desk.size = LARGE;
    desk.context.enable_accesskit();
    let camera = desk.world().resource::<TracedCameras>().0[0].camera.clone();
    let (pixel, size) = (UVec2::new(300, 400), UVec2::new(600, 480));
    desk.world().resource_mut::<DebugRay>().shoot(Shot {
        pixel,
        camera,
        size,
    });
    desk.world().resource_mut::<Preferences>().show_rays = true;
    desk.world().resource_mut::<Preferences>().hint_seen = false;
    let lines = (0..9).map(|i| format!("line {i}")).collect();
    desk.world()
        .resource_mut::<Notices>()
        .notes("house.glb", lines);
    count += note_unnamed(&mut desk, "rays", &mut unnamed);
    desk.world().write_message(Action::run("lights.mixer"));
    count += note_unnamed(&mut desk, "mixer", &mut unnamed);
    desk.world().resource_mut::<Hierarchy>().filter = Filter {
        text: "a".into(),
        ..Filter::default()
    };
    for dialog in [
        Dialog::Keys,
        Dialog::About,
        Dialog::Preferences,
        Dialog::Scenes,
        Dialog::History,
        Dialog::Render,
    ] {
        desk.world().resource_mut::<Dialogs>().open = Some(dialog);
        count += note_unnamed(&mut desk, &format!("{dialog:?}"), &mut unnamed);
    }
    desk.world().resource_mut::<Dialogs>().open = None;
    desk.world().resource_mut::<OpenPalette>().0 = Some(Palette::default());
    count += note_unnamed(&mut desk, "palette", &mut unnamed);
    assert!(count > 10 * commands().len(), "{count} controls");
    let list: Vec<String> = unnamed.into_iter().collect();
    assert!(
        list.is_empty(),
        "{} of {count} controls have no name:\n{}",
        list.len(),
        list.join("\n")
    );
}

/// What is drawn over a place, as far as it can be told apart.
fn drawn_at(desk: &Desk, place: egui::Rect) -> Vec<String> {
    let shapes = desk.output.shapes.iter();
    let there = shapes.filter(|shape| {
        let bounds = shape.shape.visual_bounding_rect();
        bounds.is_finite() && place.expand(3.0).contains_rect(bounds)
    });
    there.map(|shape| format!("{:?}", shape.shape)).collect()
}

#[test]
fn tab_reaches_every_control_once_and_the_one_that_has_the_keys_is_seen() {
    let mut desk = Desk::open("cornell-box");
    desk.size = LARGE;
    desk.context.enable_accesskit();
    let (_, lamp) = desk.named("Lamp");
    desk.select([lamp]);
    let focus = |desk: &Desk| {
        let update = listed(desk);
        let (_, node) = update.nodes.iter().find(|(id, _)| *id == update.focus)?;
        let place = desk::bounds_of(node)?;
        let name = node.label().or(node.description()).unwrap_or_default();
        Some((update.focus, place, format!("{:?} {name}", node.role())))
    };
    let mut seen = BTreeSet::new();
    let mut unseen = Vec::new();
    for _ in 0..500 {
        desk.key(Key::Tab);
        let Some((id, place, name)) = focus(&desk) else {
            continue;
        };
        if !seen.insert(id) {
            break;
        }
        let with = drawn_at(&desk, place);
        let focused = desk.context.memory(|memory| memory.focused()).unwrap();
        desk.context
            .memory_mut(|memory| memory.surrender_focus(focused));
        desk.settle();
        let is_seen = drawn_at(&desk, place) != with;
        if !is_seen {
            unseen.push(name);
        }
        desk.context
            .memory_mut(|memory| memory.request_focus(focused));
        desk.frame(Vec::new());
    }
    let update = listed(&desk);
    let all = update
        .nodes
        .iter()
        .filter(|(_, node)| node.supports_action(Request::Focus));
    let missed: Vec<String> = all
        .filter(|(id, node)| !seen.contains(id) && !node.is_disabled())
        .map(|(_, node)| format!("{:?} {:?}", node.role(), node.label()))
        .collect();
    assert!(seen.len() > 40, "{} controls", seen.len());
    assert!(missed.is_empty(), "Tab never reaches {missed:#?}");
    assert!(
        unseen.is_empty(),
        "nobody sees that they have the keys: {unseen:#?}"
    );
}

#[test]
fn f6_goes_from_panel_to_panel_and_back_to_the_picture_and_shift_f6_the_other_way() {
    let mut desk = Desk::open("cornell-box");
    let (_, lamp) = desk.named("Lamp");
    desk.select([lamp]);
    let step = |desk: &mut Desk, id: &str| {
        desk.world().write_message(Action::run(id.to_owned()));
        desk.settle();
        let focused = desk.context.memory(|memory| memory.focused());
        focused.map(|id| desk.context.read_response(id).unwrap().interact_rect)
    };
    let there: Vec<egui::Rect> = std::iter::from_fn(|| step(&mut desk, "view.next-panel"))
        .take(20)
        .collect();
    let panel = |id: &'static str| {
        egui::PanelState::load(&desk.context, egui::Id::new(id)).map(|state| state.rect)
    };
    for id in ["menu", "toolbar", "hierarchy", "inspector"] {
        let panel = panel(id).unwrap();
        let here = there.iter().filter(|stop| panel.contains(stop.center()));
        assert_eq!(here.count(), 1, "{id}: {there:?}");
    }
    // The picture's keys are commands again.
    assert!(desk.world().resource::<Viewport>().takes_keys);
    let mut back: Vec<egui::Rect> = std::iter::from_fn(|| step(&mut desk, "view.previous-panel"))
        .take(20)
        .collect();
    back.reverse();
    assert_eq!(back, there);
}
