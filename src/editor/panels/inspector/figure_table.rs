//! A table with a column for each builder: figures side by side in a narrow panel.

use super::super::says::Says;
use super::super::theme::accent;
use crate::bvh::Builder;
use crate::editor::trees::{builder_title, of_setting, setting_of};
use crate::scene::RenderSettings;
use bevy::ecs::world::World;
use bevy_egui::egui::{Align, Button, Color32, Grid, Label, Layout, RichText, Ui, vec2};

/// The size of figures.
const FONT: f32 = 11.5;
/// The part of the width that labels take.
const LABELS: f32 = 0.28;

/// Of what a table has a row: its label, what it says, how it is found in a column, and which is the best.
pub(super) type Figure<C> = (&'static str, &'static str, fn(&C) -> Option<f64>, Better);

/// Whose column it is, what it has, and whether its figures can be the best.
pub(super) type Column<'a, C> = (Builder, &'a C, bool);

/// Which of several figures is the best.
#[derive(Clone, Copy)]
pub(super) enum Better {
    Less,
    More,
    Neither,
}

/// A figure.
#[derive(Clone, Debug, PartialEq)]
struct Cell {
    /// As it is shown, short.
    text: String,
    /// With all digits, where the pointer is over it.
    exact: String,
    /// Lower is better; NaN where that means nothing.
    rank: f64,
}

impl Cell {
    fn of(figure: Option<f64>, better: Better) -> Self {
        let value = figure.unwrap_or(f64::NAN);
        Self {
            text: figure.map_or_else(|| "–".into(), short),
            exact: figure.map_or_else(|| "The view has no such ray".into(), |f| f.to_string()),
            rank: match better {
                Better::Less => value,
                Better::More => -value,
                Better::Neither => f64::NAN,
            },
        }
    }
}

/// A builder's colour in plots and headings.
pub(super) fn color(ui: &Ui, builder: Builder) -> Color32 {
    match builder {
        Builder::None => ui.visuals().weak_text_color(),
        Builder::Ploc => accent(ui),
        _ => ink_of(builder, ui.visuals().dark_mode),
    }
}

fn ink_of(builder: Builder, dark: bool) -> Color32 {
    match (builder, dark) {
        (Builder::Median, true) => Color32::from_rgb(240, 176, 72),
        (Builder::Median, false) => Color32::from_rgb(150, 84, 0),
        (_, true) => Color32::from_rgb(170, 146, 248),
        (_, false) => Color32::from_rgb(98, 70, 190),
    }
}

/// Draws it. A click on a heading has the scene's trees built with its builder; that of the scene is pressed in.
pub(super) fn figure_table_ui<C>(
    ui: &mut Ui,
    world: &mut World,
    id: &str,
    columns: &[Column<C>],
    figures: &[Figure<C>],
) {
    let scene = of_setting(world.resource::<RenderSettings>().tree.builder);
    let mut clicked = None;
    let spacing = 4.0;
    let whole = ui.available_width() - 8.0;
    let labels = (whole * LABELS).clamp(60.0, 120.0);
    let column = (whole - labels) / columns.len().max(1) as f32 - spacing;
    let column = column.clamp(30.0, 110.0);
    let height = 16.0;
    Grid::new(id)
        .num_columns(columns.len() + 1)
        .spacing([spacing, 1.0])
        .striped(true)
        .show(ui, |ui| {
            ui.allocate_exact_size(vec2(labels, height), bevy_egui::egui::Sense::hover());
            for &(builder, ..) in columns {
                let text = RichText::new(builder_title(builder))
                    .size(FONT)
                    .color(color(ui, builder));
                let says = match builder == scene {
                    true => "The scene's trees are built with this one".to_owned(),
                    false => format!(
                        "Click: the scene's trees are built with {} from now on; undo takes it back",
                        builder_title(builder)
                    ),
                };
                let button = Button::selectable(builder == scene, text);
                let response = ui.add_sized(vec2(column, 18.0), button).says(&says);
                if response.clicked() && builder != scene {
                    clicked = Some(builder);
                }
            }
            ui.end_row();
            for &(label, says, figure, better) in figures {
                let label = Label::new(RichText::new(label).size(FONT)).truncate();
                ui.allocate_ui_with_layout(
                    vec2(labels, height),
                    Layout::left_to_right(Align::Center),
                    |ui| {
                        ui.set_min_width(labels);
                        ui.add(label).says(says);
                    },
                );
                let cell = |&(_, of, is_judged): &Column<C>| match is_judged {
                    true => Cell::of(figure(of), better),
                    false => Cell::of(figure(of), Better::Neither),
                };
                let cells: Vec<Cell> = columns.iter().map(cell).collect();
                let best = best(&cells);
                for cell in &cells {
                    let mut text = RichText::new(&cell.text).size(FONT);
                    if best == Some(cell.rank) {
                        text = text.strong();
                    }
                    let label = Label::new(text).truncate();
                    ui.allocate_ui_with_layout(
                        vec2(column, height),
                        Layout::right_to_left(Align::Center),
                        |ui| {
                            ui.set_min_width(column);
                            ui.add(label).says(&cell.exact);
                        },
                    );
                }
                ui.end_row();
            }
        });
    if let Some(builder) = clicked {
        world.resource_mut::<RenderSettings>().tree.builder = setting_of(builder);
    }
}

