//! The performance test: the view rendered several times with each builder's trees.

use super::super::fields::number_row;
use super::super::save_form::{SaveForm, TABLES, is_csv, save_ui};
use super::super::says::Says;
use super::figure_table::{Better, Figure, figure_table_ui};
use super::measuring::measure_ui;
use crate::editor::trees::measure::{Measurements, test_performance};
use crate::report::performance::PerformanceColumn;
use crate::scene::Quantity;
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
    let columns = done.columns.iter();
    let columns: Vec<_> = columns.map(|of| (of.builder, of, true)).collect();
    figure_table_ui(ui, world, "performance", &columns, FIGURES);
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

/// A row for each.
const FIGURES: &[Figure<PerformanceColumn>] = &[
    (
        "Create, ms",
        "All trees of the scene",
        |column| Some(column.build_ms),
        Better::Less,
    ),
    (
        "Mean, ms",
        "Of a rendering",
        |column| Some(column.mean()),
        Better::Less,
    ),
    (
        "Min, ms",
        "The shortest rendering",
        |column| Some(column.least()),
        Better::Less,
    ),
    (
        "Max, ms",
        "The longest rendering",
        |column| Some(column.most()),
        Better::Less,
    ),
    (
        "Sigma, ms",
        "Standard deviation of one rendering; the mean is uncertain by about this over the root of the \
         number of renderings",
        |column| Some(column.sigma()),
        Better::Neither,
    ),
    (
        "Mrays / s",
        "Million rays of every kind a second in the median rendering",
        |column| Some(column.mrays_per_s()),
        Better::More,
    ),
    (
        "Levels",
        "From the root to the deepest leaf, of the trees that a ray goes through one after the other",
        |column| Some(f64::from(column.levels)),
        Better::Neither,
    ),
    (
        "Largest leaf",
        "The most triangles that one leaf holds",
        |column| Some(f64::from(column.largest_leaf)),
        Better::Neither,
    ),
    (
        "Triangles",
        "Of all objects: a mesh that two objects share counts twice",
        |column| Some(column.triangles as f64),
        Better::Neither,
    ),
];
