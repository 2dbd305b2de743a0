//! The tab BVH: builders compared and timed, and two trees at once.

use super::super::inspector::{Inspector, Tab};
use super::desk::{Desk, USUAL};
use crate::bvh::Builder;
use crate::editor::action::Action;
use crate::editor::document::adopt;
use crate::editor::history::History;
use crate::editor::inspection::{DebugRay, Inspected, Which};
use crate::editor::trees::BoxRanges;
use crate::editor::trees::measure::{BUILDERS, Measurements, Stale};
use crate::editor::trees::pair::{SideState, TreePair};
use crate::editor::viewport::{Viewport, traced_view_mut};
use crate::inspect::{
    BoxChoice, BoxRange, BuilderFigures, InspectPreset, InspectSettings, Names, compare_builders,
};
use crate::io::{OpenOptions, SceneSource, builtin, open};
use crate::scene::{self, RenderSettings, SceneId};
use crate::sync::{Traced, TracedCameras};
use crate::view::TracedView;
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy::transform::components::Transform;
use bevy_egui::egui::vec2;
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

const COMPARE: &str = "Compare the builders";

impl Desk {
    /// With all trees built.
    pub(super) fn with_trees(scene: &str) -> Self {
        let mut desk = Self::open(scene);
        desk.until("built", |world| {
            let traced = world.resource::<Traced>();
            traced.pending == 0 && !traced.world.objects.is_empty()
        });
        desk
    }

    fn in_tab_bvh(scene: &str) -> Self {
        let mut desk = Self::with_trees(scene);
        desk.world().resource_mut::<Inspector>().tab = Tab::Bvh;
        desk.settle();
        desk
    }

    /// Frames until something is so.
    fn until(&mut self, what: &str, so: impl Fn(&mut World) -> bool) {
        let start = Instant::now();
        while !so(self.world()) {
            assert!(start.elapsed() < Duration::from_secs(120), "never {what}");
            sleep(Duration::from_millis(5));
            self.frame(Vec::new());
        }
        self.settle();
    }

    fn until_measured(&mut self) {
        self.until("measured", |world| {
            !world.resource::<Measurements>().running()
        });
    }

    fn compared(&mut self) -> Option<Vec<BuilderFigures>> {
        let all = self.world().resource::<Measurements>();
        all.comparison.done().cloned()
    }

    fn stale(&mut self) -> Option<Stale> {
        let world = self.world();
        world.resource_scope(|world, all: bevy::prelude::Mut<Measurements>| {
            all.comparison.stale(world)
        })
    }

    fn paused(&mut self) -> bool {
        let mut views = self.world().query::<&TracedView>();
        views.single(self.app.world()).unwrap().paused
    }
}

/// All that does not depend on how fast the machine is.
fn without_times(mut rows: Vec<BuilderFigures>) -> Vec<BuilderFigures> {
    for row in &mut rows {
        row.build_ms = 0.0;
        row.rates = None;
    }
    rows
}

#[test]
fn comparing_runs_beside_the_frames_and_gives_the_figures_of_the_command_line() {
    let mut desk = Desk::in_tab_bvh("head");
    desk.click_on(COMPARE);
    assert!(desk.find(COMPARE).is_none() || desk.compared().is_some());
    desk.until_measured();
    let rows = desk.compared().expect("it was compared");
    let traced = desk.world().resource::<Traced>().world.clone();
    let camera = desk.world().resource::<TracedCameras>().0[0].camera.clone();
    let settings = desk.world().resource::<RenderSettings>().clone();
    let theirs = compare_builders(&traced, &BUILDERS, Some((&camera, &settings)));
    for row in &rows {
        let rates = row.rates.expect("the camera has rays");
        assert!(rates.closest_mrays_per_s.is_some_and(|rate| rate > 0.0));
    }
    assert_eq!(without_times(rows), without_times(theirs));
    assert_eq!(desk.stale(), None);
    assert!(!desk.paused(), "the view goes on");
    for name in ["None", "Median", "SAH", "PLOC", "SAH cost"] {
        assert!(desk.find(name).is_some(), "{name} is not in the table");
    }
}

