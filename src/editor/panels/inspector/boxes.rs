//! Which boxes of the trees are drawn, and how.

use super::super::fields::{chosen_ui, number_row, properties_ui, row};
use super::super::says::Says;
use crate::editor::action::Action;
use crate::editor::inspection::DebugRay;
use crate::editor::selection::Selection;
use crate::editor::texts::counted;
use crate::editor::trees::BoxRanges;
use crate::inspect::{
    BoxChoice, BoxColor, BoxRange, BoxSettings, InspectSettings, Names, TreeForm,
};
use crate::scene::{Property, Quantity, SceneId};
use crate::sync::Traced;
use crate::trace::RayHit;
use bevy::ecs::world::{Mut, World};
use bevy::reflect::Typed;
use bevy_egui::egui::{Button, Label, RichText, Ui};

pub(super) fn boxes_ui(ui: &mut Ui, world: &mut World, settings: &mut InspectSettings) {
    let traced = world.resource::<Traced>().world.clone();
    let range = match world.contains_resource::<BoxRanges>() && settings.boxes.on {
        true => world
            .resource_scope(|_, mut ranges: Mut<BoxRanges>| ranges.of(&traced, &settings.boxes)),
        false => BoxRange::default(),
    };
    properties_ui(ui, settings, &["boxes.on"]);
    if !settings.boxes.on {
        return;
    }
    properties_ui(ui, settings, &["boxes.form"]);
    let form = settings.boxes.form;
    if form == TreeForm::Binary {
        properties_ui(ui, settings, &["boxes.choice"]);
    }
    let which = match form {
        TreeForm::Binary => settings.boxes.choice,
        TreeForm::Wide => BoxChoice::Levels,
    };
    let boxes = &mut settings.boxes;
    match which {
        BoxChoice::Levels => levels_ui(ui, boxes, range),
        BoxChoice::Leaf => leaf_ui(ui, world, boxes, range),
        BoxChoice::Path => path_ui(ui, world, boxes),
    }
    if which != BoxChoice::Path {
        object_ui(ui, world, boxes);
    }
    properties_ui(ui, settings, &["boxes.trees"]);
    if form == TreeForm::Binary {
        let paths = ["boxes.color", "boxes.split_planes", "boxes.triangles"];
        properties_ui(ui, settings, &paths);
    } else {
        wide_color_ui(ui, &mut settings.boxes);
    }
    let leaves = counted(range.leaves as u64, "leaf");
    let text = match form {
        TreeForm::Binary => format!("{leaves}, the deepest level is {}", range.deepest),
        TreeForm::Wide => format!("The deepest level is {}", range.deepest),
    };
    ui.add(Label::new(RichText::new(text).weak()).wrap());
}

/// What colours of the wide form's boxes may tell: costs and leaf sizes are known of the binary form alone.
fn wide_color_ui(ui: &mut Ui, boxes: &mut BoxSettings) {
    let Some(property) = Property::of(BoxSettings::type_info(), "color") else {
        return;
    };
    let mut choices = property.choices();
    choices.retain(|choice| ["Level", "Visits"].contains(&choice.name));
    let now = match boxes.color {
        BoxColor::Visits => "Visits",
        _ => "Level",
    };
    let chosen = chosen_ui(ui, &property.label, &property.says, now, &choices, false);
    match chosen {
        Some("Visits") => boxes.color = BoxColor::Visits,
        Some(_) => boxes.color = BoxColor::Level,
        None => {}
    }
}

/// A number of a tree that is drawn, up to the last that it has.
fn number_ui(ui: &mut Ui, path: &str, value: &mut u32, last: u32) -> bool {
    let Some(property) = Property::of(BoxSettings::type_info(), path) else {
        return false;
    };
    let numbers = Quantity::slider(0.0, f64::from(last), "");
    number_row(ui, &property.label, &property.says, value, numbers)
}

fn levels_ui(ui: &mut Ui, boxes: &mut BoxSettings, range: BoxRange) {
    let deepest = range.deepest.max(1);
    if number_ui(ui, "from_level", &mut boxes.from_level, deepest) {
        boxes.to_level = boxes.to_level.max(boxes.from_level);
    }
    if number_ui(ui, "to_level", &mut boxes.to_level, deepest) {
        boxes.from_level = boxes.from_level.min(boxes.to_level);
    }
    ui.horizontal(|ui| {
        let says = "From the root to the deepest leaf";
        if ui.small_button("All levels").says(says).clicked() {
            (boxes.from_level, boxes.to_level) = (0, range.deepest);
        }
        for (name, says, deeper) in [
            (
                "Up",
                "The same number of levels, one nearer to the root",
                false,
            ),
            ("Down", "The same number of levels, one deeper", true),
        ] {
            let can = match deeper {
                true => boxes.to_level < range.deepest,
                false => boxes.from_level > 0,
            };
            let button = ui.add_enabled(can, Button::new(name).small());
            if button.says(says).clicked() {
                let step = |level: u32| match deeper {
                    true => level + 1,
                    false => level - 1,
                };
                (boxes.from_level, boxes.to_level) = (step(boxes.from_level), step(boxes.to_level));
            }
        }
    });
}

