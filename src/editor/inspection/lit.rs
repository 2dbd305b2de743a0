//! What is chosen, in front of everything: the ray, the node with its children, the step that is
//! shown.

use super::choice::{Inspected, Side};
use super::debug_ray::DebugRay;
use super::{Seen, seen_from};
use crate::bvh::primitives_below;
use crate::editor::preferences::Preferences;
use crate::editor::viewport::EditorCamera;
use crate::inspect::{InspectSettings, StepKind, Stepper, TreeView, triangle_in_world};
use crate::trace::{RayEnd, TracedRay, World};
use crate::view::{DrawnLines, Line, OVERLAY_LAYER};
use bevy::camera::visibility::RenderLayers;
use bevy::color::LinearRgba;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::ecs::system::{Commands, Local, Query, Res, Single};
use bevy::math::Vec3;
use std::sync::Arc;

/// No system draws in this colour.
const CHOSEN: LinearRgba = LinearRgba::rgb(1.0, 0.05, 0.6);
const CHILD: LinearRgba = LinearRgba::rgb(1.0, 0.45, 0.75);
const TRIANGLE: LinearRgba = LinearRgba::rgb(1.0, 0.85, 0.0);
const ENTERED: LinearRgba = LinearRgba::rgb(0.1, 1.0, 0.25);
const MISSED: LinearRgba = LinearRgba::rgb(0.5, 0.5, 0.5);
const PRUNED: LinearRgba = LinearRgba::rgb(1.0, 0.02, 0.02);
const WAITING: LinearRgba = LinearRgba::rgb(0.15, 0.6, 1.0);
/// Logical pixels.
const THICK: f32 = 3.5;
const THIN: f32 = 1.6;
/// Half the arm of the cross at a hit, as a part of its distance from the viewer.
const CROSS: f32 = 0.008;
/// More triangles below a node are not outlined: they would fill the box.
const MOST_TRIANGLES: usize = 300;

/// Thick lines in front of everything, and thin ones that are hidden by what stands before them.
#[derive(Default, PartialEq)]
struct Lit {
    thick: Vec<Line>,
    thin: Vec<Line>,
}

/// What the lines were made of, and the entities that draw them.
#[derive(Default)]
pub(super) struct Known {
    entities: [Option<Entity>; 2],
    made_of: Option<MadeOf>,
}

#[derive(PartialEq)]
struct MadeOf {
    ray: Option<(u64, u32)>,
    node: Option<(usize, Option<u32>, u32)>,
    step: Option<usize>,
    /// Crosses and endless rays depend on where they are looked at from.
    eye: [u32; 3],
}