#[test]
fn a_click_on_a_builder_switches_to_it_as_a_step_and_makes_nothing_stale() {
    let mut desk = Desk::in_tab_bvh("head");
    desk.click_on(COMPARE);
    desk.until_measured();
    let steps = desk.world().resource::<History>().position();
    let builder = |desk: &mut Desk| desk.world().resource::<RenderSettings>().tree.builder;
    assert_eq!(builder(&mut desk), scene::Builder::Sah);
    desk.click_on("PLOC");
    assert_eq!(builder(&mut desk), scene::Builder::Ploc);
    desk.until("rebuilt", |world| {
        let traced = world.resource::<Traced>();
        traced.pending == 0 && traced.world.aggregate.options().builder == Builder::Ploc
    });
    assert_eq!(desk.stale(), None);
    assert_eq!(desk.world().resource::<History>().position(), steps + 1);
    desk.world().write_message(Action::run("edit.undo"));
    desk.settle();
    assert_eq!(builder(&mut desk), scene::Builder::Sah);
    // Other leaves are other trees.
    desk.world()
        .resource_mut::<RenderSettings>()
        .tree
        .max_leaf_size = 2;
    desk.until("rebuilt", |world| {
        let traced = world.resource::<Traced>();
        traced.pending == 0 && traced.world.aggregate.options().max_leaf_size == 2
    });
    assert_eq!(desk.stale(), Some(Stale::Trees));
    assert!(desk.find(Stale::Trees.text()).is_some());
}

#[test]
fn figures_of_a_scene_that_changed_say_so() {
    let mut desk = Desk::in_tab_bvh("triangle");
    desk.click_on(COMPARE);
    desk.until_measured();
    assert_eq!(desk.stale(), None);
    let mut objects = desk
        .world()
        .query_filtered::<&mut Transform, With<bevy::mesh::Mesh3d>>();
    for mut transform in objects.iter_mut(desk.app.world_mut()) {
        transform.translation.x += 0.25;
    }
    desk.settle();
    assert_eq!(desk.stale(), Some(Stale::Scene));
    assert!(desk.find(Stale::Scene.text()).is_some());
}

#[test]
fn a_tree_of_one_leaf_has_figures_and_no_histogram() {
    let mut desk = Desk::in_tab_bvh("triangle");
    desk.click_on(COMPARE);
    desk.until_measured();
    let rows = desk.compared().unwrap();
    assert!(rows.iter().all(|row| (row.nodes, row.leaves) == (1, 1)));
    // So high that nothing of the tab is scrolled out of sight.
    desk.size[1] = 1600.0;
    desk.settle();
    let said = "No builder parts these triangles: every tree is one leaf.";
    assert!(desk.find(said).is_some());
}

#[test]
fn what_is_cancelled_leaves_what_was_measured_and_lets_the_view_go_on() {
    let mut desk = Desk::in_tab_bvh("knot");
    desk.click_on(COMPARE);
    assert!(desk.paused(), "the view waits");
    desk.click_on("Cancel");
    desk.settle();
    assert!(!desk.world().resource::<Measurements>().running());
    assert_eq!(desk.compared(), None);
    assert!(!desk.paused(), "the view goes on");
    let said = "Cancelled: nothing new was measured.";
    assert!(desk.find(said).is_some() && desk.find(COMPARE).is_some());
}

#[test]
fn another_scene_waits_neither_for_what_was_measured_of_the_last_nor_for_its_pause() {
    let mut desk = Desk::in_tab_bvh("knot");
    let open_head = |desk: &mut Desk| {
        let source = SceneSource::Builtin(builtin::find("head").unwrap());
        open(desk.world(), &source, OpenOptions::default()).unwrap();
        adopt(desk.world(), "head", None);
        desk.settle();
    };
    desk.click_on(COMPARE);
    assert!(desk.paused(), "the view waits");
    open_head(&mut desk);
    assert!(!desk.world().resource::<Measurements>().running());
    assert!(!desk.paused(), "the view goes on");
    traced_view_mut(desk.world()).unwrap().paused = true;
    open_head(&mut desk);
    assert!(!desk.paused(), "the picture is the new scene's");
}

