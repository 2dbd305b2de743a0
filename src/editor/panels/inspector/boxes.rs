//! Which boxes of the trees are drawn, and how.

use super::super::fields::{choice, integer, row, switch};
use super::super::says::Says;
use super::super::status::grouped;
use crate::editor::action::Action;
use crate::editor::inspection::{DebugRay, Names};
use crate::editor::selection::Selection;
use crate::editor::trees::BoxRanges;
use crate::inspect::{
    BoxChoice, BoxColor, BoxRange, BoxSettings, InspectSettings, TreeChoice, TreeForm,
};
use crate::scene::SceneId;
use crate::sync::Traced;
use crate::trace::RayHit;
use bevy::ecs::world::{Mut, World};
use bevy_egui::egui::{Button, Label, RichText, Slider, SliderClamping, Ui};

pub(super) fn boxes_ui(ui: &mut Ui, world: &mut World, settings: &mut InspectSettings) {
    let boxes = &mut settings.boxes;
    let traced = world.resource::<Traced>().world.clone();
    let range = match world.contains_resource::<BoxRanges>() && boxes.on {
        true => world.resource_scope(|_, mut ranges: Mut<BoxRanges>| ranges.of(&traced, boxes)),
        false => BoxRange::default(),
    };
    let says = "Boxes of the trees' nodes";
    switch(ui, "Draw", says, &mut boxes.on, false);
    if !boxes.on {
        return;
    }
    let says = "Binary: as the builder made them. Wide: up to eight children a node, made of the binary form, \
                through which rays are traced";
    choice(ui, "Form", says, &mut boxes.form, &FORMS, false);
    if boxes.form == TreeForm::Binary {
        let says = "A range of levels, one leaf, or the way to a triangle";
        choice(ui, "Which", says, &mut boxes.choice, &CHOICES, false);
    }
    let which = match boxes.form {
        TreeForm::Binary => boxes.choice,
        TreeForm::Wide => BoxChoice::Levels,
    };
    match which {
        BoxChoice::Levels => levels_ui(ui, boxes, range),
        BoxChoice::Leaf => leaf_ui(ui, world, boxes, range),
        BoxChoice::Path => path_ui(ui, world, boxes),
    }
    if which != BoxChoice::Path {
        object_ui(ui, world, boxes);
    }
    let says = "The one over the objects, those of the meshes, or both";
    choice(ui, "Trees", says, &mut boxes.trees, &TREES, false);
    if boxes.form == TreeForm::Binary {
        let says = "What a box's colour says: dark is little, bright is much";
        choice(ui, "Colour", says, &mut boxes.color, &COLORS, false);
        let says =
            "The plane between each drawn node's children, with its axis: x red, y green, z blue";
        switch(ui, "Split planes", says, &mut boxes.split_planes, false);
        let says = "The triangles of drawn leaves";
        switch(ui, "Triangles", says, &mut boxes.triangles, false);
    } else {
        let says = "What a box's colour says: dark is little, bright is much";
        let colors = [COLORS[0], COLORS[3]];
        let mut color = match boxes.color {
            BoxColor::Visits => BoxColor::Visits,
            _ => BoxColor::Level,
        };
        if choice(ui, "Colour", says, &mut color, &colors, false) {
            boxes.color = color;
        }
    }
    let leaves = grouped(range.leaves as u64);
    let text = match boxes.form {
        TreeForm::Binary => format!("{leaves} leaves, the deepest level is {}", range.deepest),
        TreeForm::Wide => format!("The deepest level is {}", range.deepest),
    };
    ui.add(Label::new(RichText::new(text).weak()).wrap());
}

const FORMS: [(TreeForm, &str, &str); 2] = [
    (TreeForm::Binary, "Binary", "As the builder made them"),
    (
        TreeForm::Wide,
        "Wide",
        "Up to eight children a node: what rays are traced through",
    ),
];
const CHOICES: [(BoxChoice, &str, &str); 3] = [
    (
        BoxChoice::Levels,
        "Levels",
        "All nodes from one level to another",
    ),
    (BoxChoice::Leaf, "One leaf", "A single leaf, by its number"),
    (
        BoxChoice::Path,
        "Way to a triangle",
        "From the root to the leaf that holds a triangle",
    ),
];
const TREES: [(TreeChoice, &str, &str); 3] = [
    (TreeChoice::Both, "Both", "All trees"),
    (
        TreeChoice::Top,
        "Over the objects",
        "The tree whose leaves are objects",
    ),
    (
        TreeChoice::Meshes,
        "Of the meshes",
        "The trees whose leaves are triangles",
    ),
];
const COLORS: [(BoxColor, &str, &str); 4] = [
    (BoxColor::Level, "Level", "How deep the node is"),
    (
        BoxColor::LeafSize,
        "Leaf size",
        "How many triangles or objects a leaf holds",
    ),
    (
        BoxColor::Cost,
        "SAH cost",
        "What the node adds to the cost of a random ray",
    ),
    (
        BoxColor::Visits,
        "Visits",
        "How many of the debug ray's rays entered the node",
    ),
];

fn levels_ui(ui: &mut Ui, boxes: &mut BoxSettings, range: BoxRange) {
    let deepest = range.deepest.max(1);
    let says = "The first level that is drawn; the root's is 0";
    if integer(
        ui,
        "From level",
        says,
        &mut boxes.from_level,
        0..=deepest,
        false,
    ) {
        boxes.to_level = boxes.to_level.max(boxes.from_level);
    }
    let says = "The last level that is drawn";
    if integer(
        ui,
        "To level",
        says,
        &mut boxes.to_level,
        0..=deepest,
        false,
    ) {
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
    let says = "Which leaf, from 0, in the order in which the trees have them; A and S step";
    row(ui, "Leaf", says, |ui| {
        let room = ui.available_width();
        ui.spacing_mut().slider_width = (room - 104.0).max(30.0);
        let slider = Slider::new(&mut boxes.leaf, 0..=last).clamping(SliderClamping::Edits);
        ui.add(slider).says(says);
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
        None => "Shoot a debug ray first: point at the picture and press R",
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
    let says = "Which triangle of the object, from 0, in the mesh's own order";
    integer(ui, "Triangle", says, &mut boxes.triangle, 0..=last, false);
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

    #[test]
    fn every_choice_says_what_it_means() {
        let says = FORMS.iter().map(|choice| choice.2);
        let says = says.chain(CHOICES.iter().map(|choice| choice.2));
        let says = says.chain(TREES.iter().map(|choice| choice.2));
        let mut says = says.chain(COLORS.iter().map(|choice| choice.2));
        assert!(says.all(|text| !text.is_empty()));
    }
}
