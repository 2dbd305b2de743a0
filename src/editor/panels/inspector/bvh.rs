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
use crate::editor::texts::{counted, grouped};
use crate::scene::{Property, RenderSettings, TreeSettings};
use crate::sync::Traced;
use crate::trace;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::platform::collections::HashSet;
use bevy::reflect::Typed;
use bevy_egui::egui::{ComboBox, Grid, Ui};
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

/// One of the trees that are traced.
struct Tree {
    name: String,
    /// Of a mesh. Held, so that no other takes its place in memory while the figures are kept.
    mesh: Option<Arc<MeshTree>>,
    stats: TreeStats,
    build_time: Duration,
    /// What its leaves hold.
    primitives: &'static str,
}

/// The trees of a traced world, looked at once for each world, and those of meshes once at all.
#[derive(Resource, Default)]
pub(in super::super) struct Trees {
    of: Option<Arc<trace::World>>,
    trees: Vec<Tree>,
    shown: usize,
}

impl Trees {
    fn update(&mut self, world: &Arc<trace::World>) {
        if self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, world)) {
            return;
        }
        self.of = Some(world.clone());
        let mut before = std::mem::take(&mut self.trees);
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
            mesh: None,
            stats: aggregate.stats(),
            build_time: aggregate.build_time(),
            primitives: if one { "triangles" } else { "objects" },
        }];
        if !one {
            let mut seen = HashSet::new();
            let objects = world.objects.iter();
            let mut meshes: Vec<_> = objects
                .filter(|object| seen.insert(Arc::as_ptr(&object.mesh.tree)))
                .collect();
            meshes.sort_by_key(|object| std::cmp::Reverse(object.mesh.tree.traced()));
            meshes.truncate(50);
            self.trees.extend(meshes.into_iter().map(|object| {
                let tree = &object.mesh.tree;
                let is_known = |known: &Tree| {
                    let mesh = known.mesh.as_ref();
                    mesh.is_some_and(|mesh| Arc::ptr_eq(mesh, tree))
                };
                let known = before.iter().position(is_known);
                Tree {
                    name: format!(
                        "Mesh of object {}, {}",
                        object.id,
                        counted(tree.traced() as u64, "triangle")
                    ),
                    mesh: Some(tree.clone()),
                    stats: match known {
                        Some(at) => before.swap_remove(at).stats,
                        None => tree.stats(),
                    },
                    build_time: tree.build_time(),
                    primitives: "triangles",
                }
            }));
        }
        self.shown = self.shown.min(self.trees.len().saturating_sub(1));
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
            let says = "Two levels, PLOC: quick to trace";
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
    let mut trees = world.resource_mut::<Trees>();
    let mut is_open = false;
    section(ui, "Trees that are traced", true, |ui| {
        is_open = true;
        trees.update(&traced);
        trees_ui(ui, &mut trees);
    });
    if !is_open {
        trees.forget();
    }
}

/// Those settings that the builder reads.
fn shown_settings(settings: &RenderSettings) -> Vec<&'static str> {
    let is_read = |path: &&str| {
        Property::of(RenderSettings::type_info(), path)
            .is_some_and(|property| property.is_read(settings))
    };
    SETTINGS_OF_TREES.iter().copied().filter(is_read).collect()
}

fn trees_ui(ui: &mut Ui, trees: &mut Trees) {
    let name = |tree: &Tree| tree.name.clone();
    let current = trees.trees.get(trees.shown).map_or_else(String::new, name);
    ComboBox::from_id_salt("tree")
        .selected_text(current)
        .width((ui.available_width() - 12.0).max(80.0))
        .truncate()
        .show_ui(ui, |ui| {
            for (i, tree) in trees.trees.iter().enumerate() {
                ui.selectable_value(&mut trees.shown, i, &tree.name);
            }
        })
        .response
        .says("Of which tree the figures are; the largest meshes are listed");
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
                    match stats.largest_leaf {
                        1 => format!("1 {}", tree.primitives.trim_end_matches('s')),
                        n => format!("{} {}", grouped(n.into()), tree.primitives),
                    },
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
    let leaf_axis = format!("{} in a leaf", tree.primitives);
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
        format!("{}{more}: {} leaves", bar.argument, bar.value)
    };
    let shown = still_plot(id, 90.0).include_y(0.0).show(ui, |plot| {
        plot.bar_chart(BarChart::new(axis, bars).element_formatter(Box::new(label)));
    });
    name_control(&shown.response, axis);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;
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
            trees.update(&app.world().resource::<Traced>().world);
            assert!(before.is_none_or(|before| !Arc::ptr_eq(&before, trees.of.as_ref().unwrap())));
            let of_meshes = trees.trees.iter().filter(|tree| tree.mesh.is_some());
            let stats = of_meshes.map(|tree| tree.stats.depths.as_ptr());
            places.push(stats.collect::<Vec<_>>());
        }
        assert!(!places[0].is_empty());
        assert_eq!(places[0], places[1]);
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