/// Draws them again where they are others.
#[expect(
    clippy::too_many_arguments,
    reason = "a system's parameters are the list of what it reads"
)]
pub(super) fn draw_lit(
    mut commands: Commands,
    inspected: Res<Inspected>,
    ray: Res<DebugRay>,
    inspect: Res<InspectSettings>,
    preferences: Option<Res<Preferences>>,
    view: Single<Seen, With<EditorCamera>>,
    mut sets: Query<&mut DrawnLines>,
    mut known: Local<Known>,
) {
    let (render, seen, camera, place, projection) = *view;
    let seen = seen_from(render, seen, camera, place, projection);
    let eye = seen.map_or(Vec3::ZERO, |(camera, _)| camera.position);
    let is_open = preferences.is_none_or(|preferences| preferences.show_rays);
    let steps = is_open && inspected.side == Side::Steps && !inspected.stepper.is_empty();
    // The master switch hides what is chosen too.
    let chosen = inspected.ray().filter(|_| inspect.on).and_then(|index| {
        let rays = ray.rays()?;
        Some((index, rays.rays.get(index as usize)?))
    });
    let made_of = MadeOf {
        ray: chosen.map(|(index, _)| (ray.number(), index)),
        node: inspected.node().filter(|_| inspect.on).map(|node| {
            let world = Arc::as_ptr(&node.world) as usize;
            (world, node.instance, node.node)
        }),
        step: (steps && chosen.is_some()).then_some(inspected.stepper.at()),
        eye: eye.to_array().map(f32::to_bits),
    };
    if known.made_of.as_ref() == Some(&made_of) {
        return;
    }
    let mut lit = Lit::default();
    if let Some((_, traced)) = chosen {
        let far = match ray.traced_with() {
            Some((world, _)) => reach(world, eye),
            None => 1.0,
        };
        lit.ray(traced, eye, far);
    }
    if let Some(node) = inspected.node().filter(|_| inspect.on) {
        lit.node(&node.world, node.instance, node.node);
    }
    if made_of.step.is_some()
        && let Some((world, _)) = ray.traced_with()
    {
        lit.step(world, &inspected.stepper);
    }
    let Known { entities, .. } = &mut *known;
    let widths = [(THICK, true), (THIN, false)];
    for ((entity, lines), (width, on_top)) in
        entities.iter_mut().zip([lit.thick, lit.thin]).zip(widths)
    {
        let drawn = DrawnLines {
            lines,
            width,
            on_top,
        };
        match *entity {
            Some(entity) => {
                if let Ok(mut set) = sets.get_mut(entity) {
                    set.set_if_neq(drawn);
                }
            }
            None if drawn.lines.is_empty() => {}
            None => {
                *entity = Some(
                    commands
                        .spawn((drawn, RenderLayers::layer(OVERLAY_LAYER)))
                        .id(),
                )
            }
        }
    }
    known.made_of = Some(made_of);
}

/// A distance that leads out of the scene.
fn reach(world: &World, eye: Vec3) -> f32 {
    let root = world.aggregate.tree().nodes.first();
    let (min, max) = root.map_or((Vec3::ZERO, Vec3::ONE), |root| (root.min, root.max));
    (max - min).length() + (eye - 0.5 * (min + max)).length()
}

impl Lit {
    fn ray(&mut self, ray: &TracedRay, eye: Vec3, far: f32) {
        let end = |t: f32| {
            let t = if t.is_finite() {
                t
            } else {
                far / ray.direction.length()
            };
            ray.at(t)
        };
        let (start, stop) = (ray.at(ray.after), end(ray.t));
        if !(start.is_finite() && stop.is_finite()) {
            return;
        }
        self.thick.push(Line::new(start, stop, CHOSEN));
        if ray.end == RayEnd::Blocked {
            let goal = end(ray.t_max);
            if goal.is_finite() {
                self.thin.push(Line::new(stop, goal, CHOSEN));
            }
        }
        let arm = CROSS * stop.distance(eye);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let (from, to) = (stop - axis * arm, stop + axis * arm);
            self.thick.push(Line::new(from, to, CHOSEN));
        }
    }

    /// A node's box, those of its children, and what it holds.
    fn node(&mut self, world: &World, instance: Option<u32>, node: u32) {
        let Some(view) = TreeView::of(world, instance) else {
            return;
        };
        let Some(here) = view.tree.nodes.get(node as usize) else {
            return;
        };
        edges(&mut self.thick, &view.corners(node), CHOSEN);
        if !here.is_leaf() {
            for child in [here.first_index, here.first_index + 1] {
                edges(&mut self.thin, &view.corners(child), CHILD);
            }
        }
        for (instance, triangle) in triangles_below(&view, node, MOST_TRIANGLES) {
            outline(&mut self.thin, world, instance, triangle, TRIANGLE);
        }
    }

    /// The box that a step is about, and those that are put off.
    fn step(&mut self, world: &World, stepper: &Stepper) {
        let Some(step) = stepper.step() else {
            return;
        };
        for ((instance, node), mark) in stepper.stack() {
            if let Some(view) = TreeView::of(world, instance).filter(|v| has(v, node)) {
                let color = if mark.is_pruned { PRUNED } else { WAITING };
                edges(&mut self.thin, &view.corners(node), color);
            }
        }
        let color = match step.kind {
            StepKind::Entered | StepKind::Hit | StepKind::NotHit => ENTERED,
            StepKind::Missed => MISSED,
            StepKind::Pruned => PRUNED,
        };
        if let Some(view) = TreeView::of(world, step.instance).filter(|v| has(v, step.node)) {
            edges(&mut self.thick, &view.corners(step.node), color);
        }
        if let Some([instance, triangle]) = step.triangle {
            let color = match step.kind {
                StepKind::Hit => TRIANGLE,
                _ => MISSED,
            };
            outline(&mut self.thick, world, instance, triangle, color);
        }
    }
}

