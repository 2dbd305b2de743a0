//! The tab BVH: how the trees are built, the builders against each other, and what the trees that are
//! traced are like.

use super::super::fields::{properties_ui, section};
use super::super::says::{Says, name_control};
use super::super::state::with;
use super::super::status::memory_text;
use super::super::theme::accent;
use super::builders::builders_ui;
use super::pair::pair_ui;
use super::performance::performance_ui;
use super::still_plot::still_plot;
use crate::bvh::{LARGEST_LEAF_BIN, MeshTree, TreeStats};
use crate::editor::inspection::Inspected;
use crate::editor::inspection::choice::Node;
use crate::editor::selection::Selection;
use crate::editor::texts::{counted, grouped};
use crate::inspect::{InspectSettings, Names, TreeChoice, plural};
use crate::scene::{Property, RenderSettings, SceneId, TreeSettings};
use crate::sync::Traced;
use crate::trace;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::{Mut, World};
use bevy::platform::collections::HashMap;
use bevy::reflect::Typed;
use bevy_egui::egui::{Button, Grid, RichText, ScrollArea, Ui, vec2};
use egui_plot::{Bar, BarChart};
use std::sync::Arc;
use std::time::Duration;

/// The settings that this tab shows.
pub(super) const SETTINGS_OF_TREES: &[&str] = &[
    "tree.builder",
    "tree.levels",
    "tree.max_depth",
    "tree.max_leaf_size",
    "tree.bins",
    "tree.preset",
];

/// Points of a row of the list of trees, and how many are seen at once.
const ROW: f32 = 20.0;
const ROWS: usize = 7;

/// One of the trees that are traced.
struct Tree {
    name: String,
    /// The first object whose mesh has it, by its place in the world and its `SceneId`; `None` for the top tree.
    of: Option<(u32, u64)>,
    /// Of a mesh. Held, so that no other takes its place in memory while the figures are kept.
    mesh: Option<Arc<MeshTree>>,
    stats: TreeStats,
    build_time: Duration,
    /// What its leaves hold, one of them, and how many there are.
    primitive: &'static str,
    count: u64,
}

/// The trees of a traced world, looked at once for each world, and those of meshes once at all.
#[derive(Resource, Default)]
pub(in super::super) struct Trees {
    /// The world, and the version of the names.
    of: Option<(Arc<trace::World>, u64)>,
    trees: Vec<Tree>,
    shown: usize,
    /// What was selected when the list went to its tree.
    followed: Option<SceneId>,
}

impl Trees {
    fn update(&mut self, world: &Arc<trace::World>, names: &Names) {
        let known = self.of.as_ref();
        if known.is_some_and(|(of, named)| Arc::ptr_eq(of, world) && *named == names.version) {
            return;
        }
        self.of = Some((world.clone(), names.version));
        let before = std::mem::take(&mut self.trees).into_iter();
        let of_mesh = |tree: Tree| Some((tree.mesh.as_ref().map(Arc::as_ptr)?, tree));
        let mut before: HashMap<*const MeshTree, Tree> = before.filter_map(of_mesh).collect();
        let aggregate = &world.aggregate;
        let one = aggregate.options().levels == crate::bvh::Levels::One;
        self.trees = vec![Tree {
            name: match one {
                true => "All triangles".into(),
                false => {
                    let objects = aggregate.instances().len() as u64;
                    format!("Over {}", counted(objects, "object"))
                }
            },
            of: None,
            mesh: None,
            stats: aggregate.stats(),
            build_time: aggregate.build_time(),
            primitive: if one { "triangle" } else { "object" },
            count: aggregate.tree().primitive_indices.len() as u64,
        }];
        if !one {
            // The first object of each mesh, and how many have it.
            let mut meshes: HashMap<*const MeshTree, (usize, u64)> = HashMap::default();
            for (place, object) in world.objects.iter().enumerate() {
                let found = meshes.entry(Arc::as_ptr(&object.mesh.tree));
                found.or_insert((place, 0)).1 += 1;
            }
            let mut meshes: Vec<(usize, u64)> = meshes.into_values().collect();
            let traced = |place: usize| world.objects[place].mesh.tree.traced();
            meshes.sort_unstable_by_key(|(place, _)| (std::cmp::Reverse(traced(*place)), *place));
            self.trees.extend(meshes.into_iter().map(|(place, users)| {
                let object = &world.objects[place];
                let tree = &object.mesh.tree;
                let name = names.of(object.id);
                Tree {
                    name: match users - 1 {
                        0 => name,
                        more => format!("{name} and {more} more"),
                    },
                    of: Some((place as u32, object.id)),
                    mesh: Some(tree.clone()),
                    stats: match before.remove(&Arc::as_ptr(tree)) {
                        Some(known) => known.stats,
                        None => tree.stats(),
                    },
                    build_time: tree.build_time(),
                    primitive: "triangle",
                    count: tree.traced() as u64,
                }
            }));
        }
        self.shown = self.shown.min(self.trees.len().saturating_sub(1));
    }

