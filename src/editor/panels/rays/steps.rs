//! The chosen ray's way through the trees: played, with the stack.

use super::super::fields::number;
use super::super::says::Says;
use super::none_chosen_ui;
use crate::editor::command::tooltip;
use crate::editor::inspection::{DebugRay, Inspected};
use crate::inspect::{Names, Step, StepKind, counted, tree_name};
use crate::scene::Quantity;
use crate::sync::Traced;
use crate::trace::{RayTree, World};
use bevy::ecs::world;
use bevy_egui::egui::{
    Align2, Button, Color32, FontFamily, FontId, Grid, Rect, RichText, Sense, Slider, Ui,
    WidgetInfo, WidgetType, pos2, vec2,
};

/// Points.
const ROW: f32 = 16.0;
/// Steps a second.
const SPEEDS: [f32; 2] = [0.5, 60.0];

pub(super) fn steps_ui(
    ui: &mut Ui,
    world: &mut world::World,
    inspected: &mut Inspected,
    rays: &RayTree,
) {
    let Some(ray) = inspected
        .ray()
        .and_then(|index| rays.rays.get(index as usize))
    else {
        none_chosen_ui(ui, inspected, rays);
        return;
    };
    if inspected.stepper.is_empty() {
        ui.weak("This ray was not traced, so it went through no tree.");
        return;
    }
    controls_ui(ui, world, inspected);
    // The steps are those of the world that the ray was traced in; the scene may have moved on.
    let traced_with = world.resource::<DebugRay>().traced_with();
    let present = &world.resource::<Traced>().world;
    let traced = traced_with.map_or(present, |(world, _)| world);
    let names = world.resource::<Names>();
    let tell = Tell {
        world: traced,
        names,
        length: ray.direction.length(),
    };
    if let Some(step) = inspected.stepper.step() {
        ui.label(RichText::new(tell.step(step)).strong());
    }
    let [entered, missed, pruned, triangles] = inspected.stepper.counts();
    ui.weak(format!(
        "so far: {entered} entered, {missed} missed, {pruned} pruned, {}",
        counted(triangles as u64, "triangle")
    ))
    .says("Nodes entered, boxes missed, nodes pruned and triangles tested, by the walk that traces pictures, through the wide form of the trees: its boxes have the numbers of the binary nodes that they are made of");
    stack_ui(ui, inspected, &tell);
    ui.add_space(4.0);
    list_ui(ui, inspected, &tell);
}

fn controls_ui(ui: &mut Ui, world: &world::World, inspected: &mut Inspected) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let stepper = &mut inspected.stepper;
        let last = stepper.len() - 1;
        if ui.small_button("|<").says("To the first step").clicked() {
            stepper.go(0);
        }
        if ui
            .small_button("<")
            .says(&tooltip(world, "rays.back"))
            .clicked()
        {
            stepper.back();
        }
        let name = if stepper.playing { "⏸" } else { "▶" };
        let play = Button::selectable(stepper.playing, name);
        if ui.add(play).says(&tooltip(world, "rays.play")).clicked() {
            stepper.toggle();
        }
        if ui
            .small_button(">")
            .says(&tooltip(world, "rays.forward"))
            .clicked()
        {
            stepper.forward();
        }
        if ui.small_button(">|").says("To the last step").clicked() {
            stepper.go(last);
        }
        let says = "Steps a second while playing";
        let speeds = Quantity::within(SPEEDS[0].into(), SPEEDS[1].into(), "/s").step(0.1);
        number(ui, says, &mut stepper.speed, speeds);
        ui.checkbox(&mut inspected.only_its_nodes, "its nodes only").says(
            "Visited and pruned nodes (tab Debug) are drawn of this ray alone, and not of all rays",
        );
    });
    let stepper = &mut inspected.stepper;
    ui.horizontal(|ui| {
        let mut at = stepper.at() + 1;
        let count = stepper.len();
        ui.spacing_mut().slider_width = (ui.available_width() - 96.0).max(60.0);
        let slider = Slider::new(&mut at, 1..=count).show_value(false);
        let is_moved = ui.add(slider).says("Which step is shown").changed();
        ui.label(format!("{at} of {count}"));
        if is_moved {
            stepper.playing = false;
            stepper.go(at - 1);
        }
    });
}

/// Puts steps into words.
struct Tell<'a> {
    world: &'a World,
    names: &'a Names,
    /// Metres of a `t` of 1.
    length: f32,
}