fn has(view: &TreeView, node: u32) -> bool {
    (node as usize) < view.tree.nodes.len()
}

/// The triangles in and below a node, as (instance, triangle), no more than `most`.
fn triangles_below(view: &TreeView, node: u32, most: usize) -> Vec<(u32, u32)> {
    let mut triangles = Vec::new();
    if primitives_below(view.tree, node as usize).len() > most {
        return triangles;
    }
    let mut open = vec![node];
    while let Some(node) = open.pop() {
        let here = &view.tree.nodes[node as usize];
        if here.is_leaf() {
            triangles.extend(view.triangles(node));
        } else {
            open.extend([here.first_index, here.first_index + 1]);
        }
    }
    triangles
}

fn outline(lines: &mut Vec<Line>, world: &World, instance: u32, triangle: u32, color: LinearRgba) {
    let Some(corners) = triangle_in_world(world, instance, triangle) else {
        return;
    };
    for i in 0..3 {
        lines.push(Line::new(corners[i], corners[(i + 1) % 3], color));
    }
}

/// The twelve edges of a box, its corners numbered by the bits x, y, z.
fn edges(lines: &mut Vec<Line>, corners: &[Vec3; 8], color: LinearRgba) {
    for axis in 0..3 {
        for corner in (0..8).filter(|corner| corner >> axis & 1 == 0) {
            lines.push(Line::new(
                corners[corner],
                corners[corner | 1 << axis],
                color,
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::Bench;
    use super::*;
    use crate::sync::Traced;

    #[test]
    fn a_chosen_ray_is_a_line_from_where_it_starts_to_where_it_ends() {
        let mut bench = Bench::open("cornell-box");
        bench.shoot([300, 240]);
        let rays = bench.ray().rays().unwrap().clone();
        for ray in &rays.rays {
            let mut lit = Lit::default();
            lit.ray(ray, Vec3::ZERO, 10.0);
            let [from, to] = lit.thick[0].ends;
            assert_eq!(from, ray.at(ray.after));
            if ray.end != RayEnd::Background {
                assert_eq!(to, ray.at(ray.t));
            }
            assert!(lit.thick.iter().all(|line| line.colors == [CHOSEN; 2]));
        }
    }

    #[test]
    fn a_node_is_drawn_with_its_children_and_the_triangles_below_it() {
        let bench = Bench::open("cornell-box");
        let world = &bench.app.world().resource::<Traced>().world;
        let instance = 0;
        let triangles = world.aggregate.instances()[0].mesh.triangles().len();
        let mut lit = Lit::default();
        lit.node(world, Some(instance), 0);
        assert_eq!(lit.thick.len(), 12);
        let inner = !TreeView::of(world, Some(instance)).unwrap().tree.nodes[0].is_leaf();
        let boxes = if inner { 24 } else { 0 };
        assert_eq!(lit.thin.len(), boxes + 3 * triangles);
        // One that is gone draws nothing.
        let mut lit = Lit::default();
        lit.node(world, Some(instance), u32::MAX);
        lit.node(world, Some(u32::MAX), 0);
        assert!(lit == Lit::default());
    }
}