    /// Goes to the tree of what was selected since. Returns whether it went anywhere.
    fn follow(&mut self, world: &trace::World, selected: Option<SceneId>) -> bool {
        if self.followed == selected {
            return false;
        }
        self.followed = selected;
        let object = selected.and_then(|id| world.objects.iter().find(|known| known.id == id.0));
        let found = object.and_then(|object| {
            let is_its = |tree: &Tree| {
                (tree.mesh.as_ref()).is_some_and(|mesh| Arc::ptr_eq(mesh, &object.mesh.tree))
            };
            self.trees.iter().position(is_its)
        });
        if let Some(found) = found {
            self.shown = found;
        }
        found.is_some()
    }

    /// Keeps nothing but which one is shown.
    fn forget(&mut self) {
        self.of = None;
        self.trees.clear();
    }
}

pub(super) fn bvh_ui(ui: &mut Ui, world: &mut World) {
    let before = world.resource::<RenderSettings>().clone();
    let mut settings = before.clone();
    section(ui, "Building", true, |ui| {
        let paths = shown_settings(&settings);
        properties_ui(ui, &mut settings, &paths);
        ui.horizontal(|ui| {
            let says = "Two levels, binned SAH: quick to trace";
            if ui.button("Default").says(says).clicked() {
                settings.tree = TreeSettings::default();
            }
            let says = "One tree, median split, at most ten levels: a simple textbook BVH, to compare with";
            if ui.button("Simple").says(says).clicked() {
                settings.tree = TreeSettings::SIMPLE;
            }
        });
    });
    if settings != before {
        *world.resource_mut::<RenderSettings>() = settings;
    }
    section(ui, "Builders compared", true, |ui| {
        with(world, |world, form| builders_ui(ui, world, form));
    });
    section(ui, "Two trees side by side", true, |ui| pair_ui(ui, world));
    section(ui, "Performance test", false, |ui| {
        with(world, |world, form| performance_ui(ui, world, form));
    });
    let traced = world.resource::<Traced>().world.clone();
    world.resource_scope(|world, mut trees: Mut<Trees>| {
        let mut is_open = false;
        section(ui, "Trees that are traced", true, |ui| {
            is_open = true;
            trees.update(&traced, world.get_resource().unwrap_or(&Names::default()));
            let selection = world.get_resource::<Selection>();
            let went = trees.follow(&traced, selection.and_then(Selection::active));
            list_ui(ui, &mut trees, went);
            ways_ui(ui, world, &traced, &trees);
            figures_ui(ui, &trees);
        });
        if !is_open {
            trees.forget();
        }
    });
}

/// Those settings that the builder reads.
fn shown_settings(settings: &RenderSettings) -> Vec<&'static str> {
    let is_read = |path: &&str| {
        Property::of(RenderSettings::type_info(), path)
            .is_some_and(|property| property.is_read(settings))
    };
    SETTINGS_OF_TREES.iter().copied().filter(is_read).collect()
}

