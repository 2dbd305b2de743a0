//! Why the pixel has its value: sentences, and where value and noise come from.

use super::super::says::Says;
use super::super::status::percent;
use crate::inspect::{Names, Source, color_text, explanation, sources};
use crate::trace::RayTree;
use bevy_egui::egui::{Grid, Label, RichText, Ui};

/// What was found out of which rays with which names.
#[derive(Default)]
pub(super) struct Why {
    of: Option<(u64, u64)>,
    sentences: Vec<String>,
    sources: Vec<Source>,
}

pub(super) fn why_ui(ui: &mut Ui, names: &Names, why: &mut Why, (rays, number): (&RayTree, u64)) {
    let of = (number, names.version);
    if why.of != Some(of) {
        *why = Why {
            of: Some(of),
            sentences: explanation(rays, &names.things),
            sources: sources(rays),
        };
    }
    let count = rays.samples.len();
    let title = match count {
        1 => format!(
            "Pixel {}, {}, sample {}",
            rays.pixel.x, rays.pixel.y, rays.samples[0].index
        ),
        _ => format!("Pixel {}, {}, {count} samples", rays.pixel.x, rays.pixel.y),
    };
    ui.label(RichText::new(title).strong());
    for sentence in &why.sentences {
        ui.add(Label::new(format!("• {sentence}")).wrap());
    }
    if why.sentences.is_empty() {
        ui.add(Label::new("• every camera ray ends at a light").wrap());
    }
    ui.add_space(4.0);
    ui.spacing_mut().interact_size.y = 0.0;
    Grid::new("sources")
        .num_columns(3)
        .spacing([10.0, 2.0])
        .striped(true)
        .show(ui, |ui| {
            ui.weak("from")
                .says("What adds to the pixel at its first hit");
            ui.weak("mean")
                .says("What it adds, linear RGB; these add up to the value");
            if count > 1 {
                ui.weak("noise")
                    .says("Its share of the variance over the samples: where the noise is from");
            }
            ui.end_row();
            for source in &why.sources {
                ui.label(source.cause.name(&names.things));
                ui.monospace(color_text(source.mean));
                if count > 1 {
                    ui.monospace(percent(source.share));
                }
                ui.end_row();
            }
        });
}