#[test]
fn an_empty_scene_has_nothing_to_measure_and_says_so() {
    let mut desk = Desk::empty(USUAL);
    desk.world().resource_mut::<Inspector>().tab = Tab::Bvh;
    desk.settle();
    desk.click_on(COMPARE);
    let no_view = "There is no view to measure: show the traced view, or add a camera.";
    assert!(desk.find(no_view).is_some());
    desk.world()
        .spawn((SceneId(1), crate::scene::SceneCamera::default()));
    desk.settle();
    desk.click_on(COMPARE);
    let nothing = "There is nothing to measure: the scene has no triangles that are traced.";
    assert!(desk.find(nothing).is_some());
    assert!(!desk.world().resource::<Measurements>().running());
}

#[test]
fn the_performance_test_times_every_builder_as_often_as_asked() {
    let mut desk = Desk::with_trees("cornell-box");
    desk.world().resource_mut::<RenderSettings>().size = bevy::math::UVec2::new(16, 12);
    desk.settle();
    crate::editor::trees::measure::test_performance(desk.world(), 3, 2);
    desk.until_measured();
    let all = desk.world().resource::<Measurements>();
    let done = all.performance.done().expect("it was measured").clone();
    assert_eq!(done.columns.len(), 4);
    assert!(
        done.columns
            .iter()
            .all(|column| column.render_ms.len() == 3)
    );
    assert_eq!((done.size.x, done.size.y), (16, 12));
    let rays = done.columns[0].rays;
    assert!(rays >= 16 * 12 * 2);
    assert!(done.columns.iter().all(|column| column.rays == rays));
    let levels: Vec<u32> = done.columns.iter().map(|column| column.levels).collect();
    assert!(
        levels[1] > 0 && levels[2] > 0 && levels[3] > 0,
        "{levels:?}"
    );
}

#[test]
fn of_two_trees_the_one_that_is_traced_is_not_built_again() {
    let mut desk = Desk::with_trees("head");
    let traced = desk.world().resource::<Traced>().world.clone();
    desk.world().resource_mut::<InspectSettings>().pair.on = true;
    desk.settle();
    let of = |desk: &mut Desk| {
        let pair = desk.world().resource::<TreePair>();
        [pair.sides[0].state(), pair.sides[1].state()]
    };
    assert_eq!(of(&mut desk)[1], SideState::Traced);
    desk.until("built", |world| {
        world.resource::<TreePair>().sides[0].state() == SideState::Built
    });
    let pair = desk.world().resource::<TreePair>();
    let [left, right] = &pair.sides;
    assert!(std::sync::Arc::ptr_eq(right.world().unwrap(), &traced));
    let options = left.world().unwrap().aggregate.options();
    assert_eq!(options.builder, Builder::Median);
    assert!(std::sync::Arc::ptr_eq(
        &desk.world().resource::<Traced>().world,
        &traced
    ));
    assert!(desk.find("Median: to look at, not traced").is_some());
    assert!(desk.find("SAH: these trees are traced").is_some());
    desk.world().resource_mut::<InspectSettings>().on = false;
    desk.settle();
    assert!(desk.find("SAH: these trees are traced").is_none());
    assert!(
        desk.world().resource::<TreePair>().sides[0]
            .world()
            .is_none()
    );
}

#[test]
fn the_list_has_every_tree_the_largest_first_and_goes_to_boxes_and_root_of_the_chosen_one() {
    let mut desk = Desk::in_tab_bvh("head");
    desk.size[1] = 1800.0;
    desk.settle();
    let traced = desk.world().resource::<Traced>().world.clone();
    let largest = traced
        .objects
        .iter()
        .max_by_key(|object| object.mesh.tree.traced());
    let largest = largest.unwrap();
    let name = desk.world().resource::<Names>().of(largest.id);
    let objects = traced.objects.len() as u64;
    let over = format!("Over {}", crate::editor::texts::counted(objects, "object"));
    // The list of entities has the name too.
    let rect = desk.world().resource::<Viewport>().rect;
    let row = desk.place_of(&over) + vec2(0.0, 20.0);
    assert!(row.x > rect.max.x);
    desk.click(row);
    desk.settle();
    let figure = crate::editor::texts::grouped(largest.mesh.tree.stats().nodes as u64);
    desk.place_beside("Nodes", &figure);
    desk.click_on("Draw its boxes");
    let boxes = &desk.world().resource::<InspectSettings>().boxes;
    assert!(boxes.on && boxes.object == largest.id, "{name}");
    desk.click_on("Its root");
    desk.settle();
    let inspected = desk.world().resource::<Inspected>();
    let node = inspected.node().expect("its root is chosen");
    let object = &node.world.objects[node.instance.unwrap() as usize];
    assert_eq!((node.node, object.id), (0, largest.id));
    for said in ["Node 0", "size", "Frame it"] {
        desk.place_of(said);
    }
}