/// The best rank where not all are alike.
fn best(cells: &[Cell]) -> Option<f64> {
    let ranks = || {
        let ranks = cells.iter().map(|cell| cell.rank);
        ranks.filter(|rank| !rank.is_nan())
    };
    let (least, most) = (
        ranks().min_by(f64::total_cmp)?,
        ranks().max_by(f64::total_cmp)?,
    );
    (least < most).then_some(least)
}

/// `950`, `87.0k`, `1.31M`.
fn short(number: f64) -> String {
    match number.abs() {
        n if n >= 99_950_000.0 => format!("{:.0}M", number * 1e-6),
        n if n >= 999_500.0 => format!("{:.2}M", number * 1e-6),
        n if n >= 99_950.0 => format!("{:.0}k", number * 1e-3),
        n if n >= 9_999.5 => format!("{:.1}k", number * 1e-3),
        _ if number.fract() == 0.0 => format!("{number:.0}"),
        n if n >= 99.95 => format!("{number:.0}"),
        n if n >= 9.995 => format!("{number:.1}"),
        n if n >= 0.0995 => format!("{number:.2}"),
        _ => format!("{number:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::theme::tests::assert_readable;
    use super::*;
    use bevy_egui::egui::Theme;

    #[test]
    fn figures_are_short_enough_for_a_column() {
        let numbers = [
            0.0,
            7.0,
            0.0123,
            0.25,
            3.456,
            34.56,
            345.6,
            1234.0,
            87_042.0,
            174_083.0,
            1_310_000.0,
            2.5e9,
        ];
        let texts = numbers.map(short);
        assert_eq!(
            texts,
            [
                "0", "7", "0.012", "0.25", "3.46", "34.6", "346", "1234", "87.0k", "174k", "1.31M",
                "2500M"
            ]
        );
        assert!(texts.iter().all(|text| text.len() <= 5));
    }

    #[test]
    fn the_builders_names_can_be_read_in_both_themes() {
        for theme in [Theme::Dark, Theme::Light] {
            for builder in [Builder::Median, Builder::Sah] {
                let ink = ink_of(builder, theme == Theme::Dark);
                assert_readable(theme, ink, &builder_title(builder));
            }
        }
    }

    #[test]
    fn the_best_is_the_least_of_what_counts_and_none_where_all_are_alike() {
        let cell = |rank| Cell::of(Some(rank), Better::Less);
        assert_eq!(best(&[cell(3.0), cell(f64::NAN), cell(1.0)]), Some(1.0));
        assert_eq!(best(&[cell(2.0), cell(2.0)]), None);
        assert_eq!(best(&[cell(f64::NAN)]), None);
        assert_eq!(Cell::of(Some(5.0), Better::More).rank, -5.0);
    }
}
