//! Which boxes of the trees are drawn, and how.

use super::super::fields::{integer, row, switch};
use super::super::says::Says;
use super::super::status::grouped;
use crate::editor::action::Action;
use crate::editor::inspection::DebugRay;
use crate::editor::selection::Selection;
use crate::editor::trees::BoxRanges;
use crate::inspect::{
    BoxChoice, BoxColor, BoxRange, BoxSettings, InspectSettings, TreeChoice, TreeForm,
};
use crate::sync::Traced;
use crate::trace::RayHit;
use bevy::ecs::world::{Mut, World};
use bevy_egui::egui::{Button, ComboBox, Label, RichText, Slider, SliderClamping, Ui};

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
    let says = "Binary: as the builder made them, and as debug rays walk them. Wide: up to eight children a \
                node, made of the binary form, through which pictures are traced";
    enum_ui(ui, "Form", says, &mut boxes.form, &FORMS);
    if boxes.form == TreeForm::Binary {
        let says = "A range of levels, one leaf, or the way to a triangle";
        enum_ui(ui, "Which", says, &mut boxes.choice, &CHOICES);
    }
    let choice = match boxes.form {
        TreeForm::Binary => boxes.choice,
        TreeForm::Wide => BoxChoice::Levels,
    };
    match choice {
        BoxChoice::Levels => levels_ui(ui, boxes, range),
        BoxChoice::Leaf => leaf_ui(ui, world, boxes, range),
        BoxChoice::Path => path_ui(ui, world, boxes),
    }
    if choice != BoxChoice::Path {
        object_ui(ui, world, boxes);
    }
    let says = "The one over the objects, those of the meshes, or both";
    enum_ui(ui, "Trees", says, &mut boxes.trees, &TREES);
    if boxes.form == TreeForm::Binary {
        let says = "What a box's colour says: dark is little, bright is much";
        enum_ui(ui, "Colour", says, &mut boxes.color, &COLORS);
        let says =
            "The plane between each drawn node's children, with its axis: x red, y green, z blue";
        switch(ui, "Split planes", says, &mut boxes.split_planes, false);
        let says = "The triangles of drawn leaves";
        switch(ui, "Triangles", says, &mut boxes.triangles, false);
    }
    let leaves = grouped(range.leaves as u64);
    let text = match boxes.form {
        TreeForm::Binary => format!("{leaves} leaves, the deepest level is {}", range.deepest),
        TreeForm::Wide => format!("The deepest level is {}", range.deepest),
    };
    ui.add(Label::new(RichText::new(text).weak()).wrap());
}

const FORMS: [(TreeForm, &str); 2] = [(TreeForm::Binary, "Binary"), (TreeForm::Wide, "Wide")];
const CHOICES: [(BoxChoice, &str); 3] = [
    (BoxChoice::Levels, "Levels"),
    (BoxChoice::Leaf, "One leaf"),
    (BoxChoice::Path, "Way to a triangle"),
];
const TREES: [(TreeChoice, &str); 3] = [
    (TreeChoice::Both, "Both"),
    (TreeChoice::Top, "Over the objects"),
    (TreeChoice::Meshes, "Of the meshes"),
];
const COLORS: [(BoxColor, &str); 4] = [
    (BoxColor::Level, "Level"),
    (BoxColor::LeafSize, "Leaf size"),
    (BoxColor::Cost, "SAH cost"),
    (BoxColor::Visits, "Visits"),
];

fn enum_ui<T: Copy + PartialEq>(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut T,
    all: &[(T, &str)],
) {
    let name = all
        .iter()
        .find(|(one, _)| one == value)
        .map_or("", |(_, name)| name);
    row(ui, label, says, |ui| {
        ComboBox::from_id_salt(label)
            .selected_text(name)
            .width((ui.available_width() - 12.0).max(60.0))
            .show_ui(ui, |ui| {
                for &(one, name) in all {
                    ui.selectable_value(value, one, name);
                }
            })
            .response
            .says(says);
    });
}

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
            ("◀", "The leaf before (A)", Action::PreviousLeaf),
            ("▶", "The next leaf (S)", Action::NextLeaf),
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

/// Of one object, or of all.
fn object_ui(ui: &mut Ui, world: &World, boxes: &mut BoxSettings) {
    let says = "Trees of all objects, or of the selected one alone";
    let selected = world
        .get_resource::<Selection>()
        .and_then(Selection::active);
    row(ui, "Of", says, |ui| {
        let all = Button::selectable(boxes.object == 0, "All");
        if ui.add(all).says("Trees of all objects").clicked() {
            boxes.object = 0;
        }
        let is_one = boxes.object != 0;
        let name = match is_one {
            true => format!("Object {}", boxes.object),
            false => "Selected".to_owned(),
        };
        let one = ui.add_enabled(selected.is_some(), Button::selectable(is_one, name));
        let says = "Of the selected object alone; select another one and press again";
        if one.says(says).clicked()
            && let Some(id) = selected
        {
            boxes.object = id.0;
        }
    });
}