#[test]
fn a_and_s_step_through_the_leaves_and_stop_at_the_ends() {
    let mut desk = Desk::with_trees("head");
    let leaf = |desk: &mut Desk| desk.world().resource::<InspectSettings>().boxes.leaf;
    let step = |desk: &mut Desk, action: Action| {
        desk.world().write_message(action);
        desk.settle();
        leaf(desk)
    };
    // Boxes are not drawn.
    assert_eq!(step(&mut desk, Action::run("boxes.next-leaf")), 0);
    let boxes = &mut desk.world().resource_mut::<InspectSettings>().boxes;
    (boxes.on, boxes.choice) = (true, BoxChoice::Leaf);
    let boxes = boxes.clone();
    assert_eq!(step(&mut desk, Action::run("boxes.next-leaf")), 1);
    assert_eq!(step(&mut desk, Action::run("boxes.previous-leaf")), 0);
    assert_eq!(step(&mut desk, Action::run("boxes.previous-leaf")), 0);
    let traced = desk.world().resource::<Traced>().world.clone();
    let last = BoxRange::of(&traced, &boxes).leaves as u32 - 1;
    assert!(last > 100, "{last}");
    desk.world().resource_mut::<InspectSettings>().boxes.leaf = last;
    assert_eq!(step(&mut desk, Action::run("boxes.next-leaf")), last);
}

#[test]
fn each_question_sets_its_lines_and_the_master_switch_keeps_them() {
    let mut desk = Desk::open("triangle");
    desk.world().resource_mut::<InspectSettings>().max_lines = 1234;
    let ids = ["lines.why-black", "lines.is-tree-good", "lines.noise"];
    for (preset, id) in InspectPreset::ALL.into_iter().zip(ids) {
        desk.world().write_message(Action::run(id));
        desk.settle();
        let wanted = InspectSettings {
            max_lines: 1234,
            ..preset.settings()
        };
        assert_eq!(*desk.world().resource::<InspectSettings>(), wanted);
        // Noise is what samples differ in, and so all of them are asked for.
        let which = match preset {
            InspectPreset::WhereIsTheNoiseFrom => Which::All,
            _ => Which::First,
        };
        assert_eq!(desk.world().resource::<DebugRay>().which, which, "{id}");
        assert!(desk.find(preset.says()).is_some(), "{}", preset.title());
        desk.world().write_message(Action::run("lines.show"));
        desk.settle();
        let off = desk.world().resource::<InspectSettings>().clone();
        assert_eq!(
            off,
            InspectSettings {
                on: false,
                ..wanted
            }
        );
    }
}

#[test]
fn nothing_holds_the_world_of_a_scene_after_another_was_opened_and_figures_say_that_they_are_of_it()
{
    let mut desk = Desk::in_tab_bvh("cornell-box");
    adopt(desk.world(), "cornell-box", None);
    desk.click_on(COMPARE);
    desk.until_measured();
    assert_eq!(desk.stale(), None);
    let traced = desk.world().resource::<Traced>().world.clone();
    let boxes = desk.world().resource::<InspectSettings>().boxes.clone();
    let mut ranges = desk.world().resource_mut::<BoxRanges>();
    ranges.of(&traced, &boxes);
    let world = Arc::downgrade(&traced);
    drop(traced);
    // Where nothing of them is drawn, they learn nothing of the new scene.
    desk.world().resource_mut::<Inspector>().tab = Tab::Object;
    desk.settle();
    assert!(world.strong_count() > 0);
    desk.world().write_message(Action::Open("triangle".into()));
    desk.until("let go", move |_| world.strong_count() == 0);
    assert_eq!(desk.stale(), Some(Stale::Scene));
}