/// A row for each tree: whose it is, what it holds, what a ray pays in it. Only those that are seen are laid out; the one
/// whose figures are shown is among them where it `went` there.
fn list_ui(ui: &mut Ui, trees: &mut Trees, went: bool) {
    ui.spacing_mut().item_spacing.y = 0.0;
    let rows = trees.trees.len();
    let mut area = ScrollArea::vertical()
        .id_salt("list of trees")
        .max_height(ROW * rows.min(ROWS) as f32)
        .auto_shrink([false, true]);
    if went {
        let before = trees.shown.saturating_sub(ROWS / 2);
        area = area.vertical_scroll_offset(ROW * before as f32);
    }
    area.show_rows(ui, ROW, rows, |ui, range| {
            for at in range {
                let tree = &trees.trees[at];
                let holds = counted(tree.count, tree.primitive);
                let figures = format!("{holds}, SAH {:.1}", tree.stats.sah_cost);
                let row = Button::selectable(trees.shown == at, &tree.name)
                    .truncate()
                    .right_text(RichText::new(figures).small());
                let row = ui.add_sized(vec2(ui.available_width(), ROW), row);
                let says = "Whose tree it is, the largest first; triangles, and the SAH cost: a click shows its figures, and so does selecting an object";
                if row.says(says).clicked() {
                    trees.shown = at;
                }
            }
        });
    ui.add_space(4.0);
}

/// What can be done with the tree whose figures are shown.
fn ways_ui(ui: &mut Ui, world: &mut World, traced: &Arc<trace::World>, trees: &Trees) {
    let Some(tree) = trees.trees.get(trees.shown) else {
        return;
    };
    ui.horizontal(|ui| {
        let root = ui.add_enabled(tree.stats.nodes > 0, Button::new("Its root").small());
        let says = "Chooses its root in the view: the card there goes on from child to child";
        if root.says(says).clicked()
            && let Some(mut inspected) = world.get_resource_mut::<Inspected>()
        {
            inspected.choose_node(Some(Node {
                world: traced.clone(),
                instance: tree.of.map(|(place, _)| place),
                node: 0,
            }));
        }
        let boxes = ui.small_button("Draw its boxes");
        if boxes
            .says("Draws the boxes of this tree and of no other (Debug, Trees)")
            .clicked()
            && let Some(mut inspect) = world.get_resource_mut::<InspectSettings>()
        {
            let boxes = &mut inspect.boxes;
            boxes.on = true;
            (boxes.object, boxes.trees) = match tree.of {
                Some((_, id)) => (id, TreeChoice::Meshes),
                None => (0, TreeChoice::Top),
            };
            inspect.on = true;
        }
    });
}

fn figures_ui(ui: &mut Ui, trees: &Trees) {
    let Some(tree) = trees.trees.get(trees.shown) else {
        return;
    };
    let stats = &tree.stats;
    Grid::new("figures of the tree")
        .num_columns(2)
        .spacing([16.0, 2.0])
        .show(ui, |ui| {
            for (label, says, value) in [
                (
                    "Levels",
                    "The depth of the deepest leaf; the root's is 0",
                    stats.levels.to_string(),
                ),
                ("Nodes", "Leaves included", grouped(stats.nodes as u64)),
                (
                    "Leaves",
                    "Nodes that hold triangles or objects",
                    grouped(stats.leaves as u64),
                ),
                (
                    "Largest leaf",
                    "The most that one leaf holds",
                    counted(stats.largest_leaf.into(), tree.primitive),
                ),
                (
                    "SAH cost",
                    "Expected cost of a random ray that hits the root's box, from surface areas; lower is better",
                    format!("{:.2}", stats.sah_cost),
                ),
                (
                    "Memory",
                    "Of nodes and indices",
                    memory_text(stats.bytes as u64),
                ),
                (
                    "Built in",
                    "Wall clock",
                    format!("{:.2} ms", tree.build_time.as_secs_f64() * 1e3),
                ),
            ] {
                ui.label(label).says(says);
                ui.label(value).says(says);
                ui.end_row();
            }
        });
    let leaf_axis = format!("{} in a leaf", plural(0, tree.primitive));
    histogram_ui(ui, "leaf sizes", &leaf_axis, &stats.leaf_sizes, true);
    histogram_ui(ui, "depths", "depth of a leaf", &stats.depths, false);
}

