//! The performance test: the view rendered several times with each builder's trees.

use super::super::fields::number_row;
use super::super::save_form::{SaveForm, TABLES, is_csv, save_ui};
use super::super::says::Says;
use super::figure_table::{Cell, Row, figure_table_ui, short};
use super::measuring::{measure_ui, switch_builder};
use crate::bvh::Builder;
use crate::editor::trees::measure::{Measurements, test_performance};
use crate::editor::trees::of_setting;
use crate::report::performance::{Performance, PerformanceColumn};
use crate::scene::{Quantity, RenderSettings};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy_egui::egui::{Label, RichText, Ui};

/// What is entered.
#[derive(Resource)]
pub(in super::super) struct PerformanceForm {
    runs: u32,
    spp: u32,
    save: SaveForm,
}

impl Default for PerformanceForm {
    fn default() -> Self {
        Self {
            runs: 5,
            spp: 1,
            save: SaveForm::default(),
        }
    }
}

pub(super) fn performance_ui(ui: &mut Ui, world: &mut World, form: &mut PerformanceForm) {
    let about = "The view rendered several times with each builder, taking turns.";
    ui.add(Label::new(RichText::new(about).weak()).wrap());
    let says = "Renderings with each builder";
    let many = Quantity::SAMPLES;
    number_row(ui, "Renderings", says, &mut form.runs, many);
    let says = "Of each pixel in a rendering, at least: what the scene's effects need counts too";
    let samples = Quantity::slider(1.0, 4096.0, "").logarithmic();
    number_row(ui, "Samples", says, &mut form.spp, samples);
    let (runs, spp) = (form.runs, form.spp);
    let start = measure_ui(
        ui,
        world,
        "Run the test",
        "Renders in the background on all threads; the traced view waits meanwhile",
        |all| &mut all.performance,
    );
    if start {
        test_performance(world, runs, spp);
    }
    let done = world.resource::<Measurements>().performance.done().cloned();
    let Some(done) = done else { return };
    ui.weak(done.caption());
    let builders: Vec<Builder> = done.columns.iter().map(|column| column.builder).collect();
    let scene = of_setting(world.resource::<RenderSettings>().tree.builder);
    let clicked = figure_table_ui(ui, "performance", &builders, scene, &table(&done));
    if let Some(builder) = clicked {
        switch_builder(world, builder);
    }
    if let Some(why) = done.left_out_text() {
        ui.add(Label::new(RichText::new(format!("{why}.")).weak()).wrap())
            .says("glassbox bench SCENE --with-none measures it all the same");
    }
    save_ui(
        ui,
        world,
        &mut form.save,
        ("performance.md", TABLES),
        |file| {
            let text = match is_csv(file)? {
                true => done.csv(),
                false => done.markdown(),
            };
            Ok(text.into_bytes())
        },
    );
}

fn table(performance: &Performance) -> Vec<Row> {
    type Figure = (
        &'static str,
        &'static str,
        fn(&PerformanceColumn) -> f64,
        fn(f64, String, String) -> Cell,
    );
    let neither = |_, text, exact| Cell::plain(text, exact);
    let figures: [Figure; 9] = [
        (
            "Create, ms",
            "All trees of the scene",
            |column| column.build_ms,
            Cell::less,
        ),
        (
            "Mean, ms",
            "Of a rendering",
            PerformanceColumn::mean,
            Cell::less,
        ),
        (
            "Min, ms",
            "The shortest rendering",
            PerformanceColumn::least,
            Cell::less,
        ),
        (
            "Max, ms",
            "The longest rendering",
            PerformanceColumn::most,
            Cell::less,
        ),
        (
            "Sigma, ms",
            "Standard deviation of one rendering; the mean is uncertain by about this over the root of the \
             number of renderings",
            PerformanceColumn::sigma,
            neither,
        ),
        (
            "Mrays / s",
            "Million rays of every kind a second in the median rendering",
            PerformanceColumn::mrays_per_s,
            Cell::more,
        ),
        (
            "Levels",
            "From the root to the deepest leaf, of the trees that a ray goes through one after the other",
            |column| f64::from(column.levels),
            neither,
        ),
        (
            "Largest leaf",
            "The most triangles that one leaf holds",
            |column| f64::from(column.largest_leaf),
            neither,
        ),
        (
            "Triangles",
            "Of all objects: a mesh that two objects share counts twice",
            |column| column.triangles as f64,
            neither,
        ),
    ];
    let of = |(label, says, figure, cell): Figure| Row {
        label,
        says,
        cells: (performance.columns.iter())
            .map(|column| {
                let value = figure(column);
                cell(value, short(value), value.to_string())
            })
            .collect(),
    };
    figures.into_iter().map(of).collect()
}