fn leaf_ui(ui: &mut Ui, world: &mut World, boxes: &mut BoxSettings, range: BoxRange) {
    let last = (range.leaves as u32).saturating_sub(1);
    number_ui(ui, "leaf", &mut boxes.leaf, last);
    ui.horizontal(|ui| {
        for (name, says, action) in [
            (
                "◀",
                "The leaf before (A)",
                Action::run("boxes.previous-leaf"),
            ),
            ("▶", "The next leaf (S)", Action::run("boxes.next-leaf")),
        ] {
            if ui.small_button(name).says(says).clicked() {
                world.write_message(action);
            }
        }
    });
}

/// The first surface that a debug ray met.
fn picked(world: &World) -> Option<RayHit> {
    let rays = world.get_resource::<DebugRay>()?.rays()?;
    rays.rays.iter().find_map(|ray| ray.hit)
}

fn path_ui(ui: &mut Ui, world: &mut World, boxes: &mut BoxSettings) {
    let hit = picked(world);
    let says = match hit {
        Some(_) => "The way to the triangle that the debug ray met first",
        None => "There is no debug ray yet: point at the picture and press R",
    };
    let to_hit = ui.add_enabled(hit.is_some(), Button::new("To what the ray met"));
    if to_hit.says(says).clicked()
        && let Some(hit) = hit
    {
        (boxes.object, boxes.triangle) = (hit.object, hit.triangle);
    }
    object_ui(ui, world, boxes);
    let objects = &world.resource::<Traced>().world.objects;
    let object = objects.iter().find(|object| object.id == boxes.object);
    let last = object.map_or(0, |object| {
        (object.mesh.tree.triangles().len() as u32).saturating_sub(1)
    });
    number_ui(ui, "triangle", &mut boxes.triangle, last);
}

/// Why the trees of what is selected cannot be drawn; `None` where they can.
fn no_tree(traced: &Traced, selected: Option<SceneId>) -> Option<&'static str> {
    let Some(id) = selected else {
        return Some("Nothing is selected: click an object first");
    };
    let objects = &traced.world.objects;
    match objects.iter().any(|object| object.id == id.0) {
        true => None,
        false => {
            Some("What is selected has no tree: it is no object, or is hidden, or cannot be traced")
        }
    }
}

/// Of one object, or of all.
fn object_ui(ui: &mut Ui, world: &World, boxes: &mut BoxSettings) {
    let says = "Trees of all objects, or of the selected one alone";
    let selected = world
        .get_resource::<Selection>()
        .and_then(Selection::active);
    let why_not = no_tree(world.resource::<Traced>(), selected);
    row(ui, "Of", says, |ui| {
        let all = Button::selectable(boxes.object == 0, "All");
        if ui.add(all).says("Trees of all objects").clicked() {
            boxes.object = 0;
        }
        let is_one = boxes.object != 0;
        let name = match (is_one, world.get_resource::<Names>()) {
            (true, Some(names)) => names.of(boxes.object),
            (true, None) => format!("#{}", boxes.object),
            (false, _) => "Selected".to_owned(),
        };
        let one = ui.add_enabled(why_not.is_none(), Button::selectable(is_one, name));
        let says = "Of the selected object alone; select another one and press again";
        if one.says(why_not.unwrap_or(says)).clicked()
            && let Some(id) = selected
        {
            boxes.object = id.0;
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;
    use crate::io::{OpenOptions, SceneSource, builtin, open};

    #[test]
    fn what_is_no_object_that_is_traced_has_no_tree_and_that_is_said() {
        let mut app = headless_editor();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        let traced = app.world().resource::<Traced>();
        let object = SceneId(traced.world.objects[0].id);
        assert_eq!(no_tree(traced, Some(object)), None);
        assert!(no_tree(traced, Some(SceneId(u64::MAX))).is_some());
        assert!(no_tree(traced, None).is_some());
    }
}