/// How many leaves have each number.
fn histogram_ui(ui: &mut Ui, id: &str, axis: &str, counts: &[u32], is_clipped: bool) {
    if counts.is_empty() {
        return;
    }
    ui.add_space(4.0);
    ui.weak(format!("Leaves by {axis}"));
    let color = accent(ui);
    let bars: Vec<Bar> = counts
        .iter()
        .enumerate()
        .filter(|&(_, &count)| count > 0)
        .map(|(number, &count)| {
            Bar::new(number as f64, f64::from(count))
                .width(0.9)
                .fill(color)
        })
        .collect();
    let label = move |bar: &Bar, _: &BarChart| {
        let more = is_clipped && bar.argument as usize >= LARGEST_LEAF_BIN;
        let more = if more { " or more" } else { "" };
        format!(
            "{}{more}: {}",
            bar.argument,
            counted(bar.value as u64, "leaf")
        )
    };
    let shown = still_plot(id, 90.0).include_y(0.0).show(ui, |plot| {
        plot.bar_chart(BarChart::new(axis, bars).element_formatter(Box::new(label)));
    });
    name_control(&shown.response, axis);
}

#[cfg(test)]
mod tests {
    use super::super::{Inspector, Tab};
    use super::*;
    use crate::editor::headless_editor;
    use crate::editor::panels::tests::{Desk, texts};
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use crate::scene::Builder;
    use bevy::ecs::query::With;
    use bevy::mesh::Mesh3d;
    use bevy::transform::components::Transform;

    #[test]
    fn figures_of_a_mesh_are_kept_while_its_objects_move() {
        let mut app = headless_editor();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        let mut trees = Trees::default();
        // Where the numbers of each mesh lie in memory.
        let mut places = Vec::new();
        for _ in 0..2 {
            let world = app.world_mut();
            let mut objects = world.query_filtered::<&mut Transform, With<Mesh3d>>();
            for mut place in objects.iter_mut(world) {
                place.translation.y += 0.125;
            }
            app.update();
            let before = trees.of.clone();
            let world = &app.world().resource::<Traced>().world;
            trees.update(world, &Names::default());
            assert!(before.is_none_or(|(before, _)| !Arc::ptr_eq(&before, world)));
            let of_meshes = trees.trees.iter().filter(|tree| tree.mesh.is_some());
            let stats = of_meshes.map(|tree| tree.stats.depths.as_ptr());
            places.push(stats.collect::<Vec<_>>());
        }
        assert!(!places[0].is_empty());
        assert_eq!(places[0], places[1]);
    }

    #[test]
    fn the_list_goes_to_the_tree_of_what_is_selected_and_stays_where_a_click_went_after_it() {
        let mut app = headless_editor();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        let world = &app.world().resource::<Traced>().world;
        let mut trees = Trees::default();
        trees.update(world, &Names::default());
        assert!(trees.trees.len() > 2);
        for object in world.objects.iter() {
            assert!(trees.follow(world, Some(SceneId(object.id))));
            let shown = trees.trees[trees.shown].mesh.as_ref().unwrap();
            assert!(Arc::ptr_eq(shown, &object.mesh.tree));
        }
        let last = world.objects.last().map(|object| SceneId(object.id));
        trees.shown = 0;
        assert!(!trees.follow(world, last));
        // What has no tree leads nowhere.
        assert!(!trees.follow(world, None));
        assert_eq!(trees.shown, 0);
    }

    #[test]
    fn one_triangle_and_one_object_are_told_in_the_singular() {
        let mut desk = Desk::open("triangle");
        desk.world().resource_mut::<Inspector>().tab = Tab::Bvh;
        desk.settle();
        let begins = |begin: &str| {
            let mut all = texts(&desk).into_iter();
            all.any(|(text, ..)| text.starts_with(begin))
        };
        for [one, many] in [["1 object,", "1 objects"], ["1 triangle,", "1 triangles"]] {
            assert!(begins(one) && !begins(many), "{one}");
        }
    }

    #[test]
    fn a_builder_shows_the_settings_that_it_reads() {
        let shown = |builder| {
            let mut settings = RenderSettings::default();
            settings.tree.builder = builder;
            shown_settings(&settings)
        };
        assert_eq!(shown(Builder::None), ["tree.builder", "tree.levels"]);
        assert!(shown(Builder::Sah).contains(&"tree.bins"));
        assert!(!shown(Builder::Ploc).contains(&"tree.max_depth"));
    }
}