impl Tell<'_> {
    fn node(&self, instance: Option<u32>, node: u32) -> String {
        match tree_name(self.world, instance, self.names) {
            Some(tree) => format!("{node} of {tree}"),
            None => node.to_string(),
        }
    }

    fn metres(&self, t: Option<f32>) -> String {
        t.map_or_else(|| "–".into(), |t| format!("{:.4} m", t * self.length))
    }

    fn step(&self, step: &Step) -> String {
        let node = self.node(step.instance, step.node);
        match (step.kind, step.triangle) {
            (StepKind::Entered, _) => format!("enter node {node} at {}", self.metres(step.t)),
            (StepKind::Missed, _) => format!("miss node {node}"),
            (StepKind::Pruned, _) => {
                format!(
                    "prune node {node}: at {}, behind the hit",
                    self.metres(step.t)
                )
            }
            (kind, Some([instance, triangle])) => {
                let object = self.world.objects.get(instance as usize);
                let object = object.map_or_else(String::new, |object| {
                    format!(" of {}", self.names.of(object.id))
                });
                match kind {
                    StepKind::Hit => format!("triangle {triangle}{object}: the nearest hit now"),
                    _ => format!("triangle {triangle}{object}: no hit"),
                }
            }
            (kind, None) => kind.name().into(),
        }
    }
}

/// The nodes that are put off, the next one above.
fn stack_ui(ui: &mut Ui, inspected: &Inspected, tell: &Tell) {
    let stack: Vec<_> = inspected.stepper.stack().rev().collect();
    ui.label(match stack.len() {
        0 => "the stack is empty".to_owned(),
        n => format!("stack, {n} put off, the next first"),
    })
    .says("Nodes whose box was hit and whose turn comes later, drawn in blue; those that lie behind the nearest hit will be pruned, drawn in red");
    let fault = ui.visuals().error_fg_color;
    Grid::new("stack")
        .num_columns(3)
        .spacing([10.0, 1.0])
        .show(ui, |ui| {
            for ((instance, node), mark) in stack {
                let text = RichText::new(tell.node(instance, node)).size(12.0);
                let distance = RichText::new(tell.metres(mark.t)).monospace().size(11.0);
                let (text, distance) = match mark.is_pruned {
                    true => (text.color(fault).strikethrough(), distance.color(fault)),
                    false => (text, distance),
                };
                ui.label(text);
                ui.label(distance).says(match mark.t {
                    Some(_) => "Where the ray enters its box",
                    None => "Its turn never comes: the ray is found blocked before",
                });
                ui.weak(if mark.is_pruned { "pruned" } else { "" });
                ui.end_row();
            }
        });
}

/// All steps; a click goes to one. Only those that are seen are laid out.
fn list_ui(ui: &mut Ui, inspected: &mut Inspected, tell: &Tell) {
    let steps = inspected.stepper.steps();
    let size = vec2(ui.available_width(), steps.len() as f32 * ROW);
    let (area, _) = ui.allocate_exact_size(size, Sense::hover());
    let clip = ui.clip_rect();
    let first = ((clip.min.y - area.min.y) / ROW).floor().max(0.0) as usize;
    let last = ((clip.max.y - area.min.y) / ROW).ceil().max(0.0) as usize;
    let mut goal = None;
    let visuals = ui.visuals();
    let font = FontId::new(11.5, FontFamily::Proportional);
    for (at, step) in steps.iter().enumerate().take(last).skip(first) {
        let top = pos2(area.min.x, area.min.y + at as f32 * ROW);
        let row = Rect::from_min_size(top, vec2(area.width(), ROW));
        let seen = row.intersect(clip);
        if !seen.is_positive() {
            continue;
        }
        let response = ui.interact(seen, ui.id().with(("step", at)), Sense::click());
        let here = at == inspected.stepper.at();
        response.widget_info(|| {
            let name = format!("Step {at}");
            WidgetInfo::selected(WidgetType::SelectableLabel, true, here, name)
        });
        let fill = match (here, response.hovered()) {
            (true, _) => visuals.selection.bg_fill,
            (_, true) => visuals.widgets.noninteractive.bg_stroke.color,
            _ => Color32::TRANSPARENT,
        };
        let ink = match (here, step.kind) {
            (true, _) => visuals.selection.stroke.color,
            (_, StepKind::Missed | StepKind::NotHit) => visuals.weak_text_color(),
            (_, StepKind::Pruned) => visuals.error_fg_color,
            (_, StepKind::Hit) => visuals.warn_fg_color,
            _ => visuals.text_color(),
        };
        let painter = ui.painter().with_clip_rect(seen);
        painter.rect_filled(seen, 2.0, fill);
        let text = format!("{}  {}", at + 1, tell.step(step));
        let at_text = row.left_center() + vec2(3.0, 0.0);
        painter.text(at_text, Align2::LEFT_CENTER, text, font.clone(), ink);
        if response.clicked() {
            goal = Some(at);
        }
    }
    if let Some(goal) = goal {
        inspected.stepper.playing = false;
        inspected.stepper.go(goal);
    }
}
