//! The builders compared: each one's tree over the scene in numbers and histograms, side by side.

use super::super::save_form::{SaveForm, TABLES, is_csv, save_ui};
use super::super::says::{Says, name_control};
use super::figure_table::{Better, Column, Figure, color, figure_table_ui};
use super::measuring::measure_ui;
use super::still_plot::still_plot;
use crate::bvh::{Builder, LARGEST_LEAF_BIN};
use crate::editor::trees::builder_title;
use crate::editor::trees::measure::{BUILDERS, Measurements, compare};
use crate::inspect::{BuilderFigures, builder_name, csv, markdown};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy_egui::egui::{Label, RichText, Ui};
use egui_plot::{Line, PlotPoints};

/// What the panel keeps of it.
#[derive(Resource, Default)]
pub(in super::super) struct Builders {
    save: SaveForm,
}

pub(super) fn builders_ui(ui: &mut Ui, world: &mut World, form: &mut Builders) {
    let about = "The tree figures are of one tree over all triangles; the ray rates use the scene's own \
                 trees and this view's rays.";
    ui.add(Label::new(RichText::new(about).weak()).wrap());
    let start = measure_ui(
        ui,
        world,
        "Compare the builders",
        "Builds and measures in the background; the traced view waits meanwhile",
        |all| &mut all.comparison,
    );
    if start {
        compare(world);
    }
    let rows = world.resource::<Measurements>().comparison.done().cloned();
    let Some(rows) = rows else { return };
    // What a builder that does nothing saves is no merit.
    let column = |row| Some((builder_of(row)?, row, row.builder != "none"));
    let columns: Vec<Column<BuilderFigures>> = rows.iter().filter_map(column).collect();
    figure_table_ui(ui, world, "builders", &columns, FIGURES);
    ui.add_space(4.0);
    histogram_ui(
        ui,
        "leaves by size",
        "% of leaves by their triangles",
        &rows,
        |row| &row.leaf_sizes,
    );
    histogram_ui(
        ui,
        "leaves by depth",
        "% of leaves by their depth",
        &rows,
        |row| &row.depths,
    );
    save_ui(ui, world, &mut form.save, ("builders.md", TABLES), |file| {
        let text = match is_csv(file)? {
            true => csv(&rows),
            false => markdown(&rows),
        };
        Ok(text.into_bytes())
    });
}

fn builder_of(row: &BuilderFigures) -> Option<Builder> {
    let mut all = BUILDERS.into_iter();
    all.find(|&builder| builder_name(builder) == row.builder)
}

/// A row for each.
const FIGURES: &[Figure<BuilderFigures>] = &[
    (
        "Levels",
        "The depth of the deepest leaf; the root's is 0",
        |row| Some(f64::from(row.levels)),
        Better::Neither,
    ),
    (
        "Nodes",
        "Leaves included",
        |row| Some(row.nodes as f64),
        Better::Neither,
    ),
    (
        "Leaves",
        "Nodes that hold triangles",
        |row| Some(row.leaves as f64),
        Better::Neither,
    ),
    (
        "Largest leaf",
        "The most triangles that one leaf holds",
        |row| Some(f64::from(row.largest_leaf)),
        Better::Neither,
    ),
    (
        "SAH cost",
        "Expected cost of a random ray that hits the root's box, from surface areas; lower is better",
        |row| Some(row.sah_cost),
        Better::Less,
    ),
    (
        "EPO",
        "Effective parent overlap: how much of the mesh's surface lies inside boxes of nodes that do \
         not hold it (Aila et al. 2013); lower is better",
        |row| Some(row.epo),
        Better::Less,
    ),
    (
        "kB",
        "Of the tree and of all that tracing keeps of the triangles; 1000 bytes",
        |row| Some(row.bytes as f64 * 1e-3),
        Better::Less,
    ),
    (
        "B / triangle",
        "The same for each triangle, in bytes",
        |row| Some(row.bytes_per_triangle),
        Better::Less,
    ),
    (
        "Built in, ms",
        "Wall clock",
        |row| Some(row.build_ms),
        Better::Less,
    ),
    (
        "Closest, M/s",
        "Million closest hits a second of this view's rays, one thread, with the scene's own levels of trees",
        |row| row.rates?.closest_mrays_per_s,
        Better::More,
    ),
    (
        "Any hit, M/s",
        "Million occlusion tests a second of this view's shadow rays, one thread",
        |row| row.rates?.occlusion_mrays_per_s,
        Better::More,
    ),
    (
        "Wide nodes",
        "Of the form that pictures are traced through: up to sixteen children each",
        |row| Some(row.wide_nodes as f64),
        Better::Neither,
    ),
    (
        "Children, of 16",
        "Of a wide node on average: how well it is filled",
        |row| Some(row.children_per_wide_node),
        Better::More,
    ),
    (
        "Triangles, of 8",
        "Of a block of triangles that are tested at once, on average: how well it is filled",
        |row| Some(row.triangles_per_block),
        Better::More,
    ),
];

/// The share of each builder's leaves, a line each. A tree that is one leaf has none to share.
fn histogram_ui(
    ui: &mut Ui,
    id: &str,
    title: &str,
    rows: &[BuilderFigures],
    bins: fn(&BuilderFigures) -> &Vec<u32>,
) {
    let lines: Vec<Line> = rows
        .iter()
        .filter(|row| row.leaves > 1)
        .filter_map(|row| {
            let builder = builder_of(row)?;
            let color = color(ui, builder);
            let points = share(bins(row));
            let line = Line::new(builder_title(builder), PlotPoints::from(points));
            Some(line.color(color).width(1.5))
        })
        .collect();
    if lines.is_empty() {
        ui.weak("No builder parts these triangles: every tree is one leaf.");
        return;
    }
    ui.weak(title).says(
        "A line for each builder, in the colour of its heading; a tree that is one leaf is left out",
    );
    let shown = still_plot(id, 90.0)
        .include_y(0.0)
        .label_formatter(|name, at| {
            let bin = at.x.round();
            let more = if bin as usize >= LARGEST_LEAF_BIN {
                " or more"
            } else {
                ""
            };
            format!("{name} {bin}{more}: {:.1} %", at.y)
        })
        .show(ui, |plot| {
            for line in lines {
                plot.line(line);
            }
        });
    name_control(&shown.response, title);
}

/// Percent of the leaves in each bin from the first to the last that has any, with an empty one on
/// either side.
fn share(bins: &[u32]) -> Vec<[f64; 2]> {
    let sum: u64 = bins.iter().map(|&count| u64::from(count)).sum();
    let first = bins.iter().position(|&count| count > 0).unwrap_or(0);
    let last = bins.iter().rposition(|&count| count > 0).unwrap_or(0);
    (first.saturating_sub(1)..=last + 1)
        .map(|bin| {
            let count = bins.get(bin).copied().unwrap_or(0);
            [bin as f64, 100.0 * f64::from(count) / sum.max(1) as f64]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_to_all_leaves() {
        let shares = share(&[0, 0, 0, 1, 0, 3]);
        assert_eq!(shares[0], [2.0, 0.0]);
        assert_eq!(shares[1], [3.0, 25.0]);
        assert_eq!(shares[3], [5.0, 75.0]);
        assert_eq!(*shares.last().unwrap(), [6.0, 0.0]);
        assert_eq!(share(&[]), [[0.0, 0.0], [1.0, 0.0]]);
    }
}
